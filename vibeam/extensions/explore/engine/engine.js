// The engine in a page: its models at any place of the sliders, flown by the compiled kernels. No part of it is the page's
// own: the same files run in a page, in a worker and in node.
import { inflated } from "../../../report/page/base64.js";
import { decoded } from "./decoding.js";
import { EventDriven } from "./flight.js";
import { orbits } from "./orbits.js";
import { HarmonicDriven } from "./harmonics.js";
import { PackedHarmonics } from "./oscillators.js";
import { PackedSystem } from "./plain.js";
import { response } from "./points.js";
import { PackedRegimes } from "./regimes.js";
import { impactsOf, readPoint, unread } from "./segments.js";
import { settingsAt } from "./settings.js";
import { Slots } from "./slots.js";
import { Motion } from "./trajectory.js";

/** @import { Place, Settings, State, SteadyPoint } from "./types.d.ts" */
/** @import { Packed } from "./flight.js" */
/** @typedef {Packed & {set: (settings: Settings, omega: number) => void}} Settable */

const PAGE = 65536; // bytes
const MOST_IMPACTS = 50000; // of a motion drawn, and as many while it settles: some tenths of a second

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
    compiled[name] ??= await WebAssembly.compile(await inflated(packed, "gzip"));
  }));
  /** @type {Record<string, any>} */
  const functions = {};
  for (const [name, module] of Object.entries(compiled)) {
    const { exports } = await WebAssembly.instantiate(module, { env: { memory } });
    for (const [entry, made] of Object.entries(exports)) functions[`${name}.${entry.slice(name.length + 1)}`] = made;
  }
  return new Engine(payload, new Slots(memory, payload.slots, functions), compiled);
};

/** Models of a payload, their motions, response curves (points.js) and periodic motions (orbits.js). */
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
    this.response = response.bind(null, this);
    this.orbits = orbits.bind(null, this);
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
    return settingsAt(this.model(fidelity), this.sliders, place);
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
      if (model.engine === "harmonics") {
        const packed = new PackedHarmonics(this.slots, model);
        known = { packed, flight: new HarmonicDriven(packed) };
      } else {
        const made = model.engine === "regimes" ? PackedRegimes : PackedSystem;
        const packed = /** @type {Settable} */ (new made(this.slots, model));
        known = { packed, flight: new EventDriven(packed) };
      }
      this.packed.set(fidelity, known);
    }
    known.packed.set(settings, slowest);
    return known.flight;
  }

  /**
   * A motion from static equilibrium over so many drive periods, and a steady point from there, read over as many.
   * @param {Place & {fidelity: string, periods: number, settle?: number}} asked
   */
  fly({ fidelity, periods, settle = this.sweep.settle, ...place }) {
    requireWhole("periods", periods, 1);
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
    const settled = settle > 0 ? flight.settle(settings, state, settle, MOST_IMPACTS) : { ended: 0, state };
    const span = settled.ended ? 0 : (periods * 2 * Math.PI) / settings.omega;
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
    requireWhole("settle", settle, 0);
    requireWhole("hold", hold, 1);
    const settings = this.settings(fidelity, place), flight = this.ready(fidelity, settings), model = this.model(fidelity);
    const { ended, period } = flight.watched(settings, state, { settle, hold, output: model.output });
    const { layout } = this.slots.rows, turn = (2 * Math.PI) / settings.omega;
    const read = ended !== layout.COMPLETE
      ? unread() : readPoint(layout, flight.watch.result.data, { period, hold, turn, gap: settings.gap });
    return { ...read, ended: this.ended[ended], state: flight.state() };
  }
}

/**
 * Throw a sentence for what is no number of drive periods.
 * @param {string} name
 * @param {unknown} value
 * @param {number} least
 */
function requireWhole(name, value, least) {
  if (!Number.isInteger(value) || Number(value) < least)
    throw new Error(`${name} must be a whole number of drive periods from ${least} up, not ${value}.`);
}
