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

// Motions at one frequency.

const kept = [...new Set(data.motions.map((each) => each.frequency))].sort((a, b) => a - b);
let frame = 0, playing = null, current = [];

function cached(motion) {
  if (!motion.x.map) {
    for (const name of ["time", "x", "v", "spectrum"]) motion[name] = unpacked(motion[name]);
    motion.section = motion.section.map(unpacked);
    motion.beam = motion.beam ? unpacked(motion.beam) : null;
  }
  return motion;
}

function drawMotion() {
  const frequency = kept[+byId("pick").value], way = byId("way").value;
  byId("picked").textContent = `${short(frequency * FACTOR, 6)} ${data.frequency.unit}`;
  const here = data.motions.filter((each) => each.frequency === frequency && each.way === way && !hiddenCurves.has(title(each)));
  byId("faults").replaceChildren(...here.filter((each) => each.fault).map((each) => element("p", { class: "note" }, `${title(each)}: ${each.fault}`)));
  current = here.filter((each) => !each.fault).map(cached);
  drawHistory(); drawSpectrum(); drawPortrait(); drawBeam(); listNumbers();
}

const own = (motion) => ({ label: fidelity[motion.fidelity].label, stroke: fidelity[motion.fidelity].colour, dash: fidelity[motion.fidelity].dash, width: 1.5, spanGaps: true, points: { show: false }, value: (plot, value) => short(value) });

function joined(motions, xs, ys) {
  return uPlot.join(motions.map((each, index) => [increasing(xs(each)), ys(each)]));
}
function increasing(values) {
  let last = -Infinity;
  return values.map((value) => (last = value > last ? value : last + 1e-9));
}

function drawHistory() {
  const host = byId("history");
  if (!current.length) return host.replaceChildren();
  const columns = joined(current, (each) => each.time, (each) => each.x.map((value) => value * data.output.factor));
  chart(host, [{ label: "Time in drive periods", value: (plot, value) => short(value) }, ...current.map(own)], columns, [{ ...axis("Time in drive periods"), size: 44 }, axis(withUnit(data.output.name, data.output.unit))], { height: 250, words: "Displacement of the output over time" });
}

function drawSpectrum() {
  const host = byId("spectrum");
  if (!current.length) return host.replaceChildren();
  const count = current[0].spectrum.length, floor = -6;
  const columns = [Array.from({ length: count }, (_, index) => (index * data.lines) / (count - 1))];
  const top = Math.max(...current.flatMap((each) => each.spectrum));
  current.forEach((each) => columns.push(each.spectrum.map((value) => Math.max(value, top + floor) + Math.log10(data.output.factor))));
  const powers = (plot, splits) => splits.map((value) => (Number.isInteger(value) ? `1e${value}` : ""));
  chart(host, [{ label: "Multiple of the drive frequency", value: (plot, value) => short(value) }, ...current.map((each) => ({ ...own(each), value: (plot, value) => short(value === null ? null : 10 ** value, 3) }))], columns, [{ ...axis("Multiple of the drive frequency"), size: 44 }, { ...axis(withUnit("Amplitude", data.output.unit)), values: powers }], { height: 250, words: "Spectrum of the output" });
}

function spanOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  const room = (high - low || Math.abs(high) || 1) * 0.06;
  return [low - room, high + room];
}

function drawPortrait() {
  const svg = byId("portrait"), [width, height, left, bottom] = [480, 300, 62, 40];
  svg.replaceChildren();
  if (!current.length) return;
  const [low, high] = spanOf(current.flatMap((each) => each.x)), [slow, fast] = spanOf(current.flatMap((each) => each.v));
  const x = (value) => left + ((value - low) / (high - low)) * (width - left - 10);
  const y = (value) => height - bottom - ((value - slow) / (fast - slow)) * (height - bottom - 10);
  svg.append(drawn("rect", { x: left, y: 10, width: width - left - 10, height: height - bottom - 10, fill: "none", stroke: "#9aa5b1" }));
  for (const share of [0.1, 0.5, 0.9]) {
    const a = low + share * (high - low), b = slow + share * (fast - slow);
    svg.append(drawn("text", { x: x(a), y: height - bottom + 15 }, short(a * data.output.factor, 3)));
    const mark = drawn("text", { x: left - 6, y: y(b) + 4 }, short(b * data.speed.factor, 3));
    mark.style.textAnchor = "end";
    svg.append(mark);
  }
  svg.append(drawn("text", { x: (left + width) / 2, y: height - 6 }, withUnit("displacement", data.output.unit) + " — velocity" + (data.speed.unit ? ` (${data.speed.unit})` : "") + " upward"));
  for (const each of current) {
    const colour = fidelity[each.fidelity].colour;
    svg.append(drawn("path", { d: each.x.map((value, at) => `${at ? "L" : "M"}${x(value).toFixed(1)} ${y(each.v[at]).toFixed(1)}`).join(""), fill: "none", stroke: colour, "stroke-width": 1.4, "stroke-dasharray": fidelity[each.fidelity].dash.join(" ") }));
    each.section[0].forEach((value, at) => svg.append(drawn("circle", { cx: x(value), cy: y(each.section[1][at]), r: 3, fill: colour })));
  }
}

function drawBeam() {
  const svg = byId("beam"), with_beam = current.filter((each) => each.beam);
  svg.replaceChildren();
  if (!with_beam.length) return svg.append(drawn("text", { x: 240, y: 130 }, "no places along a beam are known here"));
  const [low, high] = spanOf(with_beam.flatMap((each) => each.beam).concat(0));
  const y = (value) => 240 - ((value - low) / (high - low)) * 220;
  svg.append(drawn("path", { d: `M20 ${y(0)}H460`, stroke: "#9aa5b1", "stroke-dasharray": "4 3" }));
  for (const each of with_beam) {
    const places = fidelity[each.fidelity].places, count = places.length - 1, end = places[count];
    const shown = each.beam.slice(frame * count, (frame + 1) * count);
    const points = places.slice(1).map((place, at) => `${(20 + (440 * place) / end).toFixed(1)},${y(shown[at]).toFixed(1)}`);
    svg.append(drawn("polyline", { points: points.join(" "), fill: "none", stroke: fidelity[each.fidelity].colour, "stroke-width": 2.2, "stroke-dasharray": fidelity[each.fidelity].dash.join(" ") }));
  }
  svg.append(drawn("text", { x: 240, y: 16 }, `${frame + 1} of ${data.frames}, deflections ${short(low * 1e3, 2)} … ${short(high * 1e3, 2)} mm, beam not to this scale`));
}

function listNumbers() {
  const table = byId("numbers");
  table.replaceChildren(element("caption", {}, "Numbers of these motions"));
  const head = element("tr");
  for (const name of ["fidelity", "repeats after (drive periods)", "impacts shown", "velocities before impact (mm/s)", "modes from 2 on, share of energy"]) head.append(element("th", { scope: "col" }, name));
  const body = element("tbody");
  for (const each of current) {
    const row = element("tr"), curve = data.curves.find((one) => one.fidelity === each.fidelity && one.way === each.way);
    const period = curve.values.period[curve.frequency.indexOf(each.frequency)];
    const cells = [period === 0 ? "does not" : period === -1 ? "1, no contact" : short(period), String(each.impacts.length), each.impacts.slice(0, 6).map((hit) => short(hit[1] * 1e3, 3)).join(", ") || "–", each.shares.length > 1 ? `${short(100 * each.shares.slice(1).reduce((a, b) => a + b, 0), 3)} %` : "–"];
    row.append(element("th", { scope: "row" }, fidelity[each.fidelity].label), ...cells.map((text) => element("td", {}, text)));
    body.append(row);
  }
  const top = element("thead");
  top.append(head);
  table.append(top, body);
}

function play() {
  const button = byId("play");
  if (playing) { clearInterval(playing); playing = null; } else playing = setInterval(() => { frame = (frame + 1) % data.frames; drawBeam(); }, 90);
  button.setAttribute("aria-pressed", String(Boolean(playing)));
  button.textContent = playing ? "Pause" : "Play";
}

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
