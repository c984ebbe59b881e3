"use strict";
document.documentElement.classList.add("js");
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const fidelity = Object.fromEntries(data.fidelities.map((each) => [each.name, each]));
const title = (curve) => `${fidelity[curve.fidelity].label} ${curve.way === "up" ? "↑" : "↓"}`;
const withUnit = (label, unit) => (unit ? `${label} (${unit})` : label);
const short = (value, digits = 4) => (value === null || value === undefined || !isFinite(value) ? "–" : String(+value.toPrecision(digits)));

function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  return Array.from(new Uint16Array(bytes.buffer), (whole) => packed.low + packed.step * whole);
}

function element(name, attributes = {}, text = null, space = null) {
  const made = space ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== null) made.textContent = text;
  return made;
}
const drawn = (name, attributes, text = null) => element(name, attributes, text, "svg");
const shade = (curve) => fidelity[curve.fidelity].colour + (curve.way === "up" ? "" : "88");

// Charts over frequency: all curves on the union of their frequencies.

const FACTOR = data.frequency.factor;
const grid = [...new Set(data.curves.flatMap((curve) => curve.frequency).concat(data.references.flatMap((each) => each.frequency)))].sort((a, b) => a - b);
const place = new Map(grid.map((value, index) => [value, index]));
const spread = (frequency, values) => {
  const found = new Array(grid.length).fill(null);
  frequency.forEach((at, index) => { found[place.get(at)] = values[index]; });
  return found;
};
const charts = [];
const widthOf = (host) => Math.max(280, host.clientWidth || 280);

function chart(host, series, columns, axes, options = {}) {
  host.replaceChildren();
  const height = options.height || 320;
  const made = new uPlot({
    width: widthOf(host), height,
    scales: { x: { time: false }, ...(options.scales || {}) },
    axes, series, cursor: { focus: { prox: 24 }, ...(options.cursor || {}) },
    legend: { live: options.live !== false, show: options.legend !== false },
    hooks: options.hooks || {},
  }, columns, host);
  const canvas = made.root.querySelector("canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", options.words || "chart");
  const kept = charts.findIndex((each) => each.host === host);
  if (kept >= 0) { charts[kept].plot.destroy(); charts.splice(kept, 1); }
  charts.push({ host, height, plot: made });
  return made;
}
window.addEventListener("resize", () => charts.forEach((each) => each.plot.setSize({ width: widthOf(each.host), height: each.height })));

const axis = (label) => ({ label, stroke: "#1d2733", grid: { stroke: "#e3e8ee", width: 1 }, size: 60 });
const frequencyAxis = () => ({ ...axis(withUnit("Drive frequency", data.frequency.unit)), size: 44 });

function markers(curve) {
  const period = spread(curve.frequency, curve.values.period);
  return (plot, index) => {
    const draw = plot.ctx, values = plot.data[index], ratio = devicePixelRatio;
    draw.save();
    draw.strokeStyle = draw.fillStyle = shade(curve);
    values.forEach((value, at) => {
      if (value === null || period[at] === -1) return;
      const x = plot.valToPos(plot.data[0][at], "x", true), y = plot.valToPos(value, "y", true);
      draw.beginPath();
      if (period[at] === 0) { draw.moveTo(x - 3 * ratio, y - 3 * ratio); draw.lineTo(x + 3 * ratio, y + 3 * ratio); draw.moveTo(x - 3 * ratio, y + 3 * ratio); draw.lineTo(x + 3 * ratio, y - 3 * ratio); draw.stroke(); }
      else { draw.arc(x, y, (period[at] === 1 ? 1.8 : 3) * ratio, 0, 7); if (period[at] === 1) draw.fill(); else draw.stroke(); }
    });
    draw.restore();
    return false;
  };
}

const hiddenCurves = new Set();

function drawResponse() {
  const quantity = data.quantities.find((each) => each.name === byId("quantity").value);
  const references = data.references.filter((each) => each.quantity === quantity.name);
  const series = [{ label: withUnit("Frequency", data.frequency.unit), value: (plot, value) => short(value, 6) }];
  const columns = [grid.map((value) => value * FACTOR)];
  for (const curve of data.curves) {
    const own = fidelity[curve.fidelity];
    series.push({ label: title(curve), stroke: shade(curve), width: curve.way === "up" ? 1.6 : 3, dash: own.dash, spanGaps: true, show: !hiddenCurves.has(title(curve)), points: { show: markers(curve) }, value: (plot, value) => short(value) });
    columns.push(spread(curve.frequency, curve.values[quantity.name]));
  }
  for (const reference of references) {
    series.push({ label: reference.name, stroke: "#1d2733", width: 0, points: { show: true, size: 5 }, value: (plot, value) => short(value) });
    columns.push(spread(reference.frequency, reference.value.map((value) => value === null ? null : value * quantity.factor)));
  }
  const label = withUnit(quantity.label, quantity.unit);
  const read = { setCursor: [(plot) => say(plot, quantity)] };
  return chart(byId("response"), series, columns, [frequencyAxis(), axis(label)], { height: 380, hooks: read, words: `${label} against drive frequency` });
}

let lastRead = null;
function say(plot, quantity) {
  const at = plot.cursor.idx;
  if (at === null || at === undefined || at === lastRead) return;
  lastRead = at;
  const parts = data.curves.map((curve, number) => [curve, plot.data[number + 1][at]]).filter(([curve, value]) => value !== null && value !== undefined && !hiddenCurves.has(title(curve)));
  const failed = data.curves.flatMap((curve) => { const index = curve.frequency.indexOf(grid[at]); return index >= 0 && curve.ended[index] ? [`${title(curve)}: ${curve.ended[index]}`] : []; });
  byId("reading").textContent = `${short(grid[at] * FACTOR, 6)} ${data.frequency.unit}: ` + parts.map(([curve, value]) => `${title(curve)} ${short(value)} ${quantity.unit}`).concat(failed).join(", ");
}

function fillControls() {
  for (const each of data.quantities) byId("quantity").append(element("option", { value: each.name }, withUnit(each.label, each.unit)));
  byId("quantity").addEventListener("change", drawResponse);
  data.curves.forEach((curve) => {
    const label = element("label"), box = element("input", { type: "checkbox" });
    box.checked = true;
    box.addEventListener("change", () => {
      if (box.checked) hiddenCurves.delete(title(curve)); else hiddenCurves.add(title(curve));
      drawResponse(); drawMotion();
    });
    const mark = element("i");
    mark.style.borderColor = shade(curve);
    label.append(box, mark, title(curve));
    byId("shown").append(label);
  });
}
