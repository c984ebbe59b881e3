// A linear regime in 2×2 blocks as the kernels' arrays: what flight/linear/block_regime.py does. Numbers of the
// layout come with the table of slots.

/** @import { SlotArray, Slots } from "./slots.js" */
/** @typedef {Record<string, SlotArray>} Arrays */
/**
 * The blocks y' = A y of a linear system, sorted by rate; see the tuple Regime for `into` and `outof`.
 * @typedef {object} Planes
 * @property {Float64Array} into (2m, 2n)
 * @property {Float64Array} outof (2n, 2m)
 * @property {Float64Array} blocks (4, m): A11, A12, A21, A22
 * @property {Float64Array} mode (m,) the mode that a block is alone, or −1
 */

const SMALLEST = 1e-300; // rad/s: slower is as good as free
const FASTEST = 1e36; // bounds take eighth powers of the rates
const SPARE = 4; // levels of panels shorter than the fastest rate needs

/**
 * κ = σ + √(σ² + ω²), (n,): every time derivative grows at most by it.
 * @param {Float64Array} omega rad/s
 * @param {Float64Array} sigma 1/s
 * @returns {Float64Array}
 */
export function rates(omega, sigma) {
  return omega.map((own, k) => sigma[k] + Math.sqrt(sigma[k] * sigma[k] + own * own));
}

/**
 * Places of the values in ascending order, equal ones as they stand.
 * @param {ArrayLike<number>} values
 * @returns {number[]}
 */
export function ascending(values) {
  return Array.from(values, (_, k) => k).sort((a, b) => values[a] - values[b] || a - b);
}

/**
 * Level of the longest panels, 2**level s: for the slowest rate, but so that the shortest resolve the fastest.
 * @param {Record<string, number>} layout
 * @param {number} slowest rad/s
 * @param {number} fastest rad/s
 * @returns {number}
 */
export function topLevel(layout, slowest, fastest) {
  if (!(fastest < FASTEST && slowest > 1 / FASTEST))
    throw new Error(`Rates from ${slowest.toPrecision(4)} to ${fastest.toPrecision(4)} rad/s: take another unit of time.`);
  const longest = Math.floor(Math.log2(layout.PANEL / slowest));
  if (!(fastest > 1 / FASTEST)) return longest;
  return Math.min(longest, Math.floor(Math.log2(layout.RESOLVED / fastest)) + layout.LEVELS - SPARE);
}

/**
 * Arrays of a regime of m blocks of n modes.
 * @param {Slots} slots
 * @param {number} n
 * @param {number} m
 * @returns {Arrays}
 */
export function regimeArrays(slots, n, m) {
  const { layout } = slots.rows, made = (/** @type {number[]} */ ...shape) => slots.array("f8", shape);
  return {
    pairs: made(layout.PAIR_ROWS, m), table: made(layout.TABLE_ROWS, layout.LEVELS, m),
    levels: made(layout.LEVEL_ROWS, layout.LEVELS), signal: made(layout.SIGNAL_ROWS),
    attached: made(layout.ATTACHED_ROWS, m), blocks: made(layout.BLOCK_ROWS, m), into: made(2 * m, 2 * n),
    outof: made(2 * n, 2 * m), held: made(n), signals: made(layout.SIGNALS, 2 * m + 2),
    terms: made(2, 2 * m + 2, 2 + n),
  };
}

/**
 * Fill `pairs`, `levels` and `table` of pairs sorted by rate; panels of 2^top s.
 * @param {Slots} slots
 * @param {Arrays} target
 * @param {Float64Array} omega rad/s
 * @param {Float64Array} sigma 1/s
 * @param {Float64Array} disc σ² − ω²
 * @param {number} top
 */
export function fillPairs(slots, target, omega, sigma, disc, top) {
  const { layout } = slots.rows, n = omega.length, kappa = rates(omega, sigma);
  const pairs = target.pairs.data, levels = target.levels.data;
  pairs.fill(0);
  for (let k = 0; k < n; k++) {
    const over = sigma[k] + Math.sqrt(Math.max(disc[k], 0)), divisor = over > 0 ? over : 1;
    const slow = omega[k] * (omega[k] / divisor);
    const apart = disc[k] > layout.APART * (sigma[k] * sigma[k]) && slow > 0;
    const put = (/** @type {number} */ row, /** @type {number} */ value) => { pairs[row * n + k] = value; };
    put(layout.OMEGA, omega[k]);
    put(layout.SIGMA, sigma[k]);
    put(layout.DISC, disc[k]);
    put(layout.KAPPA, kappa[k]);
    put(layout.INVERSE, inverse(omega[k], over, disc[k]));
    put(layout.DECAY, disc[k] < 0 ? sigma[k] : (omega[k] * omega[k]) / divisor);
    put(layout.SLOW, apart ? slow : 0);
    put(layout.JOIN, apart ? 1 : 0);
    put(layout.TILT, apart ? -over : 1);
  }
  for (let level = 0; level < layout.LEVELS; level++) {
    const step = 2 ** (top - level);
    levels[layout.STEP * layout.LEVELS + level] = step;
    levels[layout.COUNT * layout.LEVELS + level] = kappa.filter((each) => each * step <= layout.RESOLVED).length;
  }
  slots.call("tables.tabulate", { pairs: target.pairs, levels: target.levels, table: target.table });
}

/**
 * Factor of x' with which the norm of (x, x') bounds |x| for all later times.
 * @param {number} omega
 * @param {number} over
 * @param {number} disc
 * @returns {number}
 */
function inverse(omega, over, disc) {
  const energy = omega > SMALLEST ? 1 / omega : 0;
  return Math.min(energy, disc > 0 ? (1 + Math.SQRT2) / (over > 0 ? over : 1) : Infinity);
}

/**
 * Fill what a regime has of its blocks, whatever acts on it.
 * @param {Slots} slots
 * @param {Arrays} target
 * @param {Planes} planes
 * @param {number} top
 */
export function fillPlanes(slots, target, planes, top) {
  const { layout } = slots.rows, m = planes.mode.length, a = planes.blocks, blocks = target.blocks.data;
  target.into.data.set(planes.into);
  target.outof.data.set(planes.outof);
  blocks.fill(0);
  blocks.set(a, layout.A11 * m);
  blocks.set(planes.mode, layout.MODE * m);
  const omega = new Float64Array(m), sigma = new Float64Array(m), disc = new Float64Array(m);
  for (let k = 0; k < m; k++) {
    const [a11, a12, a21, a22] = [a[k], a[m + k], a[2 * m + k], a[3 * m + k]], half = (a11 - a22) / 2;
    omega[k] = Math.sqrt(Math.max(a11 * a22 - a12 * a21, 0));
    sigma[k] = Math.max(-(a11 + a22) / 2, 0);
    disc[k] = half * half + a12 * a21;
  }
  fillPairs(slots, target, omega, sigma, disc, top);
}

/**
 * Fill what acts on a regime: z'' + Dz' + Λz = constant + load Ω²B sin φ about the displacement `held`.
 * @param {Slots} slots
 * @param {Arrays} target
 * @param {Float64Array} held (n,)
 * @param {Float64Array} constant (n,)
 * @param {Float64Array} load (n,)
 */
export function fillInputs(slots, target, held, constant, load) {
  const { layout } = slots.rows, n = held.length, [, m] = target.blocks.shape;
  const into = target.into.data, blocks = target.blocks.data;
  target.held.data.set(held);
  for (let row = 0; row < 2 * m; row++) {
    let still = 0, driven = 0;
    for (let k = 0; k < n; k++) {
      still += into[row * 2 * n + n + k] * constant[k];
      driven += into[row * 2 * n + n + k] * load[k];
    }
    const place = row >> 1, second = row & 1;
    blocks[(second ? layout.CONSTANT2 : layout.CONSTANT1) * m + place] = still;
    blocks[(second ? layout.LOAD2 : layout.LOAD1) * m + place] = driven;
  }
}

/**
 * Make (at·(η − held) + rate·η') / over + constant + load Ω²B sin φ the signal `place` of a regime.
 * @param {Arrays} target
 * @param {number} place
 * @param {{at: Float64Array, rate?: Float64Array, constant?: number, load?: number, over?: number}} row
 */
export function fillSignal(target, place, { at, rate, constant = 0, load = 0, over = 1 }) {
  const n = at.length, [, width] = target.signals.shape, columns = width - 2;
  const signals = target.signals.data, outof = target.outof.data;
  for (let column = 0; column < columns; column++) {
    let sum = 0;
    for (let k = 0; k < n; k++) {
      sum += at[k] * outof[k * columns + column];
      if (rate) sum += rate[k] * outof[(n + k) * columns + column];
    }
    signals[place * width + column] = sum / over;
  }
  signals[place * width + columns] = constant;
  signals[place * width + columns + 1] = load;
}

/**
 * Make row·η the regime's output.
 * @param {Slots} slots
 * @param {Arrays} target
 * @param {Float64Array} row (n,)
 */
export function fillOutput(slots, target, row) {
  const held = target.held.data, constant = row.reduce((sum, weight, k) => sum + weight * held[k], 0);
  fillSignal(target, slots.rows.layout.OUTPUT_SIGNAL, { at: row, constant });
}
