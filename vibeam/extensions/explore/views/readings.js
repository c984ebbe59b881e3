// Numbers at the sliders' place: of each fidelity, and whether it suffices beside the reference.
import { byId, element } from "../../../report/page/state.js";
import { short, withUnit } from "../../../report/page/numbers.js";
import { accuracy, answer, cells } from "./answer.js";
import { UNKNOWN, kindOf } from "./branches.js";
import { compared } from "./comparison.js";
import { asCase, complete, direction, flown, models, payload, place, shownText } from "./place.js";
import { startsFrom, sweepWords, units, valueAt } from "./place.js";

/** @import { Comparison, Model, Steady, Swept } from "../engine/types.d.ts" */
/** @import { Standing } from "./flying.js" */
/** @import { Curve, Point } from "./curves.js" */
/** @typedef {{model: Model, reference: Model, found: Comparison | string}} Beside ``found``: "…" until it is known */

/** Period and contact in words. @type {(model: Model, steady: Steady) => string} */
function repeats({ engine }, { period, rest }) {
  if (period === -1) return "1, no contact";
  const share = `${short(100 * rest, 3)} % of the time`;
  const resting = engine !== "regimes" ? `; chatters, rests on the stop ${share}` : `; on the stop ${share}`;
  return (period === 0 ? "does not repeat" : String(period)) + (rest > 0 ? resting : "");
}

/** The finest of several fidelities of the same physics that are shown. @type {(model: Model) => Model | undefined} */
function referenceOf(model) {
  const alike = flown().filter((each) => each.finest === model.finest);
  if (alike.length < 2) return undefined;
  return alike.find((each) => each.name === model.finest) ?? alike.sort((a, b) => b.modes - a.modes)[0];
}

/** @type {(points: Point[]) => Swept[]} */
const placesOf = (points) => points.map((each) => ({ ...each, kind: kindOf(complete(each.ended), each) }));
/** Two curves beside each other, once both are whole. @type {(own: Curve, its: Curve) => Comparison | string} */
function comparisonOf(own, its) {
  if (own.fault || its.fault) return "–";
  if (!own.swept || !its.swept) return "…";
  const way = direction === "down" ? "down" : "up", back = { ours: placesOf(own.back), theirs: placesOf(its.back) };
  const legs = [{ way, ours: placesOf(own.points), theirs: placesOf(its.points) }, { way: "down", ...back }];
  return compared(direction === "both" ? legs : legs.slice(0, 1), payload.asked);
}

/** The highest of those that ran to their ends. @type {(points: Point[]) => Point | undefined} */
export const highest = (points) => points.filter((each) => complete(each.ended))
  .reduce((/** @type {Point | undefined} */ best, each) => (best && best.amplitude >= each.amplitude ? best : each), undefined);

/** Once all are flown. @type {(curve: Curve) => Point | undefined} */
const peakOf = ({ points, back, whole }) => (whole ? highest([...points, ...back]) : undefined);

/** The place in words: the frequency, and what is not as in the case. */
function where() {
  const moved = payload.sliders.filter(({ name }) => name in place());
  const texts = moved.map((each) => `${each.label} ${shownText(each, valueAt(each.name))} ${each.unit}`.trim());
  return texts.join(", ") + (asCase() ? ", all else as in the case" : "");
}

/**
 * Table and sentences; these alone are read out, once the curves are whole, and once the motions are settled.
 * @param {Standing} standing
 * @param {(model: Model) => Curve} curveOf
 */
export function readings({ steady, faults, settled, swept }, curveOf) {
  const { output, contact_speed: speed, frequency } = units, shown = flown();
  /** @type {Beside[]} */
  const beside = shown.flatMap((model) => {
    const reference = referenceOf(model);
    if (!reference || reference === model) return [];
    return [{ model, reference, found: comparisonOf(curveOf(model), curveOf(reference)) }];
  });
  const peaks = new Map(shown.map((each) => [each.name, peakOf(curveOf(each))]));
  /** @type {[string, (own: Steady, model: Model) => string][]} */
  const here = [
    [withUnit("amplitude", output.unit), (own) => short(own.amplitude * output.factor)],
    ["repeats after (periods)", (own, model) => repeats(model, own)],
    ["impacts a period", (own) => short(own.impactsPerPeriod)],
    [withUnit("impact velocity", speed.unit),
      (own) => (own.impactsPerPeriod > 0 ? short(own.impactVelocity * speed.factor) : "–")],
  ];
  /** @type {(at: number) => (best: Point, model: Model) => string} */
  const error = (at) => (_, model) => {
    const own = beside.find((each) => each.model === model);
    return own ? cells(own.found)[at] : referenceOf(model) ? "reference" : "–";
  };
  /** @type {[string, (best: Point, model: Model) => string][]} */
  const above = [
    [withUnit("peak of the curve", output.unit), (best) => short(best.amplitude * output.factor)],
    [withUnit("peak at", frequency.unit), (best) => short(best.frequency * frequency.factor, 6)],
    ["amplitude error", error(0)], ["frequency error of ends", error(1)], [`suffices for ${accuracy}`, error(2)],
  ];
  if (!beside.length) above.splice(2);  // no rows of errors
  /** @type {(name: string, cells: string[]) => Element} */
  const row = (name, cells) => {
    const made = element("tr");
    made.append(element("th", { scope: "row" }, name), ...cells.map((text) => element("td", {}, text)));
    return made;
  };
  const head = element("tr"), top = element("thead"), body = element("tbody");
  head.append(element("td"), ...shown.map(({ label }) => element("th", { scope: "col" }, label)));
  top.append(head);
  body.append(...here.map(([name, text]) => row(name, shown.map((model) => {
    const own = steady.get(model.name);
    return faults.has(model.name) ? "–" : own ? text(own, model) : "…";
  }))));
  body.append(...above.map(([name, text]) => row(name, shown.map((model) => {
    const best = peaks.get(model.name);
    return best ? text(best, model) : faults.has(model.name) || curveOf(model).fault ? "–" : "…";
  }))));
  byId("readings").replaceChildren(element("caption", {}, "At the sliders' place"), top, body);
  const said = shown.flatMap((each) => [faults.get(each.name) ?? curveOf(each).fault].filter(Boolean)
    .map((text) => (text.startsWith(each.label) ? text : `${each.label}: ${text}`)));
  byId("live-faults").replaceChildren(...said.map((text) => element("p", { class: "warning" }, text)));
  const answered = verdicts(beside);
  if (byId("verdict").textContent !== answered) byId("verdict").textContent = answered;  // read out where it changes
  say(settled, swept, [where(), motions(steady)].filter(Boolean).join(": "));
}

/** Sentences on which fidelities suffice, one for each reference. @type {(beside: Beside[]) => string} */
function verdicts(beside) {
  return [...new Set(beside.map(({ reference }) => reference))].map((reference) => {
    const own = beside.filter((each) => each.reference === reference), { label } = reference;
    const texts = own.map(({ model, found }) => `${model.label} ${answer(found, label)}`).join("; ");
    return `Beside ${label}, for ${accuracy}: ${texts}. The error of ${label} itself is not computed here.`;
  }).join(" ");
}

/** Amplitude and kind of the motions at the place. @type {(steady: Map<string, Steady>) => string} */
function motions(steady) {
  /** @type {(model: Model) => string} */
  const kind = ({ name }) => { const own = steady.get(name); return own ? kindOf(complete(own.ended), own) : UNKNOWN; };
  const { unit, factor } = units.output;
  return flown().map((model) => {
    const reference = referenceOf(model) ?? model, own = kind(model);
    const same = own === kind(reference) ? "as" : "another motion than";
    const said = `${model.label} ${short((steady.get(model.name)?.amplitude ?? NaN) * factor)} ${unit}`.trim();
    return `${said} (${own}${reference === model ? "" : `, ${same} ${reference.label}`})`;
  }).join("; ");
}

/** @type {(settled: boolean, swept: boolean, sentence: string) => void} */
function say(settled, swept, sentence) {
  const { settle, hold } = payload.sweep;
  const from = swept ? `on from ${sweepWords}` : "from equilibrium";
  const later = startsFrom() === "sweep" && !swept ? `; those of ${sweepWords} follow` : "";
  byId("state").textContent = settled
    ? `Settled: ${settle} drive periods ${from}, ${hold} more read, as the case has it${later}.`
    : "Settling…  shown: the motion on from where it was, 20 drive periods after the last change.";
  if (settled) byId("differences").textContent = `${sentence}.`;
}

/** Which engine flies. */
export function engineNote() {
  const { level, version, digest } = payload, kinds = new Set(models.map((each) => each.engine));
  const what = kinds.has("regimes") ? "flight by exact roots within each regime" : "flight by exact roots";
  return `${what}: vibeam ${version}, level ${level}, kernels ${digest.slice(0, 12)}`;
}
