// The colour legend: name and unit of the field, the map, round numbers below it.

import { gradient } from "pneuflex/colours";
import { short, tickTexts, ticks } from "pneuflex/format";

const component = (kind, of, unit, index, odd) => ({ name: `${kind} ${of}`, unit, scale: 1, map: "signed", index, odd });

/**
 * What can be shown in colour. `scale` turns the stored unit into the shown one; `map` is the colour map; `index` the component of the
 * displacement or stress; `odd` are the axes along which a mirror image has the opposite sign; `isOfSurface` says that there is no value
 * inside of the body.
 */
export const FIELDS = {
  vonMises: { name: "von Mises stress", unit: "MPa", scale: 1, map: "size" },
  displacement: { name: "Displacement", unit: "mm", scale: 1, map: "size" },
  contactPressure: { name: "Contact pressure", unit: "kPa", scale: 1000, map: "size", isOfSurface: true },
  ux: component("Displacement", "along x", "mm", 0, [0]),
  uy: component("Displacement", "along y", "mm", 1, [1]),
  uz: component("Displacement", "along z", "mm", 2, [2]),
  stretch: { name: "Largest stretch", unit: "", scale: 1, map: "size" },
  thickness: { name: "Thickness change", unit: "%", scale: 100, map: "signed", isOfSurface: true },
  pressure: { name: "Pressure in the solid", unit: "MPa", scale: 1, map: "signed" },
  sxx: component("Stress", "xx", "MPa", 0, []),
  syy: component("Stress", "yy", "MPa", 1, []),
  szz: component("Stress", "zz", "MPa", 2, []),
  sxy: component("Stress", "xy", "MPa", 3, [0, 1]),
  syz: component("Stress", "yz", "MPa", 4, [1, 2]),
  sxz: component("Stress", "xz", "MPa", 5, [0, 2]),
};

/** Round numbers around a range, at least two. */
export const legendTicks = ([low, high]) => ticks(low, high > low ? high : low + 1, 5);

/** Numbers that divide a range as it is. */
export const evenMarks = ([low, high]) => [0, 1, 2, 3, 4].map((i) => low + ((high - low) * i) / 4);

/** What lies beyond a range, in words; `at` says where values are known. */
export function beyond({ marks, present, at }, unit) {
  const [low, high] = [marks[0], marks[marks.length - 1]];
  const slack = 5e-4 * (high - low);
  const ends = [present[0] < low - slack, present[1] > high + slack];
  const said = [ends[0] && `down to ${short(present[0])}`, ends[1] && `up to ${short(present[1])}`].filter(Boolean);
  return { ends, words: said.length ? [said.join(" and "), unit, at].filter(Boolean).join(" ") : "" };
}

export class Legend {
  constructor(element) {
    this.element = element;
  }

  /**
   * Shows a field with a bar for each of `rows`: `name`, if there are several; `marks` from the first to the last value of the colours; `present`,
   * the least and the largest value now; `at`, where these are.
   */
  show(field, rows) {
    const { name, unit, map } = FIELDS[field];
    const title = Object.assign(document.createElement("p"), { className: "name", textContent: name });
    if (unit) title.append(", ", Object.assign(document.createElement("span"), { className: "unit", textContent: unit }));
    this.element.replaceChildren(title, ...rows.flatMap((row) => this.row(row, unit, map)));
  }

  row({ name, ...row }, unit, map) {
    const { marks } = row;
    const [low, high] = [marks[0], marks[marks.length - 1]];
    const { ends, words } = beyond(row, unit);
    const part = (className, textContent = "", tag = "div") => Object.assign(document.createElement(tag), { className, textContent });
    const bar = part(`bar${ends[0] ? " below" : ""}${ends[1] ? " above" : ""}`);
    bar.style.background = gradient(map);
    const scale = part("marks");
    tickTexts(marks).forEach((text, i) => {
      const mark = part("", text, "span");
      mark.style.left = `${(100 * (marks[i] - low)) / (high - low)}%`;
      scale.append(mark);
    });
    return [...(name === undefined ? [] : [part("of", name, "p")]), bar, scale, part("beyond", words, "p")];
  }
}
