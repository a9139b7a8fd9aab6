// The axes as they lie in the view, and a length.

import { Vector3 } from "three";
import { roundStep } from "pneuflex/format";

const SIZE = 30;
const AXES = { x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1) };

/** About how long the length is, pixels. */
const LENGTH = 90;

export class Axes {
  constructor(element, stage) {
    this.stage = stage;
    element.innerHTML = `<svg viewBox="-50 -50 100 100" aria-hidden="true">${Object.keys(AXES)
      .map((name) => `<g><line/><text>${name}</text></g>`)
      .join("")}</svg><p class="length"><span></span></p>`;
    this.groups = [...element.querySelectorAll("g")];
    this.bar = element.querySelector(".length");
    this.text = element.querySelector(".length span");
  }

  update() {
    const { camera, controls, canvas } = this.stage;
    Object.values(AXES).forEach((axis, i) => {
      const { x, y, z } = axis.clone().transformDirection(camera.matrixWorldInverse);
      const [line, text] = this.groups[i].children;
      for (const [key, value] of Object.entries({ x2: SIZE * x, y2: -SIZE * y })) line.setAttribute(key, value.toFixed(1));
      for (const [key, value] of Object.entries({ x: 1.35 * SIZE * x, y: -1.35 * SIZE * y + 4 })) text.setAttribute(key, value.toFixed(1));
      // Towards the eye there is no direction to be seen.
      this.groups[i].style.opacity = Math.hypot(x, y) < 0.2 ? 0 : 1;
      this.groups[i].dataset.depth = z;
    });
    // Lengths are true in all depths without perspective, else where the view turns about.
    const distance = camera.position.distanceTo(controls.target);
    const perPixel = (2 * distance * Math.tan((camera.fov * Math.PI) / 360)) / canvas.clientHeight;
    if (!(perPixel > 0)) return;
    this.length = roundStep(LENGTH * perPixel, 1);
    if (this.length > 1.6 * LENGTH * perPixel) this.length = roundStep(LENGTH * perPixel, 2);
    this.bar.style.width = `${(this.length / perPixel).toFixed(1)}px`;
    this.text.textContent = `${Number(this.length.toPrecision(3))} mm`;
    this.bar.title = this.stage.isParallel ? "" : "True in the middle of the view";
  }
}
