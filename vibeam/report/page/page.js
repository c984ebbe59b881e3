// Participation, cost.

// Ticks of a logarithmic axis: powers of ten, with 2 and 5 times them over few decades, and even steps in less than one.
function logTicks(low, high) {
  const decades = Math.log10(high / low), found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) for (const digit of decades > 3 ? [1] : [1, 2, 5]) found.push(+(digit * 10 ** power).toPrecision(3));
  const inside = found.filter((each) => each >= low && each <= high);
  return inside.length > 1 ? inside : ticks(low, high).map((each) => +each.toPrecision(6));
}
const logarithmic = (label, values, size = 60) => ({ ...axis(label), size, splits: (plot, index, low, high) => logTicks(low, high), filter: (plot, splits) => splits, values: (plot, splits) => splits.map(values) });
const percent = (value) => (value === null || value === undefined ? "–" : value > 100 ? "> 10000 %" : `${short(100 * value, 3)} %`);

function drawShares() {
  const curve = data.curves.find((each) => title(each) === byId("modal").value);
  const colours = ["#0072B2", "#D55E00", "#009E73", "#AA4499", "#7A5C00", "#333333", "#56B4E9", "#B3261E"];
  const order = curve.frequency.map((value, index) => index).sort((a, b) => curve.frequency[a] - curve.frequency[b]);
  const positive = curve.shares.map((share) => share.map((value) => (value > 1e-6 ? value : null)));
  const columns = [curve.frequency, ...positive].map((column, at) => order.map((index) => (at ? column[index] : column[index] * FACTOR)));
  const series = curve.shares.map((share, mode) => ({ ...unjoined, label: `mode ${mode + 1}`, stroke: colours[mode], value: (plot, value) => percent(value) }));
  const draw = [(plot) => within(plot, () => positive.forEach((share, mode) => drawPieces(plot, { ...curve, way: "up" }, "amplitude", share, { colour: colours[mode], dash: [] }, 0)))];
  chart(byId("shares"), [{ label: withUnit("Frequency", data.frequency.unit), value: (plot, value) => short(value, 6) }, ...series], columns, [frequencyAxis(), logarithmic("Share of the energy", percent, 72)], { height: 280, hooks: { draw }, scales: { x: { time: false, range: beside }, y: { distr: 3, range: (plot, low, high) => [low / 1.5, 1.3 * high] } }, words: "Share of each mode in the energy against drive frequency" });
}

function drawCost() {
  const host = byId("cost"), points = data.cost.filter((each) => each.off !== null && each.seconds > 0);
  const finest = data.cost.filter((each) => each.finest), also = finest.map((each) => `${fidelity[each.fidelity].label} (${short(each.seconds, 3)} s)`);
  if (!points.length) { host.replaceChildren(element("p", { class: "note" }, "No fidelity has a finer one of the same physics to be compared with.")); return; }
  const sorted = [...points].sort((a, b) => a.seconds - b.seconds);
  const xs = increasing(sorted.map((each) => each.seconds));
  const series = [{ label: "CPU time (s)", value: (plot, value) => short(value, 3) }], columns = [xs];
  sorted.forEach((each, at) => {
    series.push({ label: fidelity[each.fidelity].label, stroke: fidelity[each.fidelity].colour, width: 0, points: { show: true, size: 12, fill: fidelity[each.fidelity].colour }, value: (plot, value) => percent(value) });
    columns.push(xs.map((_, index) => (index === at ? Math.max(each.off, 1e-9) : null)));
  });
  const around = (low, high) => (low === high ? [low / 3, high * 3] : [low / 1.5, high * 1.5]);
  chart(host, series, columns, [logarithmic("CPU time of the sweep (s)", (value) => short(value, 3), 44), logarithmic("Off the finest, at most", percent, 72)], { height: 240, scales: { x: { time: false, distr: 3, range: (plot, low, high) => around(low, high) }, y: { distr: 3, range: (plot, low, high) => around(low, high) } }, words: "Largest difference to the finest fidelity against CPU time" });
  if (also.length) host.append(element("p", { class: "note" }, `Without a point: ${also.join(", ")}, the finest of ${finest.length > 1 ? "their" : "its"} physics, to which the others are compared.`));
}

fillControls();
drawResponse();
drawCost();
const ways = [...new Set(data.curves.map((each) => each.way))];
for (const way of ways) byId("way").append(element("option", { value: way }, way));
for (const curve of data.curves) byId("modal").append(element("option", { value: title(curve) }, title(curve)));
byId("modal").value = title(data.curves.reduce((best, curve) => (curve.shares.length > best.shares.length ? curve : best), data.curves[0]));
byId("modal").addEventListener("change", drawShares);
drawShares();
if (kept.length) {
  const first = data.curves[0], peak = first.values.amplitude.reduce((best, value, at) => (value !== null && (best < 0 || value > first.values.amplitude[best]) ? at : best), -1);
  const near = peak < 0 ? 0 : kept.reduce((best, value, at) => (Math.abs(value - first.frequency[peak]) < Math.abs(kept[best] - first.frequency[peak]) ? at : best), 0);
  byId("pick").max = String(kept.length - 1);
  byId("pick").value = String(near);
  byId("pick").addEventListener("input", drawMotion);
  byId("way").addEventListener("change", drawMotion);
  byId("play").addEventListener("click", play);
  drawMotion();
} else byId("motion").hidden = true;
