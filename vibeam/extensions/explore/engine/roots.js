// Roots of the secular equation of a held system, each by its distance from the mode that moves most in it, so that
// one close to a mode's own is no small difference (as linear/eigenpairs.py). Modes by ascending ω, none silent.

/** @typedef {{value: number, shape: Float64Array}} Undamped λ² = −value, and z */
/** @typedef {{re: number, im: number, zRe: Float64Array, zIm: Float64Array}} Root λ and z */

const ROUNDS = 100, TINY = 4e-16, SURE = 1e-12;
const STEP = 0.1; // of the damping ratio from one set of roots to the next

/**
 * Root of Σ w²/(Λ − value) = 0 between the squares of mode i and the next: Newton's steps within bounds.
 * @param {Float64Array} omega
 * @param {Float64Array} contact
 * @param {number} i
 * @returns {Undamped}
 */
export function undampedRoot(omega, contact, i) {
  const apart = (/** @type {number} */ k, /** @type {number} */ j) => (omega[k] - omega[j]) * (omega[k] + omega[j]);
  const width = apart(i + 1, i);
  if (!(width > 0)) throw new Error("Two modes coincide: this page cannot hold them on the stop.");
  const middle = sums(omega, contact, i, width / 2, -1);
  const near = middle.sum > 0 ? i : i + 1;
  let [low, high] = near === i ? [0, width / 2] : [-width / 2, 0];
  const square = contact[near] * contact[near];
  let tau = (low + high) / 2;
  for (let round = 0; round < ROUNDS; round++) {
    const { sum, slope } = sums(omega, contact, near, tau, near);
    const value = tau * sum - square; // ascends through the root; the pole of `near` is taken out
    if (value > 0 === (near === i)) high = tau;
    else low = tau;
    let next = tau - value / (sum + tau * slope);
    if (!(next > low && next < high)) next = (low + high) / 2;
    const change = Math.abs(next - tau);
    tau = next;
    if (change <= TINY * Math.abs(tau)) break;
  }
  const shape = omega.map((_, k) => (k === near ? -contact[k] / tau : contact[k] / (apart(k, near) - tau)));
  return { value: omega[near] * omega[near] + tau, shape };
}

/**
 * Σ w²/(Λ − Λ_near − τ) without one mode, and its slope.
 * @param {Float64Array} omega
 * @param {Float64Array} contact
 * @param {number} near
 * @param {number} tau
 * @param {number} without
 * @returns {{sum: number, slope: number}}
 */
function sums(omega, contact, near, tau, without) {
  let sum = 0, slope = 0;
  for (let k = 0; k < omega.length; k++) {
    if (k === without) continue;
    const part = contact[k] / ((omega[k] - omega[near]) * (omega[k] + omega[near]) - tau);
    sum += contact[k] * part;
    slope += part * part;
  }
  return { sum, slope };
}

/**
 * The root that an undamped one becomes, damping added bit by bit; null where it is lost on the way.
 * @param {{omega: Float64Array, sigma: Float64Array, contact: Float64Array}} part
 * @param {Undamped} start
 * @returns {Root | null}
 */
export function dampedRoot({ omega, sigma, contact }, { value, shape }) {
  const most = sigma.reduce((worst, each, k) => Math.max(worst, each / omega[k] || 0), 0);
  const steps = Math.max(1, Math.ceil(most / STEP));
  if (!(steps * STEP < 100)) return null;
  let weight = 0, braked = 0;
  for (let k = 0; k < omega.length; k++) {
    weight += shape[k] * shape[k];
    braked += sigma[k] * shape[k] * shape[k];
  }
  const half = braked / weight / steps;
  const heavy = shape.map((each, k) => each * each * (omega[k] * omega[k] + value));
  /** @type {Root | null} */
  let root = { re: -half, im: Math.sqrt(Math.max(value - half * half, 0)), zRe: heavy, zIm: heavy.map(() => 0) };
  let near = heavy.indexOf(Math.max(...heavy));
  for (let step = 1; step <= steps && root; step++) {
    root = newton(omega, sigma.map((each) => (each * step) / steps), contact, root, near);
    if (root) near = heaviest(omega, root);
  }
  return root;
}

/**
 * The mode that has most energy in a root's shape.
 * @param {Float64Array} omega
 * @param {Root} root
 * @returns {number}
 */
function heaviest(omega, { re, im, zRe, zIm }) {
  const heavy = omega.map((own, k) => (zRe[k] * zRe[k] + zIm[k] * zIm[k]) * (own * own + re * re + im * im));
  return heavy.indexOf(Math.max(...heavy));
}

/**
 * Newton's steps on p_j + w_j²/h = 0, h = Σ_{k≠j} w_k²/p_k, for the distance ν of λ from j's own root,
 * p_j = ν (ν + 2 root_j).
 * @param {Float64Array} omega
 * @param {Float64Array} sigma
 * @param {Float64Array} contact
 * @param {Root} from
 * @param {number} j
 * @returns {Root | null}
 */
function newton(omega, sigma, contact, from, j) {
  const n = omega.length, turn = (omega[j] - sigma[j]) * (omega[j] + sigma[j]);
  const [rootRe, rootIm] = turn >= 0 ? [0, Math.sqrt(turn)] : [Math.sqrt(-turn), 0];
  let nuRe = from.re + sigma[j] - rootRe, nuIm = from.im - rootIm, re = from.re, im = from.im, sure = false;
  const gainRe = new Float64Array(n), gainIm = new Float64Array(n), square = contact[j] * contact[j];
  for (let round = 0; ; round++) {
    let hRe = 0, hIm = 0, cRe = 0, cIm = 0;
    const pRe = nuRe * (nuRe + 2 * rootRe) - nuIm * (nuIm + 2 * rootIm);
    const pIm = nuRe * (nuIm + 2 * rootIm) + nuIm * (nuRe + 2 * rootRe);
    for (let k = 0; k < n; k++) {
      if (k === j) continue;
      const further = 2 * (sigma[k] - sigma[j]), stiffer = (omega[k] - omega[j]) * (omega[k] + omega[j]);
      const x = pRe + further * re + stiffer, y = pIm + further * im, size = x * x + y * y;
      const [a, b] = [(contact[k] * x) / size, (-contact[k] * y) / size];
      gainRe[k] = a;
      gainIm[k] = b;
      hRe += contact[k] * a;
      hIm += contact[k] * b;
      const [aa, ab] = [a * a - b * b, 2 * a * b], [u, v] = [2 * (re + sigma[k]), 2 * im];
      cRe -= aa * u - ab * v;
      cIm -= aa * v + ab * u;
    }
    const over = hRe * hRe + hIm * hIm, [iRe, iIm] = [hRe / over, -hIm / over]; // 1/h
    if (sure || round === ROUNDS) {
      if (!sure) return null;
      const zRe = gainRe.map((a, k) => -contact[j] * (a * iRe - gainIm[k] * iIm));
      const zIm = gainRe.map((a, k) => -contact[j] * (a * iIm + gainIm[k] * iRe));
      [zRe[j], zIm[j]] = [1, 0];
      return { re, im, zRe, zIm };
    }
    const [qRe, qIm] = [iRe * iRe - iIm * iIm, 2 * iRe * iIm]; // 1/h²
    const fRe = pRe + square * iRe, fIm = pIm + square * iIm;
    const rRe = 2 * (nuRe + rootRe) - square * (cRe * qRe - cIm * qIm);
    const rIm = 2 * (nuIm + rootIm) - square * (cRe * qIm + cIm * qRe), slope = rRe * rRe + rIm * rIm;
    const [sRe, sIm] = [(fRe * rRe + fIm * rIm) / slope, (fIm * rRe - fRe * rIm) / slope];
    const change = Math.hypot(sRe, sIm), size = Math.hypot(re, im);
    if (!(change <= size)) return null;
    nuRe -= sRe;
    nuIm -= sIm;
    re = rootRe - sigma[j] + nuRe;
    im = rootIm + nuIm;
    sure = change <= TINY * size || (round > 8 && change <= SURE * size);
  }
}
