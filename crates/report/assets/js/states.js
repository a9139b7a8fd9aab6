// The fields at the nodes for any time between rest and the last computed one. Positions are relative to `origin`.

import { coarse, floats, integers, quantised, smallIntegers } from "pneuflex/data";
import { isOdd } from "pneuflex/images";
import { Curve } from "pneuflex/interpolation";
import { FIELDS } from "pneuflex/legend";
import { chosen } from "pneuflex/runs";

/** Of fields without a typical largest value of their own, shares of the nodes that lie below and above the range. */
const TAIL = 0.005;

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
    this.largest = new Curve(this.times, [Float64Array.of(0), ...body.states.map((state) => Float64Array.of(state.largest_von_mises))]);
    /** The rest of the data, by state, and ranges by field and region, as far as they are needed. */
    this.more = body.states;
    this.ranges = {};
    /** Fields besides those that are always known. */
    this.prepared = [];
    this.mirrored = body.mirrored;
    this.meshNodes = body.mesh_nodes;
    this.copied = integers(body.copied);
    this.blocks = body.elements.map(({ nodes, nodes_per_element: nodesPerElement, tetrahedra, regions }) => ({
      elements: integers(nodes),
      nodesPerElement,
      tetrahedra,
      regions: regions && smallIntegers(regions),
    }));
    this.collectNodes(body);
    this.displacement = new Float32Array(3 * count);
    this.position = Float32Array.from(this.nodes);
    this.values = {
      vonMises: new Float32Array(count),
      displacement: new Float32Array(count),
      contactPressure: new Float32Array(count),
    };
  }

  /** Finds the nodes of every region, and those of the surface. */
  collectNodes(body) {
    const count = this.nodes.length / 3;
    this.allNodes = Uint32Array.from({ length: count }, (_, node) => node);
    const found = body.regions.map(() => new Uint8Array(count));
    for (const { elements, nodesPerElement, regions } of this.blocks) {
      elements.forEach((node, i) => (found[regions ? regions[Math.floor(i / nodesPerElement)] : 0][node] = 1));
    }
    this.regionNodes = found.map((isIn) => this.allNodes.filter((node) => isIn[node]));
    this.isOnSurface = new Uint8Array(count);
    const skinNodes = integers(body.skin_vertices);
    const walls = chosen({ list: integers(body.skin_triangles), runs: body.skin_runs }, 3, ({ side }) => side === "outside" || side === "air");
    walls.forEach((vertex) => (this.isOnSurface[skinNodes[vertex]] = 1));
  }

  /** Fills `position`, `displacement` (mm, three per node) and `values` for a time. */
  evaluate(time) {
    this.curves.displacement.evaluate(time, this.displacement);
    for (let i = 0; i < this.position.length; i++) this.position[i] = this.nodes[i] + this.displacement[i];
    this.curves.vonMises.evaluate(time, this.values.vonMises);
    this.curves.contactPressure.evaluate(time, this.values.contactPressure);
    lengths(this.displacement, this.values.displacement);
    for (const field of this.prepared) this.curves[field].evaluate(time, this.values[field]);
  }

  /** Makes a field ready whose values are not kept from the beginning. */
  prepare(field) {
    if (this.values[field]) return;
    const count = this.nodes.length / 3;
    const { index } = FIELDS[field];
    let known;
    if (field === "stretch" || field === "thickness") known = this.more.map((state) => coarse(state[field]));
    else if (field === "pressure") {
      known = this.more.map(({ stress }) => {
        const [x, y, z] = stress.slice(0, 3).map(coarse);
        return x.map((xx, i) => -(xx + y[i] + z[i]) / 3);
      });
    } else if (field.startsWith("u")) {
      known = this.curves.displacement.values.slice(1).map((u) => Float32Array.from({ length: count }, (_, i) => u[3 * i + index]));
    } else known = this.more.map(({ stress }) => coarse(stress[index]));
    const rest = field === "stretch" ? 1 : 0;
    this.curves[field] = new Curve(this.times, [new Float32Array(count).fill(rest), ...known]);
    this.prepared.push(field);
    this.values[field] = new Float32Array(count);
  }

  /** The typical least and largest value of a field at a time; of a region, if one is named. */
  typicalAt(field, time, region) {
    const curve = new Curve(this.times, this.rangesOf(field, region).map((range) => Float64Array.from(range)));
    return Array.from(curve.evaluate(time, new Float64Array(2)));
  }

  /** The same over all times. */
  typicalOf(field, region) {
    const all = this.rangesOf(field, region);
    return [Math.min(...all.map(([low]) => low)), Math.max(...all.map(([, high]) => high))];
  }

  /** Ranges at rest and at every computed time. */
  rangesOf(field, region) {
    if (region === undefined && this.typical[field]) return this.typical[field].map((top) => [0, top]);
    const known = (this.ranges[field] ??= []);
    const number = region ?? this.regionNodes.length;
    return (known[number] ??= this.curves[field].values.map((values) => this.range(field, values, region)));
  }

  /** What all but a few of the values lie in; from zero for what has a size, symmetric where the field has the opposite sign elsewhere. */
  range(field, values, region) {
    const list = field === "displacement" ? lengths(values) : values;
    const sorted = Float32Array.from(this.nodesOf(field, region), (node) => list[node]).sort();
    const at = (share) => sorted[Math.round(share * (sorted.length - 1))] ?? 0;
    const [low, high] = [field in this.typical ? 0 : at(TAIL), at(1 - TAIL)];
    return isOdd(field, this.mirrored) ? [Math.min(low, -high), Math.max(high, -low)] : [low, high];
  }

  /** The least and the largest value of a field now; of a region, if one is named. */
  extremes(field, region) {
    const values = this.values[field];
    let [low, high] = [Infinity, -Infinity];
    for (const node of this.nodesOf(field, region)) {
      low = Math.min(low, values[node]);
      high = Math.max(high, values[node]);
    }
    return isOdd(field, this.mirrored) ? [Math.min(low, -high), Math.max(high, -low)] : [low, high];
  }

  /** The largest von Mises stress at a time, MPa: that of the table of results. */
  largestVonMises(time) {
    return this.largest.evaluate(time, new Float64Array(1))[0];
  }

  /** Nodes at which a field has values, those of a region, if one is named. */
  nodesOf(field, region) {
    const nodes = region === undefined ? this.allNodes : this.regionNodes[region];
    return FIELDS[field].isOfSurface ? nodes.filter((node) => this.isOnSurface[node]) : nodes;
  }

  /** The number that a node has in the mesh: nodes between materials have a copy for each. */
  numberOf(node) {
    return this.copied[node - this.meshNodes] ?? node;
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
