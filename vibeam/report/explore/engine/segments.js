// Segments of a motion, flights and rests one after another, and what is read off them and off a steady point.

/** @typedef {Record<string, number>} Layout */
/**
 * Rows of a trace (count, columns) and first poses (count, 2, n) in the kernels' order of modes; `size` of the motion.
 * @typedef {{trace: Float64Array, poses: Float64Array, count: number, columns: number, size: number}} Segments
 */

/**
 * True where a segment ends with an impact.
 * @param {Layout} layout
 * @param {number} end
 * @returns {boolean}
 */
function isImpact({ IMPACT, CHATTER, STUCK }, end) {
  return end === IMPACT || end === CHATTER || end === STUCK;
}

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
    if (!isImpact(layout, trace[at + layout.END])) continue;
    const time = i + 1 < count ? trace[at + columns + layout.START] : trace[at + layout.START] + trace[at + layout.DURATION];
    found.push([time, trace[at + layout.BEFORE]]);
  }
  return found;
}

/**
 * Begin, an accumulation of impacts completed, and end of each rest on the stop, s; those that take time.
 * @param {Layout} layout
 * @param {Segments} segments
 * @param {number} last end of the motion, s
 * @returns {[number, number][]}
 */
export function restsOf(layout, { trace, count, columns }, last) {
  /** @type {[number, number][]} */
  const found = [];
  for (let i = 0; i < count; i++) {
    const at = i * columns, before = at - columns;
    if (trace[at + layout.WHAT] !== layout.RESTING) continue;
    const waited = i > 0 && trace[before + layout.END] === layout.CHATTER ? trace[before + layout.LEFT] : 0;
    const end = i + 1 < count ? trace[at + columns + layout.START] : last;
    found.push([Math.min(trace[at + layout.START] + waited, end), end]);
  }
  return found;
}

/**
 * A steady point as it was watched over `hold` periods of `turn` s: what flight/readout.py reads off.
 * @typedef {object} SteadyPoint
 * @property {number} amplitude
 * @property {number} maximum
 * @property {number} minimum
 * @property {number} reach how far the contact swings from its stop, m
 * @property {number} impactsPerPeriod
 * @property {number} impactVelocity mean before impact, NaN without
 * @property {number} period in drive periods; 0: does not repeat, −1: no contact
 * @property {number} rest share of the time on the stop
 */

/**
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
