// Picture: response curves at the sliders' place, with the stored curves behind in grey.
import { byId, colourOf, ink, on } from "../../../report/page/state.js";
import { axis, chart, drawMark, framed, lines, svgOf, upright } from "../../../report/page/chart.js";
import { withUnit } from "../../../report/page/numbers.js";
import { csv, offer } from "../../../report/page/saving.js";
import { MANY, data } from "../../../report/page/result.js";
import { swept } from "./curves.js";
import { asCase, complete, direction, flown, isFlown, move, sliderOf, units, valueAt, valueOf } from "./place.js";

/** @import { Draw, Frame, Pen } from "../../../report/page/types.d.ts" */
/** @import { Model } from "../engine/types.d.ts" */
/** @import { Curve, Point } from "./curves.js" */
/** @import { Standing } from "./flying.js" */

const ROOM = 1.06, PAUSE = 30;  // PAUSE: ms between two pictures of the curves
const factor = units.frequency.factor, { output } = units;
const ends = [swept[0] * factor, swept[swept.length - 1] * factor], beside = 0.01 * (ends[1] - ends[0]);
const label = withUnit("Amplitude ½(max − min)", output.unit);

/** Points of a fidelity over its orbits; what did not run to its end is marked in a row at the upper edge. */
/** @type {(pen: Pen, at: Frame, model: Model, curve: Curve, row: number) => void} */
function paintOne(pen, at, { look, name, finest }, { points, back, orbits }, row) {
  const frame = framed(at, factor, output.factor);
  const colour = flown().length >= MANY && name !== finest ? ink("steel") : colourOf(look);
  for (const each of orbits) {
    const style = { colour, width: look.wide * (each[0].stable ? 1.4 : 1), dash: each[0].stable ? [] : [4, 4] };
    lines(pen, frame, each.map(({ frequency }) => frequency), each.map(({ amplitude }) => amplitude), style);
  }
  [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [colour, colour, 1.2 * at.ratio];
  pen.setLineDash([]);
  const size = look.wide * Math.min(2.4, Math.max(1.2, (0.3 * at.width) / at.ratio / swept.length)) * at.ratio;
  for (const { frequency, amplitude, period, ended } of [...points, ...back]) {
    const x = frame.x(frequency);
    if (complete(ended)) drawMark(pen, period === 0 ? "o" : "full", x, frame.y(amplitude), size);
    else drawMark(pen, "x", x, at.top + (6 + 8 * row) * at.ratio, size);
  }
}

/** Stored curves, those of fidelities that are not flown here too. */
const stored = () => data.curves.filter((each) => isFlown(each.fidelity));

/** @type {(points: Point[], way: string) => string[][]} */
const cells = (points, way) => points.map((each) => [
  each.frequency * factor, each.amplitude * output.factor, each.maximum * output.factor, each.minimum * output.factor,
  each.impactsPerPeriod, each.impactVelocity * units.contact_speed.factor, each.period,
  complete(each.ended) ? "" : each.ended, way,
].map((cell) => (Number.isNaN(cell) ? "" : String(cell))));

/** ``standing``: the motions at the slider's frequency, each a ring. */
/** @type {(curveOf: (model: Model) => Curve, standing: () => Standing | null) => () => void} */
export function responseChart(curveOf, standing) {
  let top = 0, frame = 0;

  // The axis holds still while points fill in.
  /** @type {() => [number, number]} */
  const upward = () => {
    const known = stored().flatMap((each) => each.values.amplitude.map((value) => value ?? 0));
    for (const curve of flown().map(curveOf)) {
      const all = [...curve.points, ...curve.back, ...curve.orbits.flat()];
      known.push(...all.map(({ amplitude }) => amplitude * output.factor || 0));
    }
    const need = Math.max(0, ...known);
    if (need > top || need < 0.5 * top) top = ROOM * need;
    return [0, top || 1];
  };

  /** @type {Draw} */
  const paint = (pen, at) => {
    const x = at.x(valueAt("frequency") * factor), known = standing(), behind = framed(at, factor, 1);
    for (const { frequency, values, pieces } of stored()) {
      for (const [, begin, end] of pieces.amplitude) {  // no line over a jump
        const xs = frequency.slice(begin, end), ys = values.amplitude.slice(begin, end), colour = ink("steel");
        lines(pen, behind, xs, ys, { colour, width: 3 });
        pen.fillStyle = colour;
        if (xs.length === 1 && ys[0] !== null) drawMark(pen, "full", behind.x(xs[0]), behind.y(ys[0]), 2.5 * at.ratio);
      }
    }
    byId("many-flown").hidden = flown().length < MANY;
    const order = flown().sort((a, b) => Number(a.name === a.finest) - Number(b.name === b.finest));
    order.forEach((each, row) => paintOne(pen, at, each, curveOf(each), row));
    upright(pen, at, valueAt("frequency") * factor);
    pen.setLineDash([]);
    for (const { name, look } of flown()) {
      const own = known?.steady.get(name);
      [pen.strokeStyle, pen.lineWidth] = [colourOf(look), 1.6 * at.ratio];
      if (own && complete(own.ended)) drawMark(pen, "o", x, at.y(own.amplitude * output.factor), 4.5 * at.ratio);
    }
  };

  const made = chart(byId("live-response"), {
    words: `${label} against drive frequency, flown at the sliders' place`, height: 300, legend: false, draw: paint,
    series: [{}, { stroke: () => ink() }], columns: [ends, [0, 1]],
    axes: [{ ...axis(withUnit("Drive frequency", units.frequency.unit)), size: 44 }, axis(label)],
    scales: { x: { time: false, range: () => [ends[0] - beside, ends[1] + beside] }, y: { range: upward } },
    cursor: { drag: { x: false, y: false }, points: { show: false } },
  });
  made.plot.over.addEventListener("click", (/** @type {MouseEvent} */ event) => {
    const slider = sliderOf("frequency"), left = made.plot.over.getBoundingClientRect().left;
    const value = slider ? valueOf(slider, +made.plot.posToVal(event.clientX - left, "x").toPrecision(5)) : NaN;
    if (isFinite(value)) move("frequency", value);
  });

  /** At most one picture in ``PAUSE``, and none within a frame that draws motions. */
  function redraw() {
    frame ||= setTimeout(() => requestAnimationFrame(() => { frame = 0; made.plot.setData([ends, [0, 1]]); }), PAUSE);
  }
  const heads = ["amplitude", "maximum", "minimum"].map((name) => withUnit(name, output.unit));
  const speed = withUnit("velocity before impact", units.contact_speed.unit);
  const head = ["fidelity", withUnit("frequency", units.frequency.unit), ...heads, "impacts a period", speed];
  offer(byId("live-response"), "response at the sliders' place", {
    csv: () => csv([[...head, "period", "ended", "sweep"], ...flown().flatMap((each) => {
      const { points, back } = curveOf(each), way = direction === "down" ? "down" : "up";
      return [...cells(points, way), ...cells(back, "down")].map((row) => [each.label, ...row]);
    })]),
    svg: () => svgOf([made], document.title + (asCase() ? "" : ", at other keys than the case's")),
  });
  for (const what of ["moved", "taken", "theme"]) on(what, redraw);
  return redraw;
}
