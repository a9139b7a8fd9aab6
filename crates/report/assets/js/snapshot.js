// The view as a picture: for the button, and for paper.

import { colourAt } from "pneuflex/colours";
import { tickTexts } from "pneuflex/format";
import { FIELDS, beyond } from "pneuflex/legend";

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
  const { stage, body, rows, clock, photo } = viewer;
  const { width, height } = canvas;
  const style = getComputedStyle(document.documentElement);
  const draw = canvas.getContext("2d");
  const unit = width / stage.canvas.clientWidth;
  draw.setTransform(1, 0, 0, 1, 0, 0);
  draw.textAlign = "start";
  draw.fillStyle = style.getPropertyValue("--stage");
  draw.fillRect(0, 0, width, height);
  if (photo.isShown) {
    draw.setTransform(unit, 0, 0, unit, 0, 0);
    draw.transform(...photo.onScreen());
    draw.drawImage(photo.image, 0, 0);
    draw.setTransform(1, 0, 0, 1, 0, 0);
    draw.globalAlpha = Number(stage.canvas.style.opacity);
  }
  draw.drawImage(stage.canvas, 0, 0, width, height);
  draw.globalAlpha = 1;
  draw.scale(unit, unit);
  draw.fillStyle = style.getPropertyValue("--ink");
  draw.font = "600 15px system-ui, sans-serif";
  draw.fillText(`${title} · ${clock.words(clock.value)}`, 20, height / unit - 20);
  drawLegend(draw, body.field, rows);
}

function drawLegend(draw, field, rows) {
  const { name, unit, map } = FIELDS[field];
  const ink = draw.fillStyle;
  draw.font = "600 13px system-ui, sans-serif";
  draw.fillText([name, unit].filter(Boolean).join(", "), 20, 30);
  draw.font = "12px system-ui, sans-serif";
  let top = 38;
  for (const row of rows) {
    const { words } = beyond(row, unit);
    draw.textAlign = "start";
    if (row.name !== undefined) draw.fillText(row.name, 20, (top += 16) - 4);
    for (let x = 0; x < 220; x++) {
      draw.fillStyle = `rgb(${colourAt(map, x / 219)})`;
      draw.fillRect(20 + x, top, 1.5, 10);
    }
    draw.fillStyle = ink;
    if (words) draw.fillText(words, 20, top + 42);
    draw.textAlign = "center";
    tickTexts(row.marks).forEach((text, i) => draw.fillText(text, 20 + (220 * i) / (row.marks.length - 1), top + 25));
    top += words ? 52 : 34;
  }
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
