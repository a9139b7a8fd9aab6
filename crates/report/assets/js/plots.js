// Plots against time (an actuator's is its air pressure) as SVG, with marks at the time shown. Dots are computed: large ones at the states
// that have fields, small ones at load steps between them. The straight lines only join them.

import { fixed, short, tickTexts, ticks } from "pneuflex/format";
import { Lines } from "pneuflex/interpolation";
import { ownPlot } from "pneuflex/own-plot";
import { layOut } from "pneuflex/plot-layout";
import { fileName, save } from "pneuflex/snapshot";

const SIZE = { width: 360, height: 176, left: 46, right: 14, top: 12, bottom: 34 };

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

/** A drawing of one or more curves. Subclasses say where they are at a time (`points`) and in words (`texts`). */
class Plot {
  /**
   * @param labels `name`, `unit`, `names` of several curves (else none), `xLabel`, lines that are `wanted`
   * @param curve all numbers of the plot by time
   * @param range `ticks` along x and y, and `ends` of the axes
   */
  constructor({ name, unit, names = [], xLabel, size = SIZE, wanted = [] }, clock, curve, range) {
    Object.assign(this, { name, unit, names, clock, curve, size, wanted });
    [this.xTicks, this.yTicks] = range.ticks;
    const { width, height, left, right, top, bottom } = size;
    this.x = scale(range.ends[0], [left, width - right]);
    this.y = scale(range.ends[1], [height - bottom, top]);
    this.drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": this.description() });
    this.axes(xLabel);
    this.lines();
    this.element = document.createElement("figure");
    this.element.append(this.caption(), this.drawing, this.buttons());
    this.drawing.addEventListener("pointermove", (event) => this.hover(event));
    this.drawing.addEventListener("pointerleave", () => this.hint.replaceChildren());
    this.drawing.addEventListener("click", (event) => clock.set(clock.snapped(this.timeAt(event))));
    /** Follows the time no longer. */
    this.stop = clock.listen((value) => this.mark(value));
  }

  /** What saves the plot. */
  buttons() {
    const bar = Object.assign(document.createElement("p"), { className: "saves" });
    const button = (text, title, act) => bar.append(Object.assign(document.createElement("button"), { type: "button", textContent: text, title, onclick: act }));
    button("CSV", `Save the numbers of “${this.name}”`, () => save(`data:text/csv;charset=utf-8,${encodeURIComponent(this.csv())}`, `${fileName(this.name)}.csv`));
    button("PNG", `Save “${this.name}” as a picture`, () => this.png().then((address) => save(address, `${fileName(this.name)}.png`)));
    return bar;
  }

  /** Headings of the numbers, without the time's. */
  columns() {
    const unit = this.unit && ` (${this.unit})`;
    return this.names.length ? this.names.map((name) => `${this.name}: ${name}${unit}`) : [`${this.name}${unit}`];
  }

  /** The computed numbers, a row for each state and load step; nothing where a load step has no number. */
  csv() {
    const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const { at, columns } = this.curve;
    const when = (place) => (this.clock.computed.includes(place) ? this.clock.written(place) : String(this.clock.parameter(place)));
    const rows = at.map((place, k) => [when(place), ...columns.map((values) => String(values[k] ?? ""))]);
    return [[this.clock.label, ...this.columns()].map(cell), ...rows.map((row) => row.map((text) => text.replace("−", "-")))].map((row) => `${row.join(",")}\n`).join("");
  }

  /** The address of a picture. */
  async png(zoom = 3) {
    const copy = this.drawing.cloneNode(true);
    const [from, to] = [this.drawing, copy].map((root) => [root, ...root.querySelectorAll("*")]);
    // Styles of the page do not go with it.
    to.forEach((element, i) => {
      const style = getComputedStyle(from[i]);
      for (const name of ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font-family", "font-size", "font-weight", "text-anchor", "paint-order"]) element.style.setProperty(name, style.getPropertyValue(name));
    });
    const { width, height } = this.size;
    const head = 22;
    for (const [key, value] of Object.entries({ width, height, xmlns: "http://www.w3.org/2000/svg" })) copy.setAttribute(key, value);
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), { width: zoom * width, height: zoom * (height + head) });
    const draw = canvas.getContext("2d");
    const style = getComputedStyle(this.element);
    draw.scale(zoom, zoom);
    draw.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--sheet");
    draw.fillRect(0, 0, width, height + head);
    draw.fillStyle = style.color;
    draw.font = "600 12px system-ui, sans-serif";
    draw.fillText([this.name, this.unit].filter(Boolean).join(", "), 8, 16);
    draw.drawImage(image, 0, head, width, height);
    return canvas.toDataURL("image/png");
  }

  /** All numbers at a time. */
  at(time) {
    return this.curve.evaluate(time);
  }

  /** What a curve belongs to, before a text of its own. */
  prefix(i) {
    return this.names.length ? `${this.names[i]} ` : "";
  }

  description() {
    const { highest } = this.clock;
    const [from, to] = [0, highest].map((time) => this.texts(time));
    const curves = from.map((text, i) => `${this.prefix(i)}from ${text} ${this.clock.rest} to ${to[i]}`);
    return `${this.name}: ${curves.join(", ")} at ${this.clock.writtenWords(highest)}`;
  }

  caption() {
    const caption = document.createElement("figcaption");
    const span = (className) => Object.assign(document.createElement("span"), { className });
    caption.append([this.name, this.unit].filter(Boolean).join(", "));
    this.values = this.points(0).map(() => span("value"));
    if (this.names.length === 0) {
      caption.append(...this.values);
      return caption;
    }
    const keys = span("keys");
    this.names.forEach((name, i) => {
      const key = span(`key curve-${i}`);
      key.append(Object.assign(span("name"), { textContent: name }), this.values[i]);
      keys.append(key);
    });
    caption.append(keys);
    return caption;
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

  /** Where a curve is known, by time. */
  placesOf(i) {
    return this.curve.known[i].at;
  }

  lines() {
    this.needle = svg("line", { class: "needle" });
    this.hint = svg("g", { class: "hint" });
    this.nows = this.points(0).map((_, i) => {
      const group = svg("g", this.names.length ? { class: `curve-${i}` } : {});
      const places = this.placesOf(i);
      const points = places.map((time) => this.points(time)[i]);
      group.append(svg("path", { class: "line", d: path(points) }));
      points.forEach(([cx, cy], k) => {
        const isState = this.clock.computed.includes(places[k]);
        group.append(svg("circle", { class: isState ? "computed" : "computed step", cx, cy, r: isState ? 3 : 1.8 }));
      });
      const now = svg("circle", { class: "now", r: 5 });
      group.append(now);
      this.drawing.append(group);
      return now;
    });
    this.drawing.append(this.needle, this.hint);
  }

  mark(time) {
    const points = this.points(time);
    const texts = this.texts(time);
    points.forEach(([x, y], i) => {
      this.nows[i].setAttribute("cx", x);
      this.nows[i].setAttribute("cy", y);
      this.values[i].textContent = texts[i];
    });
    this.setNeedle(points[0][0]);
  }

  /** Shows the computed value that is nearest to the pointer. */
  hover(event) {
    const [px, py] = this.pointer(event);
    const all = this.nows.flatMap((_, i) => this.placesOf(i).map((time) => ({ i, time, at: this.points(time)[i] })));
    const distance = ({ at: [x, y] }) => Math.hypot(x - px, y - py);
    const { i, time, at: [x, y] } = all.reduce((a, b) => (distance(b) < distance(a) ? b : a));
    const { width, right, left, top } = SIZE;
    const words = `${this.clock.words(time)}: ${this.prefix(i)}${this.texts(time)[i]}`;
    const text = svg("text", { y: Math.max(y - 10, top + 10) }, words);
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

const path = (points) => `M${points.map((point) => point.map((c) => c.toFixed(2)).join(" ")).join("L")}`;

const valueText = (value, unit) => `${short(value)} ${unit}`.replace(" °", "°");

class AgainstTime extends Plot {
  texts(time) {
    return this.at(time).map((value) => valueText(value, this.unit));
  }
  points(time) {
    return this.at(time).map((value) => [this.x(time), this.y(value)]);
  }
  setNeedle(x) {
    const { height, top, bottom } = SIZE;
    for (const [key, value] of Object.entries({ x1: x, x2: x, y1: top, y2: height - bottom })) this.needle.setAttribute(key, value);
  }
  timeAt(event) {
    const { width, left, right } = SIZE;
    const share = (this.pointer(event)[0] - left) / (this.x(this.clock.highest) - left);
    return Math.min(Math.max(share, 0), (width - right) / left) * this.clock.highest;
  }
}

/** A curve in a plane, along which time goes by. */
class InPlane extends Plot {
  /** The time at which the curve is nearest to the pointer. */
  timeAt(event) {
    const [px, py] = this.pointer(event);
    const { highest } = this.clock;
    const distance = (time) => {
      const [[x, y]] = this.points(time);
      return Math.hypot(x - px, y - py);
    };
    const all = Array.from({ length: 201 }, (_, i) => (highest * i) / 200);
    return all.map((time) => [distance(time), time]).reduce((a, b) => (b[0] < a[0] ? b : a))[1];
  }
  setNeedle() {}
}

/** One quantity over another. */
class Over extends InPlane {
  constructor(labels, ...more) {
    const { name, unit } = labels.over;
    super({ ...labels, xLabel: unit ? `${name}, ${unit}` : name }, ...more);
    this.over = labels.over;
  }
  columns() {
    const { name, unit } = this.over;
    return [unit ? `${name} (${unit})` : name, ...super.columns()];
  }
  texts(time) {
    return this.at(time).slice(1).map((value) => valueText(value, this.unit));
  }
  placesOf(i) {
    const [over, of] = [super.placesOf(0), super.placesOf(i + 1)];
    return of.filter((time) => over.includes(time));
  }
  points(time) {
    const [x, ...values] = this.at(time);
    return values.map((value) => [this.x(x), this.y(value)]);
  }
}

/** The bottom centreline: faint at the computed times, strong at the present one, with the path of its tip; dashed what it is to follow. */
class Shape extends InPlane {
  texts(time) {
    const [x, z] = this.at(time).slice(-2);
    return [`tip ${fixed(x, 1)}, ${fixed(z, 1)}`];
  }
  points(time) {
    const [x, z] = this.at(time).slice(-2);
    return [[this.x(x), this.y(z)]];
  }
  path(line) {
    return path(Array.from({ length: line.length / 2 }, (_, i) => [this.x(line[2 * i]), this.y(line[2 * i + 1])]));
  }
  lines() {
    for (const line of this.wanted) this.drawing.append(svg("path", { class: "shape wanted", d: this.path(line) }));
    for (const time of this.clock.computed) this.drawing.append(svg("path", { class: "shape", d: this.path(this.at(time)) }));
    super.lines();
    this.shape = svg("path", { class: "shape present" });
    const [now] = this.nows;
    now.parentNode.insertBefore(this.shape, now);
  }
  setNeedle() {
    this.shape.setAttribute("d", this.path(this.at(this.clock.value)));
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

const ends = (lists) => lists.map((list) => [list[0], list[list.length - 1]]);

/** Round numbers around all values of a plot. */
function around(lists, fromZero, count) {
  const values = lists.flat().filter((value) => value !== null);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  if (fromZero) return ticks(Math.min(0, low), Math.max(0, high), count);
  // What stays but for rounding is a straight line.
  const least = 1e-6 * Math.max(Math.abs(low), Math.abs(high));
  return ticks(low, Math.max(high, low + least), count);
}

function draw(places, { name, unit, from_zero: fromZero, over, curves }, clock) {
  const yTicks = around(curves.map(({ values }) => values), fromZero, 4);
  const xTicks = over ? around([over.values], false, 5) : ticks(0, clock.highest, 5);
  const range = { ticks: [xTicks, yTicks], ends: ends([xTicks, yTicks]) };
  const curve = new Lines(places, [...(over ? [over] : []), ...curves].map(({ values }) => values));
  const names = curves.map((curve) => curve.name).filter(Boolean);
  if (over) return new Over({ name, unit, names, over }, clock, curve, range);
  return new AgainstTime({ name, unit, names, xLabel: clock.label }, clock, curve, range);
}

function drawShape(places, lines, clock, wanted) {
  const [xs, zs] = [0, 1].map((d) => [...lines, ...wanted].flatMap((line) => line.map((point) => point[d])));
  const { size, range } = evenly(xs, zs);
  const labels = { name: "Bottom line", unit: "z over x in mm", xLabel: "x, mm", size, wanted: wanted.map((line) => line.flat()) };
  const flat = lines.map((line) => line.flat());
  return new Shape(labels, clock, new Lines(places, flat[0].map((_, i) => flat.map((line) => line[i]))), range);
}

/** Draws all plots into `beside` and, as far as there is no room there, `below`; `series` is the data's. */
export function drawPlots(beside, below, series, clock, wanted = []) {
  if (clock.computed.length < 2) {
    beside.textContent = "There is nothing to plot: the body stayed at rest.";
    return;
  }
  const { places } = series;
  const drawOne = (plot) => draw(places, plot, clock);
  const plots = series.plots.map(drawOne);
  if (series.centrelines) plots.splice(1, 0, drawShape(places, series.centrelines, clock, wanted));
  const own = ownPlot(series, clock, drawOne);
  const kinds = places.length > clock.computed.length ? ": large ones where there are fields, small ones at load steps on the way" : "";
  const note = Object.assign(document.createElement("p"), { className: "note", textContent: `Dots are computed${kinds}. Straight lines only join them.` });
  layOut([...plots.map((plot) => plot.element), ...(own ? [own] : [])], beside, below, note);
}
