// The colour legend: name and unit of the field, the map, round numbers below it.

import { gradient } from "pneuflex/colours";
import { short, tickTexts, ticks } from "pneuflex/format";

const component = (kind, of, unit, index, isOdd) => ({ name: `${kind} ${of}`, unit, scale: 1, map: "signed", index, isOdd });

/**
 * What can be shown in colour. `scale` turns the stored unit into the shown one; `map` is the colour map; `index` the component of the
 * displacement or stress; `isOdd` says that the field has the opposite sign in a mirrored half.
 */
export const FIELDS = {
  vonMises: { name: "von Mises stress", unit: "MPa", scale: 1, map: "vonMises" },
  displacement: { name: "Displacement", unit: "mm", scale: 1, map: "displacement" },
  contactPressure: { name: "Contact pressure", unit: "kPa", scale: 1000, map: "contactPressure" },
  ux: component("Displacement", "along x", "mm", 0, false),
  uy: component("Displacement", "along y", "mm", 1, true),
  uz: component("Displacement", "along z", "mm", 2, false),
  stretch: { name: "Largest stretch", unit: "", scale: 1, map: "vonMises" },
  pressure: { name: "Pressure in the solid", unit: "MPa", scale: 1, map: "signed" },
  sxx: component("Stress", "xx", "MPa", 0, false),
  syy: component("Stress", "yy", "MPa", 1, false),
  szz: component("Stress", "zz", "MPa", 2, false),
  sxy: component("Stress", "xy", "MPa", 3, true),
  syz: component("Stress", "yz", "MPa", 4, true),
  sxz: component("Stress", "xz", "MPa", 5, false),
};

/** Round numbers around a range, at least two. */
export const legendTicks = ([low, high]) => ticks(low, high > low ? high : low + 1, 5);

/** Numbers that divide a range as it is. */
export const evenMarks = ([low, high]) => [0, 1, 2, 3, 4].map((i) => low + ((high - low) * i) / 4);

export class Legend {
  constructor(element) {
    this.element = element;
  }

  /** Shows a field with a range from the first to the last of `marks`; `present` are the least and the largest value now. */
  show(field, marks, present) {
    const { name, unit, map } = FIELDS[field];
    const [low, high] = [marks[0], marks[marks.length - 1]];
    const texts = tickTexts(marks);
    const labels = marks.map((x, i) => `<span style="left:${(100 * (x - low)) / (high - low)}%">${texts[i]}</span>`);
    const slack = 5e-4 * (high - low);
    const ends = [present[0] < low - slack, present[1] > high + slack];
    const said = [ends[0] && `down to ${short(present[0])}`, ends[1] && `up to ${short(present[1])}`].filter(Boolean);
    const beyond = said.length ? `${said.join(" and ")} ${unit} at nodes` : "";
    this.element.innerHTML = `<p class="name">${name}${unit && `, <span class="unit">${unit}</span>`}</p>
      <div class="bar${ends[0] ? " below" : ""}${ends[1] ? " above" : ""}" style="background:${gradient(map)}"></div>
      <div class="marks">${labels.join("")}</div><p class="beyond">${beyond}</p>`;
  }
}
