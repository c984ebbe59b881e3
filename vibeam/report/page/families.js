// View: curves of all fidelities over one number, with their bands: impact velocities, spectra, what a factor does.
import { address, byId, element, on } from "./state.js";
import { axis, chart, lines, svgOf } from "./chart.js";
import { keptSpan, short } from "./numbers.js";
import { csv, offer } from "./saving.js";
import { data, isShown, lookOf } from "./record.js";
/** @import { Chart, Draw, Numbers, PlotAxis } from "./types.d.ts" */
/** @import { BandCurve, FamilyChart } from "./histories.d.ts" */

const DECADES = 8;  // that are drawn below the highest value

/** @type {(value: number | null, log: boolean) => number | null} */
const scaled = (value, log) => (!log || value === null ? value : value > 0 ? Math.log10(value) : null);
/** @type {(values: Numbers, log: boolean) => Numbers} */
const all = (values, log) => values.map((each) => scaled(each, log));
/** @type {(values: Numbers[], top: number) => number[]} */
const known = (values, top) => values.flat().filter((each) => each !== null && each >= top - DECADES).map(Number);

/** @type {(label: string, log: boolean, size: number) => PlotAxis} */
function scale(label, log, size) {
  if (!log) return { ...axis(label), size };
  /** @type {(plot: unknown, index: number, low: number, high: number) => number[]} */
  const splits = (_, index, low, high) => {
    const every = high - low < 1.5 ? [1, 2, 5] : [1], step = Math.max(1, Math.ceil((high - low) / 7)), found = [];
    for (let power = Math.floor(low); power <= high; power += 1) if (power % step === 0) found.push(...every.map((each) => power + Math.log10(each)));
    return found.filter((each) => each >= low && each <= high);
  };
  return { ...axis(label), size, splits, values: (_, splits) => splits.map((each) => short(10 ** each, 2)) };
}

// A curve of steps, each up to its x, as one of lines.
/** @type {(own: BandCurve) => BandCurve} */
function stepped(own) {
  /** @type {(values: Numbers) => Numbers} */
  const twice = (values) => values.flatMap((each) => [each, each]);
  return { ...own, x: [0, ...twice(own.x).slice(0, -1)], y: twice(own.y), low: twice(own.low), high: twice(own.high) };
}

/** @type {(own: FamilyChart, curves: BandCurve[]) => Draw} */
const painter = ({ logs }, curves) => (pen, at) => {
  for (const each of curves.map((own) => (own.steps ? stepped(own) : own))) {
    const { colour, dash } = lookOf(each.fidelity), xs = all(each.x, logs.x).map(Number), floor = at.scales.y.min;
    const lows = all(each.low, logs.y).map((low, index) => low ?? (each.low[index] === null ? null : floor)), highs = all(each.high, logs.y);
    const inner = xs.map((_, index) => index).filter((index) => lows[index] !== null && highs[index] !== null);
    pen.beginPath();
    inner.forEach((index, turn) => (turn ? pen.lineTo(at.x(xs[index]), at.y(Number(highs[index]))) : pen.moveTo(at.x(xs[index]), at.y(Number(highs[index])))));
    for (const index of inner.reverse()) pen.lineTo(at.x(xs[index]), at.y(Number(lows[index])));
    pen.closePath();
    pen.fillStyle = `${colour.trim()}33`;
    pen.fill();
    const ys = all(each.y, logs.y);
    lines(pen, at, xs, ys, { colour, dash });
    if (!each.marks) continue;
    pen.fillStyle = colour;
    ys.forEach((y, index) => { if (y !== null) { pen.beginPath(); pen.arc(at.x(xs[index]), at.y(y), 3 * at.ratio, 0, 7); pen.fill(); } });
  }
};

/** @type {(id: string, charts: FamilyChart[]) => void} */
function family(id, charts) {
  const host = byId(id), pick = element("select");
  let at = Math.max(0, charts.findIndex((each) => each.label === address.get(id)));
  /** @type {Chart | null} */
  let made = null;
  const shownOf = () => charts[at].curves.filter((each) => isShown(each.fidelity));
  function draw() {
    const own = charts[at], { logs } = own, curves = shownOf();
    const ups = curves.flatMap((each) => [all(each.y, logs.y), all(each.high, logs.y), ...(logs.y ? [] : [each.low])]);
    const top = logs.y ? Math.max(-300, ...ups.flat().map((each) => each ?? -Infinity)) : Infinity;
    const up = keptSpan(null, [known(ups, logs.y ? top : -Infinity)], 1), across = keptSpan(null, [known(curves.map((each) => all(each.x, logs.x)), -Infinity)], 1);
    const columns = curves.length ? uPlot.join(curves.map((each) => [all(each.x, logs.x), all(each.y, logs.y)])) : [[0, 1]];
    /** @type {(log: boolean) => (plot: unknown, value: number) => string} */
    const read = (log) => (_, value) => short(value === null || value === undefined ? null : log ? 10 ** value : value);
    byId(`${id}-note`).textContent = own.note;
    made = chart(host, {
      words: own.label, height: 320, columns, draw: painter(own, curves),
      series: [{ label: own.across, value: read(logs.x) }, ...curves.map((each) => ({ label: lookOf(each.fidelity).label, stroke: () => lookOf(each.fidelity).colour, value: read(logs.y) }))],
      axes: [scale(own.across, logs.x, 44), scale(own.up, logs.y, 72)],
      scales: { x: { time: false, range: (_, low, high) => (low === null || curves.every((each) => !each.x.length) ? across : [low, high]) }, y: { range: () => up } },
    });
  }
  if (charts.length > 1) {
    const label = element("label", {}, "Shown "), controls = element("div", { class: "controls" });
    charts.forEach((each, number) => pick.append(element("option", { value: number }, each.label)));
    pick.value = String(at);
    pick.addEventListener("change", () => { at = +pick.value; address.set(id, charts[at].label); draw(); });
    label.append(pick);
    controls.append(label);
    host.before(controls);
  }
  draw();
  on("hidden", draw);
  on("theme", draw);
  const rows = () => [["fidelity", charts[at].across, charts[at].up, "low", "high"], ...shownOf().flatMap((each) => each.x.map((x, index) => [lookOf(each.fidelity).label, x, each.y[index], each.low[index], each.high[index]]))];
  offer(host, id, { csv: () => csv(rows()), svg: () => svgOf(made ? [made] : [], `${document.title}, ${charts[at].label}`) });
}

for (const [id, charts] of Object.entries(data.families)) family(id, charts);
