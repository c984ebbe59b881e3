// Types of the page of a motion under a record: its data (transient.py), histories as they are drawn.
import type { Colours, Numbers, Packed, Unit } from "./types.d.ts";

export type Signal = Unit & { name: string; label: string; order: number };
/** Least and greatest values of even bins of time, in SI, of a fidelity or of all (the input: empty); ``data``: zlib of
 * four planes of bytes, the differences of the least values and the distances of the greatest, in steps. */
export type StoredHistory = {
  signal: string; fidelity: string; begin: number; width: number; bins: number; low: number; step: number; data: string;
};
export type History = { begin: number; width: number; least: Float64Array; greatest: Float64Array };
export type StoredImpacts = { fidelity: string; time: Packed; velocity: Packed; met: number };
export type Impacts = { time: number[]; velocity: number[]; met?: number };
/** A curve, in ``steps`` up to each x, with the band that holds its uncertainty; over an own x. */
export type BandCurve = { fidelity: string; x: Numbers; y: Numbers; low: Numbers; high: Numbers; marks: boolean; steps: boolean };
export type FamilyChart = {
  label: string; across: string; up: string; logs: { x: boolean; y: boolean }; note: string; curves: BandCurve[];
};
export type Mark = { label: string; begin: number; end: number };
export type RecordData = {
  span: [number, number]; fidelities: (Colours & { name: string; label: string; dash: number[]; wide: number })[];
  signals: Signal[]; histories: StoredHistory[]; impacts: StoredImpacts[]; contact_speed: Unit; marks: Mark[];
  families: Record<string, FamilyChart[]>;
};
