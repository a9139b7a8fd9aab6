// The page of what would be solved: a pale body that one can look into, and what is on it in colours, with a tick for each.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  DirectionalLight,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  Points,
  PointsMaterial,
  Vector3,
} from "three";
import { floats, readData } from "pneuflex/data";
import { Stage, hasWebGL } from "pneuflex/stage";

/** Colours that colour-blind people can tell apart (Okabe & Ito 2008). */
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#8a6d00"];

/** Diameter of the dots of nodes, pixels. */
const DOT = 5;

/** Further parts have hues far from each other's, light and dark by turns, so that no two are alike. */
const colourOf = (number) => {
  if (number < COLOURS.length) return COLOURS[number];
  const hue = Math.round((137.508 * number + 60) % 360);
  return `hsl(${hue}, ${number % 2 ? 70 : 55}%, ${[38, 62, 50][number % 3]}%)`;
};

function geometry(positions) {
  const found = new BufferGeometry();
  found.setAttribute("position", new BufferAttribute(positions, 3));
  return found;
}

function faces(positions, options) {
  const shape = geometry(positions);
  shape.computeVertexNormals();
  return new Mesh(shape, new MeshLambertMaterial({ side: DoubleSide, ...options }));
}

function drawn(part, number) {
  const group = new Group();
  const colour = colourOf(number);
  // In front of the body's own faces, which are in the same place.
  const inFront = { polygonOffset: true, polygonOffsetFactor: -1 - number, polygonOffsetUnits: -1 - number };
  group.add(faces(floats(part.triangles), { color: colour, emissive: colour, emissiveIntensity: 0.25, ...inFront }));
  const dots = new PointsMaterial({ color: colour, size: DOT, sizeAttenuation: false });
  group.add(new Points(geometry(floats(part.points)), dots));
  return group;
}

const data = readData();
document.querySelectorAll(".part .swatch").forEach((swatch, number) => (swatch.style.background = colourOf(number)));

if (hasWebGL()) {
  const body = floats(data.body);
  const outline = [];
  for (let i = 0; i < body.length; i += 3) outline.push(new Vector3(body[i], body[i + 1], body[i + 2]));
  const stage = new Stage(document.getElementById("canvas"), () => outline);
  const light = new DirectionalLight(0xffffff, 2.2);
  light.position.set(-0.4, -1, 1.2);
  const pale = { color: 0xb8bfc8, transparent: true, opacity: 0.22, depthWrite: false };
  const shell = faces(body, pale);
  shell.renderOrder = 1;
  const edges = new LineSegments(geometry(floats(data.edges)), new LineBasicMaterial({ color: 0x7a838f }));
  stage.scene.add(new AmbientLight(0xffffff, 1.4), light, shell, edges);
  const parts = data.parts.map(drawn);
  parts.forEach((part) => stage.scene.add(part));
  document.querySelectorAll("[data-part]").forEach((box) =>
    box.addEventListener("change", () => {
      parts[Number(box.dataset.part)].visible = box.checked;
      stage.requestRender();
    }),
  );
  document.querySelectorAll("[data-view]").forEach((button) =>
    button.addEventListener("click", () => stage.look(button.dataset.view === "reset" ? "iso" : button.dataset.view)),
  );
  document.getElementById("snapshot").addEventListener("click", () => {
    stage.render();
    const link = document.createElement("a");
    link.download = `${document.title}.png`;
    link.href = document.getElementById("canvas").toDataURL("image/png");
    link.click();
  });
  stage.look("iso", false);
  /** What the page shows now, for tests and for the curious. Read only. */
  window.pneuflex = Object.freeze({
    get visible() {
      return parts.map((part) => part.visible);
    },
  });
} else {
  document.getElementById("stage").classList.add("empty");
  document.getElementById("no-view").hidden = false;
}
