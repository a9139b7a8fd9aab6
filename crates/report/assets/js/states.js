// The fields at the nodes for any pressure between rest and the highest computed one.

import { floats, quantised } from "pneuflex/data";
import { Curve } from "pneuflex/interpolation";

export class States {
  /** @param body `body` of the page's data */
  constructor(body) {
    this.nodes = floats(body.nodes);
    const count = this.nodes.length / 3;
    const known = body.states.map((state) => ({
      displacement: quantised(state.displacement),
      vonMises: quantised(state.von_mises),
      contactPressure: quantised(state.contact_pressure),
    }));
    this.pressures = [0, ...body.states.map((state) => state.pressure)];
    const curve = (field, width) =>
      new Curve(this.pressures, [new Float32Array(width * count), ...known.map((state) => state[field])]);
    this.curves = {
      displacement: curve("displacement", 3),
      vonMises: curve("vonMises", 1),
      contactPressure: curve("contactPressure", 1),
    };
    /** What the fields reach without the worst of their corners, at rest and at every computed pressure. */
    this.typical = {
      vonMises: [0, ...body.states.map((state) => state.typical.von_mises)],
      displacement: [0, ...known.map((state) => largest(lengths(state.displacement)))],
      contactPressure: [0, ...body.states.map((state) => state.typical.contact_pressure)],
    };
    this.displacement = new Float32Array(3 * count);
    this.position = Float32Array.from(this.nodes);
    this.values = {
      vonMises: new Float32Array(count),
      displacement: new Float32Array(count),
      contactPressure: new Float32Array(count),
    };
  }

  /** Fills `position`, `displacement` (mm, three per node) and `values` for a pressure. */
  evaluate(pressure) {
    this.curves.displacement.evaluate(pressure, this.displacement);
    for (let i = 0; i < this.position.length; i++) this.position[i] = this.nodes[i] + this.displacement[i];
    this.curves.vonMises.evaluate(pressure, this.values.vonMises);
    this.curves.contactPressure.evaluate(pressure, this.values.contactPressure);
    lengths(this.displacement, this.values.displacement);
  }

  /** The typical largest value of a field at a pressure. */
  typicalAt(field, pressure) {
    const curve = new Curve(this.pressures, this.typical[field].map((x) => Float64Array.of(x)));
    return curve.evaluate(pressure, new Float64Array(1))[0];
  }

  /** Positions of a node, three numbers each, at rest and at every computed pressure. */
  placesOf(node) {
    return this.curves.displacement.values.map((u) => [0, 1, 2].map((d) => this.nodes[3 * node + d] + u[3 * node + d]));
  }
}

/** The largest of many numbers. */
export const largest = (values) => values.reduce((a, b) => Math.max(a, b), 0);

function lengths(vectors, target = new Float32Array(vectors.length / 3)) {
  for (let i = 0; i < target.length; i++) {
    const [x, y, z] = [vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2]];
    target[i] = Math.sqrt(x * x + y * y + z * z);
  }
  return target;
}
