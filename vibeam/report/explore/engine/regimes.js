// A system beyond plain ones as the kernels of regimes take it: any law, a second stop, damping that couples the modes.
// Blocks of every regime come with the model (Python: explore/regime_models.py). Another gap moves their constants in
// proportion, another drive may ask for other panels and so for other tables: neither needs an eigenvalue.
import { fillDerivative } from "./derivatives.js";
import { dot, equilibrium } from "./equilibrium.js";
import { fillOutput, fillPairs, regimeArrays, topLevel } from "./linear.js";

/** @typedef {import("./slots.js").Slots} Slots */
/** @typedef {import("./slots.js").SlotArray} SlotArray */
/** @typedef {import("./equilibrium.js").State} State */
/** @typedef {import("./plain.js").PlainModel} PlainModel */
/** @typedef {import("./plain.js").Settings} Settings */
/** @typedef {"pairs" | "blocks" | "into" | "outof" | "held" | "signals"} Part */
/**
 * A regime at the model's own gap, arrays in C order, and what a metre more adds to the constants of its blocks (2, m),
 * to what is held (n,) and to the constants of its signals.
 * @typedef {Record<Part, Float64Array> & {share: Record<"constants" | "held" | "signals", Float64Array>}} RegimeModel
 */
/** @typedef {typeof ROWS[number] | "law" | "curve" | "contact" | "yields" | "gaps" | "damper"} OwnName */
/** @typedef {Record<OwnName, Float64Array>} OwnRows */
/**
 * A RegimeEngine's own numbers; `coefficient` of its law, which a restitution sets: null where it has none; `fastest`
 * rate, rad/s, that its panels resolve; Runge–Kutta coefficients where the contact is integrated.
 * @typedef {object} RegimesOnly
 * @property {Float64Array} [nodes]
 * @property {Float64Array} [weights]
 * @property {number | null} coefficient
 * @property {number} fastest
 * @property {RegimeModel} free
 * @property {RegimeModel} upper
 * @property {RegimeModel | null} lower
 */
/** @typedef {import("./derivatives.js").Derivative} Derivative */
/** @typedef {PlainModel & {regimes: OwnRows & RegimesOnly, derivatives?: Record<string, Derivative>}} RegimesModel */

const PARTS = /** @type {const} */ (["pairs", "blocks", "into", "outof", "held", "signals"]);
const ROWS = /** @type {const} */ (["omega", "spring", "damping", "load", "static"]);
const ROUNDS = 200; // of a bisection, which ends where no double is left between its ends
const DAMPING = "Other damping gives this fidelity other eigenvalues, which the page does not find: change the case.";
const NO_ROOM = "At this gap the two stops leave nothing between them.";

/** One regime: free, or at one of the stops. */
class PackedRegime {
  /**
   * @param {Slots} slots
   * @param {RegimeModel} given
   * @param {number} n modes
   */
  constructor(slots, given, n) {
    this.slots = slots;
    this.given = given;
    this.m = given.pairs.length / slots.rows.layout.PAIR_ROWS;
    this.arrays = regimeArrays(slots, n, this.m);
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
    const { tuple, regimes, slots: { rows }, model: { gap: own, regimes: { fastest, coefficient } } } = this;
    if (damping !== 1) throw new Error(DAMPING);
    if (!(gap > -tuple.gaps.data[1])) throw new Error(NO_ROOM);
    const top = topLevel(rows.layout, omega, fastest);
    if (top !== this.top) for (const each of regimes) each.tabulate(top);
    if (gap !== this.gap) for (const each of regimes) each.widen(gap - own);
    tuple.gaps.data[0] = gap;
    if (coefficient !== null) tuple.law.data[rows.regimes.COEFFICIENT] = restitution;
    [this.top, this.gap] = [top, gap];
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

  /**
   * Room for a pose.
   * @returns {Record<string, SlotArray>}
   */
  scratch() {
    return this.spare;
  }
}
