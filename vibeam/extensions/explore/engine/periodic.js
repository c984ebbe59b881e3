// Motions with one impact in n drive periods in closed form, for any number of modes, stable and unstable, and the motion
// without contact. Whether one keeps clear of the stop between its impacts a flight decides: see orbits.js.
import { green, isResonant, offset, phasor, roots, sumsAt } from "./modal_sums.js";
import { isStable } from "./multipliers.js";
import { propagator } from "./propagator.js";

/** @import { Orbit } from "./types.d.ts" */
/** @import { Drive, Root, Sums } from "./modal_sums.js" */
/** @import { System } from "./multipliers.js" */
/**
 * A motion: `phase` of the drive at its impact, `state` at the drive's phase 0, displacements, then velocities (2n,),
 * `growth`: about how much a small change of it grows at the impact. NaN are read off its flight.
 * @typedef {Omit<Orbit, "frequency"> & {drive: Drive, state: Float64Array | null, growth: number}} Motion
 */

const SAMPLES = 32; // a drive period
const SEEN = 1e-6; // share of the motion that a sample beyond the stop must be

/**
 * The motions at one drive: both with one impact in `periods` drive periods, the harder first, as far as they exist.
 * `admissible`, `amplitude` and the extremes are for a flight to find; one without `state` is seen to pass through the
 * stop, and is neither admissible nor stable.
 * @param {System} system
 * @param {Drive} drive
 * @param {number} periods
 * @returns {Motion[]}
 */
export function orbitsAt(system, drive, periods) {
  if (drive.amplitude === 0 || isResonant(system, drive.omega, periods)) return [];
  const sums = sumsAt(system, drive, periods), found = [];
  for (const [k, root] of roots(system, sums, drive.omega).entries()) {
    if (!(root.impulse < 0)) continue;
    found.push(orbitOf(system, drive, periods, sums, root, k === 0 ? "harder" : "softer"));
  }
  return found;
}

/**
 * The motion under the drive alone, where it exists and never reaches the stop; its extremes in closed form.
 * @param {System} system
 * @param {Drive} drive
 * @param {ArrayLike<number>} output row of what is read off
 * @returns {Motion[]} one or none
 */
export function freeMotion(system, drive, output) {
  const n = system.omega.length, state = new Float64Array(2 * n), [re, im] = [[0, 0], [0, 0]], rest = [0, 0];
  for (let i = 0; i < n; i++) {
    if (system.omega[i] === 0 && system.static[i] !== 0) return [];
    const h = phasor(system, i, drive), still = offset(system, i);
    [state[i], state[n + i]] = [h.im + still, drive.omega * h.re];
    for (const [k, row] of [system.contact, output].entries()) {
      re[k] += row[i] * h.re;
      im[k] += row[i] * h.im;
      rest[k] += row[i] * still;
    }
  }
  const amplitude = Math.hypot(re[1], im[1]);
  if (!(Math.hypot(re[0], im[0]) + rest[0] < system.gap) || !state.every(Number.isFinite)) return [];
  return [{
    drive, periods: 1, branch: "free", phase: 0, amplitude,
    maximum: rest[1] + amplitude, minimum: rest[1] - amplitude, impactVelocity: 0,
    stable: Array.from(system.omega).every((own, i) => own * system.zeta[i] > 0), admissible: true, state, growth: 1,
  }];
}

/**
 * The motion of one root.
 * @param {System} system
 * @param {Drive} drive
 * @param {number} periods
 * @param {Sums} sums
 * @param {Root} root
 * @param {"harder" | "softer"} branch
 * @returns {Motion}
 */
function orbitOf(system, drive, periods, sums, root, branch) {
  const turned = Math.atan2(root.height, root.turn) - Math.atan2(sums.im, sums.re), whole = 2 * Math.PI;
  const phase = turned - whole * Math.floor(turned / whole);
  const velocity = (-root.impulse * sums.mobility) / (1 + system.restitution);
  const relative = (-(drive.omega ** 2) * root.height + root.impulse * sums.g2) / velocity;
  const through = passesThrough(system, drive, periods, sums, root);
  return {
    drive, periods, branch, phase, amplitude: NaN, maximum: NaN, minimum: NaN,
    impactVelocity: velocity, stable: !through && isStable(system, sums.flown, relative), admissible: false,
    state: through ? null : stateAtPhaseZero(system, drive, sums, phase, root.impulse),
    growth: Math.max(1, Math.abs(relative) * sums.span),
  };
}

/**
 * Whether the gap between two impacts, x (1 − cos Ωτ) − y sin Ωτ − p (G(τ) − G(0)), is seen to be negative: a few
 * samples tell most of the motions that are none, and spare their flights.
 * @param {System} system
 * @param {Drive} drive
 * @param {number} periods
 * @param {Sums} sums
 * @param {Root} root
 */
function passesThrough(system, drive, periods, sums, { impulse, height, turn }) {
  const count = SAMPLES * periods, step = sums.span / count, gap = new Float64Array(count);
  for (let k = 1; k < count; k++) {
    const angle = drive.omega * k * step;
    gap[k] = 2 * height * Math.sin(angle / 2) ** 2 - turn * Math.sin(angle);
  }
  for (let i = 0; i < system.omega.length; i++) {
    const own = system.omega[i], weight = impulse * system.contact[i] ** 2;
    if (weight === 0) continue;
    const [g0, g1] = green(system, i, sums.flown[i]), p = propagator(own, system.zeta[i], step);
    for (let k = 1, x = g0, y = g1; k < count; k++) {
      [x, y] = [p.p00 * x + p.p01 * y, p.p10 * x + p.p11 * y];
      gap[k] -= weight * (own > 0 ? x - g0 : k * step * (0.5 - k / (2 * count)));
    }
  }
  return gap.some((each) => each < -SEEN * Math.hypot(height, turn));
}

/**
 * State (2n,) at the drive's next phase 0 after the impact: just after it the drive's response and the impulse train's.
 * @param {System} system
 * @param {Drive} drive
 * @param {Sums} sums
 * @param {number} phase
 * @param {number} impulse
 */
function stateAtPhaseZero(system, drive, sums, phase, impulse) {
  const n = system.omega.length, state = new Float64Array(2 * n), cosine = Math.cos(phase), sine = Math.sin(phase);
  const left = phase > 0 ? (2 * Math.PI - phase) / drive.omega : 0;
  let at = 0, loose = 0;
  for (let i = 0; i < n; i++) {
    const h = phasor(system, i, drive), [g0, g1] = system.contact[i] === 0 ? [0, 0] : green(system, i, sums.flown[i]);
    const kick = impulse * system.contact[i], p = propagator(system.omega[i], system.zeta[i], left);
    state[i] = h.im + offset(system, i) + kick * (p.p00 * g0 + p.p01 * g1);
    state[n + i] = drive.omega * h.re + kick * (p.p10 * g0 + p.p11 * g1);
    at += system.contact[i] * (h.re * sine + h.im * cosine + offset(system, i) + kick * g0);
    if (system.omega[i] === 0) loose += system.contact[i] ** 2;
  }
  if (loose === 0) return state;
  for (let i = 0; i < n; i++) { // modes without stiffness put the contact at the gap, and fall
    if (system.omega[i] !== 0) continue;
    state[i] += (system.contact[i] * (system.gap - at)) / loose + (system.static[i] * left * left) / 2;
    state[n + i] += system.static[i] * left;
  }
  return state;
}
