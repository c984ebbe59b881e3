// View: histories over time, rows above one another with one window: input, outputs, impacts, contact force.
import { address, byId, element, ink, on, tickBox } from "./state.js";
import { axis, chart, lines, svgOf } from "./chart.js";
import { keptSpan, short, withUnit } from "./numbers.js";
import { csv, offer } from "./saving.js";
import { binsOf, envelope, hits, reachOf } from "./envelope.js";
import { data, historyOf, impactsOf, lookOf, shown } from "./record.js";
import { hearKeys, hearTouch, inWords, look, seen } from "./zoom.js";
/** @import { Cell, Chart, Draw, Plot } from "./types.d.ts" */
/** @import { Signal } from "./histories.d.ts" */

const IMPACTS = { name: "impacts", label: "velocity before impact", order: 0, ...data.contact_speed };
const ROWS = [...data.signals.filter((each) => each.order >= 0), IMPACTS, ...data.signals.filter((each) => each.order < 0)];
const SMALL = 120, HIGH = 180, STRIP = 84, DOTS = 120;  // px of a row, of an output's, of the whole; impacts that get a dot
const USUAL = ROWS.filter((each) => each.order <= 0).map((each) => each.name);
const asked = address.get("rows")?.split(",").filter((name) => ROWS.some((each) => each.name === name));
const chosen = new Set(asked?.length ? asked : USUAL);

/** Names of those of whom a signal has histories. @type {(signal: Signal) => string[]} */
const ownersOf = (signal) => (historyOf(signal.name, "", data.span) ? [""] : shown().map((each) => each.name));
/** @type {(owner: string) => {colour: string, wide: number}} */
const shadeOf = (owner) => (owner ? lookOf(owner) : { colour: ink(), wide: 1 });

/** @type {(signal: Signal, span: [number, number]) => number[][]} */
function extentOf(signal, span) {
  if (signal === IMPACTS) return [[0, ...shown().map(({ name }) => hardest(hits(impactsOf(name), span, 1)[1]))]];
  return ownersOf(signal).map((owner) => {
    const history = historyOf(signal.name, owner, span);
    return history ? reachOf(history, span) : [];
  });
}
/** @type {(speeds: number[]) => number} */
const hardest = (speeds) => speeds.reduce((a, b) => Math.max(a, b), 0);

/** @type {(signal: Signal, span: () => [number, number]) => Draw} */
const painter = (signal, span) => (pen, at) => {
  const scaled = { ...at, y: (/** @type {number} */ value) => at.y(value * signal.factor) };
  if (signal.name === IMPACTS.name) return shown().forEach(({ name }) => paintImpacts(pen, scaled, name, span()));
  for (const owner of ownersOf(signal)) {
    const history = historyOf(signal.name, owner, span());
    if (history) envelope(pen, scaled, history, span(), shadeOf(owner));
  }
};

/** @type {(pen: import("./types.d.ts").Pen, at: import("./types.d.ts").Frame, name: string, span: [number, number]) => void} */
function paintImpacts(pen, at, name, span) {
  const [times, speeds] = hits(impactsOf(name), span, at.width / at.ratio), { colour, wide } = lookOf(name);
  lines(pen, at, times.flatMap((time) => [time, time, time]), speeds.flatMap((speed) => [0, speed, null]), { colour, width: 1.2 * wide });
  if (times.length > DOTS) return;
  pen.fillStyle = colour;
  times.forEach((time, index) => { pen.beginPath(); pen.arc(at.x(time), at.y(speeds[index]), 2.5 * wide * at.ratio, 0, 7); pen.fill(); });
}

/** @type {[number, number][]} */
let heights = [];
/** @type {Chart[]} */
let made = [];
/** @type {Chart | null} */
let strip = null;

/** @type {(signal: Signal, row: number, last: boolean) => Chart} */
function rowOf(signal, row, last) {
  const host = element("div", { class: "chart" }), output = signal.name !== "input" && signal !== IMPACTS;
  byId("timeline").append(host);
  heights[row] = keptSpan(null, extentOf(signal, seen()), signal.factor);
  const down = { ...axis(last ? "Time (s)" : null), size: last ? 44 : 4, ...(last ? {} : { values: () => [] }) };
  const own = chart(host, {
    words: `${signal.label} over time`, height: (output ? HIGH : SMALL) + (last ? 36 : 0), legend: false,
    columns: [[...seen()], [null, null]], series: [{}, { label: signal.label }], axes: [down, { ...axis(null), size: 58 }],
    scales: { x: { time: false, range: () => seen() }, y: { range: () => heights[row] } }, draw: painter(signal, seen), mark: named(signal),
    cursor: { drag: { x: true, y: false, setScale: false }, sync: { key: "time" }, points: { show: false } },
    hooks: { setSelect: [chose], setCursor: [pointed] },
  });
  own.plot.over.addEventListener("dblclick", () => look(...data.span));
  hearTouch(own.plot.over);
  return own;
}

/** Name and unit above the row. @type {(signal: Signal) => Draw} */
const named = (signal) => (pen, at) => {
  pen.save();
  [pen.fillStyle, pen.textAlign, pen.font] = [ink(), "left", `600 ${12 * at.ratio}px system-ui, sans-serif`];
  pen.fillText(withUnit(signal.label, signal.unit), at.left, at.top - 4 * at.ratio);
  pen.restore();
};

/** A part that was dragged over becomes the window. @type {(plot: Plot) => void} */
function chose(plot) {
  const { left, width } = plot.select;
  if (width < 3) return;
  const begin = plot.posToVal(left, "x"), end = plot.posToVal(left + width, "x");
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  look(begin, end);
}

/** @type {(plot: Plot) => void} */
function pointed(plot) {
  const { left } = plot.cursor;
  if (left === undefined || left < 0) return;
  const time = plot.posToVal(left, "x");
  const read = ROWS.filter((each) => chosen.has(each.name) && each !== IMPACTS).map((signal) => {
    const said = ownersOf(signal).map((owner) => `${lookOf(owner).label} ${valueAt(signal, owner, time)}`.trim());
    return `${signal.label} ${said.join(", ")} ${signal.unit}`.trim();
  });
  byId("reading").textContent = `${short(time, 7)} s: ${read.join("; ")}`;
}

/** Value of a bin, or the two that it lies between. @type {(signal: Signal, owner: string, time: number) => string} */
function valueAt(signal, owner, time) {
  const history = historyOf(signal.name, owner, seen());
  const at = history ? Math.floor((time - history.begin) / history.width) : -1;
  if (!history || !(at in history.least)) return "–";
  const [low, high] = [history.least[at], history.greatest[at]].map((each) => short(each * signal.factor));
  return low === high ? low : `${low} … ${high}`;
}

// The whole record in a strip, the window in it: a drag or a tap there moves it.
function makeStrip() {
  const signal = data.signals.find((each) => each.name !== "input") ?? data.signals[0];
  const all = () => data.span, height = keptSpan(null, extentOf(signal, data.span), signal.factor);
  strip = chart(byId("strip"), {
    words: `${signal.label} over the whole record`, height: STRIP, legend: false, columns: [[...data.span], [null, null]],
    series: [{}, { label: signal.label }], axes: [{ ...axis(null), size: 30 }, { ...axis(null), size: 58, values: () => [] }],
    scales: { x: { time: false, range: all }, y: { range: () => height } },
    cursor: { drag: { x: true, y: false, setScale: false }, points: { show: false } }, hooks: { setSelect: [chose] },
    draw: (pen, at) => {
      painter(signal, all)(pen, at);
      const [begin, end] = seen();
      pen.fillStyle = `${ink("link").trim()}33`;
      pen.beginPath(); pen.rect(at.x(begin), at.top, Math.max(at.x(end) - at.x(begin), 2 * at.ratio), at.height); pen.fill();
    },
  });
  const { plot } = strip;
  plot.over.addEventListener("click", (event) => {
    const middle = plot.posToVal(event.offsetX, "x"), half = (seen()[1] - seen()[0]) / 2;
    look(middle - half, middle + half);
  });
}

function build() {
  byId("timeline").replaceChildren();
  heights = [];
  const rows = ROWS.filter((each) => chosen.has(each.name));
  made = rows.map((signal, row) => rowOf(signal, row, row === rows.length - 1));
  makeStrip();
  tellWindow();
}

function move() {
  const rows = ROWS.filter((each) => chosen.has(each.name)), [min, max] = seen();
  made.forEach(({ plot }, row) => {
    heights[row] = keptSpan(heights[row], extentOf(rows[row], seen()), rows[row].factor);
    plot.setData([[min, max], [null, null]]);
  });
  strip?.plot.redraw(false);
  tellWindow();
}

/** Least and greatest of the first output and the impacts in the window, of each fidelity. */
function tellWindow() {
  const signal = data.signals.find((each) => each.name !== "input"), span = seen();
  const said = shown().map(({ name, label }) => {
    const history = signal && historyOf(signal.name, name, span), ends = history ? reachOf(history, span) : [];
    const [times, speeds] = hits(impactsOf(name), span, Infinity);
    const met = times.length ? `${times.length} impacts, hardest ${short(hardest(speeds) * IMPACTS.factor)} ${IMPACTS.unit}` : "no impact";
    const { met: all, time } = impactsOf(name), cut = (all ?? 0) > time.length ? ` (of the ${time.length} hardest of ${all}, which the page holds)` : "";
    return `${label}: ${signal?.label ?? ""} ${ends.map((each) => short(each * (signal?.factor ?? 1))).join(" … ")} ${signal?.unit ?? ""}, ${met}${cut}`;
  });
  byId("in-window").textContent = `${inWords()}. ${said.join("; ")}.`;
}

const historyRows = () => {
  /** @type {Cell[][]} */
  const rows = [["signal", "fidelity", "from (s)", "to (s)", "least", "greatest", "unit"]];
  for (const signal of ROWS.filter((each) => chosen.has(each.name) && each !== IMPACTS)) {
    for (const owner of ownersOf(signal)) {
      const history = historyOf(signal.name, owner, seen()), [from, to] = history ? binsOf(history, seen()) : [0, 0];
      for (let at = from; history && at < to; at += 1) {
        const begin = history.begin + at * history.width, { factor } = signal;
        rows.push([signal.label, lookOf(owner).label, begin, begin + history.width, history.least[at] * factor, history.greatest[at] * factor, signal.unit]);
      }
    }
  }
  return rows;
};
const impactRows = () => [["fidelity", "time (s)", withUnit("velocity before", IMPACTS.unit)], ...shown().flatMap(({ name, label }) => {
  const [times, speeds] = hits(impactsOf(name), seen(), Infinity);
  return times.map((time, at) => [label, time, speeds[at] * IMPACTS.factor]);
})];

for (const each of ROWS) {
  byId("rows").append(tickBox(chosen.has(each.name), (ticked) => {
    if (ticked) chosen.add(each.name); else chosen.delete(each.name);
    address.set("rows", [...chosen].join(","));
    build();
  }, each.label));
}
hearKeys(byId("timeline"));
on("histories", build);
on("window", move);
on("hidden", () => { if (strip) build(); });
on("theme", () => { if (strip) build(); });
offer(byId("timeline"), "histories", { csv: () => csv(historyRows()), svg: () => svgOf(made, `${document.title}, ${inWords()}`) });
offer(byId("in-window"), "impacts in the window", { csv: () => csv(impactRows()) });
