// Lists of triangles or lines in runs that are shown or left out together.

/** Whether a run is shown: `shown` says so of every region, `whole` that images make the body whole. */
export function isShown({ side, regions, beyond }, shown, whole) {
  if (side === "symmetry" && whole) return false;
  if (side === "interface" && shown[beyond]) return false;
  return regions.some((region) => shown[region]);
}

/** The numbers of those runs of a list, `per` for each triangle or line, that pass. */
export function chosen({ list, runs }, per, passes) {
  const parts = [];
  let from = 0;
  for (const run of runs) {
    const to = from + per * run.count;
    if (passes(run)) parts.push(list.subarray(from, to));
    from = to;
  }
  const all = new Uint32Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}
