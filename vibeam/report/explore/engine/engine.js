// The engine in a page: its models at any place of the sliders, flown by the compiled kernels. No part of it is the page's
// own: the same files run in a page, in a worker and in node.
import { contactsOf } from "./contacts.js";
import { derivativeAlong } from "./derivatives.js";
import { driftAt } from "./drift.js";
import { EventDriven } from "./flight.js";
import { orbits } from "./orbits.js";
import { PackedSystem } from "./plain.js";
import { response } from "./points.js";
import { PackedRegimes } from "./regimes.js";
import { impactsOf, readPoint, restsOf, unread } from "./segments.js";
import { Slots } from "./slots.js";

/** @typedef {import("./equilibrium.js").State} State */
/** @typedef {import("./flight.js").Drive} Drive */
/** @typedef {import("./flight.js").Flown} Flown */
/** @typedef {import("./flight.js").Packed} Packed */
/** @typedef {import("./segments.js").SteadyPoint} SteadyPoint */
/** @typedef {Packed & {set: (settings: Settings, omega: number) => void}} Settable */
/** Values of keys in SI; what is left out is the case's.
 * @typedef {{frequency?: number, drive?: number, gap?: number, restitution?: number, damping?: number}} Place */
/** A fidelity's own numbers: rad/s, m, m, R, a factor.
 * @typedef {{omega: number, amplitude: number, gap: number, restitution: number, damping: number}} Settings */
/** @typedef {{f8: string, shape: number[]}} Packing */

const PAGE = 65536; // bytes
const POINTS = 480; // of a motion drawn
const MOST_IMPACTS = 100000; // of a motion drawn
const LIMITS = { gap: [-Infinity, Infinity], restitution: [0, 1], damping: [0, Infinity], amplitude: [0, Infinity], omega: [0, Infinity] };
const WORDS = {
  gap: "gap", restitution: "coefficient of restitution of the contact", damping: "damping factor",
  amplitude: "amplitude of the drive", omega: "drive frequency",
};

/**
 * Bytes of a text in base64.
 * @param {string} text
 * @returns {Uint8Array<ArrayBuffer>}
 */
export function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

/**
 * A payload's value with every array of it decoded, exactly.
 * @param {any} value
 * @returns {any}
 */
export function decoded(value) {
  if (Array.isArray(value)) return value.map(decoded);
  if (value === null || typeof value !== "object") return value;
  if (typeof value.f8 === "string") return new Float64Array(bytesOf(value.f8).buffer);
  return Object.fromEntries(Object.entries(value).map(([name, each]) => [name, decoded(each)]));
}

/**
 * The engine of a payload; `modules`: its libraries where they are compiled already.
 * @param {any} payload
 * @param {Record<string, WebAssembly.Module>} [modules]
 * @returns {Promise<Engine>}
 */
export const open = async (payload, modules = {}) => {
  const memory = new WebAssembly.Memory({ initial: payload.slots.first / PAGE });
  const compiled = { ...modules };
  await Promise.all(Object.entries(payload.libraries ?? {}).map(async ([name, packed]) => {
    compiled[name] ??= await WebAssembly.compile(await unpacked(packed));
  }));
  /** @type {Record<string, any>} */
  const functions = {};
  for (const [name, module] of Object.entries(compiled)) {
    const { exports } = await WebAssembly.instantiate(module, { env: { memory } });
    for (const [entry, made] of Object.entries(exports)) functions[`${name}.${entry.slice(name.length + 1)}`] = made;
  }
  return new Engine(payload, new Slots(memory, payload.slots, functions), compiled);
};

/**
 * A library from base64 of gzip.
 * @param {string} packed
 * @returns {Promise<ArrayBuffer>}
 */
function unpacked(packed) {
  return new Response(new Blob([bytesOf(packed)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

/** Models of a payload, and their motions. */
export class Engine {
  /**
   * @param {any} payload
   * @param {Slots} slots
   * @param {Record<string, WebAssembly.Module>} modules
   */
  constructor(payload, slots, modules) {
    this.slots = slots;
    this.modules = modules;
    this.sweep = decoded(payload.sweep);
    this.level = payload.level;
    this.version = payload.version;
    /** @type {string[]} */
    this.ended = payload.ended;
    /** @type {Map<string, any>} */
    this.models = new Map(payload.models.map((/** @type {any} */ each) => [each.name, decoded(each)]));
    /** @type {Map<string, any>} */
    this.sliders = new Map(payload.sliders.map((/** @type {any} */ each) => [each.name, each]));
    /** @type {Map<string, {packed: Settable, flight: EventDriven}>} */
    this.packed = new Map();
  }

  /**
   * The model of a fidelity; throws why there is none that flies.
   * @param {string} fidelity
   * @returns {any}
   */
  model(fidelity) {
    const found = this.models.get(fidelity);
    if (!found) throw new Error(`No fidelity ${fidelity}: there are ${[...this.models.keys()].join(", ")}.`);
    if (!found.engine) throw new Error(found.refusal);
    return found;
  }

  /**
   * The fidelity's own numbers at a place of the sliders; throws where one of them cannot be.
   * @param {string} fidelity
   * @param {Place} place
   * @returns {Settings}
   */
  settings(fidelity, place) {
    const model = this.model(fidelity);
    const own = (/** @type {"drive" | "gap" | "restitution" | "damping"} */ name, /** @type {number} */ usual) => {
      const value = place[name], slider = this.sliders.get(name);
      if (value === undefined) return usual;
      if (!slider) throw new Error(`${model.label}: its ${name} cannot be changed on this page.`);
      const line = slider.of[fidelity]; // none: it has no such number, or one of its own
      return line ? line[0] + line[1] * value : usual;
    };
    const frequency = place.frequency ?? this.sliders.get("frequency")?.value, omega = 2 * Math.PI * frequency;
    const drift = model.drift ? driftAt(model.drift, frequency) : 0;
    const found = {
      omega, amplitude: amplitudeOf(model, frequency, own("drive", model.amplitude.level)),
      gap: own("gap", model.gap) + drift, restitution: own("restitution", model.restitution), damping: own("damping", 1),
    };
    for (const [name, value] of Object.entries(found)) {
      const key = /** @type {keyof typeof LIMITS} */ (name), [low, most] = LIMITS[key];
      const high = key === "restitution" && model.regimes ? Infinity : most; // a law's coefficient is no share
      if (!(Number.isFinite(value) && value >= low && value <= high) || (name === "omega" && value === 0))
        throw new Error(`${model.label}: a ${WORDS[key]} of ${Number(value.toPrecision(4))} cannot be.`);
    }
    return found;
  }

  /**
   * A fidelity packed for a place, and for drives of `slowest` rad/s and more (none: that of the place).
   * @param {string} fidelity
   * @param {Settings} settings
   * @param {number} [slowest]
   * @returns {EventDriven}
   */
  ready(fidelity, settings, slowest = settings.omega) {
    let known = this.packed.get(fidelity);
    if (!known) {
      const model = this.model(fidelity);
      const made = model.engine === "regimes" ? PackedRegimes : PackedSystem;
      const packed = /** @type {Settable} */ (new made(this.slots, model));
      this.packed.set(fidelity, known = { packed, flight: new EventDriven(packed) });
    }
    known.packed.set(settings, slowest);
    return known.flight;
  }

  /**
   * A motion from static equilibrium over so many drive periods, and a steady point from there, read over as many.
   * @param {Place & {fidelity: string, periods: number, settle?: number}} asked
   */
  fly({ fidelity, periods, settle = this.sweep.settle, ...place }) {
    const settings = this.settings(fidelity, place), flight = this.ready(fidelity, settings);
    const flown = flight.simulate(settings, null, (periods * 2 * Math.PI) / settings.omega);
    const impacts = impactsOf(this.slots.rows.layout, flown.segments);
    const { period, maximum, minimum, ended } = this.steady(fidelity, place, { settle, hold: periods });
    const first = flown.ended === this.slots.rows.layout.COMPLETE;
    return {
      impactTimes: impacts.map(([time]) => time), impactVelocities: impacts.map(([, velocity]) => velocity),
      period, maximum, minimum, ended: first ? ended : this.ended[flown.ended],
      counts: { impacts: flown.impacts, evaluations: flown.evaluations },
    };
  }

  /**
   * A motion on from a state (none: static equilibrium): settled, then followed over `periods`.
   * @param {string} fidelity
   * @param {Place} place
   * @param {{state?: State | null, settle?: number, periods?: number}} [schedule]
   * @returns {Motion}
   */
  motion(fidelity, place, { state = null, settle = 0, periods = 24 } = {}) {
    const settings = this.settings(fidelity, place), flight = this.ready(fidelity, settings);
    const settled = settle > 0 ? flight.settle(settings, state, settle) : { ended: 0, state };
    const turn = (2 * Math.PI) / settings.omega, span = settled.ended ? 0 : periods * turn;
    const flown = flight.simulate(settings, settled.state, span, MOST_IMPACTS);
    return new Motion(this, fidelity, settings, { ...flown, ended: settled.ended || flown.ended }, periods);
  }

  /**
   * A steady point on from a state (none: static equilibrium): settled, then read over `hold` periods.
   * @param {string} fidelity
   * @param {Place} place
   * @param {{state?: State | null, settle?: number, hold?: number}} [schedule]
   * @returns {SteadyPoint & {ended: string, state: State}}
   */
  steady(fidelity, place, { state = null, settle = this.sweep.settle, hold = this.sweep.hold } = {}) {
    const settings = this.settings(fidelity, place), flight = this.ready(fidelity, settings), model = this.model(fidelity);
    const { ended, period } = flight.watched(settings, state, { settle, hold, output: model.output });
    const { layout } = this.slots.rows, turn = (2 * Math.PI) / settings.omega;
    const read = ended !== layout.COMPLETE
      ? unread() : readPoint(layout, flight.watch.result.data, { period, hold, turn, gap: settings.gap });
    return { ...read, ended: this.ended[ended], state: flight.state() };
  }

  /**
   * Steady points at frequencies, Hz: each by itself, or carried from one to the next.
   * @param {string} fidelity
   * @param {Place} place
   * @param {ArrayLike<number>} frequencies
   * @param {import("./types.d.ts").Schedule} [schedule]
   */
  response(fidelity, place, frequencies, schedule) {
    return response(this, fidelity, place, frequencies, schedule);
  }

  /**
   * Periodic motions at frequencies, Hz, stable and unstable, with one impact in each of `periods` drive periods.
   * @param {string} fidelity
   * @param {Place} place
   * @param {ArrayLike<number>} frequencies
   * @param {number[]} [periods]
   */
  orbits(fidelity, place, frequencies, periods) {
    return orbits(this, fidelity, place, frequencies, periods);
  }
}

/** A motion, exact between its events; times in s from its start, at the drive's phase 0. */
export class Motion {
  /**
   * @param {Engine} engine
   * @param {string} fidelity
   * @param {Settings} settings
   * @param {Flown} flown
   * @param {number} periods
   */
  constructor(engine, fidelity, settings, flown, periods) {
    const { layout } = engine.slots.rows;
    this.engine = engine;
    this.fidelity = fidelity;
    this.settings = settings;
    this.segments = flown.segments;
    this.ended = engine.ended[flown.ended];
    this.omega = settings.omega;
    this.turn = (2 * Math.PI) / settings.omega;
    this.periods = periods;
    this.start = 0;
    this.end = flown.last;
    this.state = flown.state;
    this.impacts = impactsOf(layout, flown.segments);
    this.rests = restsOf(layout, flown.segments, flown.last);
    this.contacts = contactsOf(engine.slots, flown.segments);
    this.counts = { impacts: flown.impacts, evaluations: flown.evaluations };
  }

  /**
   * Times to draw the motion at: evenly, and just before and at each impact.
   * @param {number} [points]
   * @returns {Float64Array}
   */
  times(points = POINTS) {
    const even = Array.from({ length: points }, (_, i) => (i * this.end) / (points - 1)), struck = this.impacts.length;
    if (struck > 4 * points) return Float64Array.from(even);
    const jumps = this.impacts.flatMap(([time]) => (time > 0 ? [time - time * Number.EPSILON, time] : [time]));
    return Float64Array.from([...even, ...jumps]).sort();
  }

  /**
   * The output and its rate, and modal displacements (k, n) in the user's order, at times (k,): at an impact just after it.
   * @param {ArrayLike<number>} times
   * @returns {{x: Float64Array, v: Float64Array, modes: Float64Array}}
   */
  at(times) {
    const flight = this.engine.ready(this.fidelity, this.settings), { order, size: n } = flight.packed;
    const model = this.engine.model(this.fidelity), k = times.length;
    const derivative = model.derivatives?.[model.output];
    const row = derivative?.row ?? (model.output === "contact" ? model.contact : model.outputs[model.output]);
    const poses = flight.posesAt(this.settings, this.segments, times);
    const x = new Float64Array(k), v = new Float64Array(k), modes = new Float64Array(k * n);
    for (let i = 0; i < k; i++) {
      for (let j = 0; j < n; j++) {
        const mode = order[j], place = poses[2 * n * i + j];
        modes[n * i + mode] = place;
        x[i] += row[mode] * place;
        v[i] += row[mode] * poses[2 * n * i + n + j];
      }
    }
    if (!derivative) return { x, v, modes };
    const along = (/** @type {0 | 1} */ more) =>
      derivativeAlong(/** @type {any} */ (flight.packed), this.settings, this.segments, times, poses, derivative, more);
    return { x: along(0), v: along(1), modes };
  }
}

/**
 * Amplitude of the drive, m, at a frequency, Hz; that of a table at the nearest of its frequencies, where sliders stand.
 * @param {any} model
 * @param {number} frequency
 * @param {number} level
 * @returns {number}
 */
function amplitudeOf({ amplitude: { power, factor, frequency: known, amplitude: table } }, frequency, level) {
  if (!known) {
    let found = level * factor;
    for (let i = 0; i < power; i++) found /= 2 * Math.PI * frequency;
    return found;
  }
  let nearest = 0;
  for (let i = 1; i < known.length; i++)
    if (Math.abs(known[i] - frequency) < Math.abs(known[nearest] - frequency)) nearest = i;
  return level * table[nearest];
}
