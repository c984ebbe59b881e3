// What the views of a motion under a record share: its numbers, the fidelities that are shown.
import { byId, colourOf, element, hidden, on, tell, tickBox } from "./state.js";
import { inflated } from "./base64.js";
import { unpacked } from "./numbers.js";
import { unfolded } from "./envelope.js";
/** @import { History, Impacts, RecordData } from "./histories.d.ts" */

/** @type {RecordData} */
export const data = JSON.parse(byId("data").textContent);
/** Histories by signal and fidelity, once they are inflated: of all of the record, and of parts. @type {Map<string, History[]>} */
const histories = new Map();
Promise.all(data.histories.map(async (each) => {
  return { key: `${each.signal}\n${each.fidelity}`, history: unfolded(each, await inflated(each.data, "deflate")) };
})).then((all) => {
  for (const { key, history } of all) histories.set(key, [...(histories.get(key) ?? []), history]);
  for (const several of histories.values()) several.sort((a, b) => a.width - b.width);
  tell("histories");
});
/** @type {Map<string, Impacts>} */
const impacts = new Map(data.impacts.map((each) => [each.fidelity, { time: unpacked(each.time), velocity: unpacked(each.velocity), met: each.met }]));

/** Finest history of a signal in a fidelity (empty: of all) that has a span, as far as there is a motion. @type {(signal: string, fidelity: string, span: [number, number]) => History | undefined} */
export function historyOf(signal, fidelity, [begin, end]) {
  const several = histories.get(`${signal}\n${fidelity}`) ?? [], whole = several[several.length - 1];
  const from = Math.max(begin, whole?.begin), to = Math.min(end, endOf(whole));
  return several.find((each) => from >= each.begin - 0.01 * each.width && to <= endOf(each) + 0.01 * each.width) ?? whole;
}
/** @type {(history: History | undefined) => number} */
const endOf = (history) => (history ? history.begin + history.width * history.least.length : 0);
/** @type {(fidelity: string) => Impacts} */
export const impactsOf = (fidelity) => impacts.get(fidelity) ?? { time: [], velocity: [], met: 0 };

export const shown = () => data.fidelities.filter((_, number) => !hidden.numbers.has(number));
/** @type {(name: string) => boolean} */
export const isShown = (name) => !hidden.numbers.has(data.fidelities.findIndex((each) => each.name === name));
/** @type {(name: string) => {label: string, colour: string, dash: number[], wide: number}} */
export function lookOf(name) {
  const own = data.fidelities.find((each) => each.name === name);
  return own ? { label: own.label, colour: colourOf(own), dash: own.dash, wide: own.wide } : { label: "", colour: "", dash: [], wide: 1 };
}

const colourMarks = data.fidelities.map((each, number) => {
  const mark = element("i");
  byId("shown").append(tickBox(!hidden.numbers.has(number), (ticked) => hidden.show(number, ticked), mark, each.label));
  return () => { mark.style.borderColor = colourOf(each); };
});
const recolour = () => colourMarks.forEach((each) => each());
recolour();
on("theme", recolour);
