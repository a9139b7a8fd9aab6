// The page's start. Data is read, the time (an actuator's is its air pressure) is shared by everything that shows it, and the
// parts are put together:
//   transport  slider and play button
//   plots      curves against time
//   viewer     the body in three dimensions (stage: camera; actuator, obstacles: what is drawn; section, probe, legend)

import { readData } from "pneuflex/data";
import { drawPlots } from "pneuflex/plots";
import { connectRecorder } from "pneuflex/record";
import { connectSnapshots } from "pneuflex/snapshot";
import { hasWebGL } from "pneuflex/stage";
import { Clock, Transport } from "pneuflex/transport";
import { Viewer } from "pneuflex/viewer";

const data = readData();
const clock = new Clock(data.clock, data.series.times, data.series.on_the_way);
const transport = new Transport(clock, data.series);
drawPlots(document.getElementById("plots"), data.series, clock);

let viewer = null;
if (data.body && hasWebGL()) {
  viewer = new Viewer(data.body, clock);
  connectSnapshots(viewer, data.title);
  connectRecorder(viewer, transport, data.title);
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

// The first thing to see is how the body moves, once; unless whoever looks wants no motion.
if (viewer && clock.highest > 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches) {
  clock.set(0);
  transport.play(true);
  document.addEventListener("pointerdown", () => transport.stop(), { once: true, capture: true });
}

/** What the page shows now, for tests and for the curious. Read only. */
window.pneuflex = Object.freeze({
  get time() {
    return clock.value;
  },
  get isComputed() {
    return clock.isComputed();
  },
  get field() {
    return viewer?.actuator.field;
  },
  get legend() {
    return viewer?.marks.slice();
  },
  /** What the present colours go from and to, and how long the bar of lengths is, mm and pixels. */
  get colours() {
    const { low, top } = viewer.actuator.colours;
    return [low.value, top.value];
  },
  get scale() {
    const { axes } = viewer;
    return [axes.length, axes.bar.getBoundingClientRect().width];
  },
  valueAt: (node) => viewer.states.values[viewer.actuator.field][node],
  get reading() {
    return viewer?.probe.reading();
  },
  get section() {
    const section = viewer?.actuator.halves[0].section;
    return viewer?.plane && { ...viewer.plane, triangles: section.triangles.length / 3 };
  },
  /** Names of the obstacles, and where the centres of what is drawn of them are now, mm, and on the page. */
  get obstacles() {
    return viewer?.obstacleCentres();
  },
  get camera() {
    return viewer?.stage.camera.position.toArray();
  },
  /** Milliseconds that the last change of the time took, without drawing. */
  get updateTime() {
    return viewer?.updateTime;
  },
  positionOf: (node) => viewer.states.place(viewer.states.position, node),
  placeOnPage: (node) => viewer.placeOnPage(node),
});
