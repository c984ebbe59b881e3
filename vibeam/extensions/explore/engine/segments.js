// Segments of a motion, flights and rests one after another, and what is read off them and off a steady point.

/** @import { SteadyPoint } from "./types.d.ts" */
/** @typedef {Record<string, number>} Layout */
/**
 * Rows of a trace (count, columns) and first poses (count, 2, n) in the kernels' order of modes; `size` of the motion.
 * @typedef {{trace: Float64Array, poses: Float64Array, count: number, columns: number, size: number}} Segments
 */

/**
 * Impacts [time, contact velocity before], s and m/s; a time is that at which the next segment begins, to the bit.
 * @param {Layout} layout
 * @param {Segments} segments
 * @returns {[number, number][]}
 */
export function impactsOf(layout, { trace, count, columns }) {
  /** @type {[number, number][]} */
  const found = [];
  for (let i = 0; i < count; i++) {
    const at = i * columns;
    if (![layout.IMPACT, layout.CHATTER, layout.STUCK].includes(trace[at + layout.END])) continue;
    const time = i + 1 < count ? trace[at + columns + layout.START] : trace[at + layout.START] + trace[at + layout.DURATION];
    found.push([time, trace[at + layout.BEFORE]]);
  }
  return found;
}

/**
 * What flight/readout.py reads off a steady point that was watched over `hold` periods of `turn` s.
 * @param {Layout} layout
 * @param {Float64Array} result
 * @param {{period: number, hold: number, turn: number, gap: number}} watched
 * @returns {SteadyPoint}
 */
export function readPoint(layout, result, { period, hold, turn, gap }) {
  const high = result[layout.HIGH], low = result[layout.LEAST], struck = result[layout.STRUCK], rest = result[layout.REST_TIME];
  return {
    amplitude: (high - low) / 2, maximum: high, minimum: low, reach: gap - result[layout.CONTACT_LEAST],
    impactsPerPeriod: struck / hold, impactVelocity: struck > 0 ? result[layout.SPEED_SUM] / struck : NaN,
    period: struck + rest > 0 ? period : -1, rest: rest / (hold * turn),
  };
}

/**
 * What is read off a point that did not run to its end.
 * @returns {SteadyPoint}
 */
export function unread() {
  return {
    amplitude: NaN, maximum: NaN, minimum: NaN, reach: NaN, impactsPerPeriod: NaN, impactVelocity: NaN, period: 0, rest: NaN,
  };
}

/**
 * @param {Float64Array} first
 * @param {Float64Array} second
 * @returns {Float64Array}
 */
export function after(first, second) {
  if (!first.length) return second.slice();
  const both = new Float64Array(first.length + second.length);
  both.set(first);
  both.set(second, first.length);
  return both;
}

/**
 * The last segment that begins at a time or before.
 * @param {Float64Array} trace
 * @param {number} columns
 * @param {number} start
 * @param {number} count
 * @param {number} time
 * @returns {number}
 */
export function place(trace, columns, start, count, time) {
  let [low, high] = [0, count];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (trace[middle * columns + start] <= time) low = middle;
    else high = middle;
  }
  return low;
}
