// The colour legend: name and unit of the field, the map, round numbers below it.

import { gradient } from "pneuflex/colours";
import { short, tickTexts, ticks } from "pneuflex/format";

/** What can be shown in colour. `scale` turns the stored unit into the shown one. */
export const FIELDS = {
  vonMises: { name: "von Mises stress", unit: "MPa", scale: 1 },
  displacement: { name: "Displacement", unit: "mm", scale: 1 },
  contactPressure: { name: "Contact pressure", unit: "kPa", scale: 1000 },
};

/** Round numbers from 0 to at least `top`, at least two. */
export const legendTicks = (top) => ticks(0, top > 0 ? top : 1, 5);

export class Legend {
  constructor(element) {
    this.element = element;
  }

  /** Shows a field with a range that ends at the last of `marks`; `largest` is the largest value at present. */
  show(field, marks, largest) {
    const { name, unit } = FIELDS[field];
    const top = marks[marks.length - 1];
    const texts = tickTexts(marks);
    const labels = marks.map((x, i) => `<span style="left:${(100 * x) / top}%">${texts[i]}</span>`);
    const beyond = largest > 1.0005 * top ? `up to ${short(largest)} ${unit} at nodes` : "";
    this.element.innerHTML = `<p class="name">${name}, <span class="unit">${unit}</span></p>
      <div class="bar" style="background:${gradient(field)}"></div>
      <div class="marks">${labels.join("")}</div><p class="beyond">${beyond}</p>`;
  }
}
