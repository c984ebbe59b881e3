// Arrays of many points of one plain system, kept from call to call: Task, Lane and Watch of flight/points/points.py.
import { SlotArray } from "./slots.js";

/** @import { PackedSystem } from "./plain.js" */
/** @import { Settings, State } from "./types.d.ts" */
/** @typedef {Record<string, any>} Tuple arrays and numbers by name, nested */

const ROWS = 256; // segments traced before they are read off

/** Points of one system, as the kernels take them. */
export class Room {
  /** @param {PackedSystem} packed */
  constructor(packed) {
    this.packed = packed;
    /** @type {Tuple} */
    this.task = {};
    /** @type {Tuple} */
    this.lane = { engines: {} };
    /** @type {Tuple} */
    this.watch = {};
  }

  /**
   * Room for so many points, blank, watched over `hold` periods by the output's row; lanes without points.
   * @param {number} count
   * @param {number} hold
   * @param {Float64Array} row
   */
  begin(count, hold, row) {
    const { packed, packed: { slots, size: n } } = this, { layout, points } = slots.rows, wide = points.WIDTH;
    const [, m] = packed.rest.blocks.shape, engine = packed.engine(Infinity);
    const task = { drives: [4], held: [n], constants: [2, m], offsets: [2], poses: [2, n], kinds: [] };
    const results = { results: [layout.RESULT_ROWS], energy: [n], strobes: [0] };
    this.fit(this.task, "f8", { ...task, ...results }, [count]);
    this.fit(this.task, "i8", { pack: [], counts: [layout.COUNT_ROWS], ended: [2] }, [count]);
    for (const each of Object.values(this.task)) if (each instanceof SlotArray) each.data.fill(0);
    this.task.packs = replaced(engine, ({ kind, shape, address }) => new SlotArray(slots, kind, [1, ...shape], address));
    const flat = { common: [points.COMMON_ROWS * wide], modal: [n * points.MODAL_ROWS * wide] };
    const flights = [(points.FLIGHT_COMMON + n * points.FLIGHT_ROWS) * wide];
    this.fit(this.lane, "f8", { ...flat, flights, marks: [points.MARK + n] });
    this.fit(this.lane, "f8", { poses: [2, n], status: [layout.STATUS_ROWS], alone: [points.ALONE_ROWS] }, [wide]);
    this.fit(this.lane, "i8", { counts: [layout.COUNT_ROWS], whole: [points.LANE_ROWS] }, [wide]);
    this.fit(this.lane.engines, "f8", replaced(engine, ({ shape }) => shape), [wide]);
    const traced = { nothing: [0, layout.TRACE_COLUMNS], trace: [ROWS, layout.TRACE_COLUMNS], poses: [ROWS, 2, n] };
    const read = { result: [layout.RESULT_ROWS], energy: [n], share: [n + 1], scratch: [2, n], frame: [2, n] };
    this.fit(this.watch, "f8", { ...traced, ...read, row: [n], strobes: [hold + 1, 2, n] });
    this.watch.reading = layout.EVERYTHING;
    this.watch.row.data.set(row);
    const whole = this.lane.whole.integers.fill(0n);
    for (let lane = 0; lane < wide; lane++) whole[lane * points.LANE_ROWS + points.PACK] = -1n;
  }

  /**
   * Arrays of these shapes, behind axes that all have, in the room of the earlier ones.
   * @param {Tuple} tuple
   * @param {string} kind
   * @param {Tuple} shapes
   * @param {number[]} [axes]
   */
  fit(tuple, kind, shapes, axes = []) {
    for (const [name, shape] of Object.entries(shapes)) {
      if (Array.isArray(shape)) tuple[name] = this.packed.slots.fitted(tuple[name], kind, [...axes, ...shape]);
      else this.fit((tuple[name] ??= {}), kind, shape, axes);
    }
  }

  /**
   * Put a point of the packed system, as it is, in its place; null: static equilibrium.
   * @param {number} i
   * @param {Settings} point
   * @param {State | null} start
   */
  put(i, point, start) {
    const { task, packed, packed: { slots, order, size: n, rest } } = this, { layout } = slots.rows;
    const [, m] = rest.blocks.shape, [, wide] = rest.signals.shape, poses = task.poses.data;
    const row = (/** @type {number} */ at) => rest.blocks.data.subarray(at * m, (at + 1) * m);
    const constant = (/** @type {number} */ signal) => rest.signals.data[(signal + 1) * wide - 2];
    task.drives.data.set([point.omega, point.amplitude, point.gap, point.restitution], 4 * i);
    task.held.data.set(rest.held.data, i * n);
    task.constants.data.set(row(layout.CONSTANT1), 2 * i * m);
    task.constants.data.set(row(layout.CONSTANT2), (2 * i + 1) * m);
    task.offsets.data.set([constant(layout.FORCE_SIGNAL), constant(layout.OUTPUT_SIGNAL)], 2 * i);
    const { displacement, velocity, resting } = start ?? packed.equilibrium();
    if (displacement.length !== n || velocity.length !== n)
      throw new Error(`A state of this model has ${n} displacements and velocities.`);
    order.forEach((mode, k) => {
      poses[2 * i * n + k] = displacement[mode];
      poses[(2 * i + 1) * n + k] = velocity[mode];
    });
    task.kinds.data[i] = resting ? layout.RESTING : layout.FREE;
  }

  /**
   * The state that a point came to.
   * @param {number} i
   * @returns {State}
   */
  state(i) {
    const { task, packed: { slots, order, size: n } } = this, poses = task.poses.data;
    const state = { displacement: new Float64Array(n), velocity: new Float64Array(n), resting: false };
    order.forEach((mode, k) => {
      state.displacement[mode] = poses[2 * i * n + k];
      state.velocity[mode] = poses[(2 * i + 1) * n + k];
    });
    state.resting = task.kinds.data[i] === slots.rows.layout.RESTING;
    return state;
  }
}

/**
 * A tuple with something made of each of its arrays in their place.
 * @param {Tuple} tuple
 * @param {(array: SlotArray) => any} make
 * @returns {Tuple}
 */
function replaced(tuple, make) {
  return Object.fromEntries(
    Object.entries(tuple).map(([name, each]) => [name, each instanceof SlotArray ? make(each) : replaced(each, make)]),
  );
}
