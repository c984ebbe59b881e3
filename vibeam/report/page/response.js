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
  for (const each of charts.splice(0)) if (each.host !== host && each.host.isConnected) charts.push(each); else each.plot.destroy();
  charts.push({ host, height, plot: made });
  return made;
}
window.addEventListener("resize", () => charts.forEach((each) => each.plot.setSize({ width: widthOf(each.host), height: each.height })));

const axis = (label) => ({ label, values: (plot, splits) => splits.map((value) => (value === null ? "" : short(value, 6))), stroke: "#1d2733", grid: { stroke: "#e3e8ee", width: 1 }, size: 66 });
const frequencyAxis = () => ({ ...axis(withUnit("Drive frequency", data.frequency.unit)), size: 44 });

// Upward axis from 0, or by the data where they all lie in its upper part: the rule of the figures.

const byData = (low, high) => low < 0 || (high - low > data.upward.slight * high && high - low < data.upward.top * high);
function upward(plot, low, high) {
  if (low === null || high === null) return [0, 1];
  const room = 0.08 * (high - (byData(low, high) ? low : 0)) || 0.1 * Math.abs(high) || 1;
  return [byData(low, high) ? low - room : 0, high + room];
}

// Room for marks at the ends.
const beside = (plot, low, high) => (grid.length === 1 ? [0.95 * grid[0] * FACTOR, 1.05 * grid[0] * FACTOR] : [low - 0.01 * (high - low), high + 0.01 * (high - low)]);

// Branches in the pieces in which figures draw them: no line over a jump, none between motions that do not repeat.

function drawMark(draw, marker, x, y, size) {
  draw.beginPath();
  if (marker === "_") { draw.moveTo(x - size, y); draw.lineTo(x + size, y); }
  else if (marker === "x") { draw.moveTo(x - size, y - size); draw.lineTo(x + size, y + size); draw.moveTo(x - size, y + size); draw.lineTo(x + size, y - size); }
  else if (marker === "D") { draw.moveTo(x, y - 1.4 * size); draw.lineTo(x + 1.4 * size, y); draw.lineTo(x, y + 1.4 * size); draw.lineTo(x - 1.4 * size, y); draw.closePath(); }
  else draw.arc(x, y, size, 0, 7);
  draw.stroke();
}

function drawPieces(plot, curve, quantity, values, look, failedRow) {
  const draw = plot.ctx, ratio = devicePixelRatio, down = curve.way === "down";
  draw.strokeStyle = draw.fillStyle = look.colour;
  for (const [number, begin, end] of curve.pieces[quantity] || curve.pieces.amplitude) {
    const kind = data.kinds[number], points = [];
    for (let at = begin; at < end; at += 1) {
      const x = plot.valToPos(curve.frequency[at] * FACTOR, "x", true);
      if (kind.name === "failed") points.push([x, plot.bbox.top + (6 + 8 * failedRow) * ratio]);
      else if (values[at] !== null) points.push([x, plot.valToPos(values[at], "y", true)]);
    }
    const alone = points.length === 1 && !kind.marker;
    draw.setLineDash([]);
    draw.lineWidth = 1.2 * ratio;
    if (alone || kind.marker) for (const [x, y] of points) drawMark(draw, alone ? kind.alone : kind.marker, x, y, kind.size * ratio);
    if (alone && kind.alone === "o") draw.fill();
    if (!kind.width || points.length < 2) continue;
    const plain = kind.name === data.kinds[0].name;
    draw.lineWidth = (plain ? (down ? 4 : 1.7) : 1.6 * kind.width) * ratio;
    draw.setLineDash((plain ? look.dash : kind.dash).map((each) => 1.5 * each * ratio));
    draw.beginPath();
    points.forEach(([x, y], at) => (at ? draw.lineTo(x, y) : draw.moveTo(x, y)));
    draw.stroke();
  }
}

function within(plot, drawAll) {
  const draw = plot.ctx, box = plot.bbox;
  draw.save();
  draw.beginPath();
  draw.rect(box.left, box.top, box.width, box.height);
  draw.clip();
  drawAll(draw);
  draw.restore();
}

// Mark of an axis that does not start at 0: two strokes across its lower end.
function drawCut(plot) {
  const draw = plot.ctx, ratio = devicePixelRatio, { left, top, height } = plot.bbox;
  draw.save();
  draw.strokeStyle = "#1d2733";
  draw.lineWidth = 1.2 * ratio;
  for (const up of [6, 10]) { draw.beginPath(); draw.moveTo(left - 5 * ratio, top + height - (up - 3) * ratio); draw.lineTo(left + 5 * ratio, top + height - (up + 3) * ratio); draw.stroke(); }
  draw.restore();
}

const hiddenCurves = new Set();

const unjoined = { paths: () => null, points: { show: false } };  // drawn by drawPieces

function drawResponse() {
  const quantity = data.quantities.find((each) => each.name === byId("quantity").value);
  const references = data.references.filter((each) => each.quantity === quantity.name);
  const series = [{ label: withUnit("Frequency", data.frequency.unit), value: (plot, value) => short(value, 6) }];
  const columns = [grid.map((value) => value * FACTOR)];
  for (const curve of data.curves) {
    series.push({ ...unjoined, label: title(curve), stroke: shade(curve), show: !hiddenCurves.has(title(curve)), value: (plot, value) => short(value) });
    columns.push(spread(curve.frequency, curve.values[quantity.name]));
  }
  for (const reference of references) {
    series.push({ label: reference.name, stroke: "#1d2733", width: 0, points: { show: true, size: 5 }, value: (plot, value) => short(value) });
    columns.push(spread(reference.frequency, reference.value.map((value) => value === null ? null : value * quantity.factor)));
  }
  const label = withUnit(quantity.label, quantity.unit);
  const hooks = { setCursor: [(plot) => say(plot, quantity)], draw: [(plot) => drawBranches(plot, quantity)] };
  lastRead = null;
  byId("reading").textContent = "";
  drawKinds(quantity.name);
  return chart(byId("response"), series, columns, [frequencyAxis(), axis(label)], { height: 380, hooks, scales: { x: { time: false, range: beside }, y: { range: upward } }, words: `${label} against drive frequency` });
}

function drawBranches(plot, quantity) {
  const shown = data.curves.filter((curve) => !hiddenCurves.has(title(curve)));
  within(plot, (draw) => {
    for (const way of ["down", "up"]) for (const curve of shown.filter((each) => each.way === way)) {
      const own = fidelity[curve.fidelity];
      drawPieces(plot, curve, quantity.name, curve.values[quantity.name], { colour: shade(curve), dash: own.dash }, data.curves.indexOf(curve));
    }
    if (quantity.name === "amplitude") drawGrazing(plot, draw, [...new Set(shown.map((curve) => fidelity[curve.fidelity]))], quantity.factor);
  });
  const cut = plot.scales.y.min > 0;
  if (cut) drawCut(plot);
  byId("cut").textContent = cut ? `${data.upward.note[0].toUpperCase()}${data.upward.note.slice(1)}.` : "";
}

function drawGrazing(plot, draw, fidelities, factor) {
  const ratio = devicePixelRatio;
  fidelities.forEach((own, index) => {
    if (!(own.grazing > 0)) return;
    const y = plot.valToPos(own.grazing * factor, "y", true);
    draw.strokeStyle = own.colour;
    draw.lineWidth = 1.2 * ratio;
    draw.setLineDash([1.5 * ratio, (4 * fidelities.length - 1.5) * ratio]);
    draw.lineDashOffset = -4 * index * ratio;
    draw.beginPath(); draw.moveTo(plot.bbox.left, y); draw.lineTo(plot.bbox.left + plot.bbox.width, y); draw.stroke();
  });
}

// What the lines and marks mean, of those that occur.

function drawKinds(quantity) {
  const shown = data.curves.flatMap((curve) => curve.pieces[quantity] || curve.pieces.amplitude), used = new Set(shown.map(([number]) => number));
  const entries = data.kinds.flatMap((kind, number) => {
    if (!used.has(number)) return [];
    const alone = shown.some(([own, begin, end]) => own === number && end - begin === 1);
    return [[kind.width ? kind : null, kind.marker, kind.name === "failed" ? "failed, along the upper edge" : kind.name], ...(number === 0 && alone ? [[null, "full", `${kind.name}, at one frequency alone`]] : [])];
  });
  if (quantity === "amplitude" && data.fidelities.some((each) => each.grazing > 0)) entries.push([{ width: 1.2, dash: [1.5, 2.5] }, "", "grazing: mode 1 reaches the stop"]);
  byId("kinds").replaceChildren();
  for (const [line, marker, words] of entries) {
    const svg = drawn("svg", { viewBox: "0 0 30 12", width: 30, height: 12, "aria-hidden": "true" }), keys = { fill: "none", stroke: "#1d2733" };
    if (line) svg.append(drawn("path", { ...keys, d: "M1 6H29", "stroke-width": 1.2 * line.width, "stroke-dasharray": line.dash.join(" ") }));
    if (marker === "x") svg.append(drawn("path", { ...keys, d: "M12 3L18 9M12 9L18 3" }));
    else if (marker === "D") svg.append(drawn("path", { ...keys, fill: "#fff", d: "M15 2L19 6L15 10L11 6Z" }));
    else if (marker) svg.append(drawn("circle", { ...keys, cx: 15, cy: 6, r: marker === "full" ? 2.2 : 3, fill: marker === "full" ? "#1d2733" : "#fff" }));
    const entry = element("span");
    entry.append(svg, ` ${words}`);
    byId("kinds").append(entry);
  }
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
