// Picture: displacement of the output over time.
import { axis, chart, framed, lines } from "./chart.js";
import { increasing, keptSpan, short, withUnit } from "./numbers.js";

/** @import { Chart, DrawnMotion, Draw, Numbers, Picture, Plot, PlotSeries, Units } from "./types.d.ts" */

const TIME = "Time in drive periods", TICK = 7;  // px

/** @type {(host: HTMLElement, units: Units) => Picture} */
export function history(host, { output }) {
  /** @type {DrawnMotion[]} */
  let current = [];
  /** @type {Chart | null} */
  let made = null;
  /** @type {[number, number]} */
  let span = [0, 1];
  let known = "";
  const end = () => Math.max(1, ...current.map((each) => each.window));
  /** @type {(plot: Plot, number: number) => string} */
  const value = (_, number) => short(number);
  /** @type {(each: DrawnMotion) => PlotSeries} */
  const entry = (each) => ({ label: each.label, stroke: () => each.colour(), value });

  /** @type {Draw} */
  const paint = (pen, at) => {
    const frame = framed(at, 1, output.factor);
    for (const each of current) lines(pen, frame, each.time, each.x, { colour: each.colour(), dash: each.dash });
    current.forEach(({ impacts, colour }, row) => {  // ticks along the lower edge, a row a motion
      const low = at.top + at.height - TICK * row * at.ratio, ys = [low, low - 0.7 * TICK * at.ratio, null];
      const frame = { ...at, y: (/** @type {number} */ value) => value };
      lines(pen, frame, impacts.flatMap((time) => [time, time, time]), impacts.flatMap(() => ys), { colour: colour() });
    });
  };
  // While a slider moves the chart keeps its series and has no values to read out.
  /** @type {(still: boolean) => Numbers[]} */
  const columns = (still) => still
    ? uPlot.join(current.map((each) => [increasing(each.time), Array.from(each.x, (value) => value * output.factor)]))
    : [[0, end()], ...current.map(() => [null, null])];

  /** @type {(still: boolean) => Chart} */
  const make = (still) => chart(host, {
    words: "Displacement of the output over time", height: 250, columns: columns(still), draw: paint,
    series: [{ label: TIME, value }, ...current.map(entry)],
    axes: [{ ...axis(TIME), size: 44 }, axis(withUnit(output.name, output.unit))],
    scales: { x: { time: false, range: () => [0, end()] }, y: { range: () => span } },
  });

  return {
    charts: () => (made ? [made] : []),
    draw(motions, still) {
      current = motions;
      const now = motions.map((each) => each.label + each.colour()).join("\n");
      span = keptSpan(still ? null : span, motions.map((each) => each.x), output.factor);
      if (!motions.length) { host.replaceChildren(); made = null; }
      else if (made && now === known) made.plot.setData(columns(still));
      else made = make(still);
      known = now;
    },
  };
}
