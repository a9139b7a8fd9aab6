// The pressure shown, and the slider, ticks and play button that change it.

import { fixed, kPa } from "pneuflex/format";
import { interval } from "pneuflex/interpolation";

/** Seconds from rest to the highest pressure. */
const SWEEP = 4;

/** The pressure shown, kPa. */
export class Pressure {
  /** @param {number[]} computed rest and the computed pressures */
  constructor(computed) {
    this.computed = computed;
    this.highest = computed[computed.length - 1];
    this.value = this.highest;
    this.listeners = [];
  }

  /** Calls `listener` with the pressure now and whenever it changes. */
  listen(listener) {
    this.listeners.push(listener);
    listener(this.value);
  }

  set(value) {
    this.value = Math.min(Math.max(value, 0), this.highest);
    for (const listener of this.listeners) listener(this.value);
  }

  /** A computed pressure if it is close by, so that a hand can find it. */
  snapped(value) {
    const near = this.computed.find((p) => Math.abs(p - value) < 0.008 * this.highest);
    return near ?? value;
  }

  isComputed() {
    return this.computed.includes(this.value);
  }
}

export class Transport {
  /** @param numbers called with a pressure, returns the angle (degrees) and the tip's position [x, z] (mm) or null */
  constructor(pressure, numbers) {
    const byId = (id) => document.getElementById(id);
    Object.assign(this, { pressure, numbers, slider: byId("pressure"), button: byId("play") });
    this.output = byId("pressure-readout");
    this.origin = byId("origin");
    this.keyNumbers = byId("key-numbers");
    this.slider.max = pressure.highest || 1;
    this.slider.disabled = this.button.disabled = pressure.highest === 0;
    this.slider.addEventListener("input", () => this.choose(pressure.snapped(Number(this.slider.value))));
    this.slider.addEventListener("keydown", (event) => this.key(event));
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    byId("canvas")?.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      this.button.click();
    });
    byId("ticks").append(...pressure.computed.map((p) => this.tick(p)));
    pressure.listen((value) => this.show(value));
  }

  tick(value) {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: kPa(value) });
    button.style.setProperty("--share", this.pressure.highest ? value / this.pressure.highest : 0);
    button.setAttribute("aria-label", value ? `${kPa(value)} kPa` : "At rest");
    button.addEventListener("click", () => this.choose(value));
    return button;
  }

  choose(value) {
    this.stop();
    this.pressure.set(value);
  }

  key(event) {
    const { computed, value, highest } = this.pressure;
    const goal = {
      ArrowLeft: value - highest / 100,
      ArrowDown: value - highest / 100,
      ArrowRight: value + highest / 100,
      ArrowUp: value + highest / 100,
      PageDown: computed.findLast((p) => p < value) ?? 0,
      PageUp: computed.find((p) => p > value) ?? highest,
      Home: 0,
      End: highest,
    }[event.key];
    if (goal === undefined) return;
    event.preventDefault();
    this.choose(goal);
  }

  show(value) {
    const { computed } = this.pressure;
    this.slider.value = value;
    this.slider.style.setProperty("--share", this.pressure.highest ? value / this.pressure.highest : 0);
    this.output.textContent = `${fixed(value, 1)} kPa`;
    const k = interval(computed, value);
    const isComputed = this.pressure.isComputed();
    this.origin.textContent = isComputed
      ? value === 0 ? "at rest" : "computed"
      : `interpolated between ${kPa(computed[k])} and ${kPa(computed[k + 1])}`;
    this.origin.classList.toggle("interpolated", !isComputed);
    this.slider.setAttribute("aria-valuetext", `${fixed(value, 1)} kPa, ${this.origin.textContent}`);
    const { angle, tip } = this.numbers(value);
    const place = tip ? `tip x ${fixed(tip[0], 1)}, z ${fixed(tip[1], 1)} mm` : "";
    this.keyNumbers.textContent = [`bent ${fixed(angle, 1)}°`, place].filter(Boolean).join(" · ");
  }

  /** To the highest pressure and back, until stopped; `once`: there, and no further. */
  play(once = false) {
    this.stop();
    const { highest, value } = this.pressure;
    // Where on the wave the present pressure is.
    const phase = value >= highest ? Math.PI : Math.acos(1 - (2 * value) / highest);
    const began = performance.now();
    const step = (now) => {
      const angle = phase + ((now - began) / 1000 / SWEEP) * Math.PI * (once ? 1.6 : 1);
      if (once && angle >= Math.PI) return this.choose(highest);
      this.pressure.set((highest * (1 - Math.cos(angle))) / 2);
      this.playing = requestAnimationFrame(step);
    };
    this.playing = requestAnimationFrame(step);
    this.label(true);
  }

  stop() {
    cancelAnimationFrame(this.playing);
    this.playing = 0;
    this.label(false);
  }

  label(isPlaying) {
    this.button.classList.toggle("playing", isPlaying);
    this.button.setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  }
}
