// View: stored motions at the picked frequency: their pictures and numbers.
import { address, byId, element, on } from "./state.js";
import { short, unpacked, withUnit } from "./numbers.js";
import { pictures } from "./pictures.js";
import { colour, data, fidelity, inUnits, isShown, kept, pick, picked, place, title } from "./result.js";

/** @import { DrawnMotion, StoredMotion } from "./types.d.ts" */

/** @type {ReturnType<typeof pictures>} */
let shown;
const here = () => {
  const way = byId("way").value;
  return data.motions.filter((each) => each.frequency === picked() && each.way === way && isShown(each));
};

/** The motion as it is drawn, unpacked when it is first. @type {(motion: StoredMotion) => DrawnMotion} */
function ready(motion) {
  const { label, dash, places, held } = fidelity[motion.fidelity];
  return motion.drawn ||= {
    ...motion, label, dash, places, held, colour: () => colour(motion),
    time: unpacked(motion.time), x: unpacked(motion.x), v: unpacked(motion.v), spectrum: unpacked(motion.spectrum),
    section: motion.section.map(unpacked), impacts: motion.impacts.map(([time]) => time),
    beam: motion.beam ? unpacked(motion.beam) : [],
  };
}

function draw() {
  const motions = here(), sound = motions.filter((each) => !each.fault), faults = motions.filter((each) => each.fault);
  byId("pick").value = String(place());
  byId("pick").setAttribute("aria-valuetext", inUnits(picked()));
  byId("picked").textContent = inUnits(picked());
  const said = faults.map((each) => `${title(each)}: ${each.fault}`);
  byId("faults").replaceChildren(...said.map((text) => element("p", { class: "note" }, text)));
  shown.draw(sound.map(ready));
  listNumbers(sound);
}

const HEADS = ["fidelity", "repeats after (drive periods)", "impacts shown", "", "modes from 2 on, share of energy"];
const COUNT = 6;  // velocities that are listed

/** @type {(each: StoredMotion) => string[]} */
function cells(each) {
  const curve = data.curves.find((one) => one.fidelity === each.fidelity && one.way === each.way);
  const period = curve?.values.period[curve.frequency.indexOf(each.frequency)], { factor } = data.contact_speed;
  const rest = each.shares.slice(1).reduce((a, b) => a + b, 0);
  return [
    period === 0 ? "does not" : period === -1 ? "1, no contact" : short(period), String(each.impacts.length),
    each.impacts.slice(0, COUNT).map((hit) => short(hit[1] * factor, 3)).join(", ") || "–",
    each.shares.length > 1 ? `${short(100 * rest, 3)} %` : "–",
  ];
}

/** @type {(motions: StoredMotion[]) => void} */
function listNumbers(motions) {
  const head = element("tr"), body = element("tbody"), top = element("thead");
  const heads = HEADS.map((name) => name || withUnit("velocities before impact", data.contact_speed.unit));
  head.append(...heads.map((name) => element("th", { scope: "col" }, name)));
  for (const each of motions) {
    const row = element("tr");
    row.append(element("th", { scope: "row" }, fidelity[each.fidelity].label));
    row.append(...cells(each).map((text) => element("td", {}, text)));
    body.append(row);
  }
  top.append(head);
  byId("numbers").replaceChildren(element("caption", {}, "Numbers of these motions"), top, body);
}

if (kept.length) {
  const ways = new Set(data.curves.map((each) => each.way));
  byId("way").append(...[...ways].map((way) => element("option", { value: way }, way)));
  if (data.curves.some((each) => each.way === address.get("way"))) byId("way").value = address.get("way") ?? "";
  byId("way").addEventListener("change", () => { address.set("way", byId("way").value); draw(); });
  byId("pick").max = String(kept.length - 1);
  byId("pick").addEventListener("input", () => pick(+byId("pick").value));
  shown = pictures("", data, () => `${document.title}, ${inUnits(picked())}`);
  for (const what of ["picked", "hidden", "theme"]) on(what, draw);
  if (!data.motions.some((each) => each.beam)) shown.hideBeam();
  draw();
} else byId("motion").hidden = true;
