// A fidelity's own numbers at a place of the sliders.
import { driftAt } from "./drift.js";

/** @import { Place, Settings } from "./types.d.ts" */

const NAMES = ["frequency", "drive", "gap", "restitution", "damping"];
const SAME = 1e-9; // share by which a frequency may miss the table's, by round-off
const LIMITS = { gap: [-Infinity, Infinity], restitution: [0, 1], damping: [0, Infinity], amplitude: [0, Infinity], omega: [0, Infinity] };
const WORDS = {
  gap: ["gap", " m"], restitution: ["coefficient of restitution at the contact", ""], damping: ["factor on the damping", ""],
  amplitude: ["amplitude of the drive", " m"], omega: ["drive frequency", " rad/s"],
};

/**
 * The fidelity's own numbers at a place of the sliders; throws where one of them cannot be.
 * @param {any} model
 * @param {Map<string, any>} sliders
 * @param {Place} place
 * @returns {Settings}
 */
export function settingsAt(model, sliders, place) {
  for (const [name, value] of Object.entries(place)) {
    if (!NAMES.includes(name)) throw new Error(`No slider is called ${name}: there are ${NAMES.join(", ")}.`);
    if (value !== undefined && typeof value !== "number")
      throw new Error(`${name} must be a number, not ${JSON.stringify(value)}.`);
  }
  const own = (/** @type {"drive" | "gap" | "restitution" | "damping"} */ name, /** @type {number} */ usual) => {
    const value = place[name], slider = sliders.get(name);
    if (value === undefined) return usual;
    if (!slider) throw new Error(`${model.label}: its ${name} cannot be changed on this page.`);
    const line = slider.of[model.name]; // none: it has no such number, or one of its own
    return line ? line[0] + line[1] * value : usual;
  };
  const frequency = place.frequency ?? sliders.get("frequency")?.value, omega = 2 * Math.PI * frequency;
  const drift = model.drift ? driftAt(model.drift, frequency) : 0;
  const damping = own("damping", 1);
  const damped = model.dampings?.find((/** @type {{factor: number}} */ each) => each.factor === damping);
  const found = {
    omega, amplitude: amplitudeOf(model, frequency, own("drive", model.amplitude.level)) * (damped?.drive ?? 1),
    gap: own("gap", model.gap) + drift, restitution: own("restitution", model.restitution), damping,
  };
  for (const [name, value] of Object.entries(found)) {
    const key = /** @type {keyof typeof LIMITS} */ (name), [low, most] = LIMITS[key];
    const high = key === "restitution" && model.regimes ? Infinity : most; // a law's coefficient is no share
    if (!(Number.isFinite(value) && value >= low && value <= high) || (name === "omega" && value === 0))
      throw new Error(`${model.label}: the ${WORDS[key][0]} cannot be ${Number(value.toPrecision(4))}${WORDS[key][1]}.`);
  }
  if (model.engine === "plain" && !model.damped && found.damping !== 1)
    throw new Error(`${model.label}: its damping cannot be changed on this page.`);
  return found;
}

/**
 * Amplitude of the drive, m, at a frequency, Hz; one that is a table is known at its own frequencies alone.
 * @param {any} model
 * @param {number} frequency
 * @param {number} level
 * @returns {number}
 */
function amplitudeOf({ label, amplitude: { power, factor, frequency: known, amplitude: table } }, frequency, level) {
  if (!known) {
    let found = level * factor;
    for (let i = 0; i < power; i++) found /= 2 * Math.PI * frequency;
    return found;
  }
  let nearest = 0;
  for (let i = 1; i < known.length; i++)
    if (Math.abs(known[i] - frequency) < Math.abs(known[nearest] - frequency)) nearest = i;
  if (!(Math.abs(known[nearest] - frequency) <= SAME * frequency))
    throw new Error(`${label}: its drive is known at ${known.length} frequencies alone, the nearest is ${known[nearest]} Hz.`);
  return level * table[nearest];
}
