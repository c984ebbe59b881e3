// Branches of a response curve: ranges of its grid over which the motion is of one kind, and their ends, as
// vibeam/runs/comparison has them (places.py, ends.py). An end is known to half a step of the grid.

/** @import { Branch, End, Part, Span, Swept } from "../engine/types.d.ts" */

const LONGEST = 4, MANY = 8, JUMP = 0.2, ALIKE = 0.6, FARTHEST = 0.5;  // of vibeam/periodic/motion_kind.py and ends.py
export const FREE = "no contact";
export const IRREGULAR = "no repetition";
export const UNKNOWN = "unknown";

/** Kind of a motion in words. @type {(known: boolean, point: {period: number, impactsPerPeriod: number}) => string} */
export function kindOf(known, { period, impactsPerPeriod }) {
  if (!known) return UNKNOWN;
  if (period < 0) return FREE;
  if (period === 0 || period > LONGEST) return IRREGULAR;
  const impacts = Math.round(period * impactsPerPeriod), counted = `${impacts} impact${impacts === 1 ? "" : "s"}`;
  return `period ${period} with ${impactsPerPeriod > MANY ? "chatter" : counted}`;
}
/** @type {(kind: string) => boolean} */
export const strikes = (kind) => kind !== FREE && kind !== UNKNOWN;
/** @type {(one: number, other: number) => number} */
export const width = (one, other) => Math.abs(other - one) / (0.5 * (one + other));

/** Whether two neighbours are on different branches. @type {(one: Swept, other: Swept) => boolean} */
function apart(one, other) {
  if (one.kind !== other.kind || !strikes(one.kind) || one.kind === IRREGULAR) return one.kind !== other.kind;
  const larger = Math.max(Math.abs(one.amplitude), Math.abs(other.amplitude));
  return Math.abs(one.amplitude - other.amplitude) > JUMP * larger;
}

/** Frequency between a place and the one before it, and half the step there. */
/** @type {(places: Swept[], at: number) => [number, number]} */
function edge(places, at) {
  const one = places[Math.max(at - 1, 0)].frequency, other = places[Math.min(at, places.length - 1)].frequency;
  return [0.5 * (one + other), 0.5 * Math.abs(other - one)];
}
/** Part of a sweep, and how far its width is open; ∞ at one frequency. @type {(places: Swept[], part: Part) => Span} */
export function spanOf(places, { first, last }) {
  const [[start, before], [end, after]] = [edge(places, first), edge(places, last + 1)];
  const [low, high] = [start, end].sort((a, b) => a - b);
  return { low, high, width: high > low ? width(low, high) : Infinity, open: (before + after) / (0.5 * (low + high)) };
}

/**
 * Branches in the order swept; one narrower than ``narrowest`` goes to its wider neighbour that has contact as it has.
 * @type {(places: Swept[], narrowest?: number) => Branch[]}
 */
export function branches(places, narrowest = 0) {
  /** @type {Branch[]} */
  const found = [];
  places.forEach(({ kind }, at) => {
    if (at === 0 || apart(places[at - 1], places[at])) found.push({ kind, first: at, last: at, head: at, tail: at });
    else Object.assign(found[found.length - 1], { last: at, tail: at });
  });
  const has = (/** @type {number} */ at) => found[at] && strikes(found[at].kind);
  const hosts = (/** @type {number} */ at) => [at - 1, at + 1].filter((to) => has(to) === has(at));
  for (;;) {
    const widths = found.map((each) => spanOf(places, each).width);
    const narrow = [...found.keys()].filter((at) => widths[at] < narrowest && hosts(at).length);
    if (!narrow.length) return found;
    const own = narrow.reduce((best, at) => (widths[at] < widths[best] ? at : best));
    const to = hosts(own).reduce((best, at) => (widths[at] > widths[best] ? at : best)), low = Math.min(own, to);
    found.splice(low, 2, { ...found[to], first: found[low].first, last: found[low + 1].last });
    for (const at of [low, low - 1]) {
      const [one, other] = [found[at], found[at + 1]];
      if (!one || !other || apart(places[one.tail], places[other.head])) continue;
      found.splice(at, 2, { ...one, last: other.last, tail: other.tail });
    }
  }
}

/** Ends of all branches within a sweep. @type {(places: Swept[], found: Branch[], way: string) => End[]} */
export const endsOf = (places, found, way) => found.slice(1).map(({ kind, first, head }, at) => {
  const [frequency, open] = edge(places, first), [a, b] = [places[found[at].tail].amplitude, places[head].amplitude];
  const jump = Math.abs(b - a) > JUMP * Math.max(Math.abs(a), Math.abs(b)) ? Math.sign(b - a) : 0;
  return { frequency, open, before: found[at].kind, after: kind, way, jump };
});

/** 1 where contact begins, −1 where it is lost, else 0. @type {(end: End) => number} */
export const contact = ({ before, after }) => Number(strikes(after)) - Number(strikes(before));

/** Worth of a match, 0 where two ends are not of a kind. @type {(one: End, other: End) => number} */
function worthOf(one, other) {
  const far = width(one.frequency, other.frequency), alike = one.before === other.before && one.after === other.after;
  if (far > FARTHEST || !(alike || (contact(one) && contact(one) === contact(other)))) return 0;
  return (alike ? 1 : ALIKE) * (1 - far);
}

/** Ends that are the same in both, matched in their order. @type {(ours: End[], theirs: End[]) => [End, End][]} */
export function matched(ours, theirs) {
  const worth = Array.from({ length: ours.length + 1 }, () => new Float64Array(theirs.length + 1));
  for (let i = ours.length - 1; i >= 0; i -= 1) {
    for (let j = theirs.length - 1; j >= 0; j -= 1) {
      worth[i][j] = Math.max(worthOf(ours[i], theirs[j]) + worth[i + 1][j + 1], worth[i + 1][j], worth[i][j + 1]);
    }
  }
  /** @type {[End, End][]} */
  const pairs = [];
  for (let i = 0, j = 0; i < ours.length && j < theirs.length;) {
    const own = worthOf(ours[i], theirs[j]);
    if (own > 0 && worth[i][j] === own + worth[i + 1][j + 1]) pairs.push([ours[i++], theirs[j++]]);
    else if (worth[i][j] === worth[i + 1][j]) i += 1; else j += 1;
  }
  return pairs;
}
