// Sums over the modes by which motions with one impact in n drive periods are found: the periodic Green's function method
// of Babitsky and Krupenin, see periodic/modal_sums.py. Contact and restitution leave one quadratic for the impulse p:
//
//     Im(H e^{iψ}) = Δ − p G₀,   Ω Re(H e^{iψ}) = p κ,   hence   (Δ − p G₀)² + (p κ/Ω)² = |H|²
import { dot } from "./equilibrium.js";
import { propagator } from "./propagator.js";

/** @import { System } from "./multipliers.js" */
/** @import { Propagator } from "./propagator.js" */
/** @typedef {{omega: number, amplitude: number}} Drive rad/s, m */
/** @typedef {{span: number, flown: Propagator[], re: number, im: number, g0: number, g1: number, g2: number,
 *   offset: number, fixed: number | null, mobility: number}} Sums */
/** @typedef {{impulse: number, height: number, turn: number}} Root */

const DOUBLE = 16 * 2.220446049250313e-16; // relative round-off of a discriminant: the root counts as double
const PARALLEL = 1e-12; // tolerance for the static force on modes without stiffness to point along the contact

/**
 * Why the system has no periodic motion with impacts at any drive; empty where it may.
 * @param {System} system
 */
export function fault(system) {
  let along = 0, size = 0, square = 0;
  for (let i = 0; i < system.omega.length; i++) {
    if (system.omega[i] > 0) continue;
    along += system.static[i] * system.contact[i];
    size += system.static[i] ** 2;
    square += system.contact[i] ** 2;
  }
  if (size + square === 0) return "";
  const share = along / Math.max(square, Number.MIN_VALUE), across = Math.sqrt(Math.max(size - share * along, 0));
  if (share > 0 && across <= PARALLEL * Math.sqrt(size)) return "";
  return "A mode without stiffness needs a static force toward the stop, along the contact, to come back to it.";
}

/**
 * Whether an undamped mode is driven at its own frequency, or makes a whole number of turns in the span.
 * @param {System} system
 * @param {number} omega
 * @param {number} periods
 */
export function isResonant(system, omega, periods) {
  return Array.from(system.omega).some((own, i) => {
    if (own === 0 || system.zeta[i] !== 0) return false;
    const turns = (own * periods) / omega, driven = own === omega && system.load[i] !== 0;
    return driven || (system.contact[i] !== 0 && turns === Math.round(turns));
  });
}

/**
 * Steady response h of a mode to the drive, Im(h e^{iΩt}).
 * @param {System} system
 * @param {number} i
 * @param {Drive} drive
 */
export function phasor(system, i, drive) {
  if (system.load[i] === 0) return { re: 0, im: 0 };
  const own = system.omega[i], damp = 2 * system.zeta[i] * own;
  const re = (own - drive.omega) * (own + drive.omega), im = damp * drive.omega;
  const share = (system.load[i] * drive.omega ** 2 * drive.amplitude) / (re * re + im * im);
  return { re: share * re, im: -share * im };
}

/**
 * Static displacement of a mode, 0 without stiffness.
 * @param {System} system
 * @param {number} i
 */
export const offset = (system, i) => (system.omega[i] > 0 ? system.static[i] / system.omega[i] ** 2 : 0);

/**
 * Periodic Green's function g(0), g'(0⁺) of a mode; 0 and ½ without stiffness.
 * @param {System} system
 * @param {number} i
 * @param {Propagator} p
 */
export function green(system, i, p) {
  return system.omega[i] === 0 ? [0, 0.5] : [p.p01 / p.closing, p.rise / p.closing];
}

/**
 * Sums over the modes: H, G₀, G₁, G₂ and the static contact displacement; `fixed`: the impulse that modes without
 * stiffness ask for.
 * @param {System} system
 * @param {Drive} drive
 * @param {number} periods
 * @returns {Sums}
 */
export function sumsAt(system, drive, periods) {
  const span = (2 * Math.PI * periods) / drive.omega, flown = [];
  const sum = { re: 0, im: 0, g0: 0, g1: 0, g2: 0, offset: 0 };
  let loose = 0, pushed = 0;
  for (let i = 0; i < system.omega.length; i++) {
    const own = system.omega[i], c = system.contact[i], p = propagator(own, system.zeta[i], span);
    flown.push(p);
    if (c === 0) continue;
    const [g0, g1] = green(system, i, p), h = phasor(system, i, drive);
    sum.re += c * h.re;
    sum.im += c * h.im;
    sum.g0 += c * c * g0;
    sum.g1 += c * c * g1;
    sum.g2 += c * c * (own === 0 ? -1 / span : -2 * system.zeta[i] * own * (g1 - 1) - own * own * g0);
    sum.offset += c * offset(system, i);
    if (own > 0) continue;
    loose += c * c;
    pushed += c * system.static[i];
  }
  const mobility = dot(system.contact, system.contact);
  return { span, flown, ...sum, fixed: loose > 0 ? (-span * pushed) / loose : null, mobility };
}

/**
 * Both roots, the lower impulse first; NaN where they are complex. `height`, `turn`: Im and Re of H e^{iψ}.
 * @param {System} system
 * @param {Sums} sums
 * @param {number} omega
 * @returns {Root[]}
 */
export function roots(system, sums, omega) {
  const R = system.restitution, turn = ((R * sums.mobility) / (1 + R) - sums.g1) / omega;
  const size = Math.hypot(sums.re, sums.im), clear = system.gap - sums.offset;
  if (sums.fixed !== null) {
    const across = Math.abs(turn * sums.fixed), height = Math.sqrt((size - across) * (size + across));
    const impulse = isNaN(height) ? NaN : sums.fixed;
    return [-height, height].map((each) => ({ impulse, height: each, turn: impulse * turn }));
  }
  const lead = sums.g0 ** 2 + turn ** 2, middle = clear * sums.g0;
  const long = size * Math.sqrt(lead), short = Math.abs(clear * turn);
  const discriminant = (long - short) * (long + short);
  const root = Math.abs(discriminant) <= DOUBLE * long ** 2 ? 0 : Math.sqrt(discriminant);
  const below = middle < 0 || Object.is(middle, -0), large = below ? middle - root : middle + root;
  const near = large === 0 ? 0 : ((clear - size) * (clear + size)) / large, far = large / lead;
  return (below ? [far, near] : [near, far])
    .map((impulse) => ({ impulse, height: clear - impulse * sums.g0, turn: impulse * turn }));
}
