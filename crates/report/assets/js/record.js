// The view from rest to the end as a film (WebM), with legend, title and time.

import { fileName, paint, save } from "pneuflex/snapshot";

/** Formats of the film, the best one first. */
const FORMATS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

/** Pictures per second, and ms for which the last one stays. */
const RATE = 30;
const LAST = 600;

/** Connects the button; where a browser cannot record, there is none. */
export function connectRecorder(viewer, transport, title) {
  const button = document.getElementById("record");
  const type = typeof MediaRecorder === "undefined" ? undefined : FORMATS.find((format) => MediaRecorder.isTypeSupported(format));
  button.hidden = !type || viewer.clock.highest === 0;
  button.addEventListener("click", () => record(viewer, transport, title, type, button));
}

/** Plays from rest to the end once and saves what was seen. */
function record(viewer, transport, title, type, button) {
  const { stage, clock } = viewer;
  // Even numbers of pixels suit every format.
  const [width, height] = [stage.canvas.width, stage.canvas.height].map((x) => 2 * Math.floor(x / 2));
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const recorder = new MediaRecorder(canvas.captureStream(RATE), { mimeType: type, videoBitsPerSecond: 8e6 });
  const parts = [];
  const before = stage.afterRender;
  const finish = () => {
    stage.afterRender = before;
    button.disabled = false;
  };
  recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
  recorder.addEventListener("stop", () => {
    finish();
    const film = new Blob(parts, { type: "video/webm" });
    button.dataset.bytes = film.size;
    const address = URL.createObjectURL(film);
    save(address, `${fileName(title)}.webm`);
    setTimeout(() => URL.revokeObjectURL(address), 60000);
  });
  button.disabled = true;
  stage.afterRender = () => paint(viewer, title, canvas);
  clock.set(0);
  stage.render();
  recorder.start();
  transport.play(true, () => setTimeout(() => recorder.stop(), LAST));
}
