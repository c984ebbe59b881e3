// The system held on its stop: blocks of z'' + Dz' + Λz = −w f with w·z = 0, D and Λ diagonal.
// Held modes are the roots λ of Σ w²/(λ² + dλ + Λ) = 0 and z = w/(λ² + dλ + Λ), so that no matrix is inverted: the left
// vector that takes a state to its share of such a mode is (−Λz/λ, z), which nothing that moves the contact point with
// the least energy, w/Λ, has a part in. Undamped roots lie one between each two of the modes; damping moves them on.
import { ascending, rates } from "./linear.js";
import { dampedRoot, undampedRoot } from "./roots.js";
import { after } from "./segments.js";

/** @import { Planes } from "./linear.js" */
/** @typedef {{omega: Float64Array, sigma: Float64Array, contact: Float64Array}} Modes */
/** @typedef {{outof: Float64Array[], into: Float64Array[], block: [number, number, number, number], mode: number}} Block */

const FURTHEST = 128; // binary orders by which the unit of time is moved at most
const PROPORTIONAL = 1e-9; // modal damping of a finite-element model has that much round-off
const TURNING = 0.1; // least 2 Im λ / |λ| of a held mode that has a plane of its own
const CLOSED = 1e-9; // by which sum and product of all roots may miss what they are known to be

/**
 * Blocks of the system held on its stop; modes in the kernels' order.
 * Throws a sentence where a held mode does not oscillate by itself, or two of them coincide.
 * @param {Modes} modes
 * @returns {Planes}
 */
export function heldPlanes(modes) {
  const { omega, contact } = modes, n = omega.length, scale = scales(modes);
  const active = ascending(omega).filter((k) => contact[k] !== 0);
  const of = (/** @type {Float64Array} */ values) => Float64Array.from(active, (k) => values[k]);
  const part = { omega: of(omega), sigma: of(modes.sigma), contact: of(contact), scale: of(scale) };
  const found = active.length < 2 ? [] : isProportional(part) ? undisturbed(part) : turning(part);
  for (const block of found) block.outof = block.outof.map((each) => spread(each, active, n));
  for (const block of found) block.into = block.into.map((each) => spread(each, active, n));
  for (let k = 0; k < n; k++) if (contact[k] === 0) found.push(alone(modes, scale[k], k));
  return sorted(found, n, scale);
}

/**
 * Square roots of the stiffnesses; of a mode without, the power of two above the system's fastest rate.
 * @param {Modes} modes
 * @returns {Float64Array}
 */
function scales({ omega, sigma }) {
  const fastest = Math.max(...omega, ...sigma);
  const unit = 2 ** Math.max(-FURTHEST, Math.min(FURTHEST, Math.floor(Math.log2(fastest)) + 1));
  return omega.map((own) => (own > 0 ? own : unit));
}

/**
 * True where D = a + bΛ to round-off: it couples nothing when held.
 * @param {Modes} part
 * @returns {boolean}
 */
function isProportional({ omega, sigma }) {
  const last = omega.length - 1, [low, high] = [omega[0] * omega[0], omega[last] * omega[last]];
  if (low === high) return sigma.every((each) => each === sigma[0]);
  const slope = (2 * (sigma[last] - sigma[0])) / (high - low);
  return sigma.every((each, k) => {
    const off = 2 * sigma[0] + slope * (omega[k] * omega[k] - low) - 2 * each;
    return Math.abs(off) <= PROPORTIONAL * 2 * each;
  });
}

/**
 * Planes of the held system without damping, which couples none of them.
 * @param {Modes & {scale: Float64Array}} part
 * @returns {Block[]}
 */
function undisturbed({ omega, sigma, contact, scale }) {
  const n = omega.length, found = [];
  for (let i = 0; i + 1 < n; i++) {
    const { value, shape } = undampedRoot(omega, contact, i);
    const size = Math.hypot(...shape), unit = shape.map((each) => each / size);
    const stretched = unit.map((each, k) => scale[k] * each), length = Math.hypot(...stretched);
    const damping = unit.reduce((sum, each, k) => sum + 2 * sigma[k] * each * each, 0);
    const zero = new Float64Array(n);
    found.push(/** @type {Block} */ ({
      outof: [after(stretched.map((each) => each / length), zero), after(zero, unit)],
      into: [after(unit.map((each, k) => ((omega[k] * omega[k]) / scale[k]) * each * (length / value)), zero), after(zero, unit)],
      block: [0, length, -value / length, -damping], mode: -1,
    }));
  }
  return found;
}

/**
 * A plane for each pair of conjugate roots: columns Re v and Im v of unit length, the phase of v such that they are
 * orthogonal; A (Re v, Im v) = (Re v, Im v) (a b; −b a).
 * @param {Modes & {scale: Float64Array}} part
 * @returns {Block[]}
 */
function turning(part) {
  const { omega, contact } = part, found = [];
  for (let i = 0; i + 1 < omega.length; i++) {
    const root = dampedRoot(part, undampedRoot(omega, contact, i));
    if (!root || !(2 * root.im > TURNING * Math.hypot(root.re, root.im)))
      throw new Error("With so much damping a mode held on the stop does not oscillate by itself: take less damping.");
    found.push(root);
  }
  requireAll(part, found);
  return found.map((root) => plane(part, root));
}

/**
 * Throw where a root was found twice: the sum of all is −tr D of the held system, their product follows from Σ w²/Λ.
 * @param {Modes} part
 * @param {{re: number, im: number}[]} roots
 */
function requireAll({ omega, sigma, contact }, roots) {
  const squares = contact.map((each) => each * each), mobility = squares.reduce((sum, each) => sum + each, 0);
  let trace = 0, size = 0, product = 0, soft = 0;
  const loose = omega.findIndex((each) => each === 0);
  omega.forEach((own, k) => {
    trace += 2 * sigma[k] * (1 - squares[k] / mobility);
    size += 2 * sigma[k] + own;
    if (k !== loose) product += 2 * Math.log(own);
    soft += loose < 0 ? squares[k] / (own * own) : 0;
  });
  product += Math.log((loose < 0 ? soft : squares[loose]) / mobility);
  const sum = roots.reduce((all, { re }) => all + 2 * re, 0);
  const sizes = roots.reduce((all, { re, im }) => all + 2 * Math.log(Math.hypot(re, im)), 0);
  if (!(Math.abs(sum + trace) <= CLOSED * size && Math.abs(sizes - product) <= CLOSED * omega.length * 100))
    throw new Error("Two modes held on the stop coincide so nearly that this page cannot tell them apart.");
}

/**
 * @param {Modes & {scale: Float64Array}} part
 * @param {import("./roots.js").Root} root
 * @returns {Block}
 */
function plane({ omega, scale }, { re, im, zRe, zIm }) {
  const n = omega.length, v = new Float64Array(2 * n), w = new Float64Array(2 * n);
  const l = new Float64Array(2 * n), o = new Float64Array(2 * n), size = re * re + im * im;
  let normRe = 0, normIm = 0, square = 0, turn = 0;
  for (let k = 0; k < n; k++) {
    const [x, y] = [zRe[k], zIm[k]], soft = (omega[k] * omega[k]) / scale[k] / size;
    [v[k], w[k]] = [scale[k] * x, scale[k] * y];
    [v[n + k], w[n + k]] = [re * x - im * y, re * y + im * x];
    [l[k], o[k]] = [-soft * (x * re + y * im), -soft * (y * re - x * im)];
    [l[n + k], o[n + k]] = [x, y];
  }
  for (let i = 0; i < 2 * n; i++) {
    normRe += l[i] * v[i] - o[i] * w[i];
    normIm += l[i] * w[i] + o[i] * v[i];
    square += v[i] * v[i] - w[i] * w[i];
    turn += 2 * v[i] * w[i];
  }
  const half = -0.5 * Math.atan2(turn, square), [c, s] = [Math.cos(half), Math.sin(half)];
  const first = v.map((each, i) => c * each - s * w[i]), second = v.map((each, i) => c * w[i] + s * each);
  const [long, wide] = [Math.hypot(...first), Math.hypot(...second)], ratio = long / wide;
  // a state's share of v e^{i half} is l·y / (norm e^{i half}), of both conjugates twice its real part
  const [dRe, dIm] = [normRe * c - normIm * s, normRe * s + normIm * c], over = 2 / (dRe * dRe + dIm * dIm);
  return {
    outof: [first.map((each) => each / long), second.map((each) => each / wide)],
    into: [
      l.map((each, i) => long * over * (each * dRe + o[i] * dIm)), l.map((each, i) => -wide * over * (o[i] * dRe - each * dIm)),
    ],
    block: [re, im * ratio, -im / ratio, re], mode: -1,
  };
}

/**
 * A mode that the stop does not know.
 * @param {Modes} modes
 * @param {number} scale
 * @param {number} k
 * @returns {Block}
 */
function alone({ omega, sigma }, scale, k) {
  const n = omega.length, first = new Float64Array(2 * n), second = new Float64Array(2 * n);
  first[k] = second[n + k] = 1;
  const block = /** @type {[number, number, number, number]} */ ([0, scale, -(omega[k] * omega[k]) / scale, -2 * sigma[k]]);
  return { outof: [first, second], into: [first, second], block, mode: k };
}

/**
 * Values (2a,) of the active modes among all (2n,).
 * @param {Float64Array} values
 * @param {number[]} active
 * @param {number} n
 * @returns {Float64Array}
 */
function spread(values, active, n) {
  const all = new Float64Array(2 * n);
  active.forEach((k, i) => {
    all[k] = values[i];
    all[n + k] = values[active.length + i];
  });
  return all;
}

/**
 * Blocks by rate, from energy coordinates (s z, z') to (z, z').
 * @param {Block[]} found
 * @param {number} n
 * @param {Float64Array} scale
 * @returns {Planes}
 */
function sorted(found, n, scale) {
  const m = found.length, turned = found.map(({ block: [a, b, c, d] }) => Math.sqrt(Math.max(a * d - b * c, 0)));
  const damped = found.map(({ block: [a, , , d] }) => Math.max(-(a + d) / 2, 0));
  const order = ascending(rates(Float64Array.from(turned), Float64Array.from(damped)));
  const planes = {
    into: new Float64Array(4 * m * n), outof: new Float64Array(4 * m * n), blocks: new Float64Array(4 * m),
    mode: new Float64Array(m),
  };
  order.forEach((from, k) => {
    const { into, outof, block, mode } = found[from];
    block.forEach((each, i) => { planes.blocks[i * m + k] = each; });
    planes.mode[k] = mode;
    for (let side = 0; side < 2; side++)
      for (let i = 0; i < 2 * n; i++) {
        const size = i < n ? scale[i] : 1;
        planes.into[(2 * k + side) * 2 * n + i] = into[side][i] * size;
        planes.outof[i * 2 * m + 2 * k + side] = outof[side][i] / size;
      }
  });
  return planes;
}
