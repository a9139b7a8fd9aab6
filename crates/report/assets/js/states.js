// The fields at the nodes for any time between rest and the last computed one. Positions are relative to `origin`.

import { floats, quantised } from "pneuflex/data";
import { Curve } from "pneuflex/interpolation";

export class States {
  /** @param body `body` of the page's data */
  constructor(body) {
    this.nodes = floats(body.nodes);
    this.origin = body.origin;
    /** Least and largest coordinates of the body at rest. */
    this.box = bounds(this.nodes);
    /** Diagonal of that box, mm. */
    this.size = Math.hypot(...[0, 1, 2].map((d) => this.box[1][d] - this.box[0][d]));
    const count = this.nodes.length / 3;
    const known = body.states.map((state) => ({
      displacement: quantised(state.displacement),
      vonMises: quantised(state.von_mises),
      contactPressure: quantised(state.contact_pressure),
    }));
    this.times = [0, ...body.states.map((state) => state.time)];
    const curve = (field, width) =>
      new Curve(this.times, [new Float32Array(width * count), ...known.map((state) => state[field])]);
    this.curves = {
      displacement: curve("displacement", 3),
      vonMises: curve("vonMises", 1),
      contactPressure: curve("contactPressure", 1),
    };
    /** What the fields reach without the worst of their corners, at rest and at every computed time. */
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

  /** Fills `position`, `displacement` (mm, three per node) and `values` for a time. */
  evaluate(time) {
    this.curves.displacement.evaluate(time, this.displacement);
    for (let i = 0; i < this.position.length; i++) this.position[i] = this.nodes[i] + this.displacement[i];
    this.curves.vonMises.evaluate(time, this.values.vonMises);
    this.curves.contactPressure.evaluate(time, this.values.contactPressure);
    lengths(this.displacement, this.values.displacement);
  }

  /** The typical largest value of a field at a time. */
  typicalAt(field, time) {
    const curve = new Curve(this.times, this.typical[field].map((x) => Float64Array.of(x)));
    return curve.evaluate(time, new Float64Array(1))[0];
  }

  /** The coordinates of a node in `positions` (the body's at rest or now) as they are in space, mm. */
  place(positions, node) {
    return this.origin.map((x, d) => x + positions[3 * node + d]);
  }

  /** Positions of a node, three numbers each, at rest and at every computed time. */
  placesOf(node) {
    return this.curves.displacement.values.map((u) => [0, 1, 2].map((d) => this.nodes[3 * node + d] + u[3 * node + d]));
  }
}

function bounds(points) {
  const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let i = 0; i < points.length; i++) {
    box[0][i % 3] = Math.min(box[0][i % 3], points[i]);
    box[1][i % 3] = Math.max(box[1][i % 3], points[i]);
  }
  return box;
}

/** The largest of many numbers, at least 0. */
export const largest = (values) => values.reduce((a, b) => Math.max(a, b), 0);

function lengths(vectors, target = new Float32Array(vectors.length / 3)) {
  for (let i = 0; i < target.length; i++) {
    const [x, y, z] = [vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2]];
    target[i] = Math.sqrt(x * x + y * y + z * z);
  }
  return target;
}
