// Stability of a motion with one impact a span: Floquet multipliers through the saltation matrix of the impact, see
// periodic/multipliers.py.
//
// det(λ − M) = det(λ − P) D(λ), so that D(1) < 0 or D(−1) < 0 proves a multiplier beyond 1 or −1 at a cost linear in
// the modes. Where they leave it open, powers of the monodromy matrix say whether it contracts.
import { dot } from "./equilibrium.js";

/** @import { Propagator } from "./propagator.js" */
/**
 * A plain system: rows (n,) and the stop, as ImpactSystem of vibeam.
 * @typedef {{omega: ArrayLike<number>, zeta: ArrayLike<number>, contact: ArrayLike<number>, load: ArrayLike<number>,
 *   static: ArrayLike<number>, gap: number, restitution: number}} System
 */

const CERTAIN = 1e8; // size of D(±1) up to which its sign is trusted
const SQUARINGS = 50; // of the matrix: a multiplier that is not 1 to round-off has left it by then
const BOUNDLESS = 1e200; // squared norm of a power, beyond which these grow

/**
 * Whether all multipliers lie within the unit circle.
 * @param {System} system
 * @param {Propagator[]} flown each mode's over the span
 * @param {number} relative acceleration over velocity of the contact just before the impact, 1/s
 */
export function isStable(system, flown, relative) {
  for (const sign of [1, -1]) {
    const crossing = realCrossing(system, flown, relative, sign);
    if (crossing < 0 && crossing > -CERTAIN) return false;
  }
  return isContracting(monodromy(system, flown, relative), 2 * flown.length);
}

/**
 * D(±1), by the sums of T = P(λ − P)⁻¹ over the modes.
 * @param {System} system
 * @param {Propagator[]} flown
 * @param {number} relative
 * @param {number} sign 1 or −1
 */
function realCrossing(system, flown, relative, sign) {
  const s = (1 + system.restitution) / dot(system.contact, system.contact);
  let t12 = 0, t22 = 0, k11 = 0, k21 = 0;
  for (let i = 0; i < flown.length; i++) {
    const c = system.contact[i], p = flown[i], damp = 2 * system.zeta[i] * system.omega[i];
    if (c === 0) continue;
    const share = (c * c) / (sign > 0 ? p.closing : p.opening);
    const [row12, row22] = [share * sign * p.p01, share * (sign * p.p11 - p.det)];
    t12 += row12;
    t22 += row22;
    k11 += damp * row12 - share * (sign * p.p00 - p.det);
    k21 += damp * row22 - share * sign * p.p10;
  }
  return (1 - s * k11) * (1 + s * t22) + s * s * t12 * k21 - relative * s * t12;
}

/**
 * The monodromy matrix (2n, 2n) on (ωη, η') just after the impact, row by row: modes are scaled to one unit.
 * @param {System} system
 * @param {Propagator[]} flown
 * @param {number} relative
 */
export function monodromy(system, flown, relative) {
  const n = flown.length, wide = 2 * n, s = (1 + system.restitution) / dot(system.contact, system.contact);
  const matrix = new Float64Array(wide * wide);
  const { omega, zeta, contact } = system;
  for (let j = 0; j < n; j++) {
    const p = flown[j], unit = omega[j] > 0 ? omega[j] : 1;
    const columns = [[j, p.p00 / unit, p.p10 / unit], [n + j, p.p01, p.p11]];
    for (const [column, x, y] of columns) {
      for (let i = 0; i < n; i++) {
        const own = omega[i] > 0 ? omega[i] : 1, kick = s * contact[i] * contact[j];
        const turned = kick * (2 * zeta[i] * omega[i] + relative);
        matrix[i * wide + column] = own * ((i === j ? x : 0) - kick * x);
        matrix[(n + i) * wide + column] = (i === j ? y : 0) + turned * x - kick * y;
      }
    }
  }
  return matrix;
}

/**
 * Whether the powers of a matrix (n, n), row by row, tend to zero: squared until one of them is below 1 in norm, which
 * proves it, or beyond all bounds.
 * @param {Float64Array} a
 * @param {number} n
 */
export function isContracting(a, n) {
  for (let round = 0; round < SQUARINGS; round++) {
    const size = a.reduce((sum, each) => sum + each * each, 0);
    if (size < 1) return true;
    if (!(size < BOUNDLESS)) return false;
    const next = new Float64Array(n * n);
    for (let i = 0; i < n; i++)
      for (let k = 0; k < n; k++)
        for (let j = 0; j < n; j++) next[i * n + j] += a[i * n + k] * a[k * n + j];
    a = next;
  }
  return false;
}
