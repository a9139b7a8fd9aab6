// Where the plots stand: beside the view as far as there is room, the others below, across the page.

/** Puts figures into `beside` up to the height of what it stands beside, the rest into `below`, and a note after the last one. */
export function layOut(figures, beside, below, note) {
  const viewer = beside.previousElementSibling;
  const isBeside = () => getComputedStyle(beside.parentElement).gridTemplateColumns.split(" ").length > 1;
  const place = () => {
    beside.replaceChildren(...figures, note);
    below.replaceChildren();
    const { top } = viewer.getBoundingClientRect();
    const { height } = viewer.getBoundingClientRect();
    const fits = (figure) => figure.getBoundingClientRect().bottom - top <= height;
    const count = isBeside() ? Math.max(figures.findIndex((figure) => !fits(figure)), 0) : 0;
    below.hidden = count === 0;
    if (count > 0) below.replaceChildren(...figures.slice(count), note);
  };
  let before = "";
  new ResizeObserver(() => {
    const size = `${innerWidth} ${viewer.offsetHeight}`;
    if (size === before) return;
    before = size;
    place();
  }).observe(viewer);
  place();
}
