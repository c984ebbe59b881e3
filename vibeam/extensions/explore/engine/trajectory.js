// A motion of one fidelity from beginning to end, and its values at any time.
import { derivativeAlong } from "./derivatives.js";
import { impactsOf } from "./segments.js";

/** @import { Engine } from "./engine.js" */
/** @import { Flown } from "./flight.js" */
/** @import { Settings } from "./types.d.ts" */

const POINTS = 480; // of a motion drawn
const SLACK = 1e-9; // share of a motion by which a time may lie outside, by round-off

/** A motion, exact between its events; times in s from its start, at the drive's phase 0. */
export class Motion {
  /**
   * @param {Engine} engine
   * @param {string} fidelity
   * @param {Settings} settings
   * @param {Flown} flown
   * @param {number} periods
   */
  constructor(engine, fidelity, settings, flown, periods) {
    const { layout } = engine.slots.rows;
    this.engine = engine;
    this.fidelity = fidelity;
    this.settings = settings;
    this.segments = flown.segments;
    this.ended = engine.ended[flown.ended];
    this.omega = settings.omega;
    this.turn = (2 * Math.PI) / settings.omega;
    this.periods = periods;
    this.start = 0;
    this.end = flown.last;
    this.state = flown.state;
    this.impacts = impactsOf(layout, flown.segments);
    this.counts = { impacts: flown.impacts, evaluations: flown.evaluations };
  }

  /**
   * Times to draw the motion at: evenly, and just before and at each impact.
   * @param {number} [points]
   * @returns {Float64Array}
   */
  times(points = POINTS) {
    const even = Array.from({ length: points }, (_, i) => Math.min((i * this.end) / (points - 1), this.end));
    const struck = this.impacts.length;
    if (struck > 4 * points) return Float64Array.from(even);
    const jumps = this.impacts.flatMap(([time]) => (time > 0 ? [time - time * Number.EPSILON, time] : [time]));
    return Float64Array.from([...even, ...jumps]).sort();
  }

  /**
   * The output and its rate, and modal displacements (k, n) in the user's order, at times (k,): at an impact just after it.
   * @param {ArrayLike<number>} times
   * @returns {{x: Float64Array, v: Float64Array, modes: Float64Array}}
   */
  at(times) {
    const flight = this.engine.ready(this.fidelity, this.settings), { order, size: n } = flight.shown;
    const model = this.engine.model(this.fidelity), k = times.length, slack = SLACK * this.end;
    for (let i = 0; i < k; i++)
      if (!(times[i] >= -slack && times[i] <= this.end + slack))
        throw new Error(`The motion is known from 0 to ${this.end} s, not at ${times[i]} s.`);
    const derivative = model.derivatives?.[model.output];
    const row = derivative?.row ?? (model.output === "contact" ? model.contact : model.outputs[model.output]);
    const poses = flight.posesAt(this.settings, this.segments, times);
    const x = new Float64Array(k), v = new Float64Array(k), modes = new Float64Array(k * n);
    for (let i = 0; i < k; i++) {
      for (let j = 0; j < n; j++) {
        const mode = order[j], place = poses[2 * n * i + j];
        modes[n * i + mode] = place;
        x[i] += row[mode] * place;
        v[i] += row[mode] * poses[2 * n * i + n + j];
      }
    }
    if (!derivative) return { x, v, modes };
    const along = (/** @type {0 | 1} */ more) =>
      derivativeAlong(/** @type {any} */ (flight.packed), this.settings, this.segments, times, poses, derivative, more);
    return { x: along(0), v: along(1), modes };
  }
}
