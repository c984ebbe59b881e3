// Numbers at the sliders' place: of each fidelity, and how far it is from the finest.
import { byId, element } from "../../page/state.js";
import { short, withUnit } from "../../page/numbers.js";
import { asCase, complete, flown, models, payload, place, shownText, units, valueAt } from "./place.js";

/** @import { Model, Steady } from "../engine/types.d.ts" */
/** @import { Standing } from "./flying.js" */
/** @import { Peak } from "./sweeping.js" */

const SAME = 5e-5;  // relative difference that is called none

/** Period and contact in words. @type {(model: Model, steady: Steady) => string} */
function repeats({ engine }, { period, rest }) {
  if (period === -1) return "1, no contact";
  const share = `${short(100 * rest, 3)} % of the time`;
  const resting = engine === "plain" ? `; chatters, rests on the stop ${share}` : `; on the stop ${share}`;
  return (period === 0 ? "does not repeat" : String(period)) + (rest > 0 ? resting : "");
}

/** "1.5 % too low". @type {(own: number, finest: number) => string} */
export function differs(own, finest) {
  const difference = own / finest - 1;
  if (!isFinite(difference)) return "–";
  if (Math.abs(difference) < SAME) return "the same";
  return `${short(100 * Math.abs(difference), 3)} % too ${difference < 0 ? "low" : "high"}`;
}

/** The finest fidelity of the same physics that is shown. @type {(model: Model) => Model | undefined} */
function finestOf(model) {
  const alike = flown().filter((each) => each.finest === model.finest);
  return alike.find((each) => each.name === model.finest) ?? alike.sort((a, b) => b.modes - a.modes)[0];
}

/** @type {(of: (name: string) => number | undefined, model: Model) => string} */
function beside(of, model) {
  const finest = finestOf(model), own = of(model.name), its = finest && of(finest.name);
  if (!finest || finest.name === model.name) return flown().length > 1 ? "finest" : "–";
  return own === undefined || its === undefined ? "–" : differs(own, its);
}

/** The place in words: the frequency, and what is not as in the case. */
function where() {
  const moved = payload.sliders.filter(({ name }) => name in place());
  const texts = moved.map((each) => `${each.label} ${shownText(each, valueAt(each.name))} ${each.unit}`.trim());
  return texts.join(", ") + (asCase() ? ", all else as in the case" : "");
}

/**
 * Table and sentence; the sentence alone is read out, once the motions are settled.
 * @param {Standing} standing
 * @param {(name: string) => Peak | null} peak
 */
export function readings({ steady, faults, settled }, peak) {
  const { output, contact_speed: speed, frequency } = units;
  const heads = [
    "fidelity", withUnit("amplitude", output.unit), "from the finest", "repeats after (drive periods)",
    "impacts a period", withUnit("velocity before impact", speed.unit), withUnit("highest flown", output.unit),
    withUnit("at", frequency.unit), "from the finest's highest",
  ];
  const head = element("tr"), top = element("thead"), body = element("tbody");
  head.append(...heads.map((name) => element("th", { scope: "col" }, name)));
  top.append(head);
  const amplitude = (/** @type {string} */ name) => {
    const own = steady.get(name);
    return own && complete(own.ended) ? own.amplitude : undefined;
  };
  const highest = (/** @type {string} */ name) => peak(name)?.amplitude;
  for (const model of flown()) {
    const { name, label } = model, own = steady.get(name), fault = faults.get(name), best = peak(name);
    const row = element("tr");
    row.append(element("th", { scope: "row" }, label));
    const cells = own && !fault
      ? [
        short(own.amplitude * output.factor), beside(amplitude, model), repeats(model, own),
        short(own.impactsPerPeriod), own.impactsPerPeriod > 0 ? short(own.impactVelocity * speed.factor) : "–",
      ] : ["…", "…", "…", "…", "…"];
    if (fault) row.append(element("td", { colspan: 5 }, fault));
    else row.append(...cells.map((text) => element("td", {}, text)));
    const peaks = best
      ? [short(best.amplitude * output.factor), short(best.frequency * frequency.factor, 6), beside(highest, model)]
      : ["…", "…", "…"];
    row.append(...peaks.map((text) => element("td", {}, text)));
    body.append(row);
  }
  byId("readings").replaceChildren(element("caption", {}, "At the sliders' place"), top, body);
  say(settled, amplitude);
}

/** @type {(settled: boolean, amplitude: (name: string) => number | undefined) => void} */
function say(settled, amplitude) {
  const { settle, hold } = payload.sweep;
  byId("state").textContent = settled
    ? `Settled: ${settle} drive periods from equilibrium, ${hold} more read, as the case has it.`
    : "Settling…  shown: the motion on from where it was, 20 drive periods after the last change.";
  if (!settled) return;
  const said = flown().flatMap((model) => {
    const finest = finestOf(model), text = beside(amplitude, model);
    return !finest || finest.name === model.name || text === "–" ? [] : [`${model.label} ${text}`];
  });
  const finest = [...new Set(flown().map((each) => finestOf(each)?.label))].join(", ");
  const beginning = said.length ? `Beside ${finest}: ${said.join(", ")}. ` : "";
  byId("differences").textContent = `${beginning}${where()}.`;
}

/** Which engine flies. */
export function engineNote() {
  const { level, version, digest } = payload, kinds = new Set(models.map((each) => each.engine));
  const what = kinds.has("regimes") ? "flight by exact roots within each regime" : "flight by exact roots";
  return `${what}: vibeam ${version}, level ${level}, kernels ${digest.slice(0, 12)}`;
}
