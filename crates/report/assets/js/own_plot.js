// A plot of one quantity over another, both chosen.

/** Everything that a state has a number for: what is plotted, what it is plotted over, the time among them. */
function quantities(series) {
  const found = new Map();
  const add = (name, unit, values) => found.has(name) || found.set(name, { name, unit, values });
  for (const { name, unit, over, curves } of [...series.plots, ...series.more]) {
    for (const curve of curves) add(curve.name ? `${name}: ${curve.name}` : name, unit, curve.values);
    if (over) add(over.name, over.unit, over.values);
  }
  if (series.centrelines) {
    ["x", "z"].forEach((axis, d) => add(`Tip, ${axis}`, "mm", series.centrelines.map((line) => line[line.length - 1][d])));
  }
  return [...found.values()];
}

/** A plot of any quantity over any other; `draw` makes it. */
export function ownPlot(series, clock, draw) {
  const all = quantities(series);
  if (all.length < 2) return null;
  const figure = Object.assign(document.createElement("figure"), { className: "own" });
  const chooser = (id, label, chosen) => {
    const select = Object.assign(document.createElement("select"), { id });
    select.setAttribute("aria-label", label);
    all.forEach(({ name }, i) => select.append(new Option(name, i, false, i === chosen)));
    return select;
  };
  const [x, y] = [chooser("own-x", "Quantity along x", all.findIndex(({ name }) => name === clock.name)), chooser("own-y", "Quantity along y", 0)];
  const choice = Object.assign(document.createElement("p"), { className: "choice" });
  choice.append(y, " over ", x);
  let plot = null;
  const show = () => {
    plot?.stop();
    const [over, { name, unit, values }] = [all[x.value], all[y.value]];
    plot = draw({ name, unit, over, curves: [{ values }] });
    figure.replaceChildren(choice, ...plot.element.childNodes);
  };
  for (const select of [x, y]) select.addEventListener("change", show);
  show();
  return figure;
}
