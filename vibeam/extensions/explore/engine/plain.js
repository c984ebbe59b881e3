// A plain system as the kernels see it, packed anew as far as sliders change it: packing.PackedSystem.
import { dot, equilibrium, yields } from "./equilibrium.js";
import { heldPlanes } from "./held.js";
import { beyondLanes, layOut } from "./lanes.js";
import {
  ascending, fillInputs, fillOutput, fillPairs, fillPlanes, fillSignal, rates, regimeArrays, topLevel,
} from "./linear.js";

/** @import { Slots } from "./slots.js" */
/** @import { Planes } from "./linear.js" */
/** @import { Settings, State } from "./types.d.ts" */
/**
 * A fidelity's plain system, its arrays decoded; `rest`: planes of the system held on the stop where roots do not serve.
 * @typedef {object} PlainModel
 * @property {Float64Array} omega
 * @property {Float64Array} zeta
 * @property {Float64Array} contact
 * @property {Float64Array} load
 * @property {Float64Array} static
 * @property {number} gap
 * @property {number} restitution
 * @property {Record<string, Float64Array>} outputs
 * @property {Planes | null} rest
 */

const ROW = 8; // modes that go side by side in the lanes

/** One plain system, packed for drives of one frequency and more. */
export class PackedSystem {
  /**
   * @param {Slots} slots
   * @param {PlainModel} model
   */
  constructor(slots, model) {
    const { layout, lanes } = slots.rows, n = model.omega.length, width = n === 1 ? 1 : ROW;
    const made = (/** @type {number[]} */ ...shape) => slots.array("f8", shape);
    const cells = Math.ceil(n / width) * width;
    this.slots = slots;
    this.model = model;
    this.size = n;
    this.width = width;
    this.entries = { move: "flight.move", poses_at: "flight.poses_at" };
    this.statusRows = layout.STATUS_ROWS;
    this.traceColumns = layout.TRACE_COLUMNS;
    this.gap = NaN;
    this.restitution = NaN;
    this.damping = NaN;
    this.top = NaN;
    this.lanes = false;
    /** @type {number[]} mode of the model that each of the kernels' rows is */
    this.order = [];
    const silent = model.contact.reduce((count, each) => count + (each === 0 ? 1 : 0), 0);
    this.rest = regimeArrays(slots, n, silent + Math.max(n - silent - 1, 0));
    this.free = {
      pairs: made(layout.PAIR_ROWS, n), table: made(layout.TABLE_ROWS, layout.LEVELS, n),
      levels: made(layout.LEVEL_ROWS, layout.LEVELS), signal: made(layout.SIGNAL_ROWS),
      attached: made(layout.ATTACHED_ROWS, n), modes: made(layout.MODE_ROWS, n), drive: made(layout.DRIVE_ROWS),
      cells: made(lanes.CELL_ROWS * cells), rungs: made(layout.LEVELS * lanes.RUNG_ROWS * cells),
    };
    this.arrays = { ...this.free, rest: this.rest };
    this.spare = { pose: made(2, n), status: made(layout.STATUS_ROWS) };
  }

  /**
   * Pack for settings, and for drives of `omega` rad/s and more. Throws a sentence for what cannot be.
   * @param {Settings} settings
   * @param {number} omega
   */
  set({ gap, restitution, damping }, omega) {
    const { model, slots: { rows: { layout } } } = this;
    const sigma = model.omega.map((own, k) => model.zeta[k] * damping * own);
    const top = topLevel(layout, omega, Math.max(...rates(model.omega, sigma)));
    const anew = damping !== this.damping || top !== this.top;
    if (damping !== this.damping) this.arrange(sigma);
    if (anew) this.packModes(damping, top);
    if (anew || gap !== this.gap) this.packGap(gap);
    this.free.drive.data[layout.RESTITUTION] = restitution;
    if (anew || restitution !== this.restitution) this.packLanes(anew);
    [this.gap, this.restitution, this.damping, this.top] = [gap, restitution, damping, top];
  }

  /**
   * Sort the modes by rate, and find the blocks of the system held on the stop.
   * @param {Float64Array} sigma
   */
  arrange(sigma) {
    const { model } = this, given = model.rest;
    const order = ascending(rates(model.omega, sigma));
    const own = {
      omega: reordered(model.omega, order), sigma: reordered(sigma, order), contact: reordered(model.contact, order),
      load: reordered(model.load, order), static: reordered(model.static, order),
    };
    this.planes = given ?? heldPlanes(own);
    this.order = order;
    this.own = own;
  }

  /**
   * @param {number} damping
   * @param {number} top
   */
  packModes(damping, top) {
    const { slots, free, own, order, model, size: n, slots: { rows: { layout } } } = this;
    if (!own || !this.planes) return;
    const zeta = reordered(model.zeta, order).map((each) => each * damping);
    const disc = own.omega.map((each, k) => each * each * (zeta[k] - 1) * (zeta[k] + 1));
    const modes = free.modes.data, drive = free.drive.data;
    modes.set(own.contact, layout.CONTACT * n);
    modes.set(own.load, layout.LOAD * n);
    modes.set(own.static, layout.STATIC * n);
    modes.set(zeta, layout.ZETA * n);
    modes.set(yields(own.omega, own.contact), layout.YIELD * n);
    fillPairs(slots, free, own.omega, own.sigma, disc, top);
    fillPlanes(slots, this.rest, this.planes, top);
    drive[layout.MOBILITY] = dot(own.contact, own.contact);
    drive[layout.LONGEST] = this.longestFlight();
  }

  /**
   * Time for which a flight's closed form keeps its digits, by the fastest mode that does not decay before.
   * @returns {number}
   */
  longestFlight() {
    const { size: n, slots: { rows: { layout } } } = this, pairs = this.free.pairs.data;
    let fastest = 1e-300;
    for (let k = 0; k < n; k++) {
      const turn = Math.sqrt(Math.max(-pairs[layout.DISC * n + k], 0));
      if (pairs[layout.DECAY * n + k] * layout.REDUCED < layout.FORGOTTEN * turn) fastest = Math.max(fastest, turn);
    }
    return layout.REDUCED / fastest;
  }

  /**
   * What of the system held on the stop depends on the gap, and its contact force.
   * @param {number} gap
   */
  packGap(gap) {
    const { slots, own, slots: { rows: { layout } } } = this;
    if (!own) return;
    const { omega, sigma, contact, load } = own, mobility = dot(contact, contact);
    this.free.drive.data[layout.GAP] = gap;
    const held = contact.map((each) => each * (gap / mobility)); // the least displacement
    const constant = own.static.map((each, k) => each - omega[k] * omega[k] * held[k]);
    const along = dot(contact, constant) / mobility, across = dot(contact, load) / mobility;
    fillInputs(
      slots, this.rest, held, constant.map((each, k) => each - contact[k] * along),
      load.map((each, k) => each - contact[k] * across),
    );
    fillSignal(this.rest, layout.FORCE_SIGNAL, {
      at: contact.map((each, k) => -each * (omega[k] * omega[k])), rate: contact.map((each, k) => -each * (2 * sigma[k])),
      constant: along, load: across, over: mobility,
    });
  }

  /**
   * @param {boolean} anew
   */
  packLanes(anew) {
    const { slots, free, lanes } = this;
    this.lanes = !beyondLanes(slots, free);
    for (const each of [free.cells, free.rungs]) each.reshape([this.lanes ? each.room : 0]);
    if (this.lanes && (anew || !lanes)) layOut(slots, free, this.width);
  }

  /**
   * The tuple of arrays, for modal displacements of about `motion`; infinite where that is not known.
   * @param {number} motion
   * @returns {Record<string, any>}
   */
  engine(motion) {
    this.free.drive.data[this.slots.rows.layout.MOTION] = motion;
    return this.arrays;
  }

  /**
   * The static equilibrium.
   * @returns {State}
   */
  equilibrium() {
    return equilibrium(this.model, this.gap);
  }

  /**
   * Set a status as at the start from a state, `kind` RESTING or FREE.
   * @param {Float64Array} pose
   * @param {Float64Array} status
   * @param {number} kind
   */
  restart(pose, status, kind) {
    status.fill(0);
    status[this.slots.rows.layout.KIND] = kind;
  }

  /**
   * Set the output in the regime of rest; its row in the kernels' order of modes.
   * @param {string} name
   * @returns {Float64Array}
   */
  output(name) {
    const row = reordered(name === "contact" ? this.model.contact : this.model.outputs[name], this.order);
    fillOutput(this.slots, this.rest, row);
    return row;
  }

  /**
   * True where the last motion carried modes along without their steady response.
   * @returns {boolean}
   */
  carries() {
    const { layout } = this.slots.rows, [, m] = this.rest.blocks.shape;
    const carried = this.rest.blocks.data.subarray(layout.CARRIED * m, (layout.CARRIED + 1) * m);
    return carried.some((each) => each !== 0) || this.free.signal.data[layout.ATTACHED] > 0;
  }
}

/**
 * @param {Float64Array} values
 * @param {number[]} order
 * @returns {Float64Array}
 */
function reordered(values, order) {
  return Float64Array.from(order, (k) => values[k]);
}
