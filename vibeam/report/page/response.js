// View: curves over frequency, with what was measured; a click picks the frequency of the motion.
import { address, byId, drawn, element, hidden, ink, on, tickBox } from "./state.js";
import { axis, chart, drawMark, svgOf, upright } from "./chart.js";
import { short, withUnit } from "./numbers.js";
import { csv, offer } from "./saving.js";
import { FACTOR, MANY, colour, data, fidelity, inUnits, isShown, pickNear, picked, shade, title } from "./result.js";
/** @import { Chart, Curve, Draw, Fidelity, Frame, Look, Numbers, Pen, Plot, PlotAxis, PlotHooks, PlotRange, PlotSeries, Quantity, Reference } from "./types.d.ts" */

const all = [...new Set([...data.curves, ...data.references].flatMap((each) => each.frequency))].sort((a, b) => a - b);  // all curves on the union of their frequencies
const order = new Map(all.map((value, index) => [value, index]));
/** @type {(frequency: number[], values: Numbers) => Numbers} */
function spread(frequency, values) {
  const found = new Array(all.length).fill(null);
  frequency.forEach((each, index) => { found[order.get(each) ?? -1] = values[index]; });
  return found;
}
const chosen = () => data.quantities.find((each) => each.name === byId("quantity").value) ?? data.quantities[0];
/** @type {(quantity: Quantity) => Reference[]} */
const measured = (quantity) => data.references.filter((each) => each.quantity === quantity.name);
/** @type {(curve: Curve, quantity: string) => [number, number, number][]} */
const piecesOf = (curve, quantity) => curve.pieces[quantity] || curve.pieces.amplitude;

// Upward axis from 0, or by the data where they all lie in its upper part: the rule of the figures.
/** @type {(low: number, high: number) => boolean} */
const byData = (low, high) => low < 0 || (high - low > data.upward.slight * high && high - low < data.upward.top * high);
/** @type {PlotRange} */
function upward(_, low, high) {
  if (low === null || high === null) return [0, 1];
  const room = 0.08 * (high - (byData(low, high) ? low : 0)) || 0.1 * Math.abs(high) || 1;
  return [byData(low, high) ? low - room : 0, high + room];
}

// Room for marks at the ends of the whole range; a zoom is what was asked for.
const ends = [all[0], all[all.length - 1]].map((each) => each * FACTOR);
/** @type {PlotRange} */
export function beside(_, low, high) {
  if (all.length === 1) return [0.95 * ends[0], 1.05 * ends[0]];
  const room = low > ends[0] || high < ends[1] ? 0 : 0.01 * (ends[1] - ends[0]);
  return [low - room, high + room];
}
/** @type {() => PlotAxis} */
export const frequencyAxis = () => ({ ...axis(withUnit("Drive frequency", data.frequency.unit)), size: 44 });

// A branch in the pieces in which figures draw it: no line over a jump, none between motions that do not repeat.
/** @type {(pen: Pen, at: Frame, curve: Curve, quantity: string, values: Numbers, look: Look, failedRow: number) => void} */
export function drawPieces(pen, at, curve, quantity, values, look, failedRow) {
  pen.strokeStyle = pen.fillStyle = look.colour;
  for (const [number, begin, end] of piecesOf(curve, quantity)) {
    const kind = data.kinds[number];
    /** @type {[number, number][]} */
    const points = [];
    for (let index = begin; index < end; index += 1) {
      const x = at.x(curve.frequency[index] * FACTOR), value = values[index];
      if (kind.name === "failed") points.push([x, at.top + (6 + 8 * failedRow) * at.ratio]);
      else if (value !== null) points.push([x, at.y(value)]);
    }
    const alone = points.length === 1 && !kind.marker;
    pen.setLineDash([]);
    pen.lineWidth = 1.2 * at.ratio;
    if (alone || kind.marker) for (const [x, y] of points) drawMark(pen, alone ? kind.alone : kind.marker, x, y, kind.size * at.ratio);
    if (alone && kind.alone === "o") pen.fill();
    if (!kind.width || points.length < 2) continue;
    const plain = kind.name === data.kinds[0].name;
    pen.lineWidth = (plain ? (curve.way === "down" ? 4 : 1.7) * (look.width ?? 1) : 1.6 * kind.width) * at.ratio;
    pen.setLineDash((plain ? look.dash ?? [] : kind.dash).map((each) => 1.5 * each * at.ratio));
    pen.beginPath();
    points.forEach(([x, y], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    pen.stroke();
  }
}

/** @type {(curves: Curve[]) => boolean} */
const isCrowded = (curves) => new Set(curves.map((each) => each.fidelity)).size >= MANY;
let pointed = "";  // fidelity of the curve under the pointer
/** Of many curves the pointed one lies over the reference's, and this over the others. @type {(curve: Curve) => number} */
const front = (curve) => (curve.fidelity === pointed ? 2 : fidelity[curve.fidelity].reference ? 1 : 0);

/** @type {(pen: Pen, at: Frame, quantity: Quantity) => void} */
function drawAll(pen, at, quantity) {
  const shown = data.curves.filter(isShown).sort((a, b) => front(a) - front(b)), many = isCrowded(shown);
  for (const way of ["down", "up"]) for (const curve of shown.filter((each) => each.way === way)) {
    const { dash, wide } = fidelity[curve.fidelity], behind = many && !front(curve);
    drawPieces(pen, at, curve, quantity.name, curve.values[quantity.name], { colour: behind ? ink("steel") : shade(curve), dash, width: behind ? 0.7 : wide }, data.curves.indexOf(curve));
  }
  if (quantity.name === "amplitude") drawGrazing(pen, at, [...new Set(shown.map((curve) => fidelity[curve.fidelity]))], quantity.factor);
  for (const each of measured(quantity)) drawMeasured(pen, at, each, quantity.factor);
  const frequency = picked();
  if (frequency === undefined) return;
  upright(pen, at, frequency * FACTOR);
}

// Points over the curves, each with its bar, of a long curve every so many; single measured numbers as squares on end.
const MARKS = 60;
/** @type {Record<string, string>} */
const SHAPES = { x: "M12 3L18 9M12 9L18 3", D: "M15 2L19 6L15 10L11 6Z" };
/** @type {(pen: Pen, at: Frame, each: Reference, factor: number) => void} */
function drawMeasured(pen, at, each, factor) {
  pen.setLineDash([]);
  [pen.strokeStyle, pen.lineWidth] = [ink(), 1.2 * at.ratio];
  const every = Math.ceil(each.frequency.length / MARKS);
  each.frequency.forEach((frequency, index) => {
    const known = each.value[index];
    if (known === null || index % every) return;
    const x = at.x(frequency * FACTOR), value = known * factor, bar = (each.bar[index] || 0) * factor;
    pen.beginPath(); pen.moveTo(x, at.y(value - bar)); pen.lineTo(x, at.y(value + bar)); pen.stroke();
    drawMark(pen, each.single ? "D" : "o", x, at.y(value), 3 * at.ratio);
  });
}

/** @type {(pen: Pen, at: Frame, fidelities: Fidelity[], factor: number) => void} */
function drawGrazing(pen, at, fidelities, factor) {
  fidelities.forEach((own, index) => {
    if (own.grazing === null || !(own.grazing > 0)) return;
    const y = at.y(own.grazing * factor);
    pen.strokeStyle = colour({ fidelity: own.name });
    pen.lineWidth = 1.2 * at.ratio;
    pen.setLineDash([1.5 * at.ratio, (4 * fidelities.length - 1.5) * at.ratio]);
    pen.lineDashOffset = -4 * index * at.ratio;
    pen.beginPath(); pen.moveTo(at.left, y); pen.lineTo(at.left + at.width, y); pen.stroke();
  });
  pen.lineDashOffset = 0;
}

// Mark of an axis that does not start at 0: two strokes across its lower end.
/** @type {Draw} */
function drawCut(pen, at) {
  const { left, top, height, ratio, scales } = at, cut = scales.y.min > 0;
  byId("many").hidden = !isCrowded(data.curves.filter(isShown));
  byId("cut").textContent = cut ? `${data.upward.note[0].toUpperCase()}${data.upward.note.slice(1)}.` : "";
  if (!cut) return;
  [pen.strokeStyle, pen.lineWidth] = [ink(), 1.2 * ratio];
  pen.setLineDash([]);
  for (const up of [6, 10]) { pen.beginPath(); pen.moveTo(left - 5 * ratio, top + height - (up - 3) * ratio); pen.lineTo(left + 5 * ratio, top + height - (up + 3) * ratio); pen.stroke(); }
}

// What the lines and marks mean, of those that occur.
/** @typedef {[{width: number, dash: number[]} | null, string, string]} LegendEntry */
/** @type {(quantity: Quantity) => void} */
function listKinds(quantity) {
  const shown = data.curves.flatMap((curve) => piecesOf(curve, quantity.name)), used = new Set(shown.map(([number]) => number));
  /** @type {LegendEntry[]} */
  const entries = [];
  data.kinds.forEach((kind, number) => {
    if (!used.has(number)) return;
    const alone = shown.some(([own, begin, end]) => own === number && end - begin === 1);
    entries.push([kind.width ? kind : null, kind.marker, kind.name === "failed" ? "failed, along the upper edge" : kind.name]);
    if (number === 0 && alone) entries.push([null, "full", `${kind.name}, at one frequency alone`]);
  });
  if (quantity.name === "amplitude" && data.fidelities.some((each) => (each.grazing ?? 0) > 0)) entries.push([{ width: 1.2, dash: [1.5, 2.5] }, "", "grazing: mode 1 reaches the stop"]);
  for (const each of measured(quantity)) entries.push([null, each.single ? "D" : "o", `${each.name}, of ${fidelity[each.fidelity]?.label ?? each.fidelity}${!each.bar.some(Boolean) ? "" : each.single ? "; bar: its uncertainty" : "; bar: twice the standard uncertainty"}`]);
  byId("kinds").replaceChildren(...entries.map(([line, marker, words]) => {
    const svg = drawn("svg", { viewBox: "0 0 30 12", width: 30, height: 12, "aria-hidden": "true" });
    if (line) svg.append(drawn("path", { d: "M1 6H29", "stroke-width": 1.2 * line.width, "stroke-dasharray": line.dash.join(" ") }));
    const shape = SHAPES[marker];
    if (shape) svg.append(drawn("path", { d: shape }));
    else if (marker) svg.append(drawn("circle", { class: marker, cx: 15, cy: 6, r: marker === "full" ? 2.2 : 3 }));
    const entry = element("span");
    entry.append(svg, ` ${words}`);
    return entry;
  }));
}

// Values at a frequency in words.
/** @type {(frequency: number, quantity: Quantity) => string} */
function wordsAt(frequency, quantity) {
  const read = data.curves.filter(isShown).flatMap((curve) => {
    const index = curve.frequency.indexOf(frequency);
    if (index < 0) return [];
    const value = curve.values[quantity.name][index];
    return curve.ended[index] ? [`${title(curve)}: ${curve.ended[index]}`] : value === null ? [] : [`${title(curve)} ${short(value)} ${quantity.unit}`.trim()];
  });
  return `${inUnits(frequency)}: ${read.join(", ")}`;
}

/** @type {Chart | null} */
let shown = null;
/** @type {number | null} */
let last = null;
/** @type {(frequency: number) => void} */
const sayAt = (frequency) => { byId("reading").textContent = wordsAt(frequency, chosen()); };

function draw() {
  const quantity = chosen(), references = measured(quantity), [from, to] = address.numbers("x");
  /** @type {PlotSeries[]} */
  const series = [{ label: withUnit("Frequency", data.frequency.unit), value: (_, value) => short(value, 6) }];
  /** @type {Numbers[]} */
  const columns = [all.map((value) => value * FACTOR)];
  for (const curve of data.curves) {
    series.push({ label: title(curve), stroke: () => shade(curve), show: isShown(curve), value: (_, value) => short(value) });
    columns.push(spread(curve.frequency, curve.values[quantity.name]));
  }
  for (const each of references) {
    series.push({ label: each.name, stroke: () => ink(), value: (_, value) => short(value) });
    columns.push(spread(each.frequency, each.value.map((value) => (value === null ? null : value * quantity.factor))));
  }
  const label = withUnit(quantity.label, quantity.unit);
  /** @type {PlotHooks} */
  const hooks = {
    setCursor: [(plot) => { const at = plot.cursor.idx; if (at !== null && at !== undefined && at !== last) sayAt(all[last = at]); }],
    setSeries: [(plot, at) => { pointed = data.curves[Number(at) - 1]?.fidelity ?? ""; plot.redraw(false); }],
    setScale: [(plot, key) => { if (key === "x" && shown?.plot === plot) keepZoom(plot); }],
  };
  [shown, last, byId("reading").textContent] = [null, null, ""];
  listKinds(quantity);
  shown = chart(byId("response"), { words: `${label} against drive frequency`, height: 380, series, columns, axes: [frequencyAxis(), axis(label)], hooks, scales: { x: { time: false, range: beside }, y: { range: upward } }, draw: (pen, at) => drawAll(pen, at, quantity), mark: drawCut });
  if (to > from) shown.plot.setScale("x", { min: from, max: to });
  shown.plot.over.addEventListener("click", () => { if (last !== null) pickNear(all[last]); });
}

/** @type {(plot: Plot) => void} */
function keepZoom(plot) {
  const { min, max } = plot.scales.x, whole = min <= ends[0] && max >= ends[1];
  address.set("x", whole ? null : [min, max].map((each) => +each.toPrecision(6)).join(","));
}

const rows = () => {
  const names = data.quantities.map((each) => withUnit(each.label, each.unit));
  return [["fidelity", "sweep", withUnit("frequency", data.frequency.unit), ...names], ...data.curves.filter(isShown).flatMap((curve) => curve.frequency.map((value, at) => [fidelity[curve.fidelity].label, curve.way, value * FACTOR, ...data.quantities.map((each) => curve.values[each.name][at])]))];
};

for (const each of data.quantities) byId("quantity").append(element("option", { value: each.name }, withUnit(each.label, each.unit)));
if (data.quantities.some((each) => each.name === address.get("q"))) byId("quantity").value = address.get("q") ?? "";
byId("quantity").addEventListener("change", () => { address.set("q", byId("quantity").value); draw(); });
const marks = data.curves.map((curve, number) => {
  const mark = element("i");
  byId("shown").append(tickBox(isShown(curve), (ticked) => hidden.show(number, ticked), mark, title(curve)));
  return () => { mark.style.borderColor = shade(curve); };
});
const colourMarks = () => marks.forEach((each) => each());
colourMarks();
draw();
on("hidden", draw);
on("theme", () => { colourMarks(); draw(); });
on("picked", () => { shown?.plot.redraw(false); sayAt(picked() ?? NaN); });
offer(byId("response"), "frequency response", { csv: () => csv(rows()), svg: () => svgOf(shown ? [shown] : [], document.title) });
