// Periodic motions over frequency, stable and unstable: closed forms (periodic.js), each then flown by the kernels over
// its n drive periods. Where that comes back to its start with one impact, the motion keeps clear of the stop between
// its impacts, by the kernels' bounds and not by samples; the same flight gives its extremes.
import { fault } from "./modal_sums.js";
import { freeMotion, orbitsAt } from "./periodic.js";
import { pointsOf } from "./points.js";

/** @import { PackedSystem } from "./plain.js" */
/** @import { Motion } from "./periodic.js" */
/** @import { Point } from "./points.js" */
/** @import { Orbit, Place, Settings } from "./types.d.ts" */

const CLOSE = 1e-9; // share of the motion's size by which its flight may miss the start
const PERIODS = [1, 2, 3];

/**
 * The motions of a plain fidelity at `frequencies`, Hz. Throws a sentence where there are no closed forms.
 * @param {any} engine
 * @param {string} fidelity
 * @param {Place} place
 * @param {ArrayLike<number>} frequencies
 * @param {number[]} [periods]
 * @returns {Orbit[]}
 */
export function orbits(engine, fidelity, place, frequencies, periods = PERIODS) {
  const model = engine.model(fidelity);
  if (model.engine !== "plain")
    throw new Error(`${model.label}: periodic motions have a closed form only for one stop with one coefficient of ` +
      "restitution and damping that couples no modes.");
  const settings = Array.from(frequencies, (frequency) => engine.settings(fidelity, { ...place, frequency }));
  if (!settings.length) return [];
  const slowest = Math.min(...settings.map(({ omega }) => omega));
  const { packed } = engine.ready(fidelity, settings[0], slowest);
  const row = model.output === "contact" ? model.contact : model.outputs[model.output];
  const systems = settings.map((own) => systemOf(packed.model, own)), reason = fault(systems[0]);
  if (reason) throw new Error(`${model.label}: ${reason}`);
  const at = (/** @type {(own: Settings, i: number) => Motion[]} */ found) =>
    settings.flatMap((own, i) => found(own, i).map((motion) => ({ motion, own, frequency: frequencies[i] })));
  const free = at((own, i) => freeMotion(systems[i], own, row));
  const struck = periods.flatMap((n) => {
    const found = at((own, i) => orbitsAt(systems[i], own, n));
    fly(packed, model.output, slowest, n, found.filter(({ motion }) => motion.state));
    return found;
  });
  return [...free, ...struck].map(({ motion: { drive: _, state: __, growth: ___, ...motion }, frequency }) => (
    { frequency, ...motion }
  ));
}

/**
 * A fidelity's system at a place.
 * @param {PackedSystem["model"]} model
 * @param {Settings} settings
 */
function systemOf(model, { gap, restitution, damping }) {
  const { omega, contact, load, static: still } = model;
  return { omega, zeta: model.zeta.map((each) => each * damping), contact, load, static: still, gap, restitution };
}

/**
 * Fly motions over their `periods`: those that are admissible, and their extremes.
 * @param {PackedSystem} packed
 * @param {string} output
 * @param {number} slowest
 * @param {number} periods
 * @param {{motion: Motion, own: Settings}[]} found
 */
function fly(packed, output, slowest, periods, found) {
  if (!found.length) return;
  const n = packed.size, watched = { settle: 0, hold: periods, output, slowest }, states = found.map(
    ({ motion: { state } }) => state && { displacement: state.slice(0, n), velocity: state.slice(n), resting: false },
  );
  pointsOf(packed, found.map(({ own }) => own), watched, states).forEach((point, i) => {
    const { motion } = found[i], { amplitude, maximum, minimum } = point;
    motion.admissible = isRepeated(packed, motion, point, periods);
    motion.stable &&= motion.admissible;
    if (motion.admissible) Object.assign(motion, { amplitude, maximum, minimum });
  });
}

/**
 * Whether a flight came back to its start, with one impact and no rest.
 * @param {PackedSystem} packed
 * @param {Motion} motion
 * @param {Point} point
 * @param {number} periods
 */
function isRepeated({ model: { omega }, size: n }, { drive, state, growth }, point, periods) {
  if (!state || Math.round(point.impactsPerPeriod * periods) !== 1 || point.rest > 0) return false;
  const { displacement, velocity } = point.state;
  let missed = 0, size = 0;
  for (let k = 0; k < n; k++) {
    const rate = Math.hypot(omega[k], drive.omega), off = rate * (displacement[k] - state[k]);
    missed += off * off + (velocity[k] - state[n + k]) ** 2;
    size += (rate * state[k]) ** 2 + state[n + k] ** 2;
  }
  return Math.sqrt(missed) <= CLOSE * growth * Math.sqrt(size);
}
