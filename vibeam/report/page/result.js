// What the views of a result share: its numbers, the curves that are shown, the frequency that is picked.
import { address, byId, colourOf, hidden, tell } from "./state.js";
/** @import { Data, Fidelity } from "./types.d.ts" */

const NONE = { frequency: { unit: "", factor: 1 }, fidelities: [], curves: [], references: [] };
/** Of a page without a sweep: no curves. @type {Data} */
export const data = byId("data") ? JSON.parse(byId("data").textContent) : NONE;
/** @typedef {{fidelity: string, way: string}} Branch */
/** @type {Record<string, Fidelity>} */
export const fidelity = Object.fromEntries(data.fidelities.map((each) => [each.name, each]));
/** @type {(curve: Branch) => string} */
export const title = (curve) => `${fidelity[curve.fidelity].label} ${curve.way === "up" ? "↑" : "↓"}`;
/** @type {(curve: {fidelity: string}) => string} */
export const colour = (curve) => colourOf(fidelity[curve.fidelity]);
/** @type {(curve: Branch) => string} */
export const shade = (curve) => colour(curve) + (curve.way === "up" ? "" : "88");
export const MANY = 5;  // fidelities in one pair of axes, of which the reference alone has its colour
export const FACTOR = data.frequency.factor;
/** @type {(frequency: number) => string} */
export const inUnits = (frequency) => `${+(frequency * FACTOR).toPrecision(6)} ${data.frequency.unit}`.trim();

// Curves are hidden by their numbers; those of the same fidelity and way are one in all views.
/** @type {(curve: Branch) => boolean} */
export const isShown = (curve) => !hidden.numbers.has(data.curves.findIndex((each) => each.fidelity === curve.fidelity && each.way === curve.way));

// The picked frequency (Hz) is one of the curves', on a page that flies.
const kept = byId("explore-body") ? [...new Set(data.curves.flatMap((each) => each.frequency))].sort((a, b) => a - b) : [];
/** @type {(frequency: number) => number} */
const nearest = (frequency) => kept.reduce((best, value, at) => (Math.abs(value - frequency) < Math.abs(kept[best] - frequency) ? at : best), 0);
/** Frequency of the highest point of the reference. */
function highest() {
  const own = data.curves.filter((each) => fidelity[each.fidelity].reference), curves = own.length ? own : data.curves;
  const points = curves.flatMap(({ frequency, values: { amplitude } }) => frequency.map((each, at) => [amplitude[at] ?? -1, each]));
  return points.reduce((best, each) => (each[0] > best[0] ? each : best))[1];
}
const asked = address.numbers("f")[0];
let at = kept.length ? nearest(asked === undefined ? highest() : asked / FACTOR) : -1;
/** Undefined where none can be picked. @type {() => number | undefined} */
export const picked = () => kept[at];
/** @type {(frequency: number) => void} */
export function pickNear(frequency) {
  if (!kept.length) return;
  at = nearest(frequency);
  tell("picked");
}
