// Many steady points of one fidelity. Of a plain system all go in one compiled call, side by side in the lanes, as
// flight/points/points.py; of any other one after the other.
//
// Each point is by itself: from static equilibrium, or from a state of its own, such as that of the last frame. A
// stored sweep carries its state from point to point instead, and may stand on another branch where there are two
// motions: `carried` does the same.
import { equilibrium } from "./equilibrium.js";
import { Room } from "./room.js";
import { readPoint, unread } from "./segments.js";

/** @import { PackedSystem } from "./plain.js" */
/** @import { Place, Response, Schedule, Settings, State, SteadyPoint } from "./types.d.ts" */
/** @import { EventDriven } from "./flight.js" */
/** @typedef {SteadyPoint & {outcome: number, state: State, impacts: number}} Point */
/** @typedef {{settle: number, hold: number, output: string, slowest: number}} Watched `slowest`: rad/s of the panels */

const LIMIT = 100_000; // impacts a drive period after which a point is given up, as of a sweep
const LONGEST_PERIOD = 16; // drive periods
const SIDE_BY_SIDE = 8; // modes up to which points go side by side

/** @type {WeakMap<PackedSystem, Room>} */
const rooms = new WeakMap();

/**
 * The response curve of a fidelity at `frequencies`, Hz. Throws a sentence for a place that cannot be flown.
 * @param {any} engine
 * @param {string} fidelity
 * @param {Place} place
 * @param {ArrayLike<number>} frequencies
 * @param {Schedule} [schedule]
 * @returns {Response}
 */
export function response(engine, fidelity, place, frequencies, schedule = {}) {
  const { settle = engine.sweep.settle, hold = engine.sweep.hold, states = [], carried } = schedule;
  const settings = Array.from(frequencies, (frequency) => engine.settings(fidelity, { ...place, frequency }));
  const slowest = schedule.slowest ?? Math.min(...settings.map(({ omega }) => omega));
  const { engine: kind, output } = engine.model(fidelity), own = { settle, hold, output, slowest };
  const points = kind === "plain" && !carried
    ? settings.length ? pointsOf(engine.ready(fidelity, settings[0], slowest).packed, settings, own, states) : []
    : inTurn((each) => engine.ready(fidelity, each, slowest), settings, own, states, carried);
  /** @type {(name: keyof SteadyPoint) => Float64Array} */
  const row = (name) => Float64Array.from(points, (point) => point[name]);
  return {
    frequency: Float64Array.from(frequencies), amplitude: row("amplitude"), maximum: row("maximum"),
    minimum: row("minimum"), reach: row("reach"), impactsPerPeriod: row("impactsPerPeriod"),
    impactVelocity: row("impactVelocity"), period: Int32Array.from(points, ({ period }) => period), rest: row("rest"),
    ended: points.map(({ outcome }) => engine.ended[outcome]), states: points.map(({ state }) => state),
    impacts: points.map(({ impacts }) => impacts),
  };
}

/**
 * Settle and watch points of a plain system in one call, each by itself; static equilibrium where a state is missing.
 * @param {PackedSystem} packed
 * @param {Settings[]} points at least one, all of one restitution and damping
 * @param {Watched} watched
 * @param {(State | null | undefined)[]} [states]
 * @returns {Point[]}
 */
export function pointsOf(packed, points, { settle, hold, output, slowest }, states = []) {
  const { layout } = packed.slots.rows;
  packed.set(points[0], slowest);
  let room = rooms.get(packed);
  if (!room) rooms.set(packed, (room = new Room(packed)));
  room.begin(points.length, hold, packed.output(output));
  points.forEach((point, i) => {
    if (point.gap !== packed.gap) {
      packed.set(point, slowest);
      packed.output(output);
    }
    room.put(i, point, states[i] ?? null);
  });
  const { task, lane, watch } = room, given = { settle, hold, limit: LIMIT, longest: LONGEST_PERIOD };
  let outcome = layout.PAUSED, first = 0;
  while (outcome === layout.PAUSED) {
    const values = { task, lane, watch, first, most_modes: SIDE_BY_SIDE, ...given };
    [outcome, first] = packed.slots.call("points.run", values);
  }
  return points.map(({ omega, gap }, i) => {
    const [ended, period] = Array.from(task.ended.integers.subarray(2 * i, 2 * i + 2), Number);
    const result = task.results.data.subarray(i * layout.RESULT_ROWS, (i + 1) * layout.RESULT_ROWS);
    const complete = ended === layout.COMPLETE, turn = (2 * Math.PI) / omega;
    return {
      ...(complete ? readPoint(layout, result, { period, hold, turn, gap }) : unread()), outcome: ended,
      state: complete ? room.state(i) : equilibrium(packed.model, gap),
      impacts: Number(task.counts.integers[i * layout.COUNT_ROWS + layout.IMPACTS]),
    };
  });
}

/**
 * Points one after the other, by the engine of any system; `carried`: each from the state of the one before.
 * @param {(settings: Settings) => EventDriven} ready
 * @param {Settings[]} settings
 * @param {Watched} watched
 * @param {(State | null | undefined)[]} states
 * @param {boolean} [carried]
 * @returns {Point[]}
 */
function inTurn(ready, settings, watched, states, carried) {
  /** @type {Point[]} */
  const points = [];
  /** @type {State | null} */
  let last = null;
  for (const [i, own] of settings.entries()) {
    const flight = ready(own);
    const { ended, period } = flight.watched(own, (carried && last) || states[i] || null, watched);
    const { slots: { rows: { layout } }, watch, counts: { integers } } = flight;
    const read = { period, hold: watched.hold, turn: (2 * Math.PI) / own.omega, gap: own.gap };
    last = flight.state();
    points.push({
      ...(ended === layout.COMPLETE ? readPoint(layout, watch.result.data, read) : unread()), outcome: ended,
      state: last, impacts: Number(integers[layout.IMPACTS]),
    });
  }
  return points;
}
