// View: the engine flies again as the sliders move. Without WebAssembly the page stays as it is.
import { byId, on } from "../../page/state.js";
import { pictures } from "../../page/pictures.js";
import { data, picked } from "../../page/result.js";
import { open } from "../engine/engine.js";
import { background } from "../engine/worker.js";
import { controls } from "./controls.js";
import { curves } from "./curves.js";
import { flights } from "./flying.js";
import {
  begin, flown, isLink, models, move, payload, shownText, sliderOf, startFrom, units, valueAt, valueOf,
} from "./place.js";
import { engineNote, peakOf, readings } from "./readings.js";
import { responseChart } from "./sweeping.js";

/** @import { Engine } from "../engine/engine.js" */
/** @import { Ask, Standing } from "./flying.js" */
/** @import { Model } from "../engine/types.d.ts" */

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

/** @type {(engine: Engine) => void} */
function show(engine) {
  const ask = asking(engine), slider = sliderOf("frequency");
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
  startAtPeak((model) => peakOf(curveOf(model)));
  byId("engine-note").textContent = engineNote();
  byId("stored-curves").hidden = !data.curves.length;
  byId("closed-form").hidden = !models.some((each) => each.engine === "plain");
  on("picked", () => {
    const value = slider ? valueOf(slider, (picked() ?? NaN) * slider.factor) : NaN;
    if (isFinite(value)) move("frequency", value);
  });
}

/**
 * Without results and without a link the page goes to the finest fidelity's highest point once the first curves stand,
 * unless the reader has moved a slider before. A case of one frequency has no such point: the page stays at it.
 * @type {(peak: (model: Model) => {frequency: number} | undefined) => void}
 */
function startAtPeak(peak) {
  let untouched = !data.curves.length && !isLink && payload.sweep.frequency.length > 1;
  on("moved", () => { untouched = false; });
  on("swept", () => {
    const finest = flown().find(({ name, finest: best }) => name === best), best = finest && peak(finest);
    if (untouched && best) {
      byId("start").value = "sweep";
      startFrom("sweep");
      move("frequency", best.frequency);
    }
    untouched = false;
  });
}

if (!models.length) byId("explore-waits").textContent = payload.models.map(({ refusal }) => refusal).join(" ");
else if (typeof WebAssembly !== "object") {
  byId("explore-waits").textContent = "This browser has no WebAssembly, which motions take: [show.NAME] of a case draws them.";
} else {
  const frequency = picked();
  if (frequency !== undefined) begin(frequency);
  open(payload).then((engine) => {
    const { version, level } = payload;
    Object.assign(window, { vibeam: { fly: engine.fly.bind(engine), open, version, level } });
    show(engine);
  }).catch((fault) => {
    byId("explore-waits").textContent = `The engine does not start in this browser: ${fault.message}`;
  });
}
