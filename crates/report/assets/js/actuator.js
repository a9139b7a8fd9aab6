// The actuator, or any other body, as three.js objects: surface, cut faces, lines, and its shape at rest; a second, mirrored half where a half was
// modelled. Both halves share their geometry.

import { BufferAttribute, BufferGeometry, Group, LineSegments, Mesh, Sphere, Vector3 } from "three";
import { integers } from "pneuflex/data";
import { FIELDS } from "pneuflex/legend";
import { NO_PLANE, colourUniforms, flatMaterial, surfaceMaterial, useMap } from "pneuflex/material";
import { Section } from "pneuflex/section";

export class Actuator {
  constructor(body, states) {
    this.states = states;
    this.mirrored = body.mirrored;
    this.skinNodes = integers(body.skin_vertices);
    this.triangles = integers(body.skin_triangles);
    // Lengths of the lists without the cavity, and without the symmetry plane.
    this.parts = { triangles: body.skin_parts, mesh: body.mesh_edges.parts, sharp: body.sharp_edges.parts };
    this.colours = colourUniforms(1e-3 * states.size);
    this.field = "vonMises";
    this.whole = this.mirrored;
    this.plane = null;
    this.group = new Group();
    this.buildGeometry(body);
    const blocks = body.elements.map(({ nodes, nodes_per_element: nodesPerElement, tetrahedra }) => ({
      elements: integers(nodes),
      nodesPerElement,
      tetrahedra,
    }));
    this.sections = [0, 1].map(() => new Section({ nodes: states.nodes, blocks }));
    this.halves = (this.mirrored ? [1, -1] : [1]).map((sign, i) => this.buildHalf(sign, i));
    this.useField(this.field);
    this.showParts();
  }

  buildGeometry(body) {
    const { states, skinNodes } = this;
    const gather = (values) => Float32Array.from({ length: 3 * skinNodes.length }, (_, i) => values[3 * skinNodes[(i / 3) | 0] + (i % 3)]);
    this.skin = geometry(gather(states.nodes), gather(states.nodes), this.triangles);
    this.skin.setAttribute("normal", new BufferAttribute(new Float32Array(3 * skinNodes.length), 3));
    this.skin.setAttribute("value", new BufferAttribute(new Float32Array(skinNodes.length), 1));
    this.restSkin = geometry(gather(states.nodes), gather(states.nodes), this.triangles);
    this.meshLines = geometry(states.position, states.nodes, integers(body.mesh_edges.pairs));
    this.sharpLines = geometry(states.position, states.nodes, integers(body.sharp_edges.pairs));
    this.restLines = geometry(states.nodes, states.nodes, integers(body.sharp_edges.pairs));
    // The seam of a mirrored body is smooth: normals on it lie in the plane of symmetry.
    const outer = new Set(this.triangles.subarray(0, 3 * this.parts.triangles[1]));
    const onSeam = (v) => this.mirrored && outer.has(v) && states.nodes[3 * skinNodes[v] + 1] === 0;
    this.seam = [...skinNodes.keys()].filter(onSeam);
  }

  buildHalf(sign, index) {
    const half = new Group();
    half.scale.y = sign;
    const materials = { skin: surfaceMaterial(this.colours, false), mesh: flatMaterial(0.28), sharp: flatMaterial(0.55) };
    const cap = new Mesh(capGeometry(), surfaceMaterial(this.colours, true));
    const skin = new Mesh(this.skin, materials.skin);
    const meshLines = new LineSegments(this.meshLines, materials.mesh);
    const sharpLines = new LineSegments(this.sharpLines, materials.sharp);
    const rest = new Group();
    rest.add(new Mesh(this.restSkin, flatMaterial(0.045, true)), new LineSegments(this.restLines, flatMaterial(0.34)));
    half.add(skin, cap, meshLines, sharpLines, rest);
    half.traverse((object) => (object.frustumCulled = false));
    this.group.add(half);
    rest.traverse((object) => (object.isRest = true));
    return { sign, half, skin, cap, meshLines, sharpLines, rest, materials, section: this.sections[index] };
  }

  /** Takes over the positions and values that `states` has now. */
  update() {
    const { position, values } = this.states;
    const { skinNodes } = this;
    const target = this.skin.attributes.position.array;
    const shown = this.skin.attributes.value.array;
    const field = values[this.field];
    for (let v = 0; v < skinNodes.length; v++) {
      const n = skinNodes[v];
      target[3 * v] = position[3 * n];
      target[3 * v + 1] = position[3 * n + 1];
      target[3 * v + 2] = position[3 * n + 2];
      shown[v] = field[n];
    }
    const normals = this.skin.attributes.normal.array;
    addNormals(target, this.triangles, normals);
    for (const v of this.seam) normals[3 * v + 1] = 0;
    for (const name of ["position", "value", "normal"]) this.skin.attributes[name].needsUpdate = true;
    this.meshLines.attributes.position.needsUpdate = true;
    this.sharpLines.attributes.position.needsUpdate = true;
    if (this.plane) for (const half of this.halves) this.updateCap(half);
  }

  updateCap({ cap, section }) {
    const { position, value, normal } = cap.geometry.attributes;
    section.interpolated(this.states.position, 3, position.array);
    section.interpolated(this.states.values[this.field], 1, value.array);
    addNormals(position.array, section.triangles, normal.array);
    for (const attribute of [position, value, normal]) attribute.needsUpdate = true;
  }

  useField(field) {
    this.field = field;
    useMap(this.colours, FIELDS[field].map);
    // Contact is a matter of the walls between the chambers: the rest is made of glass, and cut faces have nothing to show.
    const isContact = field === "contactPressure";
    this.colours.glass.value = isContact;
    for (const { cap, skin, sign } of this.halves) {
      for (const { material } of [cap, skin]) material.uniforms.sign.value = FIELDS[field].isOdd ? sign : 1;
      cap.material.uniforms.plain.value = isContact;
      skin.material.transparent = isContact;
      skin.material.depthWrite = !isContact;
      skin.material.needsUpdate = true;
    }
  }

  /** Values at the ends of the colours. */
  useRange([low, high]) {
    this.colours.low.value = low;
    this.colours.top.value = high;
  }

  /** Shows both halves or the modelled one, lines of the mesh, the shape at rest. */
  show({ whole, mesh, ghost }) {
    this.whole = whole && this.mirrored;
    this.meshShown = mesh;
    this.ghostShown = ghost;
    this.showParts();
  }

  showParts() {
    const { whole, parts } = this;
    const range = (shape, [, count], per) => shape.setDrawRange(0, whole ? per * count : Infinity);
    range(this.skin, parts.triangles, 3);
    range(this.meshLines, parts.mesh, 2);
    range(this.sharpLines, parts.sharp, 2);
    // The shape at rest is an outline: the cavity would only confuse.
    this.restSkin.setDrawRange(0, 3 * parts.triangles[0]);
    this.restLines.setDrawRange(0, 2 * parts.sharp[0]);
    for (const { half, meshLines, rest, sign } of this.halves) {
      half.visible = sign > 0 || whole;
      meshLines.visible = Boolean(this.meshShown);
      rest.visible = this.ghostShown !== false;
    }
  }

  /** Cuts across an axis (0, 1, 2) at a coordinate of the undeformed body, relative to the origin, and keeps the part below (side 1) or above (−1); null: no cut. */
  cut(plane) {
    this.plane = plane;
    for (const { sign, cap, skin, meshLines, sharpLines, section } of this.halves) {
      cap.visible = Boolean(plane);
      const planes = [skin, meshLines, sharpLines].map((object) => object.material.uniforms.plane.value);
      if (!plane) {
        for (const p of planes) p.set(...NO_PLANE);
        continue;
      }
      // Seen from the mirrored half, a cut across y lies and looks the other way.
      const flip = plane.axis === 1 ? sign : 1;
      const [at, side] = [flip * plane.at, flip * plane.side];
      const normal = [0, 0, 0];
      normal[plane.axis] = side;
      for (const p of planes) p.set(...normal, side * at);
      section.cut(plane.axis, at, side);
      cap.geometry.dispose();
      cap.geometry = capGeometry(section);
    }
    if (plane) for (const half of this.halves) this.updateCap(half);
  }

  /** Colours of lines and of the shape at rest, [r, g, b] from 0 to 1. */
  useLineColours(line, rest) {
    for (const { half } of this.halves) {
      half.traverse(({ material, isRest }) => {
        if (material?.uniforms.colour) material.uniforms.colour.value = isRest ? rest : line;
      });
    }
  }
}

function geometry(positions, reference, index) {
  const shape = new BufferGeometry();
  shape.setAttribute("position", new BufferAttribute(positions, 3));
  shape.setAttribute("reference", new BufferAttribute(reference, 3));
  shape.setIndex(new BufferAttribute(index, 1));
  // Positions change all the time: no bound on them is worth keeping.
  shape.boundingSphere = new Sphere(new Vector3(), 1e9);
  return shape;
}

function capGeometry(section) {
  const count = section ? section.from.length : 0;
  // Cut faces lie in the plane itself, which must not cut them away: they have no reference position.
  const shape = geometry(new Float32Array(3 * count), new Float32Array(3 * count), section ? section.triangles : new Uint32Array(0));
  shape.setAttribute("normal", new BufferAttribute(new Float32Array(3 * count), 3));
  shape.setAttribute("value", new BufferAttribute(new Float32Array(count), 1));
  return shape;
}

/** Sums of the area vectors of the triangles around every vertex. */
function addNormals(p, triangles, normals) {
  normals.fill(0);
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const v of [a, b, c]) {
      normals[v] += nx;
      normals[v + 1] += ny;
      normals[v + 2] += nz;
    }
  }
}
