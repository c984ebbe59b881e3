// Response curves at the sliders' place: flown points over closed-form orbits, with the stored curves behind in grey.
import { byId, colourOf, ink, on } from "../../page/state.js";
import { axis, chart, framed, lines, svgOf } from "../../page/chart.js";
import { withUnit } from "../../page/numbers.js";
import { csv, offer } from "../../page/saving.js";
import { data } from "../../page/result.js";
import { asCase, complete, flown, models, move, payload, place, sliderOf, units, valueAt, valueOf } from "./place.js";

/** @import { Draw, Frame, Pen } from "../../page/types.d.ts" */
/** @import { Model, Orbit, Place } from "../engine/types.d.ts" */
/** @import { Ask } from "./flying.js" */
/** @typedef {{frequency: number, amplitude: number, maximum: number, minimum: number, period: number,
 *   impactsPerPeriod: number, impactVelocity: number, ended: string}} Point */
/** @typedef {{points: Point[], of: number, orbits: Orbit[][], fault: string}} Curve */
/** @typedef {{frequency: number, amplitude: number}} Peak */

const REST = 350;  // ms without a change before the curves are flown as the case's
const QUICK = { settle: 60, hold: 10 };  // drive periods of a point while a slider moves
const FEWEST = 2, EVEN = 61;  // frequencies of a sweep that is drawn; of one in the place of a single frequency
const ROOM = 1.06;

const factor = units.frequency.factor;

/** @type {() => number[]} */
function frequencies() {
  const swept = payload.sweep.frequency, slider = sliderOf("frequency");
  if (swept.length >= FEWEST || !slider) return swept;
  return Array.from({ length: EVEN }, (_, at) => slider.low + ((slider.high - slider.low) * at) / (EVEN - 1));
}

/** Orbits as curves: broken where one is missing or no motion of the system. */
/** @type {(orbits: Orbit[], swept: number[]) => Orbit[][]} */
function branches(orbits, swept) {
  const place = new Map(swept.map((each, at) => [each, at])), open = new Map();
  /** @type {Orbit[][]} */
  const found = [];
  for (const each of orbits.filter(({ admissible, amplitude }) => admissible && isFinite(amplitude))) {
    const key = `${each.periods} ${each.branch} ${each.stable}`, last = open.get(key);
    const at = place.get(each.frequency) ?? -1;
    const curve = last && at - last.at === 1 ? last.curve : [];
    if (!curve.length) found.push(curve);
    curve.push(each);
    open.set(key, { at, curve });
  }
  return found;
}

/**
 * The chart. ``told``: hears of new points.
 * @param {Ask} ask
 * @param {() => void} told
 */
export function sweeps(ask, told) {
  const swept = frequencies(), ends = [swept[0] * factor, swept[swept.length - 1] * factor];
  const { output } = units, top = { known: 0 };
  /** @type {Map<string, Curve>} */
  const curves = new Map(models.map((each) => [each.name, { points: [], of: 0, orbits: [], fault: "" }]));
  const curveOf = (/** @type {Model} */ each) => /** @type {Curve} */ (curves.get(each.name));
  /** @type {Set<string>} */
  const busy = new Set();
  let timer = 0, frame = 0, number = 0, before = "";

  const stored = () => data.curves.filter((each) => flown().some(({ name }) => name === each.fidelity));

  function highest() {
    const own = flown().flatMap((each) => [...curveOf(each).points, ...curveOf(each).orbits.flat()]);
    const known = own.map(({ amplitude }) => amplitude * output.factor).filter(isFinite);
    const old = stored().flatMap((each) => each.values.amplitude.map((value) => value ?? 0));
    return Math.max(...known, ...old, 0) || 1;
  }
  // The axis holds still while points fill in.
  /** @type {() => [number, number]} */
  const upward = () => {
    const need = highest();
    if (need > top.known || need < 0.5 * top.known) top.known = ROOM * need;
    return [0, top.known];
  };

  /** @type {Draw} */
  function paintStored(pen, at) {
    const frame = framed(at, factor, 1);
    for (const each of stored()) {
      lines(pen, frame, each.frequency, each.values.amplitude, { colour: ink("steel"), width: 3 });
    }
  }

  /** @type {(pen: Pen, at: Frame, model: Model, row: number) => void} */
  function paintOne(pen, at, model, row) {
    const frame = framed(at, factor, output.factor), colour = colourOf(model.look);
    const { points, orbits } = curveOf(model);
    for (const each of orbits) {
      const look = { colour, width: each[0].stable ? 1.4 : 1, dash: each[0].stable ? [] : [4, 4] };
      lines(pen, frame, each.map((one) => one.frequency), each.map((one) => one.amplitude), look);
    }
    [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [colour, colour, 1.2 * at.ratio];
    pen.setLineDash([]);
    for (const each of points) {
      const sound = complete(each.ended), x = frame.x(each.frequency), r = 2.2 * at.ratio;
      const y = sound ? frame.y(each.amplitude) : at.top + (6 + 8 * row) * at.ratio;
      pen.beginPath();
      if (sound) pen.arc(x, y, r, 0, 7);
      else { pen.moveTo(x - r, y - r); pen.lineTo(x + r, y + r); pen.moveTo(x - r, y + r); pen.lineTo(x + r, y - r); }
      if (sound && each.period !== 0) pen.fill(); else pen.stroke();
    }
  }

  /** @type {Draw} */
  function paint(pen, at) {
    paintStored(pen, at);
    flown().forEach((each, row) => paintOne(pen, at, each, row));
    const x = at.x(valueAt("frequency") * factor);
    [pen.strokeStyle, pen.lineWidth] = [ink("pale"), at.ratio];
    pen.setLineDash([3 * at.ratio, 3 * at.ratio]);
    pen.beginPath(); pen.moveTo(x, at.top); pen.lineTo(x, at.top + at.height); pen.stroke();
  }

  const label = withUnit("Amplitude ½(max − min)", output.unit);
  const room = 0.01 * (ends[1] - ends[0]);
  const made = chart(byId("live-response"), {
    words: `${label} against drive frequency, flown at the sliders' place`, height: 300, legend: false, draw: paint,
    series: [{}, { stroke: () => ink() }], columns: [ends, [0, 1]],
    axes: [{ ...axis(withUnit("Drive frequency", units.frequency.unit)), size: 44 }, axis(label)],
    scales: { x: { time: false, range: () => [ends[0] - room, ends[1] + room] }, y: { range: upward } },
    cursor: { drag: { x: false, y: false }, points: { show: false } },
  });
  made.plot.over.addEventListener("click", (/** @type {MouseEvent} */ event) => {
    const slider = sliderOf("frequency"), box = made.plot.over.getBoundingClientRect();
    if (!slider) return;
    const value = valueOf(slider, +made.plot.posToVal(event.clientX - box.left, "x").toPrecision(5));
    if (isFinite(value)) move("frequency", value);
  });

  const redraw = () => {
    frame ||= requestAnimationFrame(() => { frame = 0; made.plot.setData([ends, [0, top.known]]); });
  };

  /** Keys but the frequency, which the whole curve has. @type {(at: Place) => Place} */
  const keys = ({ frequency, ...others }) => others;

  /** @type {(model: Model, at: Place, settings: {settle: number, hold: number}, done?: () => void) => void} */
  function fly(model, at, settings, done = () => {}) {
    const own = number, curve = curveOf(model);
    /** @type {Point[]} */
    const points = [];
    busy.add(model.name);
    ask("response", [model.name, at, swept, settings], ({ values, fault, from, done: to, of }) => {
      if (fault) [curve.fault, curve.points] = [fault, []];
      else {
        for (let k = 0; k < values.frequency.length; k += 1) points.push(pointOf(values, k));
        // Points of a place that the sliders have left stay until those of the new one replace them.
        curve.points = [...points, ...curve.points.slice(points.length)];
        [curve.fault, curve.of] = ["", of];
      }
      redraw();
      if (!fault && to < of) return;
      busy.delete(model.name);
      if (own === number) done();
      told();
    });
  }

  /** @type {(model: Model, at: Place) => void} */
  function orbit(model, at) {
    ask("orbits", [model.name, at, swept], ({ values, fault }) => {
      curveOf(model).orbits = fault ? [] : branches(values, swept);
      redraw();
    });
  }

  function rest() {
    const { settle, hold } = payload.sweep, at = keys(place());
    for (const each of flown()) fly(each, at, { settle, hold });
  }

  function moved() {
    redraw();
    const at = keys(place()), now = JSON.stringify(at);
    if (now === before) return;
    before = now;
    number += 1;
    for (const each of flown()) {
      orbit(each, at);
      if (!busy.has(each.name)) fly(each, at, QUICK);
    }
    clearTimeout(timer);
    timer = setTimeout(rest, REST);
  }
  function taken() {
    before = "";
    moved();
  }

  const rows = () => {
    const heads = ["amplitude", "maximum", "minimum"].map((name) => withUnit(name, output.unit));
    const speed = withUnit("velocity before impact", units.contact_speed.unit);
    const first = ["fidelity", withUnit("frequency", units.frequency.unit), ...heads];
    const all = flown().flatMap((each) => curveOf(each).points.map((point) => ({ label: each.label, ...point })));
    return [[...first, "impacts per period", speed, "period", "ended"], ...all.map((point) => [
      point.label, point.frequency * factor, point.amplitude * output.factor, point.maximum * output.factor,
      point.minimum * output.factor, point.impactsPerPeriod, point.impactVelocity * units.contact_speed.factor,
      point.period, complete(point.ended) ? "" : point.ended,
    ])];
  };
  offer(byId("live-response"), "response at the sliders' place", {
    csv: () => csv(rows()),
    svg: () => svgOf([made], document.title + (asCase() ? "" : ", at other keys than the case's")),
  });
  on("moved", moved);
  on("taken", taken);
  on("theme", redraw);
  moved();

  return {
    /** The highest flown point of a fidelity. @type {(name: string) => Peak | null} */
    peak(name) {
      const curve = curves.get(name), points = (curve?.points ?? []).filter((each) => complete(each.ended));
      if (!curve || !points.length || busy.has(name)) return null;
      return points.reduce((best, each) => (each.amplitude > best.amplitude ? each : best));
    },
    redraw,
  };
}

/** @type {(values: any, at: number) => Point} */
const pointOf = (values, at) => ({
  frequency: values.frequency[at], amplitude: values.amplitude[at], maximum: values.maximum[at],
  minimum: values.minimum[at], period: values.period[at], impactsPerPeriod: values.impactsPerPeriod[at],
  impactVelocity: values.impactVelocity[at], ended: values.ended[at],
});
