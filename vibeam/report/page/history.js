// Picture: displacement of the output over time.
import { axis, chart, framed, lines } from "./chart.js";
import { increasing, keptSpan, short, withUnit } from "./numbers.js";

/** @import { DrawnMotion, Picture, Units } from "./pictures.js" */

const TIME = "Time in drive periods";

/** @type {(host: HTMLElement, units: Units) => Picture} */
export function history(host, { output }) {
  /** @type {DrawnMotion[]} */
  let current = [];
  /** @type {any} */
  let made = null;
  let known = "", span = [0, 1];
  const end = () => Math.max(1, ...current.map((each) => each.window));
  /** @type {(plot: any, number: number) => string} */
  const value = (_, number) => short(number);
  /** @type {(each: DrawnMotion) => any} */
  const entry = (each) => ({ label: each.label, stroke: () => each.colour(), value });

  /** @type {(pen: any, at: any) => void} */
  const paint = (pen, at) => {
    const frame = framed(at, 1, output.factor);
    for (const each of current) lines(pen, frame, each.time, each.x, { colour: each.colour(), dash: each.dash });
  };
  // While a slider moves the chart keeps its series and has no values to read out.
  /** @type {(still: boolean) => any[]} */
  const columns = (still) => still
    ? uPlot.join(current.map((each) => [increasing(each.time), Array.from(each.x, (value) => value * output.factor)]))
    : [[0, end()], ...current.map(() => [null, null])];

  /** @type {(still: boolean) => any} */
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
