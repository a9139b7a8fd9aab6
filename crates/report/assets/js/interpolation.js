// Between the computed times. The body moves along piecewise cubic Hermite interpolations that keep monotone data monotone
// (Fritsch & Butland 1984, SIAM J. Sci. Stat. Comput. 5); numbers go straight from one computed value to the next. Both are exact at the
// computed times.

/** Lists of numbers that depend on one parameter, known at some of its values. */
export class Curve {
  /**
   * @param {number[]} at increasing parameters
   * @param {Float32Array[]|Float64Array[]} values one list of the same length for each of them
   */
  constructor(at, values) {
    this.at = at;
    this.values = values;
    this.slopes = slopes(at, values);
  }

  /** Writes the interpolated list for a parameter within the known range into `target`. */
  evaluate(parameter, target) {
    const { at, values, slopes } = this;
    if (at.length === 1) {
      target.set(values[0]);
      return target;
    }
    const k = interval(at, parameter);
    const h = at[k + 1] - at[k];
    const t = (parameter - at[k]) / h;
    const [a, b, m, n] = [values[k], values[k + 1], slopes[k], slopes[k + 1]];
    const wb = t * t * (3 - 2 * t);
    const wa = 1 - wb;
    const wm = h * t * (1 - t) * (1 - t);
    const wn = -h * t * t * (1 - t);
    for (let i = 0; i < target.length; i++) target[i] = wa * a[i] + wb * b[i] + wm * m[i] + wn * n[i];
    return target;
  }
}

/** Numbers that depend on one parameter, each known at some of its values. */
export class Lines {
  /**
   * @param {number[]} at increasing parameters
   * @param {(number|null)[][]} columns for each number its values there; null where it is not known, but not at the ends
   */
  constructor(at, columns) {
    this.at = at;
    this.columns = columns;
    const places = at.map((_, k) => k);
    /** For each number the parameters at which it is known, and its values there. */
    this.known = columns.map((values) => {
      const there = places.filter((k) => values[k] !== null);
      return { at: there.map((k) => at[k]), values: there.map((k) => values[k]) };
    });
  }

  /** The numbers at a parameter within the known range. */
  evaluate(parameter) {
    return this.known.map(({ at, values }) => {
      if (at.length === 1) return values[0];
      const k = interval(at, parameter);
      const share = (parameter - at[k]) / (at[k + 1] - at[k]);
      return (1 - share) * values[k] + share * values[k + 1];
    });
  }
}

/** The k for which `parameter` lies between `at[k]` and `at[k + 1]`. */
export function interval(at, parameter) {
  let k = 0;
  while (k < at.length - 2 && parameter >= at[k + 1]) k++;
  return k;
}

function slopes(at, values) {
  const last = at.length - 1;
  const result = values.map((list) => new list.constructor(list.length));
  if (last === 0) return result;
  const h = at.slice(1).map((x, k) => x - at[k]);
  const secant = new Array(last);
  for (let i = 0; i < values[0].length; i++) {
    for (let k = 0; k < last; k++) secant[k] = (values[k + 1][i] - values[k][i]) / h[k];
    for (let k = 1; k < last; k++) result[k][i] = inner(secant[k - 1], secant[k], h[k - 1], h[k]);
    result[0][i] = last === 1 ? secant[0] : end(secant[0], secant[1], h[0], h[1]);
    result[last][i] = last === 1 ? secant[0] : end(secant[last - 1], secant[last - 2], h[last - 1], h[last - 2]);
  }
  return result;
}

function inner(before, after, hBefore, hAfter) {
  if (before * after <= 0) return 0;
  const [u, v] = [hBefore + 2 * hAfter, 2 * hBefore + hAfter];
  return (u + v) / (u / before + v / after);
}

/** One-sided slope at an end, cut down where it would overshoot. */
function end(near, far, hNear, hFar) {
  const slope = ((2 * hNear + hFar) * near - hNear * far) / (hNear + hFar);
  if (slope * near <= 0) return 0;
  return near * far <= 0 && Math.abs(slope) > 3 * Math.abs(near) ? 3 * near : slope;
}
