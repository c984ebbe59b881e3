// Picture: spectrum of the output, a strip a motion, lines as stems: spectra do not cover one another.
import { axis, chart, lines } from "./chart.js";
import { element } from "./state.js";

/** @import { Cell, Chart, DrawnMotion, Draw, Picture, Plot, Units } from "./types.d.ts" */

const DECADES = 6;  // that are drawn
export const HARMONICS = 16;  // highest multiple of the drive frequency

/** Multiple of the drive frequency of a line. @type {(each: DrawnMotion, index: number) => number} */
export const multiple = (each, index) => (index * HARMONICS) / (each.spectrum.length - 1);

/** @type {(host: HTMLElement, units: Units) => Picture} */
export function spectrum(host, { output }) {
  const shift = Math.log10(output.factor);
  /** @type {Chart[]} */
  let made = [];
  /** @type {DrawnMotion[]} */
  let current = [];
  let top = 0, known = "";

  /** @type {(each: DrawnMotion) => [number[], (number | null)[]]} */
  const columnsOf = (each) => {
    const values = Array.from(each.spectrum, (value) => (value + shift <= top - DECADES ? null : value + shift));
    return [values.map((_, index) => multiple(each, index)), values];
  };

  /** @type {(place: number) => Draw} */
  const painter = (place) => (pen, at) => {
    const each = current[place], [places, values] = columnsOf(each), low = at.scales.y.min;
    const ups = values.flatMap((value) => (value === null ? [null, null, null] : [low, value, null]));
    lines(pen, at, places.flatMap((x) => [x, x, x]), ups, { colour: each.colour(), width: 1.2 });
    [pen.fillStyle, pen.textAlign, pen.font] = [each.colour(), "right", `600 ${12 * at.ratio}px system-ui, sans-serif`];
    pen.fillText(each.label, at.left + at.width - 4 * at.ratio, at.top + 12 * at.ratio);
  };

  const powers = () => {
    const first = Math.ceil((top - DECADES) / 2) * 2;
    return Array.from({ length: Math.floor((top + 0.5 - first) / 2) + 1 }, (_, at) => first + 2 * at);
  };
  /** @type {(write: (value: number) => string) => (plot: Plot, splits: Cell[]) => string[]} */
  const ticks = (write) => (_, splits) => splits.map((each) => write(Number(each)));
  const bare = { ...axis(null), size: 8, values: ticks(() => "") };
  const named = { ...axis("Multiple of the drive frequency"), size: 44 };
  const up = { ...axis(null), size: 50, splits: powers, values: ticks((value) => `1e${value}`) };

  /** @type {(each: DrawnMotion, place: number) => Chart} */
  const strip = (each, place) => {
    const own = element("div", { class: "chart" }), last = place === current.length - 1;
    host.append(own);
    return chart(own, {
      words: `Spectrum of the output: ${each.label}`, height: last ? 150 : 90, legend: false, cursor: { show: false },
      series: [{}, { label: each.label }], columns: columnsOf(each), axes: [last ? named : bare, up],
      scales: {
        x: { time: false, range: () => [-0.1, HARMONICS + 0.1] }, y: { range: () => [top - DECADES, top + 0.5] },
      },
      draw: painter(place),
    });
  };

  return {
    charts: () => made,
    draw(motions) {
      const now = motions.map((each) => each.label).join("\n");
      current = motions;
      top = Math.max(...motions.flatMap((each) => Math.max(...each.spectrum))) + shift;
      if (now === known) return made.forEach((each, place) => each.plot.setData(columnsOf(current[place])));
      known = now;
      host.replaceChildren();
      made = motions.map(strip);
    },
  };
}
