// Numbers as people write them.

/** A number with so many decimals, a true minus sign and no "−0.00". */
export function fixed(x, decimals) {
  const text = x.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** A number with about three digits that count. */
export function short(x) {
  const size = Math.abs(x);
  if (size === 0) return "0";
  if (size >= 0.01) return fixed(x, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.1 ? 3 : 4);
  return exact(Number(x.toPrecision(3)));
}

/** A number without the digits that binary arithmetic leaves behind. */
export const exact = (x) => String(Number(x.toPrecision(9))).replace("-", "−");

/** Decimals with which a number of this size has so many digits that count. */
export const decimalsFor = (size, digits) => (size > 0 ? Math.min(Math.max(digits - 1 - Math.floor(Math.log10(size)), 0), 12) : 0);

/** A round step (1, 2, 2.5 or 5 times a power of ten) that divides `span` into about `count` parts. */
export function roundStep(span, count) {
  const power = 10 ** Math.floor(Math.log10(span / count));
  return [1, 2, 2.5, 5, 10].find((m) => m * power * count >= span * 0.999) * power;
}

/** Round numbers from below `low` to above `high`. */
export function ticks(low, high, count) {
  if (!(high > low)) high = low + 1;
  const step = roundStep(high - low, count);
  const first = Math.floor(low / step + 1e-9);
  const last = Math.ceil(high / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

/** The ticks as texts that all have the decimals of their step. */
export function tickTexts(values) {
  const step = values[1] - values[0];
  const decimals = Math.max(0, ...[0, 1, 2, 3, 4, 5, 6].filter((d) => Math.abs(step * 10 ** d - Math.round(step * 10 ** d)) > 1e-6 * step * 10 ** d).map((d) => d + 1));
  return values.map((x) => fixed(x, decimals));
}
