// Stability of a motion with one impact a span: Floquet multipliers through the saltation matrix of the impact, see
// periodic/multipliers.py.
//
// det(λ − M) = det(λ − P) D(λ), so that D(1) < 0 or D(−1) < 0 proves a multiplier beyond 1 or −1 at a cost linear in
// the modes. Where they leave it open, all eigenvalues of the monodromy matrix are found: Hessenberg form by
// reflections, then Francis' QR steps with a double shift (Golub & Van Loan, Matrix Computations, 7.4 and 7.5).

/** @typedef {import("./propagator.js").Propagator} Propagator */
/**
 * A plain system: rows (n,) and the stop, as ImpactSystem of vibeam.
 * @typedef {{omega: ArrayLike<number>, zeta: ArrayLike<number>, contact: ArrayLike<number>, load: ArrayLike<number>,
 *   static: ArrayLike<number>, gap: number, restitution: number}} System
 */

const CERTAIN = 1e8; // size of D(±1) up to which its sign is trusted
const ROUND_OFF = 2.220446049250313e-16;
const STEPS = 60; // QR steps for one eigenvalue, of which two or three are usual

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
  return spectralRadius(monodromy(system, flown, relative), 2 * flown.length) < 1;
}

/**
 * Σ c², the velocity of the contact after a unit impulse there.
 * @param {System} system
 */
export function mobility(system) {
  let sum = 0;
  for (let i = 0; i < system.contact.length; i++) sum += system.contact[i] * system.contact[i];
  return sum;
}

/**
 * D(±1), by the sums of T = P(λ − P)⁻¹ over the modes.
 * @param {System} system
 * @param {Propagator[]} flown
 * @param {number} relative
 * @param {number} sign 1 or −1
 */
function realCrossing(system, flown, relative, sign) {
  const s = (1 + system.restitution) / mobility(system);
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
  const n = flown.length, wide = 2 * n, s = (1 + system.restitution) / mobility(system);
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
 * Largest modulus of the eigenvalues of `a` (n, n), row by row, which is used up; NaN where they are not found.
 * @param {Float64Array} a
 * @param {number} n
 */
export function spectralRadius(a, n) {
  for (let k = 0; k < n - 2; k++) {
    const v = mirror(a, (k + 1) * n + k, n, n - k - 1);
    if (v) reflect(a, n, v, k + 1, k, n, n);
  }
  let radius = 0, high = n - 1, steps = 0;
  while (high >= 0) {
    const low = split(a, n, high);
    if (low >= high - 1) {
      radius = Math.max(radius, low === high ? Math.abs(a[high * n + high]) : pairModulus(a, n, low));
      [high, steps] = [low - 1, 0];
    } else if (++steps > STEPS) return NaN;
    else francis(a, n, low, high, steps % 10 === 0);
  }
  return radius;
}

/**
 * First row of the block, up to `high`, that no element below the diagonal splits; what does split is set to 0.
 * @param {Float64Array} a
 * @param {number} n
 * @param {number} high
 */
function split(a, n, high) {
  let low = high;
  for (; low > 0; low--) {
    const beside = Math.abs(a[low * n + low]) + Math.abs(a[(low - 1) * (n + 1)]);
    if (Math.abs(a[low * n + low - 1]) <= ROUND_OFF * beside) {
      a[low * n + low - 1] = 0;
      break;
    }
  }
  return low;
}

/**
 * Larger modulus of the two eigenvalues of the 2×2 block at row k.
 * @param {Float64Array} a
 * @param {number} n
 * @param {number} k
 */
function pairModulus(a, n, k) {
  const at = k * n + k, half = (a[at] - a[at + n + 1]) / 2, across = a[at + 1] * a[at + n];
  const disc = half * half + across, mean = (a[at] + a[at + n + 1]) / 2;
  return disc < 0 ? Math.sqrt(mean * mean - disc) : Math.abs(mean) + Math.sqrt(disc);
}

/**
 * One QR step with two shifts at once on the block from `low` to `high`; `exceptional`: with other shifts.
 * @param {Float64Array} a
 * @param {number} n
 * @param {number} low
 * @param {number} high
 * @param {boolean} exceptional
 */
function francis(a, n, low, high, exceptional) {
  const at = (/** @type {number} */ i, /** @type {number} */ j) => a[i * n + j];
  let sum = at(high - 1, high - 1) + at(high, high);
  let product = at(high - 1, high - 1) * at(high, high) - at(high - 1, high) * at(high, high - 1);
  if (exceptional) {
    const size = Math.abs(at(high, high - 1)) + Math.abs(at(high - 1, high - 2));
    [sum, product] = [1.5 * size, size * size];
  }
  const next = at(low + 1, low);
  const bulge = Float64Array.of(
    at(low, low) * (at(low, low) - sum) + at(low, low + 1) * next + product,
    next * (at(low, low) + at(low + 1, low + 1) - sum),
    next * at(low + 2, low + 1),
  );
  for (let k = low; k < high; k++) {
    const rows = Math.min(3, high - k + 1);
    const v = k === low ? mirror(bulge, 0, 1, rows) : mirror(a, k * n + k - 1, n, rows);
    if (v) reflect(a, n, v, k, Math.max(k - 1, low), high + 1, Math.min(k + 4, high + 1), low);
  }
}

/**
 * The vector v, |v|² = 2, whose reflection 1 − vvᵀ takes `count` numbers, `stride` apart, to the first alone.
 * @param {Float64Array} values
 * @param {number} first
 * @param {number} stride
 * @param {number} count
 */
function mirror(values, first, stride, count) {
  let square = 0;
  for (let i = 0; i < count; i++) square += values[first + i * stride] ** 2;
  if (square === 0) return null;
  const lead = values[first], size = Math.sqrt(square), top = lead + (lead < 0 ? -size : size);
  const scale = Math.sqrt(1 / (size * Math.abs(top)));
  const v = new Float64Array(count);
  for (let i = 0; i < count; i++) v[i] = scale * (i ? values[first + i * stride] : top);
  return v;
}

/**
 * a ← (1 − vvᵀ) a (1 − vvᵀ), v at rows from `row` on: columns from `left` to `right`, rows from `upper` to `lower`.
 * @param {Float64Array} a
 * @param {number} n
 * @param {Float64Array} v
 * @param {number} row
 * @param {number} left
 * @param {number} right
 * @param {number} lower
 * @param {number} [upper]
 */
function reflect(a, n, v, row, left, right, lower, upper = 0) {
  for (let j = left; j < right; j++) {
    let sum = 0;
    for (let i = 0; i < v.length; i++) sum += v[i] * a[(row + i) * n + j];
    for (let i = 0; i < v.length; i++) a[(row + i) * n + j] -= sum * v[i];
  }
  for (let i = upper; i < lower; i++) {
    let sum = 0;
    for (let j = 0; j < v.length; j++) sum += a[i * n + row + j] * v[j];
    for (let j = 0; j < v.length; j++) a[i * n + row + j] -= sum * v[j];
  }
}
