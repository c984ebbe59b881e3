// Numbers as texts, packed arrays.
import { bytesOf } from "./base64.js";
/** @import { Packed } from "./types.d.ts" */

/** @type {(value: number | null | undefined, digits?: number) => string} */
export const short = (value, digits = 4) => (value === null || value === undefined || !isFinite(value) ? "–" : String(+value.toPrecision(digits)));
/** @type {(label: string, unit: string) => string} */
export const withUnit = (label, unit) => (unit ? `${label} (${unit})` : label);
/** @type {(value: number | null | undefined) => string} */
export const percent = (value) => (value === null || value === undefined ? "–" : `${short(100 * value, 3)} %`);

/** @type {[string, number][]} */
const LENGTHS = [["m", 1], ["mm", 1e3], ["µm", 1e6], ["nm", 1e9]];
/** @type {(value: number) => string} */
export const metres = (value) => {
  const [unit, factor] = LENGTHS.find(([, each]) => Math.abs(value) * each >= 0.1) || LENGTHS[3];
  return `${short(value * factor, 2)} ${unit}`;
};

/** @type {(packed: Packed) => number[]} */
export function unpacked(packed) {
  const bytes = bytesOf(packed.data);
  return Array.from(packed.wide ? new Uint32Array(bytes.buffer) : new Uint16Array(bytes.buffer), (whole) => packed.low + packed.step * whole);
}

/** @type {(values: Iterable<number>) => number[]} */
export function increasing(values) {
  let last = -Infinity;
  return Array.from(values, (value) => (last = value > last ? value : last + 1e-9));
}

/** @type {(values: Iterable<number>) => [number, number]} */
export function spanOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  const room = (high - low || Math.abs(high) || 1) * 0.06;
  return [low - room, high + room];
}

// Range of an axis for several motions' values times ``factor``: ``before`` (where given) while it still fits them.
/** @type {(before: [number, number] | null, all: Iterable<number>[], factor: number) => [number, number]} */
export function keptSpan(before, all, factor) {
  const [low, high] = spanOf(function* () { for (const values of all) for (const value of values) yield value * factor; }());
  if (before && low >= before[0] && high <= before[1] && high - low > 0.6 * (before[1] - before[0])) return before;
  return low < high ? [low, high] : [0, 1];
}
