// Sliders with their fields, choice of fidelities, buttons.
import { byId, drawn, element, colourOf, on, tickBox } from "../../../report/page/state.js";
import { short } from "../../../report/page/numbers.js";
import { save } from "../../../report/page/saving.js";
import { caseText, isFlown, models, move, payload, placesOf, reset, shownText, take } from "./place.js";
import { lost, startFrom, startsFrom, sweepWords, sweptAs, valueAt, valueOf } from "./place.js";

/** @import { Fixed, Model, Slider } from "../engine/types.d.ts" */

const STEPS = 1000;  // of a slider from end to end; one that has places steps through these
/** @type {(slider: Slider) => number} */
const steps = (slider) => (placesOf(slider).length || STEPS + 1) - 1;

/** Value (SI) at a slider's step, rounded to what a step changes. @type {(slider: Slider, step: number) => number} */
function atStep(slider, step) {
  const { low, high, factor } = slider, share = step / STEPS, places = placesOf(slider);
  if (places.length) return places[step];
  if (step <= 0 || step >= STEPS) return step <= 0 ? low : high;
  const value = low + share * (high - low);
  const digit = 10 ** Math.floor(Math.log10(((high - low) * Math.abs(factor)) / STEPS));
  return (Math.round((value * factor) / digit) * digit) / factor;
}

/** @type {(slider: Slider, value: number) => number} */
function stepOf(slider, value) {
  const { low, high } = slider, places = placesOf(slider);
  if (places.length) return places.findIndex((each) => each >= value);
  return STEPS * ((value - low) / (high - low));
}

/** @type {(slider: Slider) => string} */
function rangeText({ low, high, factor, unit }) {
  return `${[low, high].map((each) => short(each * factor, 6)).join(" to ")} ${unit}`.trim();
}

/** Rows of one slider; what writes its value into them is returned. @type {(slider: Slider) => () => void} */
function row(slider) {
  const { name, key, label, unit } = slider;
  const id = `slide-${name}`, fault = byId("slider-fault");
  const tick = element("datalist", { id: `${id}-case` });  // where the case stands
  const range = element("input", { type: "range", id, min: 0, max: steps(slider), step: 1, title: key, list: tick.id });
  const field = element("input", {
    type: "number", id: `${id}-number`, step: "any", "aria-label": `${label}${unit ? `, ${unit}` : ""}`,
  });
  const head = element("label", { for: id }, label), end = element("span", { class: "number-field" });
  end.append(field, " ", element("span", {}, unit));
  range.addEventListener("input", () => move(name, atStep(slider, +range.value)));
  field.addEventListener("input", () => {
    const value = field.value === "" ? NaN : valueOf(slider, +field.value), known = isFinite(value);
    field.setAttribute("aria-invalid", String(!known));
    fault.textContent = known ? "" : `${label}: a number from ${rangeText(slider)}.`;
    if (known) move(name, value);
  });
  field.addEventListener("change", () => { if (field.getAttribute("aria-invalid") === "false") set(); });
  if (name !== "frequency") tick.append(element("option", { value: Math.round(stepOf(slider, slider.value)) }));
  end.append(tick);
  byId("sliders").append(head, range, end);

  function set() {
    const value = valueAt(name), text = shownText(slider, value);
    range.value = String(stepOf(slider, value));
    range.setAttribute("aria-valuetext", `${text} ${unit}`.trim());
    const typed = document.activeElement === field, wrong = field.getAttribute("aria-invalid") === "true";
    if (typed && (wrong || +field.value === +text)) return;
    field.value = text;
    field.setAttribute("aria-invalid", "false");
  }
  return set;
}

/** Sample of a fidelity's line. @type {(model: Model) => SVGElement} */
function sample({ look }) {
  const svg = drawn("svg", { viewBox: "0 0 30 8", width: 30, height: 8, "aria-hidden": "true" });
  svg.append(drawn("path", { d: "M1 4H29", "stroke-width": 3, "stroke-dasharray": look.dash.join(" ") }));
  const paint = () => svg.firstChild.setAttribute("stroke", colourOf(look));
  on("theme", paint);
  paint();
  return svg;
}

/** @type {(model: Model) => Element} */
const box = (model) => tickBox(
  isFlown(model.name), (ticked) => take(model.name, ticked), sample(model), ` ${model.label}`,
);

/** Sentences on what the page cannot fly, and on keys that could have a slider. */
function limits() {
  const reasons = new Set(payload.models.filter((each) => !each.engine).map((each) => each.refusal));
  const refused = [...reasons].map((reason) => {
    const who = payload.models.filter((each) => each.refusal === reason).map((each) => each.label);
    return `Not flown here: ${who.join(", ")}. ${reason}`;
  });
  const missing = payload.fixed.filter(({ key }) => !key);
  return [...refused, ...missing.map(({ name, why }) => `No slider for ${name}: ${why}.`)];
}

/** What no slider moves: keys of a table, and the command that changes one. @type {(fixed: Fixed) => Element} */
function unmoved({ key, why, command }) {
  const item = element("li", {}, `${key}: ${why}. `);
  item.append(element("code", {}, command));
  return item;
}

/** ``save``: writes a file. */
export function controls() {
  const sets = payload.sliders.map(row), all = () => sets.forEach((set) => set());
  byId("flown").append(...models.map(box));
  const fixed = payload.fixed.filter(({ key }) => key);
  byId("limits").replaceChildren(...limits().map((text) => element("li", {}, text)));
  byId("fixed").replaceChildren(...fixed.map(unmoved));
  byId("unmoved").hidden = !fixed.length;
  byId("as-case").addEventListener("click", () => { byId("slider-fault").textContent = ""; reset(); });
  byId("write-case").addEventListener("click", () => save(caseText(), "application/toml", "at these sliders", "toml"));
  byId("start").value = startsFrom();
  byId("start-sweep").textContent = `as ${sweepWords}`;
  byId("swept-as").textContent = sweptAs;
  byId("start").addEventListener("change", () => startFrom(byId("start").value === "sweep" ? "sweep" : "equilibrium"));
  byId("slider-fault").textContent = lost
    .map((each) => `${each.label}: the link's is not from ${rangeText(each)}; that of the case is shown.`).join(" ");
  on("moved", all);
  all();
}
