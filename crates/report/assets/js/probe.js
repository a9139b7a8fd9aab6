// Reading values at a node: a click chooses it, the numbers follow the time.

import { Mesh, MeshBasicMaterial, Raycaster, SphereGeometry, Triangle, Vector2, Vector3 } from "three";
import { decimalsFor, fixed } from "pneuflex/format";

export class Probe {
  constructor(element, stage, actuator, body) {
    Object.assign(this, { element, stage, actuator });
    this.names = new Map(body.probes.map(({ name, node }) => [node, name]));
    this.node = null;
    this.sign = 1;
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
      if (moved < 5 && event.button === 0) this.pick(event);
    });
    canvas.addEventListener("keydown", (event) => event.key === "Escape" && this.choose(null));
  }

  pick({ clientX, clientY }) {
    const { left, top, width, height } = this.stage.canvas.getBoundingClientRect();
    const pointer = new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height);
    const raycaster = new Raycaster();
    raycaster.setFromCamera(pointer, this.stage.camera);
    const targets = this.actuator.halves
      .filter(({ half }) => half.visible)
      .flatMap((half) => [half.skin, half.cap].filter((mesh) => mesh.visible).map((mesh) => ({ mesh, half })));
    const owner = new Map(targets.map(({ mesh, half }) => [mesh, half]));
    const hit = raycaster.intersectObjects([...owner.keys()], false).find((hit) => this.isShown(hit));
    if (hit) this.choose(this.nodeAt(hit, owner.get(hit.object)), owner.get(hit.object).sign);
    else this.choose(null);
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

  /** The node nearest to what was hit. */
  nodeAt({ object, point, face }, half) {
    const local = object.worldToLocal(point.clone());
    const { position } = object.geometry.attributes;
    const distance = (i) => new Vector3().fromBufferAttribute(position, i).distanceTo(local);
    const nearest = [face.a, face.b, face.c].reduce((a, b) => (distance(b) < distance(a) ? b : a));
    return object === half.cap ? half.section.nodeAt(nearest) : this.actuator.skinNodes[nearest];
  }

  /** Chooses a node of the modelled half (sign 1) or of its mirror image (−1); null: none. */
  choose(node, sign = 1) {
    this.node = node;
    this.sign = sign;
    this.update();
    this.stage.requestRender();
  }

  /** Everything at the chosen node, in mm and MPa; null if there is none. */
  reading() {
    if (this.node === null) return null;
    const { nodes, position, displacement, values } = this.actuator.states;
    const mirrored = (vector) => vector.map((x, d) => (d === 1 ? this.sign : 1) * x);
    const place = (positions) => mirrored(this.actuator.states.place(positions, this.node));
    return {
      node: this.node,
      reference: place(nodes),
      position: place(position),
      displacement: mirrored(Array.from(displacement.subarray(3 * this.node, 3 * this.node + 3))),
      vonMises: values.vonMises[this.node],
      contactPressure: values.contactPressure[this.node],
    };
  }

  update() {
    const reading = this.reading();
    this.marker.visible = Boolean(reading);
    this.element.hidden = !reading;
    if (!reading) return;
    const { origin, size } = this.actuator.states;
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
    const name = this.names.get(this.node);
    this.element.replaceChildren(heading(`Node ${this.node}${name === undefined ? "" : ` · ${name}`}`, () => this.choose(null)), table(rows));
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
