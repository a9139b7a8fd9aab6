// The view as a picture: for the button, and for paper.

import { colourAt } from "pneuflex/colours";
import { tickTexts } from "pneuflex/format";
import { FIELDS } from "pneuflex/legend";

/** The view with legend, title and time on a canvas of its own. */
export function picture(viewer, title) {
  const { width, height } = viewer.stage.canvas;
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  viewer.stage.render();
  paint(viewer, title, canvas);
  return canvas;
}

/** Paints what was rendered just now, with legend, title and time. */
export function paint(viewer, title, canvas) {
  const { stage, actuator, marks, clock } = viewer;
  const { width, height } = canvas;
  const style = getComputedStyle(document.documentElement);
  const draw = canvas.getContext("2d");
  const unit = width / stage.canvas.clientWidth;
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.textAlign = "start";
  draw.fillStyle = style.getPropertyValue("--stage");
  draw.fillRect(0, 0, width, height);
  draw.drawImage(stage.canvas, 0, 0, width, height);
  draw.scale(unit, unit);
  draw.fillStyle = style.getPropertyValue("--ink");
  draw.font = "600 15px system-ui, sans-serif";
  draw.fillText(`${title} · ${clock.words(clock.value)}`, 20, height / unit - 20);
  drawLegend(draw, actuator.field, marks);
}

function drawLegend(draw, field, marks) {
  const { name, unit, map } = FIELDS[field];
  draw.font = "600 13px system-ui, sans-serif";
  draw.fillText([name, unit].filter(Boolean).join(", "), 20, 30);
  for (let x = 0; x < 220; x++) {
    draw.fillStyle = `rgb(${colourAt(map, x / 219)})`;
    draw.fillRect(20 + x, 38, 1.5, 10);
  }
  draw.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--ink");
  draw.font = "12px system-ui, sans-serif";
  draw.textAlign = "center";
  tickTexts(marks).forEach((text, i) => draw.fillText(text, 20 + (220 * i) / (marks.length - 1), 63));
}

/** A title as the name of a file. */
export const fileName = (title) => title.replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "") || "body";

/** Lets the browser save what is at an address. */
export function save(address, name) {
  Object.assign(document.createElement("a"), { href: address, download: name }).click();
}

/** Connects the button, and puts a picture in the canvas's place on paper, where there are no three-dimensional graphics. */
export function connectSnapshots(viewer, title) {
  document.getElementById("snapshot").addEventListener("click", () => {
    save(picture(viewer, title).toDataURL("image/png"), `${fileName(title)}.png`);
  });
  window.addEventListener("beforeprint", () => {
    viewer.stage.render();
    document.getElementById("printout").src = viewer.stage.canvas.toDataURL("image/png");
  });
}
