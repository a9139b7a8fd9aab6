// Plots against pressure as SVG, with a mark at the pressure shown. Dots are computed; the line between them is interpolated.

import { fixed, kPa, short, tickTexts, ticks } from "pneuflex/format";
import { Curve } from "pneuflex/interpolation";

const SIZE = { width: 360, height: 176, left: 46, right: 14, top: 12, bottom: 34 };

const QUANTITIES = [
  { key: "angle", name: "Bending angle", unit: "°" },
  { key: "volume", name: "Air volume", unit: "cm³" },
  { key: "contact_area", name: "Contact area", unit: "mm²" },
  { key: "stress", name: "von Mises stress, 99 %", unit: "MPa" },
];

function svg(name, attributes, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** A straight scale from an interval of numbers to one of pixels. */
function scale([low, high], [from, to]) {
  return (x) => from + ((x - low) / (high - low)) * (to - from);
}

class Plot {
  /** @param range `ticks` along x and y, and `ends` of the axes */
  constructor({ name, unit, xLabel, size = SIZE }, pressure, curve, range) {
    Object.assign(this, { name, unit, pressure, curve, size });
    [this.xTicks, this.yTicks] = range.ticks;
    const { width, height, left, right, top, bottom } = size;
    this.x = scale(range.ends[0], [left, width - right]);
    this.y = scale(range.ends[1], [height - bottom, top]);
    this.drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": this.description() });
    this.axes(xLabel);
    this.line();
    this.value = document.createElement("span");
    this.element = document.createElement("figure");
    const caption = document.createElement("figcaption");
    this.value.className = "value";
    caption.append(`${name}, ${unit}`, this.value);
    this.element.append(caption, this.drawing);
    this.drawing.addEventListener("pointermove", (event) => this.hover(event));
    this.drawing.addEventListener("pointerleave", () => this.hint.replaceChildren());
    this.drawing.addEventListener("click", (event) => pressure.set(pressure.snapped(this.pressureAt(event))));
    pressure.listen((value) => this.mark(value));
  }

  description() {
    const [from, to] = [0, this.pressure.highest].map((p) => this.text(this.at(p)));
    return `${this.name}: from ${from} at rest to ${to} at ${kPa(this.pressure.highest)} kPa`;
  }

  axes(xLabel) {
    const { width, height, left, right, bottom } = this.size;
    const grid = svg("g", { class: "grid" });
    const texts = svg("g", { class: "texts" });
    tickTexts(this.yTicks).forEach((text, i) => {
      const y = this.y(this.yTicks[i]);
      grid.append(svg("line", { x1: left, x2: width - right, y1: y, y2: y }));
      texts.append(svg("text", { x: left - 7, y: y + 4, "text-anchor": "end" }, text));
    });
    tickTexts(this.xTicks).forEach((text, i) => {
      const x = this.x(this.xTicks[i]);
      grid.append(svg("line", { x1: x, x2: x, y1: height - bottom, y2: height - bottom + 4 }));
      texts.append(svg("text", { x, y: height - bottom + 16, "text-anchor": "middle" }, text));
    });
    texts.append(svg("text", { class: "label", x: width - right, y: height - 3, "text-anchor": "end" }, xLabel));
    this.drawing.append(grid, texts);
  }

  line() {
    const { computed, highest } = this.pressure;
    const samples = Array.from({ length: 161 }, (_, i) => (highest * i) / 160).concat(computed).sort((a, b) => a - b);
    const place = (p) => this.place(p).map((c) => c.toFixed(2)).join(" ");
    this.drawing.append(svg("path", { class: "line", d: `M${samples.map(place).join("L")}` }));
    for (const p of computed) {
      const [cx, cy] = this.place(p);
      this.drawing.append(svg("circle", { class: "computed", cx, cy, r: 3 }));
    }
    this.needle = svg("line", { class: "needle" });
    this.dot = svg("circle", { class: "now", r: 5 });
    this.hint = svg("g", { class: "hint" });
    this.drawing.append(this.needle, this.dot, this.hint);
  }

  mark(value) {
    const [x, y] = this.place(value);
    this.dot.setAttribute("cx", x);
    this.dot.setAttribute("cy", y);
    this.setNeedle(x);
    this.value.textContent = this.text(this.at(value));
  }

  hover(event) {
    const p = this.pressure.snapped(this.pressureAt(event));
    const [x, y] = this.place(p);
    const { width, right, left, top } = SIZE;
    const text = svg("text", { y: Math.max(y - 10, top + 10) }, `${kPa(p)} kPa: ${this.text(this.at(p))}`);
    this.hint.replaceChildren(svg("circle", { cx: x, cy: y, r: 4 }), text);
    const half = text.getComputedTextLength() / 2;
    text.setAttribute("x", Math.min(Math.max(x, left + half + 2), width - right - half));
  }

  /** Where the pointer is, in the drawing's own lengths. */
  pointer(event) {
    const { left, top, width } = this.drawing.getBoundingClientRect();
    const zoom = SIZE.width / width;
    return [(event.clientX - left) * zoom, (event.clientY - top) * zoom];
  }
}

class Against extends Plot {
  at(p) {
    return this.curve.evaluate(p, new Float64Array(1));
  }
  text([value]) {
    return `${short(value)} ${this.unit}`.replace(" °", "°");
  }
  place(p) {
    return [this.x(p), this.y(this.at(p)[0])];
  }
  setNeedle(x) {
    const { height, top, bottom } = SIZE;
    for (const [key, value] of Object.entries({ x1: x, x2: x, y1: top, y2: height - bottom })) this.needle.setAttribute(key, value);
  }
  pressureAt(event) {
    const { width, left, right } = SIZE;
    const share = (this.pointer(event)[0] - left) / (this.x(this.pressure.highest) - left);
    return Math.min(Math.max(share, 0), (width - right) / left) * this.pressure.highest;
  }
}

/** The bottom centreline: faint at the computed pressures, strong at the present one, with the path of its tip. */
class Shape extends Plot {
  at(p) {
    return this.curve.evaluate(p, new Float64Array(this.curve.values[0].length));
  }
  text(line) {
    const [x, z] = line.slice(-2);
    return `tip ${fixed(x, 1)}, ${fixed(z, 1)}`;
  }
  place(p) {
    const [x, z] = this.at(p).slice(-2);
    return [this.x(x), this.y(z)];
  }
  path(line) {
    const points = Array.from({ length: line.length / 2 }, (_, i) => `${this.x(line[2 * i]).toFixed(2)} ${this.y(line[2 * i + 1]).toFixed(2)}`);
    return `M${points.join("L")}`;
  }
  line() {
    for (const line of this.curve.values) this.drawing.append(svg("path", { class: "shape", d: this.path(line) }));
    super.line();
    this.shape = svg("path", { class: "shape present" });
    this.drawing.insertBefore(this.shape, this.dot);
  }
  setNeedle() {
    this.shape.setAttribute("d", this.path(this.at(this.pressure.value)));
  }
  /** The pressure at which the tip is nearest to the pointer. */
  pressureAt(event) {
    const [px, py] = this.pointer(event);
    const { highest } = this.pressure;
    const distance = (p) => {
      const [x, y] = this.place(p);
      return Math.hypot(x - px, y - py);
    };
    const all = Array.from({ length: 201 }, (_, i) => (highest * i) / 200);
    return all.map((p) => [distance(p), p]).reduce((a, b) => (b[0] < a[0] ? b : a))[1];
  }
}

/** Size and ticks of a drawing in which lengths are alike in both directions. */
function evenly(xs, ys) {
  const { width, left, right, top, bottom } = SIZE;
  const padded = (list, least) => {
    const [low, high] = [Math.min(...list), Math.max(...list)];
    const pad = 0.06 * Math.max(high - low, least);
    return [low - pad, high + pad];
  };
  const x = padded(xs, 1e-3);
  const y = padded(ys, (x[1] - x[0]) / 2);
  const within = ([low, high], count) => ticks(low, high, count).filter((t) => low <= t && t <= high);
  const tall = ((width - left - right) * (y[1] - y[0])) / (x[1] - x[0]);
  return { size: { ...SIZE, height: tall + top + bottom }, range: { ticks: [within(x, 5), within(y, 4)], ends: [x, y] } };
}

/** Draws all plots into `container`; `series` is the data's. */
export function drawPlots(container, series, pressure) {
  if (series.length < 2) {
    container.textContent = "There is nothing to plot: no pressure was reached.";
    return;
  }
  const column = (pick) => new Curve(pressure.computed, series.map((point) => Float64Array.from(pick(point))));
  const xTicks = ticks(0, pressure.highest, 5);
  const plots = QUANTITIES.map(({ key, name, unit }) => {
    const values = series.map((point) => point[key]);
    const low = key === "volume" ? Math.min(...values) : Math.min(0, ...values);
    const both = [xTicks, ticks(low, Math.max(...values), 4)];
    const range = { ticks: both, ends: both.map((list) => [list[0], list[list.length - 1]]) };
    return new Against({ name, unit, xLabel: "pressure, kPa" }, pressure, column((p) => [p[key]]), range);
  });
  if (series.every(({ centreline }) => centreline.length > 1)) {
    const [xs, zs] = [0, 1].map((d) => series.flatMap(({ centreline }) => centreline.map((point) => point[d])));
    const { size, range } = evenly(xs, zs);
    const labels = { name: "Bottom line", unit: "z over x in mm", xLabel: "x, mm", size };
    plots.splice(1, 0, new Shape(labels, pressure, column((p) => p.centreline.flat()), range));
  }
  container.append(...plots.map((plot) => plot.element));
}
