// The window of time that is shown: by pointer, touch, keyboard, buttons; it stands in the address.
import { address, byId, element, tell } from "./state.js";
import { short } from "./numbers.js";
import { data } from "./record.js";

const [first, last] = data.span, whole = last - first;
const LEAST = Math.min(...data.histories.map((each) => 8 * each.width), whole);  // width of the smallest window, s
const PAN = 0.25, CLOSER = 0.5;  // share of the window, of its width
/** @type {[number, number]} */
let span = [first, last];
export const seen = () => span;

/** Look at [begin, end], s, kept within the record. @type {(begin: number, end: number) => void} */
export function look(begin, end) {
  const width = Math.min(Math.max(end - begin, LEAST), whole);
  const low = Math.min(Math.max((begin + end - width) / 2, first), last - width);
  span = width < whole ? [low, low + width] : [first, last];
  address.set("x", width < whole ? span.map((each) => +each.toPrecision(9)).join(",") : null);
  tell("window");
}
/** @type {(share: number) => void} */
const pan = (share) => look(span[0] + share * (span[1] - span[0]), span[1] + share * (span[1] - span[0]));
/** Width times ``factor`` about the share ``at`` of the window. @type {(factor: number, at?: number) => void} */
export function scale(factor, at = 0.5) {
  const width = span[1] - span[0], centre = span[0] + at * width;
  look(centre - at * factor * width, centre + (1 - at) * factor * width);
}
const all = () => look(first, last);

/** @type {Record<string, () => void>} */
const KEYS = {
  ArrowLeft: () => pan(-PAN), ArrowRight: () => pan(PAN), "+": () => scale(CLOSER), "=": () => scale(CLOSER),
  "-": () => scale(1 / CLOSER), Home: all, 0: all,
};

/** @type {(host: HTMLElement) => void} */
export function hearKeys(host) {
  host.addEventListener("keydown", (event) => {
    const act = event.ctrlKey || event.metaKey || event.altKey ? null : KEYS[event.key];
    if (act) { event.preventDefault(); act(); }
  });
}

// One finger moves the window, two stretch it; a wheel with Ctrl, as a touchpad's pinch is reported, scales it.
/** @type {(over: HTMLElement) => void} */
export function hearTouch(over) {
  /** @type {Map<number, number>} */
  const fingers = new Map();
  /** @type {(event: {clientX: number}) => number} */
  const share = (event) => { const { left, width } = over.getBoundingClientRect(); return (event.clientX - left) / width; };
  over.style.touchAction = "pan-y";
  over.addEventListener("pointerdown", (event) => { if (event.pointerType === "touch") fingers.set(event.pointerId, share(event)); });
  for (const ended of ["pointerup", "pointercancel", "pointerleave"]) over.addEventListener(ended, (event) => fingers.delete(/** @type {PointerEvent} */ (event).pointerId));
  over.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId), now = share(event);
    if (before === undefined || Math.abs(now - before) < 0.004) return;
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, now);
    if (other === undefined) pan(before - now);
    else if (Math.abs(now - other) > 0.02) scale(Math.abs(before - other) / Math.abs(now - other), other);
  });
  over.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    scale(Math.exp(event.deltaY / 200), share(event));
  }, { passive: false });
}

/** @type {(text: string, label: string, act: () => void) => void} */
function button(text, label, act) {
  const made = element("button", { type: "button", "aria-label": label }, text);
  made.addEventListener("click", act);
  byId("window").append(made);
}
button("←", "earlier", () => pan(-PAN));
button("→", "later", () => pan(PAN));
button("+", "closer", () => scale(CLOSER));
button("−", "wider", () => scale(1 / CLOSER));
button("Whole record", "whole record", all);
for (const each of data.marks) button(each.label, `look at ${each.label}`, () => look(each.begin, each.end));
const [from, to] = address.numbers("x");
if (to > from) look(from, to);
export const inWords = () => `${short(span[0], 6)} to ${short(span[1], 6)} s`;
