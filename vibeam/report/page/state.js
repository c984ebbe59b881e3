// Elements of the page, its theme, and its state in the address: #section&f=15.2&theme=dark, so that a link reproduces it.

document.documentElement.classList.add("js");
export const byId = (id) => document.getElementById(id);

export function element(name, attributes = {}, text = null, space = null) {
  const made = space ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== null) made.textContent = text;
  return made;
}
export const drawn = (name, attributes, text = null) => element(name, attributes, text, "svg");

// Who is told when something changes: "theme", "hidden", "picked".
const listeners = {};
export const on = (what, listen) => (listeners[what] ||= []).push(listen);
export const tell = (what) => (listeners[what] || []).forEach((listen) => listen());

const said = () => [...new URLSearchParams(location.hash.slice(1))];
const values = new Map(said().filter(([, value]) => value));
let section = said().find(([, value]) => !value)?.[0] ?? "";

export const address = {
  get: (key) => values.get(key) ?? null,
  numbers: (key) => (values.get(key) ?? "").split(",").filter(Boolean).map(Number).filter(isFinite),
  set(key, value) {
    if (value === null || value === "") values.delete(key); else values.set(key, String(value));
    const parts = [...values].map(([name, each]) => `${name}=${encodeURIComponent(each).replaceAll("%2C", ",")}`);
    history.replaceState(null, "", `#${[section, ...parts].filter(Boolean).join("&")}`);
  },
  go: () => byId(section)?.scrollIntoView(),
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
export const colourOf = (own) => (dark() ? own.dark : own.colour);

export function onPaper(make) {
  const chosen = root.dataset.theme;
  root.dataset.theme = "light";
  try { return make(); } finally { setTheme(chosen); }
}

function setTheme(chosen) {
  if (["light", "dark"].includes(chosen)) root.dataset.theme = chosen; else delete root.dataset.theme;
  tell("theme");
}
byId("theme").value = address.get("theme") ?? "";
setTheme(address.get("theme"));
byId("theme").addEventListener("change", (event) => { address.set("theme", event.target.value); setTheme(event.target.value); });
system.addEventListener("change", () => tell("theme"));
