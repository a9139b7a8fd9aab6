// Colours of a scalar: the same as in the program's pictures. What has a size is dark where there is little and bright where there is much
// (viridis, S. van der Walt and N. Smith, CC0), on light and dark ground alike; what has both signs is light in the middle ("balance" of
// cmocean, K. Thyng et al. 2016, Oceanography 29; MIT; without its darkest ends, so that shading stays visible).

const MAPS = {
  size: `440154 470d60 48186a 482374 472d7b 453681 424086 3f4989 3b528b 375a8d 33638d 2f6a8e 2c728e 297a8e 26818e 23898e 21908c
    1f988b 1f9f88 21a685 28ae80 31b57b 3ebc74 4cc26c 5dc963 6ece58 82d34c 96d83f abdc32 c0df24 d5e21a eae51a fde725`,
  signed: "2a4b9b 2f68b5 4b87c0 74a2c9 9cbad3 c2d1df e3e6ea f1ecea ecdcd5 e2bfb2 d99f8c cf7e68 c25c49 ae3936 8f1b30",
};

const tables = Object.fromEntries(
  Object.entries(MAPS).map(([name, text]) => [
    name,
    text.split(/\s+/).map((hex) => [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16))),
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
