// Participation, cost.

function drawShares() {
  const curve = data.curves.find((each) => title(each) === byId("modal").value);
  const colours = ["#0072B2", "#D55E00", "#009E73", "#AA4499", "#7A5C00", "#333333", "#56B4E9", "#B3261E"];
  const order = curve.frequency.map((value, index) => index).sort((a, b) => curve.frequency[a] - curve.frequency[b]);
  const columns = [order.map((index) => curve.frequency[index] * FACTOR), ...curve.shares.map((share) => order.map((index) => share[index]))];
  const positive = columns.slice(1).map((share) => share.map((value) => (value > 1e-6 ? value : null)));
  chart(byId("shares"), [{ label: withUnit("Frequency", data.frequency.unit), value: (plot, value) => short(value, 6) }, ...curve.shares.map((share, mode) => ({ label: `mode ${mode + 1}`, stroke: colours[mode], width: 1.5, points: { show: columns[0].length < 4 }, value: (plot, value) => (value === null || value === undefined ? "–" : `${short(100 * value, 3)} %`) }))], [columns[0], ...positive], [frequencyAxis(), axis("Share of the energy")], { height: 280, scales: { y: { distr: 3 } }, words: "Share of each mode in the energy against drive frequency" });
}

function drawCost() {
  const host = byId("cost"), points = data.cost.filter((each) => each.off !== null && each.seconds > 0);
  if (!points.length) { host.replaceChildren(element("p", { class: "note" }, "No fidelity has a finer one of the same physics to be compared with.")); return; }
  const sorted = [...points].sort((a, b) => a.seconds - b.seconds);
  const xs = increasing(sorted.map((each) => each.seconds));
  const series = [{ label: "CPU time (s)", value: (plot, value) => short(value, 3) }], columns = [xs];
  sorted.forEach((each, at) => {
    series.push({ label: fidelity[each.fidelity].label, stroke: fidelity[each.fidelity].colour, width: 0, points: { show: true, size: 12, fill: fidelity[each.fidelity].colour }, value: (plot, value) => (value === null || value === undefined ? "–" : `${short(100 * value, 3)} %`) });
    columns.push(xs.map((_, index) => (index === at ? Math.max(each.off, 1e-9) : null)));
  });
  const around = (low, high) => (low === high ? [low / 3, high * 3] : [low / 1.5, high * 1.5]);
  chart(host, series, columns, [{ ...axis("CPU time of the sweep (s)"), size: 44 }, axis("Off the finest, at most")], { height: 240, scales: { x: { time: false, distr: 3, range: (plot, low, high) => around(low, high) }, y: { distr: 3, range: (plot, low, high) => around(low, high) } }, words: "Largest difference to the finest fidelity against CPU time" });
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
