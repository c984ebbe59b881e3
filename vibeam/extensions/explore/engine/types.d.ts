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
  asked: Asked;
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

/** Errors that a case allows: of amplitudes, of ends of branches; shares. */
export type Asked = { amplitude: number; frequency: number };
/** Place of a swept curve with the kind of its motion in words; places are in the order swept. */
export type Swept = { frequency: number; amplitude: number; kind: string };
/** Curves of two models in one direction of the sweep, "up" or "down", on one grid. */
export type Leg = { way: string; ours: Swept[]; theirs: Swept[] };
/** Places from the first to the last of a curve. */
export type Part = { first: number; last: number };
/** Range in Hz, its relative width, and how far this is open. */
export type Span = { low: number; high: number; width: number; open: number };
/** `head`, `tail`: first and last of its own places, where it has taken in narrow neighbours. */
export type Branch = Part & { kind: string; head: number; tail: number };
/** Range in which the kinds of the motions, ours and the reference's, are the same two all over. */
export type Piece = Part & Span & { kinds: string[] };
/** End of a branch, Hz, known to ± `open`: kinds before and after it as swept; `jump` of the amplitude: 1 up, −1 down. */
export type End = { frequency: number; open: number; before: string; after: string; way: string; jump: number };
/** `scatter`: standard error of an error of means, of motions that do not repeat; else 0. */
export type AmplitudeError = { error: number; scatter: number; frequency: number; way: string };
export type EndError = { error: number; open: number; ours: End; reference: End };
/** `alone`: one of the two has contact, the other has none in the whole sweep of this direction. */
export type KindDifference = Span & { kinds: string[]; way: string; alone: boolean };
/** `unknown`: frequencies of places at which the two cannot be compared. */
export type Errors = { amplitudes: AmplitudeError[]; ends: EndError[]; kinds: KindDifference[]; unknown: number[] };
export type Comparison = {
  /** Where the amplitude is surely most off, and where it may be. */
  amplitude: AmplitudeError | undefined; scattered: AmplitudeError | undefined;
  ends: EndError[]; kinds: KindDifference[]; unknown: number[]; suffices: boolean | null;
};

/** A question to the worker: the arguments of the method in its order; the payload for "open". */
export type Question = { id: number; call: string; args: any[] };
/** Its answers: points from..done of so many, or the sentence of a refusal. */
export type Answer =
  | { id: number; done: number; of: number; from?: number; values: any; fault?: undefined }
  | { id: number; fault: string };
