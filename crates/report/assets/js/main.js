// The page's start. Data is read, the pressure is shared by everything that shows it, and the parts are put together:
//   transport  slider and play button
//   plots      curves against pressure
//   viewer     the actuator in three dimensions (stage: camera; actuator: what is drawn; section, probe, legend)

import { readData } from "pneuflex/data";
import { Curve } from "pneuflex/interpolation";
import { drawPlots } from "pneuflex/plots";
import { connectSnapshots } from "pneuflex/snapshot";
import { hasWebGL } from "pneuflex/stage";
import { Pressure, Transport } from "pneuflex/transport";
import { Viewer } from "pneuflex/viewer";

const data = readData();
const pressure = new Pressure(data.series.map((point) => point.pressure));
const hasTip = data.series.every(({ centreline }) => centreline.length > 0);
const numbers = ({ angle, centreline }) => Float64Array.of(angle, ...(hasTip ? centreline[centreline.length - 1] : []));
const curve = new Curve(pressure.computed, data.series.map(numbers));
const transport = new Transport(pressure, (value) => {
  const [angle, x, z] = curve.evaluate(value, new Float64Array(hasTip ? 3 : 1));
  return { angle, tip: hasTip ? [x, z] : null };
});
drawPlots(document.getElementById("plots"), data.series, pressure);

let viewer = null;
if (data.body && hasWebGL()) {
  viewer = new Viewer(data.body, pressure);
  connectSnapshots(viewer, data.title);
} else if (data.body) {
  document.getElementById("stage").classList.add("empty");
  document.getElementById("no-view").hidden = false;
  document.getElementById("options").hidden = true;
}

document.getElementById("theme").addEventListener("click", () => {
  const isDark = getComputedStyle(document.documentElement).colorScheme === "dark";
  document.documentElement.dataset.theme = isDark ? "light" : "dark";
  viewer?.useTheme();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => viewer?.useTheme());

// The first thing to see is how the actuator bends, once; unless whoever looks wants no motion.
if (viewer && pressure.highest > 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches) {
  pressure.set(0);
  transport.play(true);
  document.addEventListener("pointerdown", () => transport.stop(), { once: true, capture: true });
}

/** What the page shows now, for tests and for the curious. Read only. */
window.pneuflex = Object.freeze({
  get pressure() {
    return pressure.value;
  },
  get isComputed() {
    return pressure.isComputed();
  },
  get field() {
    return viewer?.actuator.field;
  },
  get legend() {
    return viewer?.marks.slice();
  },
  get reading() {
    return viewer?.probe.reading();
  },
  get section() {
    const section = viewer?.actuator.halves[0].section;
    return viewer?.plane && { ...viewer.plane, triangles: section.triangles.length / 3 };
  },
  get camera() {
    return viewer?.stage.camera.position.toArray();
  },
  /** Milliseconds that the last change of pressure took, without drawing. */
  get updateTime() {
    return viewer?.updateTime;
  },
  positionOf: (node) => Array.from(viewer.states.position.subarray(3 * node, 3 * node + 3)),
  placeOnPage: (node) => viewer.placeOnPage(node),
});
