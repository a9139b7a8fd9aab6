// The view of the body with its legend, probe, views, and the controls of what is shown.

import { Box3, Vector3 } from "three";
import { Axes } from "pneuflex/axes";
import { Body } from "pneuflex/body";
import { decimalsFor, fixed } from "pneuflex/format";
import { FIELDS, Legend, evenMarks, legendTicks } from "pneuflex/legend";
import { Obstacles } from "pneuflex/obstacles";
import { Photo } from "pneuflex/photo";
import { Probe } from "pneuflex/probe";
import { Stage } from "pneuflex/stage";
import { States } from "pneuflex/states";

/** How far from the body, relative to its size, obstacles are in sight. */
const NEAR = 0.6;

const byId = (id) => document.getElementById(id);

/** Which of the numbered ticks of a kind are set. */
const ticked = (kind) => [...document.querySelectorAll(`[data-${kind}]`)].map((box) => box.checked);

export class Viewer {
  /** @param data `body` of the page's data */
  constructor(data, clock) {
    this.clock = clock;
    this.states = new States(data);
    this.body = new Body(data, this.states);
    this.obstacles = new Obstacles(data.obstacles ?? [], this.states.size);
    this.stage = new Stage(byId("canvas"), () => this.outline());
    this.stage.scene.add(this.body.group, this.obstacles.group);
    this.legend = new Legend(byId("legend"));
    this.probe = new Probe(byId("probe"), this.stage, this.body, data.probes);
    this.axes = new Axes(byId("axes"), this.stage);
    this.photo = new Photo(this.stage, (isOff) => (this.probe.isOff = isOff));
    this.stage.beforeRender = () => {
      this.probe.scale();
      this.axes.update();
      this.photo.update();
    };
    /** Ranges by hand, in the shown unit: of all, or of the regions by their numbers. */
    this.byHand = new Map();
    this.side = 1;
    this.connect();
    clock.listen((value) => this.showTime(value));
    this.showParts();
    this.useTheme();
    this.stage.look("iso", false);
  }

  connect() {
    const on = (id, event, act) => byId(id)?.addEventListener(event, act);
    byId("options").addEventListener("change", ({ target }) => {
      if (target.name === "field" || (target.id === "more-fields" && target.value)) this.useField(target.value);
      if (target.name === "section") this.chooseAxis(target.value);
      if (["whole", "ghost", "mesh"].includes(target.id) || "region" in target.dataset || "obstacle" in target.dataset) this.showParts();
    });
    for (const id of ["fit", "own-ranges", "range-of"]) on(id, "change", () => this.showRange());
    for (const id of ["low", "high"]) on(id, "input", () => this.setRange());
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
  }

  showTime(value) {
    const began = performance.now();
    this.states.evaluate(value);
    this.body.update();
    this.obstacles.move(value);
    this.probe.update();
    this.showLegend();
    this.updateTime = performance.now() - began;
    this.stage.requestRender();
  }

  useField(field) {
    this.states.prepare(field);
    this.body.useField(field);
    const radio = document.querySelector(`input[name=field][value=${field}]`);
    document.querySelectorAll("input[name=field]").forEach((input) => (input.checked = input === radio));
    byId("more-fields").value = radio ? "" : field;
    // A range by hand is one of a field.
    this.byHand.clear();
    this.showTime(this.clock.value);
    this.showRange();
  }

  /** Whose range is set by hand: a region's number, or all. */
  get rangeOf() {
    return byId("own-ranges")?.checked ? Number(byId("range-of").value) : "all";
  }

  /** Takes over what was written as a range. */
  setRange() {
    const ends = ["low", "high"].map((id) => (byId(id).value.trim() === "" ? NaN : Number(byId(id).value)));
    const isWanted = ends.some((end) => !Number.isNaN(end));
    const isRange = ends[0] < ends[1];
    for (const id of ["low", "high"]) byId(id).toggleAttribute("aria-invalid", isWanted && !isRange);
    if (isRange) this.byHand.set(this.rangeOf, ends);
    else this.byHand.delete(this.rangeOf);
    this.showLegend();
  }

  /** Writes the range by hand where it can be changed. */
  showRange() {
    const label = byId("range-of-label");
    if (label) label.hidden = this.rangeOf === "all";
    const range = this.byHand.get(this.rangeOf) ?? ["", ""];
    ["low", "high"].forEach((id, end) => {
      byId(id).value = range[end];
      byId(id).removeAttribute("aria-invalid");
    });
    this.showLegend();
  }

  showLegend() {
    const { field, regions } = this.body;
    /** What the legend says: a row for all, or for every region. */
    this.rows = this.rangeOf === "all" ? [this.row()] : regions.map(({ name }, number) => ({ ...this.row(number), name, number }));
    const { scale } = FIELDS[field];
    const range = ({ marks }) => [marks[0], marks[marks.length - 1]].map((x) => x / scale);
    this.body.useRanges(regions.map((_, number) => range(this.rows[number] ?? this.rows[0])));
    this.legend.show(field, this.rows.filter(({ number }) => number === undefined || regions[number].isShown));
    this.stage.requestRender();
  }

  /** Marks and present values of a region, or of the whole body. */
  row(region) {
    const { states, clock, byHand } = this;
    const { field } = this.body;
    const { scale, map } = FIELDS[field];
    const typical = byId("fit").checked ? states.typicalAt(field, clock.value, region) : states.typicalOf(field, region);
    // Of both signs, zero is light.
    const most = Math.max(...typical.map(Math.abs));
    const range = map === "signed" ? [-most, most] : typical;
    const own = byHand.get(region ?? "all");
    const present = states.extremes(field, region);
    // The largest stress of the whole body is the one that the table has.
    const isOfTable = field === "vonMises" && region === undefined;
    if (isOfTable) present[1] = states.largestVonMises(clock.value);
    return {
      marks: own ? evenMarks(own) : legendTicks(range.map((x) => scale * x)),
      present: present.map((x) => scale * x),
      at: isOfTable ? "" : "at nodes",
    };
  }

  showParts() {
    const regions = ticked("region");
    this.body.show({
      whole: Boolean(byId("whole")?.checked),
      mesh: byId("mesh").checked,
      ghost: byId("ghost").checked,
      regions: this.body.regions.map((_, number) => regions[number] ?? true),
    });
    this.obstacles.show(ticked("obstacle"), this.body.whole);
    if (this.plane) this.chooseAxis("xyz"[this.plane.axis]);
    this.showLegend();
  }

  chooseAxis(name) {
    const axis = "xyz".indexOf(name);
    const slider = byId("cut");
    for (const id of ["cut", "flip"]) byId(id).disabled = axis < 0;
    if (axis >= 0) {
      const ends = this.states.box.map((corner) => corner[axis]);
      const isMirrored = this.body.whole && this.body.mirrored[axis];
      const far = Math.max(...ends.map(Math.abs));
      const [low, high] = isMirrored ? [-far, far] : ends;
      const changed = this.plane?.axis !== axis;
      [slider.min, slider.max] = [low, high];
      // A first cut shows something: through the middle, or along the body beside its symmetry plane.
      if (changed) slider.value = (low + high) / 2;
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
    this.body.cut(this.plane);
    this.stage.requestRender();
  }

  /** Corners of what is ever in sight: the shapes at all computed times, and what of obstacles is near. */
  outline() {
    const { skinNodes, whole, images } = this.body;
    const points = [];
    for (let v = 0; v < skinNodes.length; v += 7) {
      for (const place of this.states.placesOf(skinNodes[v])) {
        for (const { signs } of whole ? images : images.slice(0, 1)) points.push(new Vector3(...signs.map((sign, d) => sign * place[d])));
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
    this.body.useLineColours(colour("--line"), colour("--ghost"));
    this.obstacles.useColours(colour("--obstacle"), colour("--ghost"));
    this.stage.requestRender();
  }

  /** Where a node of the modelled part is on the page. */
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
    return this.obstacles.visible.map(({ data, moving: [object] }) => {
      const centre = object.position.clone().add(new Vector3(...data.centre));
      return { name: data.name, centre: centre.toArray().map((x, d) => x + this.states.origin[d]), onPage: this.onPage(centre) };
    });
  }
}
