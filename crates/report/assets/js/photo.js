// A photo behind the side view, brought to the body's size and place by two points of both. It stays where it is on the body when the view is
// shifted or zoomed; from another side it is not shown.

import { Vector3 } from "three";
import { fixed, short } from "pneuflex/format";

/** What is clicked, one after the other. */
const STEPS = [
  "Click a point of the body.",
  "Click the same point in the photo.",
  "Click a second point of the body, far from the first one.",
  "Click the second point in the photo.",
];

/** A click moves by less than this, pixels; points of the photo are further apart than that. */
const CLICK = 5;

const byId = (id) => document.getElementById(id);

export class Photo {
  /** @param {(isOff: boolean) => void} holdClicks says whether clicks are for the photo */
  constructor(stage, holdClicks) {
    Object.assign(this, { stage, holdClicks, step: null, points: [], map: null });
    const root = stage.canvas.parentElement;
    this.image = Object.assign(new Image(), { className: "photo", hidden: true, alt: "" });
    this.marks = [1, 2].map((number) => Object.assign(document.createElement("span"), { className: "photo-mark", textContent: number, hidden: true }));
    root.prepend(this.image);
    root.append(...this.marks);
    this.image.addEventListener("load", () => this.begin());
    this.image.addEventListener("error", () => this.image.src && this.say("This file is no picture that the browser can show."));
    byId("photo").addEventListener("click", () => byId("photo-file").click());
    byId("photo-file").addEventListener("change", ({ target }) => this.open(target));
    byId("photo-align").addEventListener("click", () => this.align());
    byId("photo-remove").addEventListener("click", () => this.remove());
    byId("see-through").addEventListener("input", () => this.show());
    let start = null;
    root.addEventListener("pointerdown", ({ target, clientX, clientY }) => (start = target === stage.canvas ? [clientX, clientY] : null));
    root.addEventListener("pointerup", ({ clientX, clientY }) => {
      const isClick = start && Math.hypot(clientX - start[0], clientY - start[1]) < CLICK;
      start = null;
      if (isClick && this.step !== null && this.isShown) this.take(clientX, clientY);
    });
  }

  get isShown() {
    return !this.image.hidden;
  }

  say(text) {
    byId("photo-bar").hidden = false;
    byId("photo-step").textContent = text;
  }

  open(input) {
    const [file] = input.files;
    if (!file) return;
    this.remove();
    this.image.src = URL.createObjectURL(file);
    input.value = "";
  }

  /** Shows the photo in the middle of the side view, as large as there is room. */
  begin() {
    const { stage, image } = this;
    stage.look("side", false);
    stage.camera.updateMatrixWorld();
    const { clientWidth: width, clientHeight: height } = stage.canvas;
    const { perMm } = this.view();
    const scale = Math.min(width / image.naturalWidth, height / image.naturalHeight) / perMm;
    const [x, z] = this.inBody(width / 2, height / 2);
    this.map = { cos: scale, sin: 0, x: x - (scale * image.naturalWidth) / 2, z: z + (scale * image.naturalHeight) / 2 };
    this.isLoaded = true;
    this.align();
  }

  align() {
    if (!this.isLoaded) return;
    this.stage.look("side", false);
    this.points = [];
    this.goTo(0);
  }

  goTo(step) {
    this.step = step;
    this.holdClicks(step !== null);
    this.stage.controls.enableRotate = step === null;
    if (step !== null) this.say(STEPS[step]);
    this.show();
  }

  /** Takes the point that was clicked, of the body or of the photo, by turns. */
  take(clientX, clientY) {
    const { left, top } = this.stage.canvas.getBoundingClientRect();
    const [x, z] = this.inBody(clientX - left, clientY - top);
    this.points[this.step] = this.step % 2 ? this.inPhoto([x, z]) : [x, z];
    if (this.step < STEPS.length - 1) return this.goTo(this.step + 1);
    const [a, p, b, q] = this.points;
    const [inBody, inPhoto] = [[b[0] - a[0], b[1] - a[1]], [q[0] - p[0], q[1] - p[1]]];
    const isFar = Math.hypot(...inBody) * this.view().perMm > CLICK && Math.hypot(...inPhoto) > CLICK;
    if (!isFar) {
      this.goTo(0);
      return this.say(`The two points are too close to each other. ${STEPS[0]}`);
    }
    // The similarity that takes p to a and q to b, in complex numbers; rows of a photo run downwards.
    const [u, v] = [inPhoto[0], -inPhoto[1]];
    const square = u * u + v * v;
    const cos = (inBody[0] * u + inBody[1] * v) / square;
    const sin = (inBody[1] * u - inBody[0] * v) / square;
    this.map = { cos, sin, x: a[0] - cos * p[0] - sin * p[1], z: a[1] - sin * p[0] + cos * p[1] };
    this.goTo(null);
    const turned = (Math.atan2(sin, cos) * 180) / Math.PI;
    this.say(`One millimetre is ${short(1 / Math.hypot(cos, sin))} pixels of the photo, which is turned by ${fixed(turned, 1)}°.`);
  }

  remove() {
    if (this.image.src) URL.revokeObjectURL(this.image.src);
    this.image.removeAttribute("src");
    this.isLoaded = false;
    this.goTo(null);
    byId("photo-bar").hidden = true;
  }

  /** Sets how far one sees through the body: to the photo while a point of it is looked for. */
  show() {
    this.update();
    const share = this.step === null ? Number(byId("see-through").value) : this.step % 2 ? 0.9 : 0.25;
    this.stage.canvas.style.opacity = this.isShown ? 1 - 0.9 * share : "";
    this.stage.requestRender();
  }

  /** Puts the photo to where it is in the present view; from another side it is hidden. */
  update() {
    const { camera, controls } = this.stage;
    const direction = camera.position.clone().sub(controls.target).normalize();
    const isShown = Boolean(this.isLoaded) && this.stage.isParallel && direction.y < -0.99999;
    if (this.image.hidden === isShown) {
      this.image.hidden = !isShown;
      this.show();
    }
    this.marks.forEach((mark, i) => this.mark(mark, this.points[2 * i]));
    if (!isShown) return;
    this.image.style.transform = `matrix(${this.onScreen().join(",")})`;
  }

  mark(element, place) {
    element.hidden = !place || this.step === null || !this.isShown;
    if (element.hidden) return;
    const { origin, right, up } = this.view();
    element.style.translate = `${origin[0] + place[0] * right[0] + place[1] * up[0]}px ${origin[1] + place[0] * right[1] + place[1] * up[1]}px`;
  }

  /** Where x = z = 0 is on the canvas, and what a millimetre along x and z is there, pixels. */
  view() {
    const [origin, x, z] = [[0, 0, 0], [1, 0, 0], [0, 0, 1]].map((place) => this.stage.project(new Vector3(...place)));
    const [right, up] = [x, z].map((end) => [end[0] - origin[0], end[1] - origin[1]]);
    return { origin, right, up, perMm: Math.hypot(...right) };
  }

  /** x and z of a place on the canvas, mm, relative to the origin. */
  inBody(px, py) {
    const { origin, right, up } = this.view();
    const [dx, dy] = [px - origin[0], py - origin[1]];
    const area = right[0] * up[1] - right[1] * up[0];
    return [(dx * up[1] - dy * up[0]) / area, (dy * right[0] - dx * right[1]) / area];
  }

  /** The pixel of the photo at a place of the body. */
  inPhoto([x, z]) {
    const { cos, sin, x: x0, z: z0 } = this.map;
    const square = cos * cos + sin * sin;
    return [(cos * (x - x0) + sin * (z - z0)) / square, (sin * (x - x0) - cos * (z - z0)) / square];
  }

  /** The affine map from the photo's pixels to the canvas's, as canvas and CSS have it. */
  onScreen() {
    const { origin, right, up } = this.view();
    const { cos, sin, x, z } = this.map;
    const place = (a, b) => [0, 1].map((d) => a * right[d] + b * up[d]);
    const [along, down, shift] = [place(cos, sin), place(sin, -cos), place(x, z)];
    return [...along, ...down, origin[0] + shift[0], origin[1] + shift[1]];
  }
}
