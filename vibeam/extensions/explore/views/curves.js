// Curves over frequency at the sliders' place: closed-form orbits and flown points, by the worker, piece by piece.
import { on, tell } from "../../../report/page/state.js";
import { REST, complete, direction, flown, models, payload, place, sliderOf, valueAt } from "./place.js";

/** @import { Model, Orbit, Place, Schedule, State } from "../engine/types.d.ts" */
/** @import { Ask } from "./flying.js" */
/** @typedef {{frequency: number, amplitude: number, maximum: number, minimum: number, period: number,
 *   impactsPerPeriod: number, impactVelocity: number, ended: string}} Point */
/** ``points`` and ``states`` in the order swept; ``back``: points of the way down again, of a sweep up and down. */
/** @typedef {{points: Point[], back: Point[], states: State[], orbits: Orbit[][], fault: string, at: string,
 *   whole: boolean, swept: boolean}} Curve ``swept``: whole, and the way down again is there too */

const QUICK = { settle: 20, hold: 10 };  // drive periods while a slider moves
export const AFRESH = { settle: 60, hold: 10 };
export const EVEN = 61;  // frequencies in the place of a single one

/** Frequencies of the case's sweep; even ones over the slider where that is a single one. */
function frequencies() {
  const swept = [...payload.sweep.frequency].sort((a, b) => a - b), slider = sliderOf("frequency");
  if (swept.length > 1 || !slider) return swept;
  return Array.from({ length: EVEN }, (_, at) => slider.low + ((slider.high - slider.low) * at) / (EVEN - 1));
}
export const swept = frequencies();
const downwards = direction === "down";
const along = downwards ? [...swept].reverse() : swept;

/** Orbits as curves: broken where one is missing or no motion of the system. @type {(orbits: Orbit[]) => Orbit[][]} */
function branches(orbits) {
  const number = new Map(swept.map((each, at) => [each, at])), open = new Map();
  /** @type {Orbit[][]} */
  const found = [];
  for (const each of orbits.filter(({ admissible }) => admissible)) {
    const key = `${each.periods} ${each.branch} ${each.stable}`, at = number.get(each.frequency) ?? -1;
    const last = open.get(key), curve = last && at - last.at === 1 ? last.curve : [];
    if (!curve.length) found.push(curve);
    curve.push(each);
    open.set(key, { at, curve });
  }
  return found;
}

/** @type {(values: any, at: number) => Point} */
export const pointOf = (values, at) => ({
  frequency: values.frequency[at], amplitude: values.amplitude[at], maximum: values.maximum[at],
  minimum: values.minimum[at], period: values.period[at], impactsPerPeriod: values.impactsPerPeriod[at],
  impactVelocity: values.impactVelocity[at], ended: values.ended[at],
});

/**
 * Curves that follow the sliders: each fidelity has one question open while they move, the newest place follows its
 * answer; at rest all points are flown as the case's sweep flies them. ``told``: hears of every piece.
 * @param {Ask} ask
 * @param {() => void} told
 */
export function curves(ask, told) {
  /** @type {Map<string, Curve>} */
  const known = new Map();
  for (const { name } of models) {
    known.set(name, { points: [], back: [], states: [], orbits: [], fault: "", at: "", whole: false, swept: false });
  }
  /** @type {(model: Model) => Curve} */
  const curveOf = ({ name }) => /** @type {Curve} */ (known.get(name));
  /** @type {Set<string>} */
  const busy = new Set();
  let timer = 0, resting = true, now = "", gap = place().gap;

  /** Keys but the frequency, which the whole curve has. @type {() => Place} */
  const keys = () => ({ ...place(), frequency: undefined });

  /** @type {(model: Model, at: Place, schedule: Schedule, done: () => void, back?: boolean) => void} */
  function fly(model, at, schedule, done, back = false) {
    const curve = curveOf(model), asked = now;
    /** @type {Point[]} */
    const points = [];
    /** @type {State[]} */
    const states = [];
    const order = back ? [...along].reverse() : along;
    ask("response", [model.name, at, order, schedule], ({ values, fault, done: to, of }) => {
      if (fault) Object.assign(curve, { fault, points: [], back: [], states: [] });
      else {
        for (let k = 0; k < values.frequency.length; k += 1) points.push(pointOf(values, k));
        states.push(...values.states);
        if (back) curve.back = asked === now ? points : [];
        // Points of a place that the sliders have left stay until those of the new one replace them.
        else Object.assign(curve, { fault: "", states, points: [...points, ...curve.points.slice(points.length)] });
      }
      if (fault || to === of) done();
      told();
    });
  }

  /** @type {(model: Model, at: Place, done: () => void) => void} */
  function orbit(model, at, done) {
    const curve = curveOf(model), asked = now;
    if (model.engine !== "plain" || curve.at === asked) return done();
    ask("orbits", [model.name, at, swept], ({ values, fault }) => {
      Object.assign(curve, { at: asked, orbits: fault ? [] : branches(values), fault: fault ?? curve.fault });
      told();
      done();
    });
  }

  /** While a slider moves. @type {(model: Model) => void} */
  function follow(model) {
    const { name } = model, at = keys(), asked = now, { states, points } = curveOf(model);
    if (busy.has(name)) return;
    busy.add(name);
    // A state may lie beyond a stop that came nearer.
    const carried = at.gap === gap && points.length === states.length && points.every((each) => complete(each.ended));
    orbit(model, at, () => {
      if (resting) return;
      fly(model, at, carried ? { ...QUICK, states } : AFRESH, () => {
        if (resting) return;
        busy.delete(name);
        if (asked !== now) follow(model);
      });
    });
  }

  function rest() {
    const { settle, hold } = payload.sweep, at = keys(), asked = now;
    [resting, gap] = [true, at.gap];
    busy.clear();
    for (const model of flown()) {
      orbit(model, at, () => {});
      const curve = curveOf(model);
      if (curve.whole) continue;
      fly(model, at, { settle, hold, carried: true }, () => {
        const ended = () => !curve.fault && asked === now;  // the sliders may have moved on since
        [curve.whole, curve.swept] = [ended(), ended() && direction !== "both"];
        const turned = { settle, hold, carried: true, states: curve.states.slice(-1) };
        if (curve.whole && direction === "both") fly(model, at, turned, () => { curve.swept = ended(); }, true);
        if (flown().every((each) => curveOf(each).whole)) tell("swept");
      });
    }
  }

  function moved() {
    const key = JSON.stringify(keys());
    clearTimeout(timer);
    timer = setTimeout(rest, REST);
    if (key === now) return;
    [now, resting] = [key, false];
    for (const curve of known.values()) Object.assign(curve, { whole: false, swept: false, back: [] });
    flown().forEach(follow);
  }
  on("moved", moved);
  on("taken", rest);
  now = JSON.stringify(keys());
  rest();

  /** State of the sweep, on its way out, at the slider's frequency or last before it. */
  /** @type {(model: Model) => State | null} */
  function stateOf(model) {
    const { whole, points, states } = curveOf(model), frequency = valueAt("frequency"), near = 1 + Number.EPSILON;
    const place = along.findLastIndex((each) => (downwards ? each * near >= frequency : each <= frequency * near));
    return whole && place >= 0 && complete(points[place].ended) ? states[place] : null;
  }
  return { curveOf, stateOf };
}
