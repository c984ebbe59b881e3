// Picture: phase portrait of the output, with its section at the drive's phase 0.
import { axis, chart, framed, lines } from "./chart.js";
import { keptSpan, withUnit } from "./numbers.js";

/** @import { Chart, DrawnMotion, Draw, Picture, Units } from "./types.d.ts" */

/** @type {(host: HTMLElement, units: Units) => Picture} */
export function portrait(host, { output, speed }) {
  /** @type {DrawnMotion[]} */
  let current = [];
  /** @type {Chart | null} */
  let made = null;
  /** @type {[number, number]} */
  let across = [0, 1];
  /** @type {[number, number]} */
  let up = [0, 1];

  /** @type {Draw} */
  const paint = (pen, at) => {
    const frame = framed(at, output.factor, speed.factor);
    for (const each of current) {
      const [xs, vs] = each.section;
      lines(pen, frame, each.x, each.v, { colour: each.colour(), dash: each.dash });
      pen.fillStyle = each.colour();
      xs.forEach((x, index) => {
        pen.beginPath();
        pen.arc(frame.x(x), frame.y(vs[index]), 3 * at.ratio, 0, 7);
        pen.fill();
      });
    }
  };

  const make = () => chart(host, {
    words: "Phase portrait: velocity against displacement", height: 300, legend: false, cursor: { show: false },
    series: [{}, { stroke: () => "none" }], columns: [[0, 1], [0, 1]], draw: paint,
    axes: [{ ...axis(withUnit(output.name, output.unit)), size: 44 }, axis(withUnit("velocity", speed.unit))],
    scales: { x: { time: false, range: () => across }, y: { range: () => up } },
  });

  return {
    charts: () => (made ? [made] : []),
    draw(motions, still) {
      current = motions;
      across = keptSpan(still ? null : across, motions.map((each) => each.x), output.factor);
      up = keptSpan(still ? null : up, motions.map((each) => each.v), speed.factor);
      if (!motions.length) { host.replaceChildren(); made = null; }
      else if (made) made.plot.setData([across, up]);
      else made = make();
    },
  };
}
