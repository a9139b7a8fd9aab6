// The page's start. Data is read, the time (an actuator's is its air pressure) is shared by everything that shows it, and the
// parts are put together:
//   transport  slider and play button
//   plots      curves against time
//   viewer     the body in three dimensions (stage: camera; body, obstacles: what is drawn; section, probe, legend, photo)

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
drawPlots(document.getElementById("plots"), document.getElementById("more-plots"), data.series, clock, data.wanted);

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
    return viewer?.body.field;
  },
  get legend() {
    return viewer?.rows[0].marks.slice();
  },
  /** What the present colours go from and to, region by region. */
  get colours() {
    return viewer.body.regions.flatMap(({ low, top }) => [low.value, top.value]);
  },
  /** How long the bar of lengths is, mm and pixels. */
  get scale() {
    const { axes } = viewer;
    return [axes.length, axes.bar.getBoundingClientRect().width];
  },
  valueAt: (node) => viewer.states.values[viewer.body.field][node],
  get reading() {
    return viewer?.probe.reading();
  },
  get section() {
    const triangles = viewer?.body.cuts[0].section.triangles.map((list) => list.length / 3);
    return viewer?.plane && { ...viewer.plane, triangles };
  },
  /** Triangles that are drawn of the surface of every region, and how many images there are. */
  get surface() {
    const { regions, walls, inner, images } = viewer.body;
    const triangles = regions.map(({ isShown }, r) => (isShown ? (walls[r].index.count + inner[r].index.count) / 3 : 0));
    return { triangles, images: images.filter(({ group }) => group.visible).length };
  },
  /** The photo: whether it is shown, which point is to be clicked, and its map to the canvas. */
  get photo() {
    const { isShown, step, isLoaded } = viewer.photo;
    return { isShown, step, map: isLoaded ? viewer.photo.onScreen() : null };
  },
  /** Names of the obstacles, and where the centres of what is drawn of them are now, mm, and on the page. */
  get obstacles() {
    return viewer?.obstacleCentres();
  },
  /** Rest and the computed times. */
  get computed() {
    return clock.computed.slice();
  },
  get camera() {
    return viewer?.stage.camera.position.toArray();
  },
  /** From the middle of the view towards the eye, and how far that is, mm. */
  get direction() {
    const { camera, controls } = viewer.stage;
    return camera.position.clone().sub(controls.target).normalize();
  },
  get distance() {
    const { camera, controls } = viewer.stage;
    return camera.position.distanceTo(controls.target);
  },
  /** Whether the shape at rest, and the lines of the mesh, are drawn. */
  get shows() {
    const { rest, meshLines } = viewer.body.images[0];
    return { ghost: rest.visible, mesh: meshLines.visible };
  },
  /** Milliseconds that the last change of the time took, without drawing. */
  get updateTime() {
    return viewer?.updateTime;
  },
  positionOf: (node) => viewer.states.place(viewer.states.position, node),
  placeOnPage: (node) => viewer.placeOnPage(node),
});
