// The view of the body with its legend, probe, views, and the controls of what is shown.

import { Box3, Vector3 } from "three";
import { Actuator } from "pneuflex/actuator";
import { decimalsFor, fixed } from "pneuflex/format";
import { Axes } from "pneuflex/axes";
import { FIELDS, Legend, evenMarks, legendTicks } from "pneuflex/legend";
import { Obstacles } from "pneuflex/obstacles";
import { Probe } from "pneuflex/probe";
import { Stage } from "pneuflex/stage";
import { States } from "pneuflex/states";

/** How far from the body, relative to its size, obstacles are in sight. */
const NEAR = 0.6;

const byId = (id) => document.getElementById(id);

export class Viewer {
  constructor(body, clock) {
    this.clock = clock;
    this.states = new States(body);
    this.actuator = new Actuator(body, this.states);
    this.obstacles = new Obstacles(body.obstacles ?? [], this.states.size);
    this.stage = new Stage(byId("canvas"), () => this.outline());
    this.stage.scene.add(this.actuator.group, this.obstacles.group);
    this.legend = new Legend(byId("legend"));
    this.probe = new Probe(byId("probe"), this.stage, this.actuator, body);
    const renderOnly = this.stage.render.bind(this.stage);
    this.axes = new Axes(byId("axes"), this.stage);
    this.stage.render = () => {
      this.probe.scale();
      this.axes.update();
      renderOnly();
    };
    this.connect();
    clock.listen((value) => this.showTime(value));
    this.showParts();
    this.useTheme();
    this.stage.look("iso", false);
  }

  connect() {
    const on = (id, event, act) => byId(id)?.addEventListener(event, act);
    byId("options").addEventListener("change", (event) => {
      if (event.target.name === "field") this.useField(event.target.value);
      if (event.target.id === "more-fields" && event.target.value) this.useField(event.target.value);
      if (event.target.name === "section") this.chooseAxis(event.target.value);
    });
    on("fit", "change", () => this.showLegend());
    for (const id of ["low", "high"]) on(id, "input", () => this.showLegend());
    for (const id of ["whole", "obstacles", "ghost", "mesh"]) on(id, "change", () => this.showParts());
    on("cut", "input", () => this.cut());
    on("flip", "click", () => {
      this.side = -this.side;
      this.cut();
    });
    document.querySelectorAll("[data-view]").forEach((button) =>
      button.addEventListener("click", () => {
        if (button.dataset.view === "reset") this.probe.choose(null);
        this.stage.look(button.dataset.view === "reset" ? "iso" : button.dataset.view);
      }),
    );
    this.side = 1;
  }

  showTime(value) {
    const began = performance.now();
    this.states.evaluate(value);
    this.actuator.update();
    this.obstacles.move(value);
    this.probe.update();
    this.showLegend();
    this.updateTime = performance.now() - began;
    this.stage.requestRender();
  }

  useField(field) {
    this.states.prepare(field);
    this.actuator.useField(field);
    const radio = document.querySelector(`input[name=field][value=${field}]`);
    document.querySelectorAll("input[name=field]").forEach((input) => (input.checked = input === radio));
    byId("more-fields").value = radio ? "" : field;
    // A range by hand is one of a field.
    byId("low").value = byId("high").value = "";
    this.showTime(this.clock.value);
  }

  /** The range by hand, in the shown unit; null if there is none. */
  ownRange() {
    const ends = ["low", "high"].map((id) => (byId(id).value.trim() === "" ? NaN : Number(byId(id).value)));
    const isWanted = ends.some((end) => !Number.isNaN(end));
    const isRange = ends[0] < ends[1];
    for (const id of ["low", "high"]) byId(id).toggleAttribute("aria-invalid", isWanted && !isRange);
    return isRange ? ends : null;
  }

  showLegend() {
    const { field } = this.actuator;
    const { scale, map } = FIELDS[field];
    const own = this.ownRange();
    const typical = byId("fit").checked ? this.states.typicalAt(field, this.clock.value) : this.states.typicalOf(field);
    // Of both signs, zero is light.
    const most = Math.max(...typical.map(Math.abs));
    const range = map === "signed" ? [-most, most] : typical;
    this.marks = own ? evenMarks(own) : legendTicks(range.map((x) => scale * x));
    this.actuator.useRange([this.marks[0], this.marks[this.marks.length - 1]].map((x) => x / scale));
    this.legend.show(field, this.marks, this.states.extremes(field).map((x) => scale * x));
    this.stage.requestRender();
  }

  showParts() {
    this.actuator.show({ whole: Boolean(byId("whole")?.checked), mesh: byId("mesh").checked, ghost: byId("ghost").checked });
    this.obstacles.show(Boolean(byId("obstacles")?.checked), this.actuator.whole);
    if (this.plane) this.chooseAxis("xyz"[this.plane.axis]);
    this.stage.requestRender();
  }

  chooseAxis(name) {
    const axis = "xyz".indexOf(name);
    const slider = byId("cut");
    for (const id of ["cut", "flip"]) byId(id).disabled = axis < 0;
    if (axis >= 0) {
      const [least, high] = this.states.box.map((corner) => corner[axis]);
      const low = axis === 1 && this.actuator.whole ? -high : least;
      const changed = this.plane?.axis !== axis;
      [slider.min, slider.max] = [low, high];
      // A first cut shows something: through the middle, or along the body beside its symmetry plane.
      if (changed) slider.value = axis === 1 && this.actuator.whole ? 0 : (low + high) / 2;
      if (changed) this.side = axis === 1 ? -1 : 1;
    }
    this.axis = axis;
    this.cut();
  }

  cut() {
    const { axis, side } = this;
    const at = Number(byId("cut").value);
    // A hair beside the number, because cuts through whole layers of nodes, and along the seam of both halves, are ambiguous.
    this.plane = axis >= 0 ? { axis, at: at + 3e-4 * this.states.size, side } : null;
    const decimals = Math.max(1, decimalsFor(this.states.size, 3));
    byId("cut-readout").textContent = axis < 0 ? "–" : `${"xyz"[axis]} = ${fixed(at + this.states.origin[axis], decimals)} mm`;
    this.actuator.cut(this.plane);
    this.stage.requestRender();
  }

  /** Corners of what is ever in sight: the shapes at all computed times, and what of obstacles is near. */
  outline() {
    const { skinNodes, whole } = this.actuator;
    const points = [];
    for (let v = 0; v < skinNodes.length; v += 7) {
      for (const [x, y, z] of this.states.placesOf(skinNodes[v])) {
        points.push(new Vector3(x, y, z));
        if (whole) points.push(new Vector3(x, -y, z));
      }
    }
    const near = new Box3().setFromPoints(points).expandByScalar(NEAR * this.states.size);
    for (const box of this.obstacles.boxes()) {
      if (box.intersect(near).isEmpty()) continue;
      for (const x of [box.min.x, box.max.x]) for (const y of [box.min.y, box.max.y]) for (const z of [box.min.z, box.max.z]) points.push(new Vector3(x, y, z));
    }
    this.obstacles.move(this.clock.value);
    return points;
  }

  useTheme() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => [1, 3, 5].map((i) => parseInt(style.getPropertyValue(name).trim().slice(i, i + 2), 16) / 255);
    this.actuator.useLineColours(colour("--line"), colour("--ghost"));
    this.obstacles.useColours(colour("--obstacle"), colour("--ghost"));
    this.stage.requestRender();
  }

  /** Where a node of the modelled half is on the page. */
  placeOnPage(node) {
    return this.onPage(new Vector3(...this.states.position.subarray(3 * node, 3 * node + 3)));
  }

  onPage(point) {
    const [x, y] = this.stage.project(point);
    const { left, top } = this.stage.canvas.getBoundingClientRect();
    return [left + x, top + y];
  }

  /** Every shown obstacle's name, and the centre of what is drawn: in space, mm, and on the page. */
  obstacleCentres() {
    const { group, list } = this.obstacles;
    return list.filter(() => group.visible).map(({ data, moving: [object] }) => {
      const centre = object.position.clone().add(new Vector3(...data.centre));
      return { name: data.name, centre: centre.toArray().map((x, d) => x + this.states.origin[d]), onPage: this.onPage(centre) };
    });
  }
}
