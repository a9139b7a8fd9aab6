// Reading values at a node: a click chooses it, the numbers follow the time.

import { Mesh, MeshBasicMaterial, Raycaster, SphereGeometry, Triangle, Vector2, Vector3 } from "three";
import { decimalsFor, fixed, short } from "pneuflex/format";
import { onImage, signOf } from "pneuflex/images";
import { FIELDS } from "pneuflex/legend";

/** Fields that have rows of their own. */
const ALWAYS = ["vonMises", "displacement", "contactPressure"];
const PART = [1, 1, 1];

export class Probe {
  constructor(element, stage, body, probes) {
    Object.assign(this, { element, stage, body });
    this.names = new Map(probes.map(({ name, node }) => [node, name]));
    this.node = null;
    this.signs = PART;
    /** Whether clicks are for something else. */
    this.isOff = false;
    const ring = (radius, colour) =>
      new Mesh(new SphereGeometry(radius, 20, 14), new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true }));
    this.marker = ring(1, 0xffffff);
    this.dot = ring(0.62, 0x0b6e75);
    [this.marker.renderOrder, this.dot.renderOrder] = [10, 11];
    this.marker.add(this.dot);
    this.marker.visible = false;
    stage.scene.add(this.marker);
    stage.renderer.setClearAlpha(0);
    this.listen(stage.canvas);
  }

  listen(canvas) {
    let start = null;
    canvas.addEventListener("pointerdown", (event) => (start = event.isPrimary ? [event.clientX, event.clientY] : null));
    canvas.addEventListener("pointerup", (event) => {
      const moved = start ? Math.hypot(event.clientX - start[0], event.clientY - start[1]) : Infinity;
      start = null;
      if (moved < 5 && event.button === 0 && !this.isOff) this.pick(event);
    });
    canvas.addEventListener("keydown", (event) => event.key === "Escape" && this.choose(null));
  }

  pick({ clientX, clientY }) {
    const { left, top, width, height } = this.stage.canvas.getBoundingClientRect();
    const pointer = new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    const raycaster = new Raycaster();
    raycaster.setFromCamera(pointer, this.stage.camera);
    const targets = new Map(this.body.targets().map((target) => [target.mesh, target]));
    const hit = raycaster.intersectObjects([...targets.keys()], false).find((hit) => this.isShown(hit));
    if (!hit) return this.choose(null);
    const { image, nodeOf } = targets.get(hit.object);
    this.choose(nodeOf(this.nearest(hit)), image.signs);
  }

  /** Whether the section leaves the place that was hit. */
  isShown({ object, point, face }) {
    const plane = object.material.uniforms.plane.value;
    const { position, reference } = object.geometry.attributes;
    const corners = (attribute) => [face.a, face.b, face.c].map((i) => new Vector3().fromBufferAttribute(attribute, i));
    const place = new Vector3();
    Triangle.getInterpolation(object.worldToLocal(point.clone()), ...corners(position), ...corners(reference), place);
    return place.dot(new Vector3(plane.x, plane.y, plane.z)) <= plane.w + 1e-6;
  }

  /** The corner of the triangle that is nearest to what was hit. */
  nearest({ object, point, face }) {
    const local = object.worldToLocal(point.clone());
    const { position } = object.geometry.attributes;
    const distance = (i) => new Vector3().fromBufferAttribute(position, i).distanceTo(local);
    return [face.a, face.b, face.c].reduce((a, b) => (distance(b) < distance(a) ? b : a));
  }

  /** Chooses a node of the modelled part or, by the signs, of an image of it; null: none. */
  choose(node, signs = PART) {
    this.node = node;
    this.signs = signs;
    this.update();
    this.stage.requestRender();
  }

  /** Everything at the chosen node, in mm and MPa; null if there is none. */
  reading() {
    if (this.node === null) return null;
    const { states, field } = this.body;
    const { nodes, position, displacement, values, origin } = states;
    const vector = (list) => onImage(this.signs, Array.from(list.subarray(3 * this.node, 3 * this.node + 3)));
    const place = (list) => vector(list).map((x, d) => x + origin[d]);
    const isThere = !FIELDS[field].isOfSurface || states.isOnSurface[this.node];
    return {
      node: states.numberOf(this.node),
      reference: place(nodes),
      position: place(position),
      displacement: vector(displacement),
      vonMises: values.vonMises[this.node],
      contactPressure: values.contactPressure[this.node],
      /** What is shown in colour; null where there is none of it. */
      shown: isThere ? signOf(field, this.signs) * values[field][this.node] : null,
    };
  }

  update() {
    const reading = this.reading();
    this.marker.visible = Boolean(reading);
    this.element.hidden = !reading;
    if (!reading) return;
    const { field, states } = this.body;
    const { origin, size } = states;
    this.marker.position.set(...reading.position.map((x, d) => x - origin[d]));
    const decimals = Math.max(3, decimalsFor(size, 4));
    const vector = (v) => v.map((x) => fixed(x, decimals)).join(", ");
    const rows = [
      ["undeformed", vector(reading.reference), "mm"],
      ["deformed", vector(reading.position), "mm"],
      ["displacement", vector(reading.displacement), "mm"],
      ["", `|u| = ${fixed(Math.hypot(...reading.displacement), decimals)}`, "mm"],
      ["von Mises", fixed(reading.vonMises, 4), "MPa"],
      ["contact", fixed(1000 * reading.contactPressure, 2), "kPa"],
    ];
    if (!ALWAYS.includes(field)) {
      const { name, unit, scale } = FIELDS[field];
      rows.push([name, reading.shown === null ? "not inside" : short(scale * reading.shown), unit]);
    }
    const name = this.names.get(reading.node);
    this.element.replaceChildren(heading(`Node ${reading.node}${name === undefined ? "" : ` · ${name}`}`, () => this.choose(null)), table(rows));
  }

  /** Keeps the marker's size on the screen. */
  scale() {
    const { camera } = this.stage;
    const distance = camera.position.distanceTo(this.marker.position);
    this.marker.scale.setScalar(distance * 0.015 * Math.tan((camera.fov * Math.PI) / 360));
  }
}

function heading(text, close) {
  const p = Object.assign(document.createElement("p"), { className: "name", textContent: text });
  const button = Object.assign(document.createElement("button"), { type: "button", textContent: "×", onclick: close });
  button.setAttribute("aria-label", "Close the readings");
  p.append(button);
  return p;
}

function table(rows) {
  const element = document.createElement("table");
  for (const texts of rows) {
    const row = element.insertRow();
    texts.forEach((text) => (row.insertCell().textContent = text));
  }
  return element;
}
