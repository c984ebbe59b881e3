// What the comparison of a fidelity with its reference says, in words (Python: report/comparison_words.py).
import { short } from "../../../report/page/numbers.js";
import { contact } from "./branches.js";
import { most, sure } from "./comparison.js";
import { payload, units } from "./place.js";

/** @import { AmplitudeError, Comparison, End, EndError } from "../engine/types.d.ts" */

const { asked } = payload, { frequency: { factor, unit } } = units;
export const accuracy = `${short(100 * asked.amplitude, 3)} %`;
/** Size of a difference, to a tenth of a percent; one digit of a small one. @type {(value: number) => string} */
export function size(value) {
  const share = 100 * Math.abs(value);
  return share < 0.01 ? "less than 0.01 %" : `${share < 1 ? short(share, 1) : +share.toFixed(1)} %`;
}
/** Size of an error, and how uncertain a mean leaves it. @type {(error: AmplitudeError) => string} */
const spread = ({ error, scatter }) => `${size(error)}${scatter ? ` ± ${size(2 * scatter)}` : ""}`;
/** @type {(...frequencies: number[]) => string} */
const at = (...frequencies) => `${frequencies.map((each) => short(each * factor)).join(" to ")} ${unit}`.trim();

/** @type {(end: End) => string} */
function noun(end) {
  if (end.jump) return `jump ${end.jump > 0 ? "up" : "down"}`;
  if (contact(end)) return contact(end) > 0 ? "first contact" : "loss of contact";
  return `change from ${end.before} to ${end.after}`;
}

/** An end that is surely elsewhere, as a range: the grid leaves it open. @type {(error: EndError) => string} */
function moved({ error, open, ours, reference }) {
  const late = error > 0 === (ours.way === "up") ? "late" : "early", off = Math.abs(error);
  if (off <= open) return `ends of branches within ${size(off + open)}, to the grid`;
  const range = `${size(off - open)} to ${size(off + open)}`;
  return `the ${noun(ours)} ${range} ${late} (${short(ours.frequency * factor)} for ${at(reference.frequency)})`;
}

/** What a fidelity that suffices is within. @type {(found: Comparison) => string} */
function numbers({ amplitude, ends }) {
  const [widest] = [...ends].sort((a, b) => Math.abs(b.error) + b.open - Math.abs(a.error) - a.open);
  const within = amplitude ? `amplitudes within ${spread(amplitude)} (at ${at(amplitude.frequency)})` : "";
  return [within, widest ? moved(widest) : ""].filter(Boolean).join(", ") || "no contact in either";
}

/** The largest error that is surely more than is allowed. @type {(found: Comparison, reference: string) => string} */
function gravest({ amplitude, ends, kinds }, reference) {
  const end = ends.find((each) => Math.abs(each.error) - each.open > asked.frequency);
  const kind = kinds.find((each) => each.alone || each.width - each.open > asked.frequency);
  const high = amplitude ? sure(amplitude) / asked.amplitude : 0, far = Math.abs(end?.error ?? 0) / asked.frequency;
  if (kind && (kind.alone || kind.width / asked.frequency >= Math.max(high, far))) {
    const way = kind.way === "down" ? " swept down" : "";
    return `${kind.kinds[0]} from ${at(kind.low, kind.high)}${way}, where ${reference} has ${kind.kinds[1]}`;
  }
  if (end && far >= high) return moved(end);
  if (!amplitude) return "–";
  return `${spread(amplitude)} too ${amplitude.error > 0 ? "high" : "low"} at ${at(amplitude.frequency)}`;
}

/** What leaves it open whether a fidelity suffices. @type {(found: Comparison) => string} */
function open({ scattered, ends, kinds: [kind], unknown }) {
  const end = ends.find(({ error, open }) => Math.abs(error) + open > asked.frequency);
  if (unknown.length) return `not known at ${at(unknown[0])}, where a motion failed`;
  if (scattered && most(scattered) > asked.amplitude) {
    const by = isFinite(scattered.scatter) ? `scatter by ${size(2 * scattered.scatter)}` : "were read but once";
    return `motions that do not repeat ${by} at ${at(scattered.frequency)}`;
  }
  if (!end) return `${kind.kinds.join(" or ")} at ${at(kind.low, kind.high)}, to the grid`;
  return `the ${noun(end.ours)} at ${at(end.reference.frequency)} is known to ± ${size(end.open)}, by the grid`;
}

/** Whether a fidelity suffices, and why. @type {(found: Comparison | string, reference: string) => string} */
export function answer(found, reference) {
  if (typeof found === "string") return found;
  if (found.suffices) return `suffices: ${numbers(found)}`;
  return found.suffices === null ? `may suffice: ${open(found)}` : `does not suffice: ${gravest(found, reference)}`;
}

/** Both errors, and whether it suffices. @type {(found: Comparison | string) => string[]} */
export function cells(found) {
  if (typeof found === "string") return [found, found, found];
  const { amplitude, ends: [end], suffices } = found, off = Math.abs(end?.error ?? 0);
  return [
    amplitude && isFinite(amplitude.scatter) ? `${spread(amplitude)} at ${at(amplitude.frequency)}` : "–",
    !end ? "–" : off > end.open ? `${size(off)} ± ${size(end.open)}` : `within ${size(off + end.open)}`,
    suffices ? "yes" : suffices === null ? "open" : "no",
  ];
}
