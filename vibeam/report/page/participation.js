// View: share of each mode in the energy over frequency.
import { address, byId, colourOf, element, on } from "./state.js";
import { axis, chart, svgOf } from "./chart.js";
import { percent, short, withUnit } from "./numbers.js";
import { csv, offer } from "./saving.js";
import { FACTOR, data, title } from "./result.js";
import { beside, drawPieces, frequencyAxis } from "./response.js";
/** @import { Chart, Draw, PlotAxis, PlotScales, PlotSeries } from "./types.d.ts" */

const DECADES = 6;  // that are drawn, at most
const powers = Array.from({ length: DECADES + 1 }, (_, power) => -power);
/** @type {Chart[]} */
let shown = [];
const chosen = () => data.curves[+byId("modal").value];

function draw() {
  const curve = chosen(), order = [...curve.frequency.keys()].sort((a, b) => curve.frequency[a] - curve.frequency[b]);
  const positive = curve.shares.map((share) => share.map((value) => (value !== null && value > 10 ** -DECADES ? Math.log10(value) : null)));
  const label = withUnit("Frequency", data.frequency.unit);
  const columns = [curve.frequency.map((value) => value * FACTOR), ...positive].map((column) => order.map((index) => column[index]));
  /** @type {PlotSeries[]} */
  const series = [{ label, value: (_, value) => short(value, 6) }];
  positive.forEach((_, mode) => series.push({ label: `mode ${mode + 1}`, stroke: () => colourOf(data.palette[mode]), value: (_, value) => percent(value === null ? null : 10 ** value) }));
  /** @type {Draw} */
  const paint = (pen, at) => positive.forEach((share, mode) => drawPieces(pen, at, { ...curve, way: "up" }, "amplitude", share, { colour: colourOf(data.palette[mode]), dash: [] }, 0));
  /** @type {PlotScales} */
  const scales = { x: { time: false, range: beside }, y: { range: (_, low) => [Math.min(low - 0.1, -1), 0.1] } };
  /** @type {PlotAxis} */
  const up = { ...axis("Share of the energy"), size: 72, splits: (_, index, low) => powers.filter((each) => each >= low), values: (_, splits) => splits.map((each) => percent(10 ** each)) };
  shown = [chart(byId("shares"), { words: "Share of each mode in the energy against drive frequency", height: 280, series, columns, axes: [frequencyAxis(), up], scales, draw: paint })];
}

data.curves.forEach((curve, number) => byId("modal").append(element("option", { value: number }, title(curve))));
const most = data.curves.reduce((best, curve, at) => (curve.shares.length > data.curves[best].shares.length ? at : best), 0), [asked] = address.numbers("modal");
byId("modal").value = String(asked in data.curves ? asked : most);
byId("modal").addEventListener("change", () => { address.set("modal", byId("modal").value); draw(); });
on("theme", draw);
draw();
const rows = () => [[withUnit("frequency", data.frequency.unit), ...chosen().shares.map((_, mode) => `share of mode ${mode + 1}`)], ...chosen().frequency.map((value, at) => [value * FACTOR, ...chosen().shares.map((share) => share[at])])];
offer(byId("shares"), "participation", { csv: () => csv(rows()), svg: () => svgOf(shown, `${document.title}, ${title(chosen())}`) });
