// View: the engine flies again as the sliders move. Without WebAssembly the page stays as it is.
import { byId, on } from "../../../report/page/state.js";
import { pictures } from "../../../report/page/pictures.js";
import { data, picked } from "../../../report/page/result.js";
import { open } from "../engine/engine.js";
import { background } from "../engine/worker.js";
import { controls } from "./controls.js";
import { AFRESH, EVEN, curves, pointOf, swept } from "./curves.js";
import { flights } from "./flying.js";
import { begin, isLink, models, move, payload, shownText, sliderOf, units, valueAt, valueOf } from "./place.js";
import { engineNote, highest, readings } from "./readings.js";
import { responseChart } from "./sweeping.js";

/** @import { Engine } from "../engine/engine.js" */
/** @import { Ask, Standing } from "./flying.js" */
/** @import { Point } from "./curves.js" */

const PATIENCE = 1500;  // ms

/** Questions to the worker, each with who hears its answers. @type {(engine: Engine) => Ask} */
function asking(engine) {
  const worker = background(engine, payload, byId("worker").textContent), waiting = new Map();
  /** @type {Map<string, number>} */
  const newest = new Map();  // by call and fidelity: an older question is not answered any more
  let number = 0;
  worker.onmessage = ({ data: answer }) => {
    const hear = waiting.get(answer.id);
    if (answer.fault !== undefined || answer.done === answer.of) waiting.delete(answer.id);
    if (hear) hear(answer);
  };
  return (call, args, hear) => {
    const key = `${call} ${args[0]}`;
    number += 1;
    waiting.delete(newest.get(key));
    newest.set(key, number);
    waiting.set(number, hear);
    worker.postMessage({ id: number, call, args });
  };
}

/** @type {(engine: Engine, ask: Ask) => void} */
function show(engine, ask) {
  const slider = sliderOf("frequency");
  const at = () => (slider ? `, ${shownText(slider, valueAt("frequency"))} ${slider.unit}` : "");
  byId("explore-body").hidden = false;
  byId("explore-waits").hidden = true;
  controls();
  const views = pictures("live-", units, () => document.title + at());
  if (!models.some((each) => each.stations)) views.hideBeam();
  /** @type {Standing | null} */
  let last = null;
  const { curveOf, stateOf } = curves(ask, () => tell());
  const redraw = responseChart(curveOf, () => last);
  const read = () => { if (last) readings(last, curveOf); };
  const tell = () => { redraw(); read(); };
  flights(engine, ask, { draw: views.draw, stateOf, stand: (standing) => { last = standing; tell(); } });
  byId("engine-note").textContent = engineNote();
  byId("stored-curves").hidden = !data.curves.length;
  byId("closed-form").hidden = !models.some((each) => each.engine === "plain");
  on("picked", () => {
    const value = slider ? valueOf(slider, (picked() ?? NaN) * slider.factor) : NaN;
    if (isFinite(value)) move("frequency", value);
  });
}

/**
 * Where the page opens without results and without a link: at the reference fidelity's highest motion with impacts,
 * of some frequencies each from equilibrium, as far as these are known in ``PATIENCE``; NaN: where the case stands.
 * @type {(ask: Ask, go: (frequency: number) => void) => void}
 */
function opening(ask, go) {
  const { name } = models.find((each) => each.name === each.finest) ?? models[0], late = performance.now() + PATIENCE;
  const some = swept.filter((_, at) => at % Math.ceil(swept.length / EVEN) === 0);
  /** @type {Point[]} */
  const points = [];
  let open = !isLink && payload.sweep.frequency.length > 1;
  if (open) ask("response", [name, {}, some, AFRESH], ({ values, fault, done, of }) => {
    if (!fault) points.push(...Array.from(values.frequency, (_, at) => pointOf(values, at)));
    if (!open || (!fault && done < of && performance.now() < late)) return;
    open = false;
    const struck = points.filter(({ impactsPerPeriod }) => impactsPerPeriod > 0);
    go((highest(struck) ?? highest(points))?.frequency ?? NaN);
  });
  else go(NaN);
}

if (!models.length) byId("explore-waits").textContent = payload.models.map(({ refusal }) => refusal).join(" ");
else if (typeof WebAssembly !== "object") {
  byId("explore-waits").textContent = "This browser has no WebAssembly, which motions take: [show.NAME] of a case draws them.";
} else {
  const frequency = picked();
  open(payload).then((engine) => {
    const { version, level } = payload, ask = asking(engine);
    Object.assign(window, { vibeam: { fly: engine.fly.bind(engine), open, version, level } });
    if (frequency === undefined) opening(ask, (at) => { begin(at, "equilibrium"); show(engine, ask); });
    else { begin(frequency, "sweep"); show(engine, ask); }
  }).catch((fault) => {
    byId("explore-waits").textContent = `The engine does not start in this browser: ${fault.message}`;
  });
}
