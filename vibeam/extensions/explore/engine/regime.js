// One regime of a system: free, at a stop that holds or pushes, or at the second one. Its blocks come with the model;
// constants go with the gap, tables with the drive.
import { fillPairs, regimeArrays } from "./linear.js";

/** @import { Slots } from "./slots.js" */
/** @typedef {"pairs" | "blocks" | "into" | "outof" | "held" | "signals"} Part */
/**
 * A regime at the model's own gap, arrays in C order, and what a metre more adds to the constants of its blocks (2, m),
 * to what is held (n,) and to the constants of its signals.
 * @typedef {Record<Part, Float64Array> & {share: Record<"constants" | "held" | "signals", Float64Array>}} RegimeModel
 */

const PARTS = /** @type {const} */ (["pairs", "blocks", "into", "outof", "held", "signals"]);

/** A regime as the kernels' arrays. */
export class PackedRegime {
  /**
   * @param {Slots} slots
   * @param {RegimeModel} given
   * @param {number} n modes
   */
  constructor(slots, given, n) {
    this.slots = slots;
    this.m = given.pairs.length / slots.rows.layout.PAIR_ROWS;
    this.arrays = regimeArrays(slots, n, this.m);
    this.given = given;
    this.take(given);
  }

  /**
   * Take the blocks of other damping, as they are at the model's own gap.
   * @param {RegimeModel} given
   */
  take(given) {
    this.given = given;
    for (const name of PARTS) this.arrays[name].data.set(given[name]);
  }

  /**
   * Take the constants of a gap that is `more` metres larger than the model's own.
   * @param {number} more
   */
  widen(more) {
    const { m, given, given: { share }, slots: { rows: { layout } } } = this, width = 2 * m + 2;
    const added = share.constants;
    const blocks = this.arrays.blocks.data, held = this.arrays.held.data, signals = this.arrays.signals.data;
    [layout.CONSTANT1, layout.CONSTANT2].forEach((row, half) => {
      for (let k = row * m; k < row * m + m; k++) blocks[k] = given.blocks[k] + more * added[k + (half - row) * m];
    });
    for (let k = 0; k < held.length; k++) held[k] = given.held[k] + more * share.held[k];
    for (let i = 0; i < layout.SIGNALS; i++) {
      const at = (i + 1) * width - 2;
      signals[at] = given.signals[at] + more * share.signals[i];
    }
  }

  /**
   * Fill levels and tables for panels of 2^top s and shorter.
   * @param {number} top
   */
  tabulate(top) {
    const { slots, m, given: { pairs }, slots: { rows: { layout } } } = this;
    const row = (/** @type {number} */ place) => pairs.slice(place * m, (place + 1) * m);
    fillPairs(slots, this.arrays, row(layout.OMEGA), row(layout.SIGMA), row(layout.DISC), top);
  }

  /**
   * True where the last motion carried modes along without their steady response.
   * @returns {boolean}
   */
  carries() {
    const { m, slots: { rows: { layout } } } = this, at = layout.CARRIED * m;
    return this.arrays.blocks.data.subarray(at, at + m).some((each) => each !== 0);
  }
}
