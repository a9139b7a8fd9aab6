// The page's data: JSON in which long lists of numbers are little-endian bytes in base64.

/** The data of this page. */
export function readData() {
  return JSON.parse(document.getElementById("report-data").textContent);
}

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes.buffer;
}

/** Whole numbers. */
export const integers = (base64) => new Uint32Array(bytesOf(base64));

/** Small whole numbers. */
export const smallIntegers = (base64) => new Uint16Array(bytesOf(base64));

/** Single-precision numbers. */
export const floats = (base64) => new Float32Array(bytesOf(base64));

/** Numbers stored as 8-bit multiples of a step. */
export function coarse({ low, step, data }) {
  return Float32Array.from(new Uint8Array(bytesOf(data)), (level) => low + step * level);
}

/** Numbers stored as 16-bit multiples of a step: off by half a step at most. */
export function quantised({ low, step, data }) {
  return Float32Array.from(new Uint16Array(bytesOf(data)), (level) => low + step * level);
}
