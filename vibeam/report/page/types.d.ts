// Types that the page's modules share: elements of its templates, the data of a result (charts.py), charts.
export {};

/** An element of the templates, of whatever kind: fields have a value, drawings a view box. */
export type PageElement = HTMLInputElement & HTMLButtonElement & HTMLTableElement & SVGSVGElement;
/** Colour of a line on white paper and on a dark ground. */
export type Colours = { colour: string; dark: string };
/** Unit that numbers in SI are shown in, and the factor to it. */
export type Unit = { unit: string; factor: number };
/** Units of the output, with its name, and of its velocity. */
export type Units = { output: Unit & { name: string }; speed: Unit };
/** Numbers in steps of their range, of 16 bits each, or of 32 where they are ``wide``. */
export type Packed = { data: string; low: number; step: number; wide?: boolean };
export type Numbers = (number | null)[];
export type Cell = string | number | null | undefined;

export type Fidelity = Colours & {
  name: string; label: string; dash: number[]; grazing: number | null; places: number[]; held: boolean;
  reference: boolean; wide: number;
};
export type Quantity = Unit & { name: string; label: string };
export type Kind = { name: string; width: number; dash: number[]; marker: string; alone: string; size: number };
export type Curve = {
  fidelity: string; way: string; frequency: number[]; values: Record<string, Numbers>;
  pieces: Record<string, [number, number, number][]>; ended: Record<string, string>; shares: Numbers[];
};
export type Reference = {
  name: string; fidelity: string; quantity: string; single: boolean; frequency: number[]; value: Numbers; bar: Numbers;
};
export type Data = {
  frequency: Unit; output: Unit & { name: string }; speed: Unit; contact_speed: Unit; quantities: Quantity[];
  palette: Colours[]; kinds: Kind[]; upward: { top: number; slight: number; note: string }; fidelities: Fidelity[];
  curves: Curve[]; references: Reference[];
};

/** Files of a view: texts of numbers and of a drawing, or the data URL of a picture in the drawing's place. */
export type Files = { csv?: (() => string) | ""; svg?: (() => string) | null | false; image?: string };

/** Numbers of a motion, as they come. */
export type Series = ArrayLike<number> & Iterable<number>;
/** A motion as it is drawn, just flown; SI, times in drive periods from the start of its window. */
export type DrawnMotion = {
  label: string; colour: () => string; dash: number[]; window: number; time: Series; x: Series; v: Series;
  /** Displacements and velocities. */
  section: number[][];
  /** Times, in drive periods. */
  impacts: number[];
  /** log10 of amplitudes from 0 to 16 times the drive frequency, evenly. */
  spectrum: number[];
  /** Deflections, frame by frame, at the places after the first; none where they are not known. */
  beam: Series; places: number[]; held: boolean;
  /** Place, height, 1 above or −1 below. */
  stops: number[][];
  /** Amplitude of the base; null where its motion is not harmonic. */
  base: number | null;
};
/** ``still``: at rest, with values to read out; false while a slider moves. */
export type Picture = { draw: (motions: DrawnMotion[], still: boolean) => void; charts: () => Chart[] };

/** What a canvas and the writer of SVG both draw with. */
export type Pen = {
  lineWidth: number; lineDashOffset: number; strokeStyle: any; fillStyle: any; font: string; textAlign: any;
  beginPath(): void; moveTo(x: number, y: number): void; lineTo(x: number, y: number): void; closePath(): void;
  arc(x: number, y: number, r: number, from: number, to: number): void;
  rect(x: number, y: number, width: number, height: number): void;
  setLineDash(dash: number[]): void; save(): void; restore(): void; clip(): void; stroke(): void; fill(): void;
  fillText(text: string, x: number, y: number, turn?: any): void;
};
/** The plot's frame for a pen: pixels of values, ``ratio`` of them to one of the page. */
export type Frame = {
  ratio: number; left: number; top: number; width: number; height: number;
  x: (value: number) => number; y: (value: number) => number; scales: Record<string, PlotScale>;
};
export type Draw = (pen: Pen, at: Frame) => void;
export type Look = { colour: string; width?: number; dash?: number[] };

export type PlotScale = { min: number; max: number };
export type PlotAxis = {
  label?: string | null; size?: number; stroke?: () => string; grid?: object; ticks?: object;
  values?: (plot: Plot, splits: any[]) => Cell[];
  splits?: (plot: Plot, axis: number, low: number, high: number) => number[];
  _splits?: number[]; _values?: Cell[];
};
export type PlotSeries = {
  label?: string; show?: boolean; stroke?: () => string; paths?: () => null; points?: object;
  value?: (plot: Plot, value: number) => string;
};
/** A chart of uPlot: the part of it that the page uses. */
export type Plot = {
  ctx: CanvasRenderingContext2D; root: HTMLElement; over: HTMLElement; bbox: DOMRect; width: number; height: number;
  axes: PlotAxis[]; series: PlotSeries[]; data: Numbers[]; scales: Record<string, PlotScale>;
  cursor: { idx?: number | null; left?: number };
  select: { left: number; width: number };
  setSelect(box: { left: number; top: number; width: number; height: number }, heard?: boolean): void;
  valToPos(value: number, scale: string, canvas?: boolean): number;
  posToVal(place: number, scale: string, canvas?: boolean): number;
  setSize(size: { width: number; height: number }): void;
  setScale(scale: string, range: PlotScale): void;
  setData(columns: Numbers[], scaled?: boolean): void;
  redraw(paths?: boolean, axes?: boolean): void;
  batch(change: () => void): void;
  destroy(): void;
};
export type PlotRange = (plot: Plot, low: number, high: number) => number[];
export type PlotScales = Record<string, { time?: boolean; range?: PlotRange }>;
export type PlotHooks = Record<string, ((plot: Plot, key: any) => void)[]>;
/** What a chart is made of; `draw` is cut off at the frame, `mark` is not. */
export type ChartParts = {
  words: string; height?: number; series: PlotSeries[]; columns: Numbers[]; axes: PlotAxis[]; scales?: PlotScales;
  draw: Draw; mark?: Draw; hooks?: PlotHooks; legend?: boolean; cursor?: object;
};
export type Chart = { plot: Plot; words: string; series: PlotSeries[]; drawAll: Draw };

declare global {
  const uPlot: { new (options: object, columns: Numbers[], host: Element): Plot; join(tables: Numbers[][]): Numbers[] };
}
