// Event-driven motions of a packed system, plain or by regimes: what flight/event_driven.py does.
// Poses (2, n) are in the kernels' order of modes, states in the user's.
import { sizeOfMotion } from "./equilibrium.js";
import { after, place } from "./segments.js";

/** @import { SlotArray, Slots } from "./slots.js" */
/** @import { Modal } from "./equilibrium.js" */
/** @import { State } from "./types.d.ts" */
/** @import { Segments } from "./segments.js" */
/** @typedef {{omega: number, amplitude: number}} Drive rad/s, m */
/**
 * A system as the kernels' arrays: PackedSystem, or that of regimes.
 * @typedef {object} Packed
 * @property {Slots} slots
 * @property {Modal} model
 * @property {number} size
 * @property {{move: string, poses_at: string}} entries
 * @property {number} statusRows
 * @property {number} traceColumns
 * @property {number} gap
 * @property {number[]} order
 * @property {(motion: number) => Record<string, any>} engine
 * @property {() => State} equilibrium
 * @property {(pose: Float64Array, status: Float64Array, kind: number) => void} restart
 * @property {(name: string) => Float64Array} output
 * @property {() => boolean} carries
 * @property {Record<string, SlotArray>} spare what `poses_at` needs besides
 */
/** @typedef {{ended: number, last: number, state: State, segments: Segments, impacts: number, evaluations: number}} Flown */
/** @typedef {{settle: number, hold: number, output: string, limit?: number}} Schedule */

const ROWS = 256, MOST_ROWS = 65536, LONGEST_PERIOD = 16; // segments traced before they are read off; drive periods
const LIMIT = 100000; // impacts a drive period after which a steady point is given up
const MOST_IMPACTS = 10000000; // of one motion
const AT_ONCE = 32; // periods settled between two settings of the phase

/** Motions of one packed system; arrays are made once and used again. */
export class EventDriven {
  /**
   * @param {Packed} packed
   */
  constructor(packed) {
    const { slots, size: n, statusRows, traceColumns: columns } = packed, { layout } = slots.rows;
    const made = (/** @type {number[]} */ ...shape) => slots.array("f8", shape);
    this.packed = packed;
    this.slots = slots;
    this.pose = made(2, n);
    this.status = made(statusRows);
    this.counts = slots.array("i8", [layout.COUNT_ROWS]);
    this.watch = {
      row: made(n), nothing: made(0, columns), trace: made(ROWS, columns), poses: made(ROWS, 2, n),
      strobes: made(1, 2, n), scratch: made(2, n), frame: made(2, n), result: made(layout.RESULT_ROWS), energy: made(n),
      share: made(n + 1), reading: layout.EVERYTHING,
    };
    /** @type {Record<string, SlotArray>} room of `posesAt` */
    this.asked = {};
  }

  /** Number of modes that poses have, and the user's number of each. */
  get shown() {
    return { size: this.packed.size, order: this.packed.order };
  }

  /**
   * The packed system's state of one that is given; null: static equilibrium.
   * @param {State | null} state
   */
  begun(state) {
    return state ?? this.packed.equilibrium();
  }

  /**
   * Put a state into `pose` and `status`; null: static equilibrium.
   * @param {State | null} state
   */
  enter(state) {
    const { packed, slots: { rows: { layout } } } = this, n = packed.size, from = this.begun(state);
    if (from.displacement.length !== n || from.velocity.length !== n)
      throw new Error(`A state of this model has ${n} displacements and velocities.`);
    const pose = this.pose.data;
    packed.order.forEach((mode, k) => {
      pose[k] = from.displacement[mode];
      pose[n + k] = from.velocity[mode];
    });
    packed.restart(pose, this.status.data, from.resting ? layout.RESTING : layout.FREE);
  }

  /**
   * The state that the arrays hold.
   * @returns {State}
   */
  state() {
    const { packed, slots: { rows: { layout } } } = this, n = packed.size, pose = this.pose.data;
    const displacement = new Float64Array(n), velocity = new Float64Array(n);
    packed.order.forEach((mode, k) => {
      displacement[mode] = pose[k];
      velocity[mode] = pose[n + k];
    });
    return { displacement, velocity, resting: this.status.data[layout.KIND] === layout.RESTING };
  }

  /**
   * Carry the pose on until it no longer pauses: outcome, and the time done or the period.
   * @param {Drive} drive
   * @param {number} motion size of the motion
   * @param {{span?: number, settle?: number, hold?: number, limit: number}} asked
   * @returns {number[]}
   */
  move({ omega, amplitude }, motion, { span = 0, settle = 0, hold = 0, limit }) {
    const { packed, pose, status, watch, counts } = this, { PAUSED } = this.slots.rows.layout;
    const values = {
      engine: packed.engine(motion), omega, amplitude, pose, status, span, settle, hold, limit, watch, counts,
      longest: span > 0 ? 0 : LONGEST_PERIOD,
    };
    let found = this.slots.call(packed.entries.move, values);
    while (found[0] === PAUSED) found = this.slots.call(packed.entries.move, values);
    return found;
  }

  /**
   * The motion from a state, None: static equilibrium, over `span` s from the drive's phase 0: as vibeam.simulate.
   * @param {Drive} drive
   * @param {State | null} state
   * @param {number} span
   * @param {number} [limit] impacts
   * @returns {Flown}
   */
  simulate(drive, state, span, limit = MOST_IMPACTS) {
    const { layout } = this.slots.rows, size = sizeOfMotion(this.packed.model, drive.amplitude, this.begun(state));
    this.enter(state);
    let flown = this.flown(drive, span, limit, size);
    if (flown.ended === layout.UNRESOLVED && this.packed.carries()) {
      this.enter(state);
      flown = this.flown(drive, span, limit, Infinity);
    }
    return flown;
  }

  /**
   * @param {Drive} drive
   * @param {number} span
   * @param {number} limit
   * @param {number} size
   * @returns {Flown}
   */
  flown(drive, span, limit, size) {
    const { slots, packed, watch, counts, slots: { rows: { layout } } } = this, n = packed.size, columns = packed.traceColumns;
    watch.row.data.set(packed.output("contact"));
    watch.strobes.reshape([1, 2, n]);
    counts.integers.fill(0n);
    /** @type {[Float64Array, Float64Array]} */
    let [trace, poses] = [new Float64Array(0), new Float64Array(0)];
    let outcome = layout.FULL, done = 0, rows = ROWS;
    while (outcome === layout.FULL) {
      watch.trace = slots.fitted(watch.trace, "f8", [rows, columns]);
      watch.poses = slots.fitted(watch.poses, "f8", [rows, 2, n]);
      counts.integers[layout.SEGMENTS] = 0n;
      let step = 0;
      [outcome, step] = span > 0 ? this.move(drive, size, { span: span - done, limit }) : [layout.COMPLETE, 0];
      const count = Number(counts.integers[layout.SEGMENTS]), found = watch.trace.data.slice(0, count * columns);
      for (let i = 0; i < count; i++) found[i * columns + layout.START] += done;
      trace = after(trace, found);
      poses = after(poses, watch.poses.data.subarray(0, count * 2 * n));
      done += step;
      rows = Math.min(2 * rows, MOST_ROWS);
    }
    if (!trace.length) [trace, poses] = this.instant();
    const count = trace.length / columns, last = (count - 1) * columns;
    return {
      ended: outcome, state: this.state(), segments: { trace, poses, count, columns, size },
      last: outcome === layout.COMPLETE ? span : trace[last + layout.START] + trace[last + layout.DURATION],
      impacts: Number(counts.integers[layout.IMPACTS]), evaluations: Number(counts.integers[layout.PANELS]),
    };
  }

  /**
   * A segment without duration: of a motion that ended where it began.
   * @returns {[Float64Array, Float64Array]}
   */
  instant() {
    const { layout } = this.slots.rows, trace = new Float64Array(this.packed.traceColumns), status = this.status.data;
    trace[layout.AT_CLOCK] = status[layout.CLOCK];
    trace[layout.WHAT] = status[layout.KIND];
    return [trace, this.pose.data.slice()];
  }

  /**
   * The state after `periods` of the drive, nothing traced: outcome and state; at most `most` impacts in all.
   * @param {Drive} drive
   * @param {State | null} state
   * @param {number} periods
   * @param {number} most
   * @returns {{ended: number, state: State}}
   */
  settle(drive, state, periods, most) {
    const { watch, counts, packed, slots: { rows: { layout } } } = this, turn = (2 * Math.PI) / drive.omega;
    this.enter(state);
    counts.integers.fill(0n);
    watch.row.data.set(packed.output("contact"));
    watch.trace.reshape([0, packed.traceColumns]);
    let ended = layout.COMPLETE;
    for (let left = periods; left > 0 && ended === layout.COMPLETE; left -= AT_ONCE) {
      [ended] = this.move(drive, Infinity, { span: Math.min(AT_ONCE, left) * turn, limit: most });
      this.status.data[layout.CLOCK] = 0;
    }
    return { ended, state: this.state() };
  }

  /**
   * Modal displacements and velocities (m, 2, n) at times (m,) within the segments, in the kernels' order; to be read
   * before the next call.
   * @param {Drive} drive
   * @param {Segments} segments
   * @param {ArrayLike<number>} times
   * @returns {Float64Array}
   */
  posesAt({ omega, amplitude }, { trace, poses, count, columns, size }, times) {
    const { slots, packed, asked, slots: { rows: { layout } } } = this, n = packed.size, m = times.length;
    asked.which = slots.fitted(asked.which, "i8", [m]);
    asked.after = slots.fitted(asked.after, "f8", [m]);
    asked.out = slots.fitted(asked.out, "f8", [m, 2, n]);
    const places = Int32Array.from(times, (time) => place(trace, columns, layout.START, count, time));
    const first = places.reduce((a, b) => Math.min(a, b), count), last = places.reduce((a, b) => Math.max(a, b), 0);
    asked.trace = slots.fitted(asked.trace, "f8", [Math.max(last - first + 1, 0), columns]);
    asked.poses = slots.fitted(asked.poses, "f8", [Math.max(last - first + 1, 0), 2, n]);
    asked.trace.data.set(trace.subarray(first * columns, (last + 1) * columns));
    asked.poses.data.set(poses.subarray(first * 2 * n, (last + 1) * 2 * n));
    const which = asked.which.integers, since = asked.after.data;
    for (let i = 0; i < m; i++) {
      which[i] = BigInt(places[i] - first);
      since[i] = times[i] - trace[places[i] * columns + layout.START];
    }
    slots.call(packed.entries.poses_at, { engine: packed.engine(size), omega, amplitude, ...asked, ...packed.spare });
    return asked.out.data;
  }

  /**
   * One steady point: settled, watched over `hold` periods, and read off into `watch`: outcome and period.
   * @param {Drive} drive
   * @param {State | null} state
   * @param {Schedule} schedule
   * @returns {{ended: number, period: number}}
   */
  watched(drive, state, { settle, hold, output, limit = LIMIT }) {
    const { slots, packed, watch } = this, n = packed.size;
    this.enter(state);
    this.counts.integers.fill(0n);
    watch.row.data.set(packed.output(output));
    watch.trace = slots.fitted(watch.trace, "f8", [ROWS, packed.traceColumns]);
    watch.poses = slots.fitted(watch.poses, "f8", [ROWS, 2, n]);
    watch.strobes = slots.fitted(watch.strobes, "f8", [hold + 1, 2, n]);
    const [ended, period] = this.move(drive, Infinity, { settle, hold, limit });
    if (ended !== slots.rows.layout.COMPLETE) this.enter(null);
    return { ended, period };
  }
}
