// Rigid obstacles: translucent, so that they hide nothing, and nothing that a click could hit.

import { Box3, BoxGeometry, BufferAttribute, BufferGeometry, CylinderGeometry, EdgesGeometry, Group, LineSegments, Matrix4, Mesh, PlaneGeometry, SphereGeometry, Vector3 } from "three";
import { roundStep } from "pneuflex/format";
import { imagesOf } from "pneuflex/images";
import { flatMaterial, obstacleMaterial } from "pneuflex/material";

/** How far round surfaces may be from their chords, relative to the body. */
const DEVIATION = 0.002;

/** Chords around a circle. */
const [FEWEST, MOST] = [48, 512];

/** Chords around the edge of a rounded cuboid. */
const EDGE = 6;

export class Obstacles {
  /**
   * @param list `obstacles` of the page's data
   * @param {number} size of the body, mm
   */
  constructor(list, size) {
    this.group = new Group();
    this.list = list.map((data) => build(data, size));
    for (const { whole } of this.list) this.group.add(whole);
  }

  /** Moves them to where they are at a time. */
  move(time) {
    for (const { data, moving } of this.list) moving.forEach((object) => object.position.set(...offset(data.path, time)));
  }

  /** Shows those that are `shown`; `whole`: with their mirror images. */
  show(shown, whole) {
    this.list.forEach(({ whole: all, moving }, number) => {
      all.visible = shown[number];
      moving.forEach((object, i) => (object.parent.visible = i === 0 || whole));
    });
  }

  /** Those that are shown. */
  get visible() {
    return this.list.filter(({ whole }) => whole.visible);
  }

  /** Boxes around what is shown of them at the corners of their paths. */
  boxes() {
    return this.visible.flatMap(({ data, whole }) => {
      const times = data.path.length ? data.path.map(([time]) => time) : [0];
      return times.map((time) => {
        this.move(time);
        whole.updateMatrixWorld(true);
        const box = new Box3();
        whole.traverseVisible((object) => object.isMesh && box.expandByObject(object));
        return box;
      });
    });
  }

  /** Colours of surfaces and lines, [r, g, b] from 0 to 1. */
  useColours(surface, line) {
    this.group.traverse(({ material, isMesh }) => {
      if (material) material.uniforms.colour.value = isMesh ? surface : line;
    });
  }
}

/** Where a path is at a time: on straight lines between its corners. */
export function offset(path, time) {
  if (path.length === 0) return [0, 0, 0];
  const k = path.findIndex(([corner]) => corner >= time);
  if (k === 0) return path[0].slice(1);
  if (k < 0) return path[path.length - 1].slice(1);
  const [a, b] = [path[k - 1], path[k]];
  const share = (time - a[0]) / (b[0] - a[0]);
  return [1, 2, 3].map((d) => a[d] + share * (b[d] - a[d]));
}

/** The objects of an obstacle: those that move, in a group of all its images. */
function build(data, size) {
  const { surface, lines } = SHAPES[data.shape](data, size);
  const frame = new Matrix4().makeBasis(...data.axes.map((axis) => new Vector3(...axis))).setPosition(...data.centre);
  const whole = new Group();
  const moving = imagesOf(data.mirrored).map((signs) => {
    const image = new Group();
    image.scale.set(...signs);
    const object = new Group();
    object.add(new Mesh(surface, obstacleMaterial(data.shape === "plane", data.hollow)), new LineSegments(lines, flatMaterial(0.3)));
    for (const part of object.children) part.applyMatrix4(frame);
    image.add(object);
    whole.add(image);
    return object;
  });
  // Positions change all the time: no bound on them is worth keeping. Drawn first, they do not tint a body of glass.
  whole.traverse((object) => Object.assign(object, { frustumCulled: false, renderOrder: -1 }));
  return { data, whole, moving };
}

/** Chords with which a circle is as round as it has to be. */
function chords(radius, size) {
  const needed = Math.PI * Math.sqrt(radius / (2 * DEVIATION * size));
  return Math.min(Math.max(4 * Math.ceil(needed / 4), FEWEST), MOST);
}

/** Surface and lines of every shape around the origin; planes have their normal and cylinders their axis along z. */
const SHAPES = {
  plane: ({ size: [a, b] }) => ({ surface: new PlaneGeometry(a, b), lines: grid(a, b) }),
  sphere: ({ size: [diameter] }, size) => {
    const count = chords(diameter / 2, size);
    const surface = new SphereGeometry(diameter / 2, count, count / 2).rotateX(Math.PI / 2);
    return { surface, lines: pairs([]) };
  },
  cylinder: ({ size: [diameter, , length], hollow }, size) => {
    const count = chords(diameter / 2, size);
    const surface = new CylinderGeometry(diameter / 2, diameter / 2, length, count, 1, hollow).rotateX(Math.PI / 2);
    return { surface, lines: rims(diameter / 2, length, count) };
  },
  cuboid: ({ size, edge_radius: radius }) => {
    const surface = radius > 0 ? roundedBox(size, radius) : new BoxGeometry(...size);
    return { surface, lines: new EdgesGeometry(surface, 40) };
  },
};

function pairs(points) {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(Float32Array.from(points), 3));
}

/** The border of a rectangle, and lines with round distances across it. */
function grid(a, b) {
  const step = roundStep(Math.max(a, b), 10);
  const points = [];
  const inner = (length) => Array.from({ length: 2 * Math.floor((0.5 * length) / step) + 1 }, (_, i) => step * (i - Math.floor((0.5 * length) / step)));
  for (const x of [-a / 2, ...inner(a), a / 2]) points.push(x, -b / 2, 0, x, b / 2, 0);
  for (const y of [-b / 2, ...inner(b), b / 2]) points.push(-a / 2, y, 0, a / 2, y, 0);
  return pairs(points);
}

/** The circles at both ends of a cylinder. */
function rims(radius, length, count) {
  const at = (i) => [radius * Math.cos((2 * Math.PI * i) / count), radius * Math.sin((2 * Math.PI * i) / count)];
  return pairs([-1, 1].flatMap((end) => Array.from({ length: count }, (_, i) => [...at(i), (end * length) / 2, ...at(i + 1), (end * length) / 2]).flat()));
}

/** A box whose surface is a radius away from that of a smaller one: its middle strips are flat, the others round. */
function roundedBox(size, radius) {
  const count = 2 * EDGE + 1;
  const box = new BoxGeometry(1, 1, 1, count, count, count);
  const { position, normal } = box.attributes;
  const inner = size.map((length) => length / 2 - radius);
  for (let i = 0; i < position.count; i++) {
    const place = [position.getX(i), position.getY(i), position.getZ(i)];
    // Without the middle strip, the grid is one of a box that a ball is made of.
    const direction = new Vector3(...place.map((x) => x - Math.sign(x) * (0.5 / count))).normalize();
    normal.setXYZ(i, ...direction);
    position.setXYZ(i, ...direction.toArray().map((x, d) => Math.sign(place[d]) * inner[d] + radius * x));
  }
  return box;
}
