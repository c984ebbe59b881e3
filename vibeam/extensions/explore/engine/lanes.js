// The free modes once more, in blocks of as many as go side by side in the lanes: packing.lay_out.

/** @import { SlotArray, Slots } from "./slots.js" */
/** @typedef {Record<string, SlotArray>} Arrays */

/**
 * True where flights cannot go by the lanes: a mode takes no part in the contact, one far beyond critical damping
 * lingers, or damped impacts may go on without end.
 * @param {Slots} slots
 * @param {Arrays} engine pairs, levels, modes and drive, filled
 * @returns {boolean}
 */
export function beyondLanes({ rows: { layout } }, { pairs, levels, modes, drive }) {
  const [, n] = pairs.shape, own = pairs.data, longest = levels.data[layout.STEP * layout.LEVELS];
  const elastic = 1 - drive.data[layout.RESTITUTION] < layout.ELASTIC;
  for (let k = 0; k < n; k++) {
    const slow = own[layout.SLOW * n + k];
    if (Math.abs(modes.data[layout.CONTACT * n + k]) < layout.SILENT) return true;
    if (slow > 0 && slow * longest < layout.LINGERING) return true;
    if (elastic && own[layout.SIGMA * n + k] > 0) return true;
  }
  return false;
}

/**
 * Fill `cells` and `rungs` of a packed system.
 * @param {Slots} slots
 * @param {Arrays} engine
 * @param {number} width lanes
 */
export function layOut({ rows: { layout, lanes } }, engine, width) {
  const [, n] = engine.pairs.shape, blocks = Math.ceil(n / width), pairs = engine.pairs.data;
  const modes = engine.modes.data, mobility = engine.drive.data[layout.MOBILITY];
  const table = engine.table.data, levels = engine.levels.data, count = layout.LEVELS;
  const cells = engine.cells.data.fill(0), rungs = engine.rungs.data.fill(0);
  const pair = (/** @type {number} */ row, /** @type {number} */ k) => pairs[row * n + k];
  const cell = (/** @type {number} */ row, /** @type {number} */ k) =>
    (Math.floor(k / width) * lanes.CELL_ROWS + row) * width + (k % width);
  const rung = (/** @type {number} */ level, /** @type {number} */ row, /** @type {number} */ k) =>
    ((level * blocks + Math.floor(k / width)) * lanes.RUNG_ROWS + row) * width + (k % width);
  for (let k = 0; k < n; k++) {
    const turn = Math.sqrt(Math.max(-pair(layout.DISC, k), 0)), kappa = pair(layout.KAPPA, k);
    const contact = modes[layout.CONTACT * n + k], omega = pair(layout.OMEGA, k), square = kappa * kappa;
    cells[cell(lanes.RATE, k)] = pair(layout.SIGMA, k);
    cells[cell(lanes.TURN, k)] = turn;
    cells[cell(lanes.TURN_INVERSE, k)] = turn > 0 ? 1 / turn : 0;
    cells[cell(lanes.DAMP, k)] = 2 * pair(layout.SIGMA, k);
    cells[cell(lanes.SPRING, k)] = omega * omega;
    cells[cell(lanes.NORM, k)] = pair(layout.INVERSE, k);
    cells[cell(lanes.KICK, k)] = (contact * contact) / mobility;
    cells[cell(lanes.PUT, k)] = contact * modes[layout.YIELD * n + k];
    cells[cell(lanes.K1, k)] = kappa;
    cells[cell(lanes.K2, k)] = square;
    cells[cell(lanes.K4, k)] = square * square;
    cells[cell(lanes.K5, k)] = square * square * kappa;
    for (let level = 0; level < count; level++) {
      for (let row = lanes.P00; row <= lanes.V1; row++)
        rungs[rung(level, row, k)] = table[(row * count + level) * n + k];
      const low = k < levels[layout.COUNT * count + level], h = levels[layout.STEP * count + level], h4 = h * h * (h * h);
      rungs[rung(level, lanes.LOW, k)] = low ? 1 : 0;
      rungs[rung(level, lanes.MISSED, k)] = low ? (square * square * h4) / 384 : 1;
      rungs[rung(level, lanes.MISSED_FIRST, k)] = low ? (square * square * kappa * h4) / (384 * 5) : kappa;
    }
  }
  for (let block = 0; block < blocks; block++) {
    let slowest = Infinity, mixed = 0;
    for (let k = block * width; k < Math.min(n, (block + 1) * width); k++) {
      slowest = Math.min(slowest, pair(layout.DECAY, k));
      if (pair(layout.DISC, k) >= 0) mixed = 1;
    }
    for (let k = block * width; k < (block + 1) * width; k++) {
      cells[cell(lanes.SLOWEST, k)] = slowest;
      cells[cell(lanes.MIXED, k)] = mixed;
    }
  }
}
