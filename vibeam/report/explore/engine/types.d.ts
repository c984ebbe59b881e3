// Types of what a page carries of its case, and of what its engine answers; numbers in SI where nothing else is said.

/** Array to the bit: base64 of little-endian doubles. */
export type Packed = { f8: string; shape: number[] };
/** Kind of an argument: "d", "q", an array as "f8:2" or "i8:1", or a tuple of such. */
export type Kind = string | { tuple: string; fields: [string, Kind][] };
export type Entry = { arguments: [string, Kind][]; results: string[] };
/** Entries of the libraries, numbers of their rows by module, first byte of the memory that is the page's own. */
export type Table = { entries: Record<string, Entry>; rows: Record<string, Record<string, number>>; first: number };
export type Unit = { unit: string; factor: number };

export type Model = {
  name: string; label: string; finest: string;
  /** Engine that flies it, or null with the reason why the page cannot. */
  engine: "plain" | "regimes" | "harmonics" | null; refusal: string;
  modes: number; omega: Packed; zeta: Packed; contact: Packed; load: Packed; static: Packed;
  gap: number; restitution: number; damped?: boolean;
  outputs: Record<string, Packed>; output: string;
  stations: { places: number[]; rows: Packed; held: boolean } | null;
  /** Place, height at the case's gap, side, change of the height with the gap. */
  stops: [number, number, number, number][];
  /** Share of the drive's amplitude with which the base moves; null where it moves otherwise. */
  base: number | null;
  /** Regimes of a system beyond plain ones, and what of them other damping changes, by its factor. */
  rest: any; regimes?: any; dampings?: any[];
  /** Order, share of the first harmonic's Ω²B and phase (rad) of each further one. */
  harmonics?: Packed; drift?: { frequency: Packed; gap: Packed };
  /** Base amplitude: level · factor / Ω^power, or level times a table; the level is the case's. */
  amplitude: { level: number; power: number; factor: number } | { level: number; frequency: Packed; amplitude: Packed };
  look: { colour: string; dark: string; dash: number[]; wide: number };
};
export type SliderName = "frequency" | "drive" | "gap" | "restitution" | "damping";
/** A key of the case with its range; each fidelity's own number is a + b · value. */
export type Slider = Unit & {
  name: SliderName; key: string; label: string; value: number; low: number; high: number;
  of: Record<string, [number, number]>;
  /** Values that the slider keeps to: frequencies (Hz), factors on the damping. */
  places?: Packed;
};
/** What no slider changes, why, and the command that does. */
export type Fixed = { name?: SliderName; key: string; why: string; command: string };
export type Payload = {
  version: string; level: string; digest: string; libraries: Record<string, string>; slots: Table;
  models: Model[]; sliders: Slider[]; fixed: Fixed[];
  /** Words of an outcome by its code. */
  ended: Record<string, string>;
  sweep: {
    frequency: number[]; direction: "up" | "down" | "both"; settle: number; hold: number; output: string;
    units: { frequency: Unit; output: Unit & { name: string }; speed: Unit; contact_speed: Unit };
  };
  /** The template's parts are texts and sliders' values times a factor. */
  case: { title: string; name: string; file: string; template: (string | { slider: SliderName; times: number })[] };
};

/** Values of the keys; what is left out is the case's. */
export type Place = { [name in SliderName]?: number };
/** A fidelity's own numbers at a place. */
export type Settings = { omega: number; amplitude: number; gap: number; restitution: number; damping: number };
/** A state in the user's order of modes. */
export type State = { displacement: Float64Array; velocity: Float64Array; resting: boolean };
export type Flight = {
  impactTimes: ArrayLike<number>; impactVelocities: ArrayLike<number>; period: number; maximum: number; minimum: number;
  ended: string;
};
export type Poses = { x: Float64Array; v: Float64Array; modes: Float64Array };
export type Motion = {
  ended: string; omega: number; turn: number; state: State; start: number;
  times(points?: number): Float64Array; at(times: ArrayLike<number>): Poses;
  impacts: [number, number][]; counts: Record<string, number>;
};
/**
 * A steady point: how far the contact swings from its stop (m), mean velocity before impact (NaN without), drive periods
 * until it repeats (0: does not, −1: no contact), share of the time on the stop.
 */
export type SteadyPoint = {
  amplitude: number; maximum: number; minimum: number; reach: number; impactsPerPeriod: number; impactVelocity: number;
  period: number; rest: number;
};
export type Steady = SteadyPoint & { ended: string; state: State };
/**
 * How points are settled and watched: drive periods; start states, static equilibrium where there is none; `carried`:
 * each from the state of the point before, as a sweep; `slowest`: drive, rad/s, that panels are made for (none: the
 * slowest of the points), the same for all pieces of a curve.
 */
export type Schedule = {
  settle?: number; hold?: number; states?: (State | null)[]; carried?: boolean; slowest?: number;
};
/** Steady points over frequency, (points,), as Steady has them one by one; `impacts` of settling and hold. */
export type Response = {
  frequency: Float64Array; amplitude: Float64Array; maximum: Float64Array; minimum: Float64Array; reach: Float64Array;
  impactsPerPeriod: Float64Array; impactVelocity: Float64Array; period: Int32Array; rest: Float64Array;
  ended: string[]; states: State[]; impacts: number[];
};
/**
 * A motion with one impact in `periods` drive periods, the harder or the softer one, or that without contact, "free".
 * `phase` of the drive at the impact, 0 … 2π. Not admissible: it passes through the stop, is no motion and has neither
 * amplitude nor extremes.
 */
export type Orbit = {
  frequency: number; periods: number; branch: "harder" | "softer" | "free"; phase: number;
  amplitude: number; maximum: number; minimum: number; impactVelocity: number; stable: boolean; admissible: boolean;
};

/** A question to the worker: the arguments of the method in its order; the payload for "open". */
export type Question = { id: number; call: string; args: any[] };
/** Its answers: points from..done of so many, or the sentence of a refusal. */
export type Answer =
  | { id: number; done: number; of: number; from?: number; values: any; fault?: undefined }
  | { id: number; fault: string };
