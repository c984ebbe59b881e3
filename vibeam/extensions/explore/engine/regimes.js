// A system beyond plain ones as the kernels of regimes take it: any law, a second stop, damping that couples the modes.
// Blocks of every regime come with the model (Python: explore/regime_models.py). Another gap moves their constants in
// proportion, another drive may ask for other panels and so for other tables: neither needs an eigenvalue.
import { fillDerivative } from "./derivatives.js";
import { dot, equilibrium } from "./equilibrium.js";
import { fillOutput, topLevel } from "./linear.js";
import { PackedRegime } from "./regime.js";

/** @import { Slots } from "./slots.js" */
/** @import { Settings, State } from "./types.d.ts" */
/** @import { PlainModel } from "./plain.js" */
/** @import { RegimeModel } from "./regime.js" */
/** @import { Derivative } from "./derivatives.js" */
/** @typedef {typeof ROWS[number] | "law" | "curve" | "contact" | "yields" | "gaps" | "damper"} OwnName */
/** @typedef {Record<OwnName, Float64Array>} OwnRows */
/**
 * A RegimeEngine's own numbers; `coefficient` of its law, which a restitution sets: null where it has none; `fastest`
 * rate, rad/s, that its panels resolve; Runge–Kutta coefficients where the contact is integrated.
 * @typedef {object} RegimesOnly
 * @property {Float64Array} [nodes]
 * @property {Float64Array} [weights]
 * @property {number | null} coefficient
 */
/**
 * What of it other damping changes.
 * @typedef {object} Damped
 * @property {number} fastest
 * @property {RegimeModel} free
 * @property {RegimeModel} upper
 * @property {RegimeModel | null} lower
 */
/** @typedef {Damped & Record<"law" | "damper" | "damping", Float64Array> & {factor: number}} Damping */
/** @typedef {{regimes: OwnRows & RegimesOnly & Damped, dampings?: Damping[]}} InRegimes */
/** @typedef {PlainModel & InRegimes & {derivatives?: Record<string, Derivative>}} RegimesModel */

const ROWS = /** @type {const} */ (["omega", "spring", "damping", "load", "static"]);
const DAMPED = /** @type {const} */ (["law", "damper", "damping"]);
const ROUNDS = 200; // of a bisection, which ends where no double is left between its ends
const DAMPING = "Other damping gives this fidelity other eigenvalues, which the page does not find: ";
const NO_ROOM = "At this gap the two stops leave nothing between them.";

/** One system in regimes, packed for drives of one frequency and more. */
export class PackedRegimes {
  /**
   * @param {Slots} slots
   * @param {RegimesModel} model
   */
  constructor(slots, model) {
    const { layout, regimes: rows } = slots.rows, own = model.regimes, n = model.omega.length;
    const made = (/** @type {number[]} */ ...shape) => slots.array("f8", shape);
    const filled = (/** @type {Float64Array | undefined} */ values, /** @type {number[]} */ ...shape) => {
      const array = made(...shape);
      if (values) array.data.set(values);
      return array;
    };
    this.slots = slots;
    this.model = model;
    this.size = n;
    this.entries = { move: "regimes.move", poses_at: "regimes.poses_at" };
    this.statusRows = rows.STATUS_ROWS;
    this.traceColumns = rows.TRACE_COLUMNS;
    this.order = Array.from(model.omega, (_, k) => k);
    this.gap = model.gap;
    this.damping = 1;
    this.fastest = own.fastest;
    this.top = NaN;
    const free = new PackedRegime(slots, own.free, n), upper = new PackedRegime(slots, own.upper, n);
    const lower = own.lower ? new PackedRegime(slots, own.lower, n) : upper;
    this.regimes = own.lower ? [free, upper, lower] : [free, upper];
    /** @type {Record<string, any>} the fields of a RegimeEngine */
    this.tuple = {
      free: free.arrays, upper: upper.arrays, lower: lower.arrays, drive: made(layout.DRIVE_ROWS),
      law: filled(own.law, rows.LAW_ROWS), curve: filled(own.curve, 3, own.curve.length / 3),
      contact: filled(own.contact, 2, n), yields: filled(own.yields, 2, n), gaps: filled(own.gaps, 2),
      damper: filled(own.damper, n, n), nodes: filled(own.nodes, 14, 12), weights: filled(own.weights, 2, 13),
      stages: made(13, 2 * n), state: made(3, 2 * n),
    };
    for (const name of ROWS) this.tuple[name] = filled(own[name], n);
    this.spare = { pose: made(2, n) };
  }

  /**
   * Pack for settings, and for drives of `omega` rad/s and more. Throws a sentence for what cannot be.
   * @param {Settings} settings `restitution`: the coefficient of the law
   * @param {number} omega
   */
  set({ gap, restitution, damping }, omega) {
    const { tuple, regimes, slots: { rows }, model: { gap: own, regimes: { coefficient } } } = this;
    if (!(gap > -tuple.gaps.data[1])) throw new Error(NO_ROOM);
    if (damping !== this.damping) this.damp(damping);
    const top = topLevel(rows.layout, omega, this.fastest);
    if (top !== this.top) for (const each of regimes) each.tabulate(top);
    if (gap !== this.gap) for (const each of regimes) each.widen(gap - own);
    tuple.gaps.data[0] = gap;
    if (coefficient !== null) tuple.law.data[rows.regimes.COEFFICIENT] = restitution;
    [this.top, this.gap] = [top, gap];
  }

  /**
   * Take the regimes of another damping, which Python found.
   * @param {number} factor
   */
  damp(factor) {
    const { model: { regimes: own, dampings = [] }, regimes, tuple } = this;
    const found = factor === 1 ? own : dampings.find((each) => each.factor === factor);
    const known = [1, ...dampings.map((each) => each.factor)].sort((a, b) => a - b).join(", ");
    if (!found) throw new Error(`${DAMPING}it knows those of ${known} times the case's damping.`);
    [found.free, found.upper, found.lower].forEach((each, i) => each && regimes[i].take(each));
    for (const name of DAMPED) tuple[name].data.set(found[name]);
    [this.damping, this.fastest, this.gap, this.top] = [factor, found.fastest, this.model.gap, NaN];
  }

  /**
   * The tuple of arrays, for modal displacements of about `motion`; infinite where that is not known.
   * @param {number} motion
   * @returns {Record<string, any>}
   */
  engine(motion) {
    this.tuple.drive.data[this.slots.rows.layout.MOTION] = motion;
    return this.tuple;
  }

  /**
   * The static equilibrium: on a hard stop that is in the way, where the forces balance on one that yields.
   * @returns {State}
   */
  equilibrium() {
    const { tuple, model, model: { omega }, size: n, slots: { rows: { regimes: rows } } } = this, law = tuple.law.data;
    const free = equilibrium(model, Infinity);
    for (let side = 0; side < law[rows.SIDES]; side++) {
      /** @type {[Float64Array, number]} */
      const [row, gap] = [tuple.contact.data.slice(side * n, (side + 1) * n), tuple.gaps.data[side]];
      const beyond = dot(row, free.displacement) - gap;
      if (!(beyond > 0)) continue;
      if (law[rows.FAMILY] === rows.IMPULSIVE) return equilibrium({ ...model, contact: row }, gap);
      const give = row.map((each, k) => (omega[k] > 0 ? each / (omega[k] * omega[k]) : 0));
      const force = this.balance(beyond, dot(row, give));
      return { ...free, displacement: free.displacement.map((each, k) => each - give[k] * force) };
    }
    return free;
  }

  /**
   * Static force (N) of a stop that yields, `beyond` m into it, on a contact that gives way by `give` m/N.
   * @param {number} beyond
   * @param {number} give
   * @returns {number}
   */
  balance(beyond, give) {
    const rows = this.slots.rows.regimes, law = this.tuple.law.data, stiffness = law[rows.STIFFNESS];
    if (law[rows.FAMILY] === rows.LINEAR) return (stiffness * beyond) / (1 + stiffness * give);
    let [low, high] = [0, beyond];
    for (let i = 0; i < ROUNDS; i++) {
      const middle = (low + high) / 2;
      if (middle === low || middle === high) break;
      if (middle + give * stiffness * middle ** law[rows.EXPONENT] > beyond) high = middle;
      else low = middle;
    }
    return stiffness * high ** law[rows.EXPONENT];
  }

  /**
   * Set a status as at the start from a state of which nothing is known, `kind` RESTING or FREE; the nearer stop.
   * @param {Float64Array} pose
   * @param {Float64Array} status
   * @param {number} kind
   */
  restart(pose, status, kind) {
    const { layout, regimes: rows } = this.slots.rows, [first, second] = this.tuple.gaps.data;
    const place = dot(this.model.contact, pose);
    status.fill(0);
    status[layout.KIND] = kind;
    status[layout.ORDER] = rows.UNKNOWN;
    status[rows.SIDE] = place + second < first - place ? 1 : 0;
  }

  /**
   * Set the output in every regime; its row.
   * @param {string} name
   * @returns {Float64Array}
   */
  output(name) {
    const { slots, regimes, model } = this, derivative = model.derivatives?.[name];
    const row = derivative?.row ?? (name === "contact" ? model.contact : model.outputs[name]);
    for (const { arrays } of regimes)
      if (derivative) fillDerivative(slots, arrays, derivative);
      else fillOutput(slots, arrays, row);
    return row;
  }

  /**
   * True where the last motion carried modes along without their steady response.
   * @returns {boolean}
   */
  carries() {
    return this.regimes.some((each) => each.carries());
  }
}
