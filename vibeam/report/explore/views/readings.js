// Numbers at the sliders' place: of each fidelity, and how far it is from the finest.
import { byId, element } from "../../page/state.js";
import { short, withUnit } from "../../page/numbers.js";
import { asCase, complete, flown, models, payload, place, shownText } from "./place.js";
import { startsFrom, sweepWords, units, valueAt } from "./place.js";

/** @import { Model, Steady } from "../engine/types.d.ts" */
/** @import { Standing } from "./flying.js" */
/** @import { Curve, Point } from "./curves.js" */

const LEAST = 5e-5, SAME = "the same";  // relative difference that is called none

/** Period and contact in words. @type {(model: Model, steady: Steady) => string} */
function repeats({ engine }, { period, rest }) {
  if (period === -1) return "1, no contact";
  const share = `${short(100 * rest, 3)} % of the time`;
  const resting = engine !== "regimes" ? `; chatters, rests on the stop ${share}` : `; on the stop ${share}`;
  return (period === 0 ? "does not repeat" : String(period)) + (rest > 0 ? resting : "");
}

/** "1.5 % too low". @type {(own: number, finest: number) => string} */
export function differs(own, finest) {
  const difference = own / finest - 1;
  if (!isFinite(difference)) return "–";
  if (Math.abs(difference) < LEAST) return SAME;
  return `${short(100 * Math.abs(difference), 3)} % too ${difference < 0 ? "low" : "high"}`;
}

/** Contact in words, where one strikes the stop and the other does not: a difference in per cent would mislead. */
/** @type {(own: Steady, finest: Steady, name: string) => string} */
function anotherMotion(own, finest, name) {
  const [strikes, its] = [own, finest].map(({ period }) => period !== -1);
  if (strikes === its) return "";
  return strikes ? `strikes the stop where ${name} does not` : `has no contact where ${name} strikes the stop`;
}

/** The finest of several fidelities of the same physics that are shown. @type {(model: Model) => Model | undefined} */
function finestOf(model) {
  const alike = flown().filter((each) => each.finest === model.finest);
  if (alike.length < 2) return undefined;
  return alike.find((each) => each.name === model.finest) ?? alike.sort((a, b) => b.modes - a.modes)[0];
}

/** @type {(of: (name: string) => number | undefined, model: Model) => string} */
function beside(of, model) {
  const finest = finestOf(model), own = of(model.name), its = finest && of(finest.name);
  if (finest?.name === model.name) return "finest";
  return own === undefined || its === undefined ? "–" : differs(own, its);
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
 * Table and sentence; the sentence alone is read out, once the motions are settled.
 * @param {Standing} standing
 * @param {(model: Model) => Curve} curveOf
 */
export function readings({ steady, faults, settled, swept }, curveOf) {
  const { output, contact_speed: speed, frequency } = units, shown = flown();
  /** @type {(name: string) => number | undefined} */
  const amplitude = (name) => {
    const own = steady.get(name);
    return own && complete(own.ended) ? own.amplitude : undefined;
  };
  /** @type {(model: Model) => string} */
  const fromFinest = (model) => {
    const finest = finestOf(model), [own, its] = [steady.get(model.name), finest && steady.get(finest.name)];
    const other = finest && own && its ? anotherMotion(own, its, finest.label) : "";
    return other ? `${beside(amplitude, model)}: another motion, ${other}` : beside(amplitude, model);
  };
  const peaks = new Map(shown.map((each) => [each.name, peakOf(curveOf(each))]));
  /** @type {(name: string) => number | undefined} */
  const height = (name) => peaks.get(name)?.amplitude;
  /** @type {[string, (own: Steady, model: Model) => string][]} */
  const here = [
    [withUnit("amplitude", output.unit), (own) => short(own.amplitude * output.factor)],
    ["from the finest", (_, model) => fromFinest(model)],
    ["repeats after (periods)", (own, model) => repeats(model, own)],
    ["impacts a period", (own) => short(own.impactsPerPeriod)],
    [withUnit("impact velocity", speed.unit),
      (own) => (own.impactsPerPeriod > 0 ? short(own.impactVelocity * speed.factor) : "–")],
  ];
  /** @type {[string, (best: Point, model: Model) => string][]} */
  const above = [
    [withUnit("peak of the curve", output.unit), (best) => short(best.amplitude * output.factor)],
    [withUnit("peak at", frequency.unit), (best) => short(best.frequency * frequency.factor, 6)],
    ["peak from the finest", (_, model) => beside(height, model)],
  ];
  if (!shown.some(finestOf)) { here.splice(1, 1); above.splice(2, 1); }  // no rows of differences
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
  say(settled, swept, fromFinest);
}

/** @type {(settled: boolean, swept: boolean, fromFinest: (model: Model) => string) => void} */
function say(settled, swept, fromFinest) {
  const { settle, hold } = payload.sweep;
  const from = swept ? `on from ${sweepWords}` : "from equilibrium";
  const later = startsFrom() === "sweep" && !swept ? `; those of ${sweepWords} follow` : "";
  byId("state").textContent = settled
    ? `Settled: ${settle} drive periods ${from}, ${hold} more read, as the case has it${later}.`
    : "Settling…  shown: the motion on from where it was, 20 drive periods after the last change.";
  if (!settled) return;
  /** @type {Map<string, string[]>} */
  const groups = new Map();
  for (const model of flown()) {
    const finest = finestOf(model)?.label ?? "", text = fromFinest(model);
    if (!text.includes("%") && text !== SAME) continue;
    groups.set(finest, [...(groups.get(finest) ?? []), `${model.label} ${text}`]);
  }
  const said = [...groups].map(([finest, texts]) => `Beside ${finest}: ${texts.join(", ")}. `);
  byId("differences").textContent = `${said.join("")}${where()}.`;
}

/** Which engine flies. */
export function engineNote() {
  const { level, version, digest } = payload, kinds = new Set(models.map((each) => each.engine));
  const what = kinds.has("regimes") ? "flight by exact roots within each regime" : "flight by exact roots";
  return `${what}: vibeam ${version}, level ${level}, kernels ${digest.slice(0, 12)}`;
}
