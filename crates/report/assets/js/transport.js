// The time shown (an actuator's is its air pressure), and the slider, ticks and play button that change it.

import { decimalsFor, exact, fixed, short } from "pneuflex/format";
import { interval, Lines } from "pneuflex/interpolation";

/** Seconds from rest to the end. */
const SWEEP = 4;

/** Pictures of a film at least. */
const FEWEST = 24;

/** The time shown: the parameter that results depend on, whatever its name. */
export class Clock {
  /**
   * @param {{name: string, unit: string, rest?: string, decimals?: number, parameters?: number[]}} what what it stands for, what is at zero, and its values where they turn back
   * @param {number[]} computed rest and the computed times
   * @param {number} onTheWay how many of them, at the end, were not asked for
   */
  constructor(what, computed, onTheWay = 0) {
    Object.assign(this, { rest: "at rest" }, what);
    this.computed = computed;
    /** The parameter along the path, where it turns back. */
    this.course = what.parameters && new Lines(computed, [what.parameters]);
    /** Where those begin that were not asked for. */
    this.requested = computed.length - onTheWay;
    this.highest = computed[computed.length - 1];
    this.value = this.highest;
    this.listeners = [];
    /** What stands along an axis. */
    this.label = this.unit ? `${this.name}, ${this.unit}` : this.name;
    // A hundredth of a schedule is worth showing.
    this.decimals = what.decimals ?? (this.unit ? 1 : decimalsFor(Math.max(...(what.parameters ?? computed)), 3));
  }

  /** The parameter at a place of the slider. */
  parameter(value) {
    return this.course ? this.course.evaluate(value)[0] : value;
  }

  /** A time in words, as it is now between two computed ones. */
  words(value) {
    const text = fixed(this.parameter(value), this.decimals);
    return this.unit ? `${text} ${this.unit}` : `${this.name} ${text}`;
  }

  /** A computed time as somebody would write it. */
  written(value) {
    const parameter = this.parameter(value);
    if (this.unit) return String(Number(parameter.toFixed(1))).replace("-", "−");
    return this.course ? fixed(parameter, this.decimals) : exact(parameter);
  }

  /** The same in words. */
  writtenWords(value) {
    return this.unit ? `${this.written(value)} ${this.unit}` : `${this.name} ${this.written(value)}`;
  }

  /** Calls `listener` with the time now and whenever it changes, until the function that is returned is called. */
  listen(listener) {
    this.listeners.push(listener);
    listener(this.value);
    return () => (this.listeners = this.listeners.filter((other) => other !== listener));
  }

  set(value) {
    this.value = Math.min(Math.max(value, 0), this.highest);
    for (const listener of this.listeners) listener(this.value);
  }

  /** A computed time if it is close by, so that a hand can find it. */
  snapped(value) {
    const near = this.computed.find((p) => Math.abs(p - value) < 0.008 * this.highest);
    return near ?? value;
  }

  isComputed() {
    return this.computed.includes(this.value);
  }

  /** Whether a computed time is one that was not asked for, on the way of a run that ended early. */
  isOnTheWay(value) {
    return this.computed.indexOf(value) >= this.requested;
  }
}

export class Transport {
  /** @param series the data's */
  constructor(clock, series) {
    const byId = (id) => document.getElementById(id);
    Object.assign(this, { clock, slider: byId("time"), button: byId("play") });
    this.output = byId("time-readout");
    this.origin = byId("origin");
    this.keyNumbers = byId("key-numbers");
    this.numbers = keyNumbers(series);
    this.slider.max = clock.highest || 1;
    this.slider.disabled = this.button.disabled = clock.highest === 0;
    this.slider.addEventListener("input", () => this.choose(clock.snapped(Number(this.slider.value))));
    this.slider.addEventListener("keydown", (event) => this.key(event));
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    byId("canvas")?.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      this.button.click();
    });
    this.showTicks(byId("ticks"));
    clock.listen((value) => this.show(value));
  }

  /** Marks at all computed times, with texts where there is room, the last one first. */
  showTicks(element) {
    let before = Infinity;
    for (const value of this.clock.computed.toReversed()) {
      const button = this.tick(value);
      const share = value / (this.clock.highest || 1);
      const room = (7 * button.textContent.length + 8) / 320;
      if (before - share < room) button.textContent = "";
      else before = share;
      element.prepend(button);
    }
  }

  tick(value) {
    const { clock } = this;
    const onTheWay = clock.isOnTheWay(value);
    const text = onTheWay ? fixed(clock.parameter(value), clock.decimals) : clock.written(value);
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: text });
    button.style.setProperty("--share", this.clock.highest ? value / this.clock.highest : 0);
    button.classList.toggle("on-the-way", onTheWay);
    button.setAttribute("aria-label", value ? clock.writtenWords(value) + (onTheWay ? ", on the way" : "") : clock.rest);
    button.addEventListener("click", () => this.choose(value));
    return button;
  }

  choose(value) {
    this.stop();
    this.clock.set(value);
  }

  key(event) {
    const { computed, value, highest } = this.clock;
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
    const { clock } = this;
    const { computed } = clock;
    this.slider.value = value;
    this.slider.style.setProperty("--share", this.clock.highest ? value / this.clock.highest : 0);
    this.output.textContent = clock.words(value);
    const k = interval(computed, value);
    const isComputed = this.clock.isComputed();
    this.origin.textContent = isComputed
      ? value === 0 ? clock.rest : clock.isOnTheWay(value) ? "computed, on the way" : "computed"
      : `interpolated between ${clock.written(computed[k])} and ${clock.written(computed[k + 1])}`;
    this.origin.classList.toggle("interpolated", !isComputed);
    this.slider.setAttribute("aria-valuetext", `${clock.words(value)}, ${this.origin.textContent}`);
    this.keyNumbers.textContent = this.numbers.map((text) => text(value)).join(" · ");
  }

  /**
   * To the end and back, until stopped; `once`: there, and no further, and then `done`, in at least so many pictures as a film needs: where
   * drawing takes long, it is slower.
   */
  play(once = false, done = () => {}) {
    this.stop();
    const { highest, value } = this.clock;
    // Where on the wave the present time is.
    let angle = value >= highest ? Math.PI : Math.acos(1 - (2 * value) / highest);
    let before = performance.now();
    const [speed, longest] = once ? [1.6, Math.PI / FEWEST] : [1, Infinity];
    const step = (now) => {
      angle += Math.min(((now - before) / 1000 / SWEEP) * Math.PI * speed, longest);
      before = now;
      if (once && angle >= Math.PI) {
        this.choose(highest);
        return done();
      }
      this.clock.set((highest * (1 - Math.cos(angle))) / 2);
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

/** What is said beside the slider: functions from a time to a text. */
function keyNumbers({ places, key_numbers: numbers, centrelines }) {
  const texts = numbers.map(({ name, unit, curves: [{ values }] }) => {
    const line = new Lines(places, [values]);
    const text = (x) => (unit === "°" ? `${fixed(x, 1)}°` : `${short(x)} ${unit}`);
    return (time) => `${name} ${text(line.evaluate(time)[0])}`;
  });
  if (centrelines) {
    const tip = new Lines(places, [0, 1].map((d) => centrelines.map((line) => line[line.length - 1][d])));
    texts.push((time) => {
      const [x, z] = tip.evaluate(time);
      return `tip x ${fixed(x, 1)}, z ${fixed(z, 1)} mm`;
    });
  }
  return texts;
}
