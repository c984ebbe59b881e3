// Static equilibrium of a plain system, on the stop where that is in the way, and the size of a motion.

/** @import { State } from "./types.d.ts" */
/**
 * @typedef {object} Modal a plain system's rows (n,)
 * @property {Float64Array} omega rad/s
 * @property {Float64Array} contact
 * @property {Float64Array} load
 * @property {Float64Array} static
 */

const LOST = 1e-14; // share of the gap by which the contact may miss the stop that it rests on
const SMALLEST = 1e-150; // rad/s
const DRIVEN = 10; // how much larger than the base motion times its share a driven mode is taken to be
const STRONG = 1e6; // drive over start beyond which the size of the motion is that of the start

/**
 * @param {ArrayLike<number>} first
 * @param {ArrayLike<number>} second
 */
export function dot(first, second) {
  let sum = 0;
  for (let k = 0; k < first.length; k++) sum += first[k] * second[k];
  return sum;
}

/**
 * The static equilibrium with the stop at a gap, m.
 * @param {Modal} system
 * @param {number} gap
 * @returns {State}
 */
export function equilibrium(system, gap) {
  const { omega, contact } = system, n = omega.length, velocity = new Float64Array(n);
  const free = omega.map((own, k) => (own > 0 && system.static[k] !== 0 ? system.static[k] / (own * own) : 0));
  if (!free.every(Number.isFinite)) throw new Error("The equilibrium is beyond all numbers: take other units.");
  const beyond = dot(contact, free) - gap;
  if (!(beyond > 0)) return { displacement: free, velocity, resting: false };
  const loose = omega.some((own, k) => own === 0 && contact[k] !== 0);
  const shape = loose
    ? contact.map((each, k) => (omega[k] === 0 ? each : 0))
    : contact.map((each, k) => each / (omega[k] > 0 ? omega[k] : 1) ** 2);
  const over = dot(contact, shape), displacement = free.map((each, k) => each - shape[k] * (beyond / over));
  const left = dot(displacement, contact) - gap;
  if (Math.abs(left) > LOST * Math.abs(gap))
    for (let k = 0; k < n; k++) displacement[k] -= shape[k] * (left / over);
  return { displacement, velocity, resting: true };
}

/**
 * Displacements that move the contact by 1 with the least energy, (n,): c/ω² over its sum, free modes alone if any.
 * @param {Float64Array} omega
 * @param {Float64Array} contact
 * @returns {Float64Array}
 */
export function yields(omega, contact) {
  const loose = omega.some((own, k) => own === 0 && contact[k] !== 0);
  const softest = Math.min(...omega.filter((_, k) => contact[k] !== 0));
  const weight = contact.map((each, k) => {
    if (loose) return omega[k] === 0 ? each : 0;
    const share = softest / (omega[k] > 0 ? omega[k] : 1);
    return each * (share * share);
  });
  const over = dot(contact, weight);
  return weight.map((each) => each / over);
}

/**
 * About how large the modal displacements are: those of the start, a swing on, and the drive's.
 * @param {Modal} system
 * @param {number} amplitude m
 * @param {State} start
 * @returns {number}
 */
export function sizeOfMotion({ omega, load }, amplitude, { displacement, velocity }) {
  let start = 0, largest = 0;
  for (let k = 0; k < omega.length; k++) {
    const turn = omega[k] > SMALLEST ? 1 / omega[k] : 0;
    start = Math.max(start, Math.abs(displacement[k]) + Math.abs(velocity[k]) * turn);
    largest = Math.max(largest, Math.abs(load[k]));
  }
  const driven = DRIVEN * Math.abs(amplitude) * largest;
  return start > 0 && driven > STRONG * start ? start : start + driven;
}
