// Pictures of motions at one frequency, which move: beam, history, phase portrait, spectrum; what of them is saved.
import { byId } from "./state.js";
import { svgOf } from "./chart.js";
import { withUnit } from "./numbers.js";
import { alone, csv, offer } from "./saving.js";
import { beam, shapeAt } from "./beam.js";
import { history } from "./history.js";
import { portrait } from "./portrait.js";
import { multiple, spectrum } from "./spectrum.js";

/** @import { Cell, DrawnMotion, PageElement, Units } from "./types.d.ts" */

const PACE = 0.7;  // drive periods a second of the moving beam
const REPEAT = 12;  // drive periods after which motions of 1 to 4 of them are together again
const SLOW = 6;  // frames from one spectrum to the next while a slider moves

/**
 * The pictures in the page's elements whose ids begin with ``prefix``; ``title`` is written above what is saved.
 * @param {string} prefix
 * @param {Units} units
 * @param {() => string} title
 */
export function pictures(prefix, units, title) {
  /** @type {(name: string) => PageElement} */
  const host = (name) => byId(prefix + name);
  const button = host("play"), bent = beam(host("beam"));
  const each = { history: history(host("history"), units), portrait: portrait(host("portrait"), units) };
  const strips = spectrum(host("spectrum"), units);
  /** @type {DrawnMotion[]} */
  let current = [];
  let turn = 0, last = 0, playing = 0, frame = 0;

  // While a slider moves, pictures out of sight are not drawn.
  /** @type {Set<Element>} */
  const hidden = new Set();
  const observer = new IntersectionObserver((seen) => seen.forEach(({ target, isIntersecting }) => {
    if (isIntersecting) hidden.delete(target); else hidden.add(target);
  }));
  for (const name of ["history", "portrait", "spectrum", "beam"]) observer.observe(host(name));
  /** @type {(name: string) => boolean} */
  const inSight = (name) => !hidden.has(host(name));

  /** @type {(now: number) => void} */
  function step(now) {
    turn = (turn + (PACE * Math.max(0, Math.min(now - last, 100))) / 1000) % REPEAT;
    last = now;
    bent.move(turn);
    playing = requestAnimationFrame(step);
  }
  button.addEventListener("click", () => {
    if (playing) { cancelAnimationFrame(playing); playing = 0; }
    else { last = performance.now(); playing = requestAnimationFrame(step); }
    button.setAttribute("aria-pressed", String(Boolean(playing)));
    button.textContent = playing ? "Pause" : "Play";
  });

  /** CSV of all motions drawn. @type {(heads: string[], rows: (one: DrawnMotion) => Cell[][]) => () => string} */
  const table = (heads, rows) => () => {
    return csv([["fidelity", ...heads], ...current.flatMap((one) => rows(one).map((row) => [one.label, ...row]))]);
  };

  function offerAll() {
    const { output, speed } = units, time = "time (drive periods)";
    const moving = table([time, withUnit(output.name, output.unit), withUnit("velocity", speed.unit)], (one) => {
      return Array.from(one.time, (now, at) => [now, one.x[at] * output.factor, one.v[at] * speed.factor]);
    });
    const lines = table(["multiple of the drive frequency", withUnit("amplitude", output.unit)], (one) => {
      return one.spectrum.map((value, at) => [multiple(one, at), 10 ** value * output.factor]);
    });
    const shapes = table([time, "place (m)", "deflection (m)"], (one) => {
      const frames = one.beam.length && one.beam.length / (one.places.length - 1);
      const times = Array.from({ length: frames }, (_, at) => (at * one.window) / frames);
      return times.flatMap((now) => shapeAt(one, now).map((value, k) => [now, one.places[k], value]));
    });
    const drawing = () => { bent.move(turn); return alone(host("beam")); };
    offer(host("beam"), "beam", { csv: shapes, svg: drawing });
    offer(host("history"), "displacement over time", { csv: moving, svg: () => svgOf(each.history.charts(), title()) });
    offer(host("portrait"), "phase portrait", { csv: moving, svg: () => svgOf(each.portrait.charts(), title()) });
    offer(host("spectrum"), "spectrum", { csv: lines, svg: () => svgOf(strips.charts(), title()) });
  }
  host("spectrum-unit").textContent = withUnit("amplitude", units.output.unit);
  offerAll();

  return {
    hideBeam: () => host("beam").parentElement?.setAttribute("hidden", ""),
    /**
     * ``still``: at rest, with values to read out; false while a slider moves.
     * @type {(motions: DrawnMotion[], still?: boolean) => void}
     */
    draw(motions, still = true) {
      current = motions;
      frame += 1;
      if (still || inSight("history")) each.history.draw(motions, still);
      if (still || inSight("portrait")) each.portrait.draw(motions, still);
      if (still || (inSight("spectrum") && frame % SLOW === 0)) strips.draw(motions, still);
      bent.draw(motions);
      if (still || (inSight("beam") && !playing)) bent.move(turn);
    },
  };
}
