// A plane section of the undeformed body. Its points are fixed to the material: each lies on an edge of a tetrahedron, at a share
// of the way from one node to another, and moves with both. Only a new plane needs a new section; a new time does not.

export class Section {
  /**
   * @param body nodes (reference positions), blocks of elements: elements, nodesPerElement, tetrahedra (local nodes), regions
   * @param {number} numRegions how many regions the elements belong to
   */
  constructor(body, numRegions) {
    this.body = body;
    this.numRegions = numRegions;
    this.bounds = [0, 1, 2].map((axis) => body.blocks.map((block) => elementBounds(body.nodes, block, axis)));
    this.clear();
  }

  clear() {
    this.from = new Uint32Array(0);
    this.to = new Uint32Array(0);
    this.share = new Float32Array(0);
    /** Points of the triangles of every region. */
    this.triangles = Array.from({ length: this.numRegions }, () => new Uint32Array(0));
  }

  /** Cuts across an axis (0, 1, 2) at a coordinate in mm; normals point along the axis if `side` is 1, against it if −1. */
  cut(axis, at, side) {
    const { nodes, blocks } = this.body;
    const found = { from: [], to: [], share: [], triangles: this.triangles.map(() => []), known: new Map() };
    const distance = (node) => nodes[3 * node + axis] - at;
    blocks.forEach(({ elements, nodesPerElement, tetrahedra, regions }, number) => {
      const [low, high] = this.bounds[axis][number];
      for (let e = 0; e < low.length; e++) {
        if (low[e] > at || high[e] < at) continue;
        const own = found.triangles[regions ? regions[e] : 0];
        for (const local of tetrahedra) {
          const corners = local.map((n) => elements[e * nodesPerElement + n]);
          const below = corners.filter((n) => distance(n) < 0);
          const above = corners.filter((n) => distance(n) >= 0);
          if (!below.length || !above.length) continue;
          const point = (a, b) => pointOn(found, a, b, distance, nodes.length / 3);
          if (below.length === 2) {
            const [p, q, r, s] = [...below, ...above];
            const ring = [point(p, r), point(p, s), point(q, s), point(q, r)];
            own.push([ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]);
          } else {
            const [[tip], base] = below.length === 1 ? [below, above] : [above, below];
            own.push(base.map((n) => point(tip, n)));
          }
        }
      }
    });
    this.from = Uint32Array.from(found.from);
    this.to = Uint32Array.from(found.to);
    this.share = Float32Array.from(found.share);
    const points = this.interpolated(nodes, 3);
    this.triangles = found.triangles.map((triangles) => oriented(triangles, points, axis, side));
  }

  /** Values at the section's points from values at nodes, `width` per node. */
  interpolated(values, width, target = new Float32Array(width * this.from.length)) {
    for (let i = 0; i < this.from.length; i++) {
      const [a, b, t] = [width * this.from[i], width * this.to[i], this.share[i]];
      for (let d = 0; d < width; d++) target[width * i + d] = (1 - t) * values[a + d] + t * values[b + d];
    }
    return target;
  }

  /** The node nearest to a point of the section. */
  nodeAt(i) {
    return this.share[i] < 0.5 ? this.from[i] : this.to[i];
  }
}

/** The number of the point in which the plane meets the edge between two nodes. */
function pointOn(found, a, b, distance, count) {
  if (a > b) [a, b] = [b, a];
  const key = a * count + b;
  let i = found.known.get(key);
  if (i === undefined) {
    i = found.from.push(a) - 1;
    found.to.push(b);
    found.share.push(distance(a) / (distance(a) - distance(b)));
    found.known.set(key, i);
  }
  return i;
}

function oriented(triangles, points, axis, side) {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  return Uint32Array.from(
    triangles.flatMap(([a, b, c]) => {
      const across = (i, d) => points[3 * i + d] - points[3 * a + d];
      const area = across(b, u) * across(c, v) - across(b, v) * across(c, u);
      return area * side >= 0 ? [a, b, c] : [a, c, b];
    }),
  );
}

function elementBounds(nodes, { elements, nodesPerElement }, axis) {
  const count = elements.length / nodesPerElement;
  const [low, high] = [new Float32Array(count).fill(Infinity), new Float32Array(count).fill(-Infinity)];
  for (let i = 0; i < elements.length; i++) {
    const [e, x] = [Math.floor(i / nodesPerElement), nodes[3 * elements[i] + axis]];
    low[e] = Math.min(low[e], x);
    high[e] = Math.max(high[e], x);
  }
  return [low, high];
}
