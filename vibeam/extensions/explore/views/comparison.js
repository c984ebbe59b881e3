// Comparison of two response curves on one grid, as vibeam/runs/comparison/responses.py has it: amplitudes where both
// make a motion of one kind, ends of branches that both have, differences in kind. No point is put between those of the
// grid, and motions that do not repeat are read but once.
import { FREE, IRREGULAR, UNKNOWN, branches, contact, endsOf, matched, spanOf, strikes } from "./branches.js";

/** @import { AmplitudeError, Asked, Branch, Comparison, End, Errors, Leg, Piece, Swept } from "../engine/types.d.ts" */

const LEAST = 0.1;  // share of the largest amplitude, below which an error is relative to that
const GROUP = 8;  // places over which the amplitude of a motion that does not repeat is averaged
const MOVED = 0.7;  // share of the range between two ends in which the motions differ, at least, where they are one end

/** @type {(found: Branch[]) => Branch[]} */
const byPlace = (found) => found.flatMap((each) => new Array(each.last - each.first + 1).fill(each));

/** Whether two ends are one that has moved: between them the motions differ, most of the way. */
/** @type {(pair: [End, End], different: Piece[]) => boolean} */
function hasMoved([one, other], different) {
  if (contact(one) || one.before === one.after) return true;
  const [low, high] = [one.frequency, other.frequency].sort((a, b) => a - b);
  const parts = different.map((each) => Math.max(0, Math.min(each.high, high) - Math.max(each.low, low)));
  return high - low <= one.open + other.open || parts.reduce((sum, each) => sum + each, 0) >= MOVED * (high - low);
}

/** Errors of means over neighbouring places, of motions that do not repeat; a single one scatters without end. */
/** @type {(places: [Swept, Swept][], least: number, way: string) => AmplitudeError[]} */
function ofMeans(places, least, way) {
  const mean = (/** @type {number[]} */ values) => values.reduce((sum, each) => sum + each, 0) / values.length;
  const groups = Math.max(1, Math.floor(places.length / GROUP)), more = places.length % groups;
  const from = (/** @type {number} */ group) => group * Math.floor(places.length / groups) + Math.min(group, more);
  return Array.from({ length: places.length && groups }, (_, group) => {
    const some = places.slice(from(group), from(group + 1)), n = some.length;
    const size = Math.max(mean(some.map(([, its]) => its.amplitude)), least);
    const off = some.map(([own, its]) => (own.amplitude - its.amplitude) / size), error = mean(off);
    const scatter = n > 1 ? Math.sqrt(mean(off.map((each) => (each - error) ** 2)) / (n - 1)) : Infinity;
    return { error, scatter, frequency: some[Math.floor(n / 2)][0].frequency, way };
  });
}

/** Errors in one direction of the sweep. @type {(leg: Leg, narrowest: number, least: number) => Errors} */
function compareLeg({ way, ours, theirs }, narrowest, least) {
  const both = [ours, theirs], own = both.map((places) => byPlace(branches(places)));
  const wide = both.map((places) => branches(places, narrowest)), told = wide.map(byPlace);
  /** @type {{kinds: string[], first: number, last: number}[]} */
  const parts = [];  // on which neither changes its branch
  ours.forEach((_, at) => {
    if (at && own.every((side) => side[at] === side[at - 1])) parts[parts.length - 1].last = at;
    else parts.push({ kinds: own.map((side) => side[at].kind), first: at, last: at });
  });
  const pieces = parts.map((each) => ({ ...each, ...spanOf(ours, each) }));
  const different = pieces.filter(({ kinds: [one, other] }) => one !== other);
  const same = matched(endsOf(ours, wide[0], way), endsOf(theirs, wide[1], way));
  const pairs = same.filter((each) => hasMoved(each, different));
  const ends = pairs.map(([one, reference]) => {
    const { frequency, open } = reference;
    return { error: one.frequency / frequency - 1, open: (one.open + open) / frequency, ours: one, reference };
  });
  const alone = both.some((places) => places.every(({ kind }) => kind === FREE))
    && both.some((places) => places.some(({ kind }) => strikes(kind)));
  /** @type {(Piece & {widest: number, way: string, alone: boolean})[]} */
  const kinds = [];
  for (const each of different) {  // where no end accounts for it: neighbours are one, named by the widest
    const middle = 0.5 * (each.low + each.high), last = kinds[kinds.length - 1];
    const moved = pairs.some(([one, other]) => (one.frequency - middle) * (other.frequency - middle) <= 0);
    if (moved || each.kinds.includes(UNKNOWN)) continue;
    if (last?.last !== each.first - 1) kinds.push({ ...each, widest: each.width, way, alone });
    else {
      if (each.width > last.widest) [last.kinds, last.widest] = [each.kinds, each.width];
      Object.assign(last, { last: each.last, ...spanOf(ours, { first: last.first, last: each.last }) });
    }
  }
  const all = ours.map((each, at) => /** @type {[Swept, Swept]} */ ([each, theirs[at]]));
  const sides = [...own, ...told];
  const alike = all.filter(([{ kind }], at) => strikes(kind) && sides.every((side) => side[at].kind === kind));
  const odd = alike.filter(([{ kind }]) => kind === IRREGULAR).sort(([a], [b]) => a.frequency - b.frequency);
  const amplitudes = alike.filter(([{ kind }]) => kind !== IRREGULAR).map(([{ frequency, amplitude }, its]) => {
    const size = Math.max(Math.abs(its.amplitude), least);
    return { frequency, error: size > 0 ? (amplitude - its.amplitude) / size : 0, scatter: 0, way };
  });
  return {
    amplitudes: [...amplitudes, ...ofMeans(odd, least, way)], ends,
    kinds: kinds.filter((each) => each.alone || each.width + each.open > narrowest),
    unknown: all.filter((pair) => pair.some(({ kind }) => kind === UNKNOWN)).map(([{ frequency }]) => frequency),
  };
}

/** Size of an error that is sure. @type {(error: AmplitudeError) => number} */
export const sure = ({ error, scatter }) => Math.max(Math.abs(error) - 2 * scatter, 0);
/** Size that it may have. @type {(error: AmplitudeError) => number} */
export const most = ({ error, scatter }) => Math.abs(error) + 2 * scatter;

/** Whether a number known to ± ``open`` is at most so large; null where that is open. */
/** @type {(size: number, open: number, allowed: number) => boolean | null} */
const within = (size, open, allowed) => (size + open <= allowed ? true : size - open > allowed ? false : null);

/** Errors of a response beside a reference, the largest first, and whether it suffices; null: that is open. */
/** @type {(legs: Leg[], asked: Asked) => Comparison} */
export function compared(legs, asked) {
  const large = legs.flatMap(({ theirs }) => theirs.map((each) => (strikes(each.kind) ? Math.abs(each.amplitude) : 0)));
  const found = legs.map((leg) => compareLeg(leg, asked.frequency, LEAST * Math.max(...large)));
  const amplitudes = found.flatMap((each) => each.amplitudes), ends = found.flatMap((each) => each.ends);
  const [scattered] = [...amplitudes].sort((a, b) => most(b) - most(a));
  /** @type {(a: {error: number}, b: {error: number}) => number} */
  const larger = (a, b) => Math.abs(b.error) - Math.abs(a.error);
  const [amplitude] = amplitudes.sort(larger)
    .sort((a, b) => sure(b) - sure(a) || Number(isFinite(b.scatter)) - Number(isFinite(a.scatter)));
  ends.sort(larger);
  const kinds = found.flatMap((each) => each.kinds), unknown = found.flatMap((each) => each.unknown);
  kinds.sort((a, b) => Number(b.alone) - Number(a.alone) || b.width - a.width);
  const states = [
    !amplitude || (sure(amplitude) <= asked.amplitude && (most(scattered) <= asked.amplitude || null)),
    unknown.length ? null : true,
    ...ends.map(({ error, open }) => within(Math.abs(error), open, asked.frequency)),
    ...kinds.map((each) => !each.alone && within(each.width, each.open, asked.frequency)),
  ];
  const suffices = states.includes(false) ? false : states.includes(null) ? null : true;
  return { amplitude, scattered, ends, kinds, unknown, suffices };
}
