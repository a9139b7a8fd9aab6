// Colours of a scalar. The maps are "matter", "deep" and "dense" of cmocean (K. Thyng et al. 2016, Oceanography 29; MIT), which
// are perceptually uniform: light where there is little, dark where there is much; what has both signs is light in the middle. Their darkest tenth is left out, so that
// shading stays visible.

const MAPS = {
  vonMises: "feedb0 fcda9d fac58b f7b27b f49f6d ef8a60 ea7758 e36453 d95153 cd4257 bf365b ae2b60 9c2363 8a1d63 761a61 63185b 4f1652",
  displacement: "fdfecc e1f3bc c6eab0 a7e0a7 8bd6a3 71caa3 61bea4 56afa4 4fa2a2 4a949f 46879c 427999 3e6b96 3e5e93 404e8d 41417d 3e3666",
  // Both signs: "balance", without its darkest ends.
  signed: "2a4b9b 2f68b5 4b87c0 74a2c9 9cbad3 c2d1df e3e6ea f1ecea ecdcd5 e2bfb2 d99f8c cf7e68 c25c49 ae3936 8f1b30",
  contactPressure: "e6f1f1 cee5e9 b7dae4 a2cee2 8fc1e2 80b3e3 77a5e4 7395e4 7584df 7773d7 7963ca 7953ba 7745a7 733793 6c2a7e 641f67 591750",
};

const tables = Object.fromEntries(
  Object.entries(MAPS).map(([name, text]) => [
    name,
    text.split(" ").map((hex) => [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16))),
  ]),
);

/** Colour [r, g, b] from 0 to 255 at a share of the range; below 0 and above 1 the ends. */
export function colourAt(map, share) {
  const table = tables[map];
  const place = Math.min(Math.max(share, 0), 1) * (table.length - 1);
  const k = Math.min(Math.floor(place), table.length - 2);
  return table[k].map((c, i) => Math.round(c + (place - k) * (table[k + 1][i] - c)));
}

/** 256 colours as bytes r, g, b, a. */
export function colourBytes(map) {
  const bytes = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) bytes.set([...colourAt(map, i / 255), 255], 4 * i);
  return bytes;
}

/** The map as a CSS gradient from left to right. */
export function gradient(map) {
  const stops = tables[map].map((rgb, i, all) => `rgb(${rgb}) ${((100 * i) / (all.length - 1)).toFixed(2)}%`);
  return `linear-gradient(to right, ${stops})`;
}
