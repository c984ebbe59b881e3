// The sliders' place: values of the keys in SI, the fidelities that are shown; both stand in the address.
import { address, byId, tell } from "../../../report/page/state.js";
import { decoded } from "../engine/decoding.js";

/** @import { Model, Packed, Payload, Place, Slider, SliderName } from "../engine/types.d.ts" */

/** @type {Payload} */
export const payload = JSON.parse(byId("engine").textContent);
export const units = payload.sweep.units;
/** @type {Model[]} */
export const models = payload.models.filter((each) => each.engine);
/** @type {(name: SliderName) => Slider | undefined} */
export const sliderOf = (name) => payload.sliders.find((each) => each.name === name);
/** Whether a motion ran to its end. @type {(ended: string) => boolean} */
export const complete = (ended) => ended === payload.ended[0];

/** Array of the payload. @type {(packed: Packed) => number[]} */
export const numbers = (packed) => Array.from(decoded(packed));
const snaps = new Map(payload.sliders.map((each) => [each.name, each.places ? numbers(each.places) : []]));
/** What a slider snaps to, where its drive is a table. @type {(slider: Slider) => number[]} */
export const placesOf = ({ name }) => snaps.get(name) ?? [];

const ADDRESS = { frequency: "f", drive: "drive", gap: "gap", restitution: "R", damping: "damping" };
/** Whether the address names a place. */
export const isLink = [...Object.values(ADDRESS), "start"].some((key) => address.get(key) !== null);
const DIGITS = 6, TOLERANCE = 1e-9;
export const REST = 200;  // ms without a change that are rest

/** A value as its text in shown units; that text is the value, so that a link reproduces it. */
/** @type {(slider: Slider, value: number) => string} */
export const shownText = (slider, value) => String(+(value * slider.factor).toPrecision(DIGITS));

/**
 * The value (SI) of a number in shown units, at one of the slider's places where it has such; NaN outside its range.
 * @type {(slider: Slider, number: number) => number}
 */
export function valueOf(slider, number) {
  const value = number / slider.factor, room = TOLERANCE * Math.max(Math.abs(slider.low), Math.abs(slider.high));
  if (!(value >= slider.low - room && value <= slider.high + room)) return NaN;
  const within = Math.min(Math.max(value, slider.low), slider.high);  // of an end's rounded text
  if (!placesOf(slider).length) return within;
  return placesOf(slider).reduce((best, each) => (Math.abs(each - within) < Math.abs(best - within) ? each : best));
}

/** Place of the case itself; ``frequency``: where the page starts. */
/** @type {Record<string, number>} */
const start = Object.fromEntries(payload.sliders.map((each) => [each.name, each.value]));
const values = { ...start };
/** @type {(name: SliderName) => number} */
export const valueAt = (name) => values[name];
/** The place as the engine takes it: what is as in the case is left out. @type {() => Place} */
export function place() {
  const moved = payload.sliders.filter(({ name, value }) => name === "frequency" || values[name] !== value);
  return Object.fromEntries(moved.map(({ name }) => [name, values[name]]));
}
/** Whether the keys but the frequency are the case's. */
export const asCase = () => payload.sliders.every(({ name }) => name === "frequency" || values[name] === start[name]);

// Browsers bear few changes of the address a second: it is written at rest.
let timer = 0;
function write() {
  for (const slider of payload.sliders) {
    const { name } = slider, value = values[name];
    address.set(ADDRESS[name], value === start[name] ? null : shownText(slider, value));
  }
}
function changed() {
  clearTimeout(timer);
  timer = setTimeout(write, REST);
  tell("moved");
}

/**
 * Move a slider; all that is drawn hears of it. ``exact``: a value (SI) of the case or of its results.
 * @type {(name: SliderName, value: number) => void}
 */
export function move(name, value) {
  if (value === values[name] || !isFinite(value)) return;
  values[name] = value;
  changed();
}

export function reset() {
  Object.assign(values, start);
  changed();
}

/** Where the page starts without a link. @type {(frequency: number, wanted: Start) => void} */
export function begin(frequency, wanted) {
  if (address.get("start") === null) from = wanted;
  const slider = sliderOf("frequency"), value = slider ? valueOf(slider, frequency * slider.factor) : NaN;
  if (!isFinite(value)) return;
  start.frequency = value;
  if (address.get(ADDRESS.frequency) === null) values.frequency = value;
}

/** Sliders whose value in the link is none of theirs. @type {Slider[]} */
export const lost = [];
for (const slider of payload.sliders) {
  const key = ADDRESS[slider.name], value = valueOf(slider, address.numbers(key)[0] ?? NaN);
  if (isFinite(value)) values[slider.name] = value; else if (address.get(key) !== null) lost.push(slider);
}

// Fidelities that the reader took away, by name.
const known = new Set(models.map((each) => each.name));
const taken = new Set((address.get("without") ?? "").split(",").filter((name) => known.has(name)));
export const flown = () => models.filter((each) => !taken.has(each.name));
/** @type {(name: string) => boolean} */
export const isFlown = (name) => !taken.has(name);
/** @type {(name: string, wanted: boolean) => void} */
export function take(name, wanted) {
  if (wanted) taken.delete(name); else taken.add(name);
  address.set("without", [...taken].join(","));
  tell("taken");
}

export const direction = payload.sweep.direction;
export const sweepWords = direction === "down" ? "a sweep downwards" : "a sweep upwards";
/** What the points of a curve follow, in words. */
export const sweptAs = direction === "both" ? "before, as a sweep upwards and down again"
  : `${direction === "down" ? "above" : "below"}, as ${sweepWords}`;

// Where a motion starts before it settles: static equilibrium, or the state of the case's sweep at its frequency.
/** @typedef {"equilibrium" | "sweep"} Start */
/** @type {Start} */
let from = address.get("start") === "sweep" ? "sweep" : "equilibrium";
export const startsFrom = () => from;
/** @type {(wanted: Start) => void} */
export function startFrom(wanted) {
  from = wanted;
  address.set("start", wanted);
  tell("taken");
}

/** The case as TOML with the keys at the sliders' place, in SI. */
export const caseText = () => payload.case.template
  .map((part) => (typeof part === "string" ? part : String(values[part.slider] * part.times))).join("");
