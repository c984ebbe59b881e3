// Elements of the page, its theme, and its state in the address: #section&f=15.2&theme=dark, so that a link reproduces it.
/** @import { Colours, PageElement } from "./types.d.ts" */

document.documentElement.classList.add("js");
/** @type {(id: string) => PageElement} */
export const byId = (id) => /** @type {any} */ (document.getElementById(id));

/**
 * @param {string} name
 * @param {Record<string, string | number>} [attributes]
 * @param {string | null} [text]
 * @param {"svg" | null} [space]
 * @returns {any}
 */
export function element(name, attributes = {}, text = null, space = null) {
  const made = space ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (text !== null) made.textContent = text;
  return made;
}
/** @type {(name: string, attributes?: Record<string, string | number>, text?: string | null) => any} */
export const drawn = (name, attributes, text = null) => element(name, attributes, text, "svg");

/** Box to tick, with what it stands for. @type {(ticked: boolean, change: (ticked: boolean) => void, ...parts: (Element | string)[]) => Element} */
export function tickBox(ticked, change, ...parts) {
  const label = element("label"), box = element("input", { type: "checkbox" });
  box.checked = ticked;
  box.addEventListener("change", () => change(box.checked));
  label.append(box, ...parts);
  return label;
}

// Who is told when something changes: "theme", "hidden", "picked".
/** @type {Record<string, (() => void)[]>} */
const listeners = {};
/** @type {(what: string, listen: () => void) => void} */
export const on = (what, listen) => (listeners[what] ||= []).push(listen);
/** @type {(what: string) => void} */
export const tell = (what) => (listeners[what] || []).forEach((listen) => listen());

const said = () => [...new URLSearchParams(location.hash.slice(1))];
const values = new Map(said().filter(([, value]) => value));
let section = said().find(([, value]) => !value)?.[0] ?? "";

export const address = {
  /** @type {(key: string) => string | null} */
  get: (key) => values.get(key) ?? null,
  /** @type {(key: string) => number[]} */
  numbers: (key) => (values.get(key) ?? "").split(",").filter(Boolean).map(Number).filter(isFinite),
  /** @type {(key: string, value: string | number | null) => void} */
  set(key, value) {
    if (value === null || value === "") values.delete(key); else values.set(key, String(value));
    const parts = [...values].map(([name, each]) => `${name}=${encodeURIComponent(each).replaceAll("%2C", ",")}`);
    if (location.protocol === "about:") return;  // a frame of a notebook has no address of its own
    history.replaceState(null, "", `#${[section, ...parts].filter(Boolean).join("&")}`);
  },
  go: () => { if (section) byId(section)?.scrollIntoView(); },
};

/** Numbers that the reader took away; they stand in the address. */
export const hidden = {
  numbers: new Set(address.numbers("hide")),
  /** @type {(number: number, wanted: boolean) => void} */
  show(number, wanted) {
    if (wanted) hidden.numbers.delete(number); else hidden.numbers.add(number);
    address.set("hide", [...hidden.numbers].sort().join(","));
    tell("hidden");
  },
};
addEventListener("hashchange", () => {
  if (said().some(([, value]) => value)) location.reload();  // the link of another state
  section = said()[0]?.[0] ?? "";
  address.set("", null);
});

// Theme: the system's, or the reader's choice. What is saved or printed is on white paper.
const system = matchMedia("(prefers-color-scheme: dark)"), root = document.documentElement;
const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
export const ink = (name = "ink") => getComputedStyle(root).getPropertyValue(`--${name}`);
/** @type {(own: Colours) => string} */
export const colourOf = (own) => (dark() ? own.dark : own.colour);

/** @template T @param {() => T} make @returns {T} */
export function onPaper(make) {
  const chosen = root.dataset.theme;
  root.dataset.theme = "light";
  try { return make(); } finally { setTheme(chosen); }
}

/** @param {string | null | undefined} chosen */
function setTheme(chosen) {
  if (chosen === "light" || chosen === "dark") root.dataset.theme = chosen; else delete root.dataset.theme;
  tell("theme");
}
byId("theme").value = address.get("theme") ?? "";
setTheme(address.get("theme"));
byId("theme").addEventListener("change", () => { address.set("theme", byId("theme").value); setTheme(byId("theme").value); });
system.addEventListener("change", () => tell("theme"));
