// Modes that follow an oscillator which nothing moves: their steady response to it, and the blocks of the system held
// on its stop, where they follow so that the contact stays. (Python finds these blocks as eigenvectors.)
import { heldPlanes } from "./held.js";
import { ascending, rates } from "./linear.js";

/** @import { Planes } from "./linear.js" */
/** @import { PlainModel } from "./plain.js" */
/** @typedef {{re: Float64Array, im: Float64Array}} Phasors */
/**
 * A harmonic of a drive: its rate, rad/s; responses of the modes; its oscillator's phasor; whether the contact sees it.
 * @typedef {{rate: number, response: Phasors, re: number, im: number, seen: boolean}} Harmonic
 */
/** @typedef {{at: number, rate: number, follow: Phasors | null}} Carrier row of an oscillator, and what follows it */
/** @typedef {{into: Float64Array[], outof: Float64Array[], block: number[], mode: number, rate: number}} Block */

const NEAR = 1e-12; // |ω² − ν² + 2iζων| over ν² below which a mode has no steady response

/**
 * (ω² − ν² + 2iζων)⁻¹ of a force e^{i phase}; throws for an undamped mode that is there.
 * @param {Float64Array} omega
 * @param {Float64Array} zeta
 * @param {number} rate
 * @param {Float64Array} force
 * @param {number} phase
 * @returns {Phasors}
 */
export function answered(omega, zeta, rate, force, phase) {
  const found = { re: new Float64Array(omega.length), im: new Float64Array(omega.length) };
  omega.forEach((own, k) => {
    if (force[k] === 0) return;
    const real = (own - rate) * (own + rate), imaginary = 2 * zeta[k] * own * rate;
    const size = real * real + imaginary * imaginary, push = force[k] / size;
    if (Math.sqrt(size) <= NEAR * rate * rate)
      throw new Error("An undamped mode is at a harmonic of the drive, so that its motion grows without bound.");
    const [cosine, sine] = [push * Math.cos(phase), push * Math.sin(phase)];
    [found.re[k], found.im[k]] = [cosine * real + sine * imaginary, sine * real - cosine * imaginary];
  });
  return found;
}

/**
 * Phasor of an output.
 * @param {Float64Array} row
 * @param {Phasors} phasors
 */
export function along(row, { re, im }) {
  let [real, imaginary] = [0, 0];
  for (let k = 0; k < re.length; k++) {
    real += row[k] * re[k];
    imaginary += row[k] * im[k];
  }
  return { re: real, im: imaginary };
}

/**
 * Blocks of a system held on its stop whose modes from `n` on are oscillators, in the kernels' order.
 * @param {PlainModel} model
 * @param {number} n
 * @param {Harmonic[]} harmonics two oscillators each, the second unseen
 * @param {number} light contact row of an oscillator
 * @returns {Planes}
 */
export function heldWith(model, n, harmonics, light) {
  const own = model.omega.slice(0, n), contact = model.contact.slice(0, n), wide = model.omega.length;
  const sigma = own.map((each, k) => model.zeta[k] * each), plain = ascending(rates(own, sigma));
  const all = ascending(rates(model.omega, model.omega.map((each, k) => model.zeta[k] * each)));
  const pick = (/** @type {Float64Array} */ values) => Float64Array.from(plain, (k) => values[k]);
  const found = heldPlanes({ omega: pick(own), sigma: pick(sigma), contact: pick(contact) });
  const place = plain.map((k) => all.indexOf(k));
  const carriers = harmonics.flatMap(({ rate, seen }, j) => [0, 1].map((second) => {
    const give = seen && !second ? follow(answered(own, model.zeta, rate, contact, 0), contact, light) : null;
    return { at: all.indexOf(n + 2 * j + second), rate, follow: give && { re: pick(give.re), im: pick(give.im) } };
  }));
  const blocks = [
    ...Array.from(found.mode, (_, i) => widened(found, i, place, carriers, wide)),
    ...carriers.map((each) => oscillating(each, place, wide)),
  ];
  return joined(ascending(blocks.map(({ rate }) => rate)).map((i) => blocks[i]), wide);
}

/**
 * Displacements of the modes while an oscillator of unit displacement moves the held contact: −light/S.
 * @param {Phasors} give response to a unit force at the contact
 * @param {Float64Array} contact
 * @param {number} light
 * @returns {Phasors}
 */
function follow(give, contact, light) {
  const { re, im } = along(contact, give), share = light / (re * re + im * im), [fRe, fIm] = [-share * re, share * im];
  /** @param {number} own @param {number} other */
  const turned = (own, other) => give.re.map((each, k) => each * own + give.im[k] * other);
  return { re: turned(fRe, -fIm), im: turned(fIm, fRe) };
}

/**
 * The i-th block of the modes, which sees what is left of them when they follow the oscillators.
 * @param {Planes} found
 * @param {number} i
 * @param {number[]} place of each mode in the kernels' order
 * @param {Carrier[]} carriers
 * @param {number} wide
 * @returns {Block}
 */
function widened(found, i, place, carriers, wide) {
  const n = place.length, m = found.mode.length, block = [0, 1, 2, 3].map((row) => found.blocks[row * m + i]);
  const into = [0, 1].map((half) => {
    const row = new Float64Array(2 * wide), first = (2 * i + half) * 2 * n;
    const from = found.into.subarray(first, first + 2 * n);
    place.forEach((at, k) => { [row[at], row[wide + at]] = [from[k], from[n + k]]; });
    for (const { at, rate, follow: seen } of carriers) {
      for (let k = 0; seen && k < n; k++) {
        row[at] -= from[k] * seen.re[k] - from[n + k] * rate * seen.im[k];
        row[wide + at] -= (from[k] * seen.im[k]) / rate + from[n + k] * seen.re[k];
      }
    }
    return row;
  });
  const outof = [0, 1].map((half) => {
    const column = new Float64Array(2 * wide), from = 2 * i + half;
    place.forEach((at, k) => {
      [column[at], column[wide + at]] = [found.outof[k * 2 * m + from], found.outof[(n + k) * 2 * m + from]];
    });
    return column;
  });
  const [a, b, c, d] = block, mode = found.mode[i];
  const square = Math.max(a * d - b * c, 0), sigma = Math.max(-(a + d) / 2, 0);
  return { into, outof, block, mode: mode < 0 ? -1 : place[mode], rate: sigma + Math.sqrt(sigma * sigma + square) };
}

/**
 * The block (νz, z') of an oscillator, in which the modes follow it.
 * @param {Carrier} carrier
 * @param {number[]} place
 * @param {number} wide
 * @returns {Block}
 */
function oscillating({ at, rate, follow: seen }, place, wide) {
  const [first, second, third, fourth] = Array.from({ length: 4 }, () => new Float64Array(2 * wide));
  [first[at], second[wide + at], third[at], fourth[wide + at]] = [rate, 1, 1 / rate, 1];
  place.forEach((row, k) => {
    if (!seen) return;
    [third[row], fourth[row]] = [seen.re[k] / rate, seen.im[k] / rate];
    [third[wide + row], fourth[wide + row]] = [-seen.im[k], seen.re[k]];
  });
  return { into: [first, second], outof: [third, fourth], block: [0, rate, -rate, 0], mode: seen ? -1 : at, rate };
}

/**
 * @param {Block[]} blocks
 * @param {number} n
 * @returns {Planes}
 */
function joined(blocks, n) {
  const m = blocks.length, into = new Float64Array(4 * m * n), outof = new Float64Array(4 * m * n);
  blocks.forEach((each, i) => [0, 1].forEach((half) => {
    into.set(each.into[half], (2 * i + half) * 2 * n);
    each.outof[half].forEach((value, row) => { outof[row * 2 * m + 2 * i + half] = value; });
  }));
  return {
    into, outof, blocks: Float64Array.from({ length: 4 * m }, (_, at) => blocks[at % m].block[Math.floor(at / m)]),
    mode: Float64Array.from(blocks, ({ mode }) => mode),
  };
}
