// The body as three.js objects: surface, cut faces, lines, and its shape at rest, region by region; mirror images where a part was modelled.
// All images share their geometry, and all regions their positions and values.

import { BufferAttribute, BufferGeometry, Group, LineSegments, Mesh, Sphere, Vector3 } from "three";
import { integers } from "pneuflex/data";
import { imagesOf, signOf } from "pneuflex/images";
import { FIELDS } from "pneuflex/legend";
import { NO_PLANE, colourUniforms, flatMaterial, surfaceMaterial, useMap } from "pneuflex/material";
import { chosen, isShown } from "pneuflex/runs";
import { Section } from "pneuflex/section";

/** Sides of the body that are no cuts through it. */
const WALLS = ["outside", "air"];

export class Body {
  /**
   * @param data `body` of the page's data
   * @param {import("pneuflex/states").States} states of it
   */
  constructor(data, states) {
    this.states = states;
    this.mirrored = data.mirrored;
    this.skinNodes = integers(data.skin_vertices);
    this.surface = { list: integers(data.skin_triangles), runs: data.skin_runs };
    this.meshEdges = { list: integers(data.mesh_edges.pairs), runs: data.mesh_edges.runs };
    this.sharpEdges = { list: integers(data.sharp_edges.pairs), runs: data.sharp_edges.runs };
    this.colours = colourUniforms(1e-3 * states.size);
    /** Name, and values at the ends of the colours, of every region. */
    this.regions = data.regions.map((name) => ({ name, isShown: true, low: { value: 0 }, top: { value: 1 } }));
    this.field = "vonMises";
    this.plane = null;
    this.group = new Group();
    this.buildGeometry();
    /** Sections of the part and of what is its mirror image across the cut. */
    this.cuts = [0, 1].map(() => ({ section: new Section(states, data.regions.length), caps: this.regions.map(() => new BufferGeometry()) }));
    this.images = imagesOf(data.mirrored).map((signs) => this.buildImage(signs));
    this.whole = this.images.length > 1;
    this.useField(this.field);
    this.showParts();
  }

  buildGeometry() {
    const { states, skinNodes, surface } = this;
    const gather = (values) => Float32Array.from({ length: 3 * skinNodes.length }, (_, i) => values[3 * skinNodes[(i / 3) | 0] + (i % 3)]);
    this.skin = {
      position: new BufferAttribute(gather(states.nodes), 3),
      reference: new BufferAttribute(gather(states.nodes), 3),
      normal: new BufferAttribute(new Float32Array(3 * skinNodes.length), 3),
      value: new BufferAttribute(new Float32Array(skinNodes.length), 1),
    };
    this.walls = this.regions.map(() => geometry(this.skin));
    this.inner = this.regions.map(() => geometry(this.skin));
    const [now, rest] = [new BufferAttribute(states.position, 3), new BufferAttribute(states.nodes, 3)];
    this.linePositions = now;
    this.meshLines = geometry({ position: now, reference: rest });
    this.sharpLines = geometry({ position: now, reference: rest });
    // The shape at rest is an outline: the cavity would only confuse.
    const isOutside = ({ side }) => side === "outside";
    const still = this.skin.reference;
    this.restSkin = geometry({ position: still, reference: still }, chosen(surface, 3, isOutside));
    this.restLines = geometry({ position: rest, reference: rest }, chosen(this.sharpEdges, 2, isOutside));
    // The seam of a mirrored body is smooth: normals on it lie in the plane of symmetry.
    const outer = new Set(chosen(surface, 3, ({ side }) => WALLS.includes(side)));
    this.seams = [0, 1, 2].map((axis) => (this.mirrored[axis] ? [...outer].filter((v) => states.nodes[3 * skinNodes[v] + axis] === 0) : []));
  }

  buildImage(signs) {
    const group = new Group();
    group.scale.set(...signs);
    const surface = (shape, region, isCap) => new Mesh(shape, surfaceMaterial({ ...this.colours, low: region.low, top: region.top }, isCap));
    const image = {
      signs,
      group,
      walls: this.regions.map((region, r) => surface(this.walls[r], region, false)),
      inner: this.regions.map((region, r) => surface(this.inner[r], region, false)),
      caps: this.regions.map((region, r) => surface(this.cuts[0].caps[r], region, true)),
      meshLines: new LineSegments(this.meshLines, flatMaterial(0.28)),
      sharpLines: new LineSegments(this.sharpLines, flatMaterial(0.55)),
      rest: new Group(),
    };
    image.rest.add(new Mesh(this.restSkin, flatMaterial(0.045, true)), new LineSegments(this.restLines, flatMaterial(0.34)));
    group.add(...image.walls, ...image.inner, ...image.caps, image.meshLines, image.sharpLines, image.rest);
    group.traverse((object) => (object.frustumCulled = false));
    image.rest.traverse((object) => (object.isRest = true));
    this.group.add(group);
    return image;
  }

  /** Takes over the positions and values that `states` has now. */
  update() {
    const { position, values } = this.states;
    const { skinNodes, skin } = this;
    const [target, shown, normals] = [skin.position.array, skin.value.array, skin.normal.array];
    const field = values[this.field];
    for (let v = 0; v < skinNodes.length; v++) {
      const n = skinNodes[v];
      target[3 * v] = position[3 * n];
      target[3 * v + 1] = position[3 * n + 1];
      target[3 * v + 2] = position[3 * n + 2];
      shown[v] = field[n];
    }
    normals.fill(0);
    addNormals(target, this.surface.list, normals);
    this.seams.forEach((seam, axis) => seam.forEach((v) => (normals[3 * v + axis] = 0)));
    for (const attribute of [skin.position, skin.value, skin.normal, this.linePositions]) attribute.needsUpdate = true;
    this.updateCaps();
  }

  updateCaps() {
    if (!this.plane) return;
    for (const { section, points } of this.cuts.filter(({ points }) => points)) {
      const { position, value, normal } = points;
      section.interpolated(this.states.position, 3, position.array);
      section.interpolated(this.states.values[this.field], 1, value.array);
      normal.array.fill(0);
      for (const triangles of section.triangles) addNormals(position.array, triangles, normal.array);
      for (const attribute of [position, value, normal]) attribute.needsUpdate = true;
    }
  }

  useField(field) {
    this.field = field;
    useMap(this.colours, FIELDS[field].map);
    // Contact is a matter of the walls: the rest is made of glass, and cut faces have nothing to show, as with all that is of the surface alone.
    const isContact = field === "contactPressure";
    const { isOfSurface } = FIELDS[field];
    this.colours.glass.value = isContact;
    for (const { walls, inner, caps, signs } of this.images) {
      for (const { material } of [...walls, ...inner, ...caps]) material.uniforms.sign.value = signOf(field, signs);
      for (const { material } of caps) material.uniforms.plain.value = Boolean(isOfSurface);
      for (const { material } of inner) material.uniforms.plain.value = isOfSurface && !isContact;
      for (const { material } of [...walls, ...inner]) {
        material.transparent = isContact;
        material.depthWrite = !isContact;
        material.needsUpdate = true;
      }
    }
  }

  /** Values at the ends of the colours of every region. */
  useRanges(ranges) {
    this.regions.forEach((region, r) => ([region.low.value, region.top.value] = ranges[r]));
  }

  /** Shows all images or the modelled part, lines of the mesh, the shape at rest; `regions`: which of them. */
  show({ whole, mesh, ghost, regions }) {
    this.whole = whole && this.images.length > 1;
    this.meshShown = mesh;
    this.ghostShown = ghost;
    this.regions.forEach((region, r) => (region.isShown = regions[r]));
    this.showParts();
  }

  showParts() {
    const { whole, regions, surface } = this;
    const shown = regions.map((region) => region.isShown);
    const isVisible = (run) => isShown(run, shown, whole);
    const index = (shape, numbers) => shape.setIndex(new BufferAttribute(numbers, 1));
    regions.forEach((_, r) => {
      const isOwn = (run) => run.regions[0] === r && isVisible(run);
      index(this.walls[r], chosen(surface, 3, (run) => isOwn(run) && WALLS.includes(run.side)));
      index(this.inner[r], chosen(surface, 3, (run) => isOwn(run) && !WALLS.includes(run.side)));
    });
    index(this.meshLines, chosen(this.meshEdges, 2, isVisible));
    index(this.sharpLines, chosen(this.sharpEdges, 2, isVisible));
    this.images.forEach(({ group, meshLines, rest, caps }, i) => {
      group.visible = i === 0 || whole;
      meshLines.visible = Boolean(this.meshShown);
      rest.visible = this.ghostShown !== false;
      caps.forEach((cap, r) => (cap.visible = Boolean(this.plane) && shown[r]));
    });
  }

  /** Cuts across an axis (0, 1, 2) at a coordinate of the undeformed body, relative to the origin, and keeps the part below (side 1) or above (−1); null: no cut. */
  cut(plane) {
    this.plane = plane;
    if (plane) this.cuts.forEach((cut, i) => this.cutAcross(cut, plane, i ? -1 : 1));
    for (const { signs, walls, inner, caps, meshLines, sharpLines } of this.images) {
      // Seen from an image across the cut, it lies and looks the other way.
      const flip = plane ? signs[plane.axis] : 1;
      const normal = [0, 0, 0];
      if (plane) normal[plane.axis] = flip * plane.side;
      for (const { material } of [...walls, ...inner, meshLines, sharpLines]) {
        material.uniforms.plane.value.set(...(plane ? [...normal, plane.side * plane.at] : NO_PLANE));
      }
      caps.forEach((cap, r) => (cap.geometry = this.cuts[flip > 0 ? 0 : 1].caps[r]));
    }
    this.updateCaps();
    this.showParts();
  }

  /** Cuts the part as an image with a sign along the cut's axis needs it. */
  cutAcross(cut, { axis, at, side }, flip) {
    cut.caps.forEach((shape) => shape.dispose());
    cut.points = null;
    if (flip < 0 && !(this.whole && this.mirrored[axis])) return;
    const { section } = cut;
    section.cut(axis, flip * at, flip * side);
    const count = section.from.length;
    const list = (per) => new BufferAttribute(new Float32Array(per * count), per);
    // Cut faces lie in the plane itself, which must not cut them away: they have no reference position.
    cut.points = { position: list(3), reference: list(3), normal: list(3), value: list(1) };
    cut.caps = section.triangles.map((triangles) => geometry(cut.points, triangles));
  }

  /** Surfaces that can be hit, each with its image, and how a vertex of it becomes a node. */
  targets() {
    const ofSkin = (vertex) => this.skinNodes[vertex];
    return this.images
      .filter(({ group }) => group.visible)
      .flatMap((image) => {
        const cut = this.plane && this.cuts[image.signs[this.plane.axis] > 0 ? 0 : 1];
        const ofCap = (point) => cut.section.nodeAt(point);
        const caps = cut ? image.caps.filter((cap) => cap.visible) : [];
        return [...[...image.walls, ...image.inner].map((mesh) => ({ mesh, image, nodeOf: ofSkin })), ...caps.map((mesh) => ({ mesh, image, nodeOf: ofCap }))];
      });
  }

  /** Colours of lines and of the shape at rest, [r, g, b] from 0 to 1. */
  useLineColours(line, rest) {
    this.group.traverse(({ material, isRest }) => {
      if (material?.uniforms.colour) material.uniforms.colour.value = isRest ? rest : line;
    });
  }
}

function geometry(attributes, index = new Uint32Array(0)) {
  const shape = new BufferGeometry();
  for (const [name, attribute] of Object.entries(attributes)) shape.setAttribute(name, attribute);
  shape.setIndex(new BufferAttribute(index, 1));
  // Positions change all the time: no bound on them is worth keeping.
  shape.boundingSphere = new Sphere(new Vector3(), 1e9);
  return shape;
}

/** Adds the area vectors of the triangles to those of their vertices. */
function addNormals(p, triangles, normals) {
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
