// Motions at the sliders' place: on from the last state while these move, settled as the case does at rest.
import { colourOf, on } from "../../../report/page/state.js";
import { HARMONICS } from "../../../report/page/spectrum.js";
import { REST, complete, flown, models, numbers, payload, place, startsFrom } from "./place.js";

/** @import { DrawnMotion } from "../../../report/page/types.d.ts" */
/** @import { Engine } from "../engine/engine.js" */
/** @import { Model, Motion, Place, State, Steady } from "../engine/types.d.ts" */

const SETTLED = 20, SHOWN = 4, RECORD = 16;  // drive periods settled and shown while moving; flown at rest
const BUDGET = 9;  // ms of a frame that flights may take
const POINTS = 480, FRAMES = 32, FEW = 8, SAMPLES = 8 * HARMONICS;  // of a window, and a drive period
const FLOOR = 1e-6;  // of the largest line: what is below is left out

const rows = new Map(models.map((each) => [each.name, each.stations && numbers(each.stations.rows)]));

/** Even times. @type {(count: number, end: number) => Float64Array} */
const even = (count, end) => Float64Array.from({ length: count }, (_, at) => (at * end) / count);

/** log10 of the amplitudes of lines up to 16 times the drive frequency, of even samples. */
/** @type {(values: Float64Array, lines: number) => number[]} */
function lines(values, count) {
  const n = values.length, cosine = Float64Array.from({ length: n }, (_, at) => Math.cos((2 * Math.PI * at) / n));
  const quarter = n / 4, found = new Array(count + 1).fill(0);
  for (let line = 1; line <= count; line += 1) {
    let real = 0, imaginary = 0;
    for (let at = 0, turned = 0; at < n; at += 1, turned = (turned + line) % n) {
      real += values[at] * cosine[turned];
      imaginary += values[at] * cosine[(turned + quarter) % n];
    }
    found[line] = (2 / n) * Math.hypot(real, imaginary);
  }
  const floor = Math.max(FLOOR * Math.max(...found), 1e-300);
  return found.map((value) => Math.log10(Math.max(value, floor)));
}

/** Deflections, frame by frame, at a fidelity's places; none where these are not known. */
/** @type {(model: Model, modes: Float64Array) => Float64Array} */
function deflections({ name, modes: n }, modes) {
  const own = rows.get(name) ?? [];
  const frames = modes.length / n, count = own.length / n, made = new Float64Array(frames * count);
  for (let frame = 0; frame < frames; frame += 1) {
    for (let at = 0; at < count; at += 1) {
      let sum = 0;
      for (let mode = 0; mode < n; mode += 1) sum += modes[frame * n + mode] * own[at * n + mode];
      made[frame * count + at] = sum;
    }
  }
  return made;
}

/**
 * A motion of ``periods`` drive periods as it is drawn, its first ``window`` of them.
 * @type {(engine: Engine, model: Model, at: Place, motion: Motion, periods: number, window: number) => DrawnMotion}
 */
function drawnOf(engine, model, at, motion, periods, window) {
  const { turn } = motion, end = window * turn * (1 + 1e-12), settings = engine.settings(model.name, at);
  const times = motion.times(Math.round((POINTS * periods) / window) + 1).filter((time) => time <= end);
  const { x, v } = motion.at(times), section = motion.at(even(periods, periods * turn));
  const places = model.stations ? model.stations.places : [], frames = periods < RECORD ? FEW : FRAMES;
  /** @type {number[]} */
  let spectrum;
  return {
    label: model.label, dash: model.look.dash, colour: () => colourOf(model.look), window, x, v,
    time: times.map((time) => time / turn), section: [Array.from(section.x), Array.from(section.v)],
    impacts: motion.impacts.filter(([time]) => time <= end).map(([time]) => time / turn),
    get spectrum() {
      return (spectrum ||= lines(motion.at(even(SAMPLES * periods, periods * turn)).x, HARMONICS * periods));
    },
    beam: deflections(model, motion.at(even(frames * window, window * turn)).modes),
    places, held: Boolean(model.stations?.held), base: model.base === null ? null : model.base * settings.amplitude,
    stops: model.stops.map(([x, height, side, slope]) => [x, height + slope * (settings.gap - model.gap), side]),
  };
}

/** Drive periods drawn of a motion of that period. @type {(period: number) => number} */
const windowOf = (period) => (period === -1 ? 1 : period >= 1 && period <= SHOWN ? period : SHOWN);

/** @typedef {{motion: Motion, window: number}} Record */
/** @typedef {(call: string, args: any[], hear: (answer: any) => void) => void} Ask */
/**
 * @typedef {object} Standing what is known at the sliders' place
 * @property {boolean} swept settled on from a sweep's states, not from equilibrium
 * @property {boolean} settled of all fidelities
 * @property {Map<string, Steady>} steady
 * @property {Map<string, string>} faults refusals, by fidelity
 */

/**
 * Flights that follow the sliders: ``draw(motions, still)`` is called at most once a frame, ``stand`` when something is
 * known. ``ask``: the worker.
 * @param {Engine} engine
 * @param {Ask} ask
 * @param {{draw: (motions: DrawnMotion[], still: boolean) => void, stand: (standing: Standing) => void,
 *   stateOf: (model: Model) => State | null}} page ``stateOf``: the state of a sweep
 */
export function flights(engine, ask, { draw, stand, stateOf }) {
  /** @type {Map<string, State>} */
  const states = new Map();
  /** @type {Map<string, DrawnMotion>} */
  const motions = new Map();
  /** @type {Map<string, {flight: number, period: number}>} */
  const costs = new Map();  // ms of the last flight, and of a drive period
  /** @type {Model[]} */
  let waiting = [];
  let frame = 0, timer = 0, number = 0;
  /** @type {Standing} */
  let standing = { swept: false, settled: false, steady: new Map(), faults: new Map() };

  const drawAll = (/** @type {boolean} */ still) => {
    draw(flown().flatMap((each) => motions.get(each.name) ?? []), still);
  };
  /** @type {(model: Model, fault: unknown) => void} */
  const refuse = ({ name }, fault) => {
    standing.faults.set(name, fault instanceof Error ? fault.message : String(fault));
    motions.delete(name);
    states.delete(name);
  };

  /** On from the state of the last flight. @type {(model: Model) => void} */
  function follow(model) {
    const { name } = model, at = place(), begun = performance.now(), room = BUDGET / (costs.get(name)?.period ?? 0.1);
    const settle = Math.max(0, Math.min(SETTLED, Math.floor(room) - SHOWN)), options = { settle, periods: SHOWN };
    try {
      let motion = engine.motion(name, at, { ...options, state: states.get(name) });
      if (!complete(motion.ended)) motion = engine.motion(name, at, { ...options, settle: SETTLED });
      if (!complete(motion.ended)) throw new Error(motion.ended);
      states.set(name, motion.state);
      motions.set(name, drawnOf(engine, model, at, motion, SHOWN, SHOWN));
      const flight = performance.now() - begun;
      costs.set(name, { flight, period: flight / (settle + SHOWN) });
      if (standing.faults.delete(name)) stand(standing);
    } catch (fault) {
      refuse(model, fault);
      stand(standing);
    }
  }

  /** As many flights as a frame has room for; those that are left have their turn in the next. */
  function step() {
    frame = 0;
    const begun = performance.now();
    for (let next = waiting.shift(); next; next = waiting.shift()) {
      follow(next);
      const left = BUDGET - (performance.now() - begun);
      if (waiting.length && left < (costs.get(waiting[0].name)?.flight ?? 0)) break;
    }
    drawAll(false);
    if (waiting.length) frame = requestAnimationFrame(step);
  }

  /** At rest: settled as long as the case's points are. */
  function settle() {
    const own = (number += 1), at = place(), { settle, hold } = payload.sweep, asked = flown();
    let open = asked.length;
    waiting = [];
    /** @type {Map<Model, Record>} */
    const records = new Map();
    standing = { swept: startsFrom() === "sweep", settled: !open, steady: new Map(), faults: new Map() };
    stand(standing);
    const done = () => {
      open -= 1;
      standing.settled = open === 0;
      // All are drawn over the longest of their periods.
      const longest = Math.max(...[...records.values()].map(({ window }) => window));
      for (const [model, { motion, window }] of open ? [] : records) {
        if (window < longest) motions.set(model.name, drawnOf(engine, model, at, motion, RECORD, longest));
      }
      drawAll(standing.settled);
      stand(standing);
    };
    for (const model of asked) {
      const state = startsFrom() === "sweep" ? stateOf(model) : null;
      standing.swept &&= state !== null;
      ask("steady", [model.name, at, { state, settle, hold }], ({ values, fault }) => {
        if (own !== number) return;
        if (fault) refuse(model, fault);
        else {
          standing.steady.set(model.name, values);
          if (complete(values.ended)) show(model, at, values, records); else refuse(model, values.ended);
        }
        done();
      });
    }
    if (!open) drawAll(true);
  }

  /** @type {(model: Model, at: Place, steady: Steady, records: Map<Model, Record>) => void} */
  function show(model, at, { state, period }, records) {
    try {
      const motion = engine.motion(model.name, at, { state, settle: 0, periods: RECORD });
      if (!complete(motion.ended)) throw new Error(motion.ended);
      const window = windowOf(period);
      states.set(model.name, state);
      records.set(model, { motion, window });
      motions.set(model.name, drawnOf(engine, model, at, motion, RECORD, window));
    } catch (fault) { refuse(model, fault); }
  }

  function moved() {
    number += 1;  // answers to what was asked before are of another place
    const known = standing.settled || standing.steady.size;
    standing = { swept: false, settled: false, steady: new Map(), faults: known ? new Map() : standing.faults };
    if (known) stand(standing);
    const shown = flown(), later = waiting.filter((each) => shown.includes(each));
    waiting = [...later, ...shown.filter((each) => !later.includes(each))];
    frame ||= requestAnimationFrame(step);
    clearTimeout(timer);
    timer = setTimeout(() => { timer = 0; settle(); }, REST);
  }
  on("moved", moved);
  on("taken", settle);
  on("swept", () => { if (startsFrom() === "sweep" && !standing.swept && !timer) settle(); });
  on("theme", () => drawAll(standing.settled));
  settle();
}
