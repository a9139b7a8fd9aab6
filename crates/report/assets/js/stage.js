// Camera, mouse, touch and keyboard; draws only when something has changed.

import { PerspectiveCamera, Scene, Spherical, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/orbit-controls";

/** Of the eye, degrees; from so far away that its rays are parallel but for a pixel. */
const FIELD_OF_VIEW = 24;
const PARALLEL = 0.1;

/** Directions from the actuator to the eye; it is clamped at x = 0, its tip points along x, up is z. */
export const VIEWS = {
  iso: new Vector3(0.55, -1, 0.42),
  side: new Vector3(0, -1, 0),
  front: new Vector3(1, 0, 0),
};

/** Whether there are three-dimensional graphics at all. */
export function hasWebGL() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

export class Stage {
  /** @param {() => Vector3[]} outline points that should be in view */
  constructor(canvas, outline) {
    this.canvas = canvas;
    this.outline = outline;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 1, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.requestRender());
    this.controls.addEventListener("start", () => (this.view = null));
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.beforeRender = () => {};
    this.afterRender = () => {};
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    // A view chosen by name stays fitted; one that was turned by hand stays as it is.
    if (this.view) this.look(this.view, false);
    this.requestRender();
  }

  requestRender() {
    if (this.requested) return;
    this.requested = requestAnimationFrame(() => this.render());
  }

  render() {
    cancelAnimationFrame(this.requested);
    this.requested = 0;
    if (this.isParallel) {
      const distance = this.camera.position.distanceTo(this.controls.target);
      [this.camera.near, this.camera.far] = [Math.max(distance - this.around, distance / 50), distance + this.around];
      this.camera.updateProjectionMatrix();
    }
    this.camera.updateMatrixWorld();
    this.beforeRender();
    this.renderer.render(this.scene, this.camera);
    this.afterRender();
  }

  /** Turns the eye to a named view, with everything in sight. */
  look(view, smoothly = true) {
    this.view = view;
    // Straight views have no perspective: they can be laid over photos.
    const wasParallel = this.isParallel;
    this.isParallel = view !== "iso";
    this.camera.fov = this.isParallel ? PARALLEL : FIELD_OF_VIEW;
    if (this.isParallel !== wasParallel) smoothly = false;
    const { position, target } = this.fitted(VIEWS[view].clone().normalize());
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.moveTo(position, target, smoothly && !still ? 350 : 0);
  }

  fitted(direction) {
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new Vector3().crossVectors(direction, right);
    const axes = [right, up, direction];
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const point of this.outline()) {
      axes.forEach((axis, d) => {
        const x = point.dot(axis);
        low[d] = Math.min(low[d], x);
        high[d] = Math.max(high[d], x);
      });
    }
    const target = new Vector3();
    axes.forEach((axis, d) => target.addScaledVector(axis, (low[d] + high[d]) / 2));
    const slope = Math.tan((this.camera.fov * Math.PI) / 360);
    // Room for the legend above, the hint below, and a little air beside it.
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    const [above, below, beside] = width < 600 ? [118, 44, 14] : [92, 44, 40];
    const share = (length, room) => length / 2 / Math.max(1 - room / length, 0.3) / length;
    const size = Math.max((high[1] - low[1]) * share(height, above + below), ((high[0] - low[0]) / this.camera.aspect) * share(width, 2 * beside));
    const distance = size / slope + (high[2] - low[2]) / 2;
    target.addScaledVector(up, ((above - below) / height) * size);
    // Depths are told apart only around the body.
    const around = 20 * (size + high[2] - low[2]);
    this.camera.near = Math.max(distance / 50, distance - around);
    this.camera.far = this.isParallel ? distance + around : distance * 20;
    this.around = around;
    this.camera.updateProjectionMatrix();
    return { position: target.clone().addScaledVector(direction, distance), target };
  }

  moveTo(position, target, milliseconds) {
    cancelAnimationFrame(this.moving);
    const from = { position: this.camera.position.clone(), target: this.controls.target.clone() };
    const began = performance.now();
    const step = (now) => {
      const t = milliseconds ? Math.min((now - began) / milliseconds, 1) : 1;
      const eased = t * t * (3 - 2 * t);
      const goal = new Vector3().lerpVectors(from.target, target, eased);
      // On a sphere around the target, not through it.
      const [a, b] = [from.position.clone().sub(from.target), position.clone().sub(target)];
      const offset = a.clone().lerp(b, eased).setLength(a.length() + eased * (b.length() - a.length()));
      this.controls.target.copy(goal);
      this.camera.position.copy(goal).add(offset);
      this.controls.update();
      this.requestRender();
      if (t < 1) this.moving = requestAnimationFrame(step);
    };
    if (milliseconds) this.moving = requestAnimationFrame(step);
    else step(began);
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
    const zooms = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 };
    const views = { 1: "iso", 2: "side", 3: "front", 0: "iso" };
    const { key } = event;
    if (!(key in turns || key in zooms || key in views) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (key in views) return this.look(views[key]);
    this.view = null;
    const { camera, controls } = this;
    // Spherical coordinates have y up.
    const offset = camera.position.clone().sub(controls.target);
    const ball = new Spherical().setFromVector3(new Vector3(offset.x, offset.z, -offset.y));
    const [theta, phi] = turns[key] ?? [0, 0];
    ball.theta += theta;
    ball.phi += phi;
    ball.makeSafe();
    ball.radius *= zooms[key] ?? 1;
    const { x, y, z } = new Vector3().setFromSpherical(ball);
    camera.position.copy(controls.target).add(new Vector3(x, -z, y));
    controls.update();
  }

  /** Where a point is on the screen, in pixels from the canvas's corner. */
  project(point) {
    const { x, y } = point.clone().project(this.camera);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return [((x + 1) / 2) * width, ((1 - y) / 2) * height];
  }
}
