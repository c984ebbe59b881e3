// Picture: the beam in space, its stops and its moving base; deflections, gaps and base to one scale.
import { drawn } from "./state.js";
import { metres, short, spanOf } from "./numbers.js";

/** @import { DrawnMotion } from "./types.d.ts" */

const FAR = 3;  // a stop further off than so many of the largest deflection is not drawn

/**
 * Deflections at a motion's places, ``turn`` drive periods after the start of its window.
 * @type {(each: DrawnMotion, turn: number) => number[]}
 */
export function shapeAt(each, turn) {
  const count = each.places.length - 1, frames = each.beam.length / count;
  const at = ((turn % each.window) / each.window) * frames, share = at % 1;
  const here = (Math.floor(at) % frames) * count, next = (Math.ceil(at) % frames) * count;
  const heights = each.places.slice(1).map((_, k) => (1 - share) * each.beam[here + k] + share * each.beam[next + k]);
  return [0, ...heights];
}

/** @type {(svg: Element) => {draw: (motions: DrawnMotion[]) => void, move: (turn: number) => void}} */
export function beam(svg) {
  /** @type {DrawnMotion[]} */
  let bent = [];
  let range = [0, 0], low = 0, high = 1, most = 0, reach = 0;
  /** @type {(value: number) => number} */
  const y = (value) => 226 - ((value - low) / (high - low)) * 186;
  /** @type {(each: DrawnMotion, at: number) => number} */
  const x = ({ places }, at) => 20 + (440 * at) / places[places.length - 1];
  /** @type {(each: DrawnMotion) => number[][]} */
  const near = ({ stops }) => stops.filter(([, height]) => Math.abs(height) <= reach);
  /** @type {(each: DrawnMotion, turn: number) => number} */
  const base = ({ base: most }, turn) => (most || 0) * Math.sin(2 * Math.PI * turn);
  /** @type {(text: string, up: number) => void} */
  const write = (text, up) => svg.append(drawn("text", { class: "middle", x: 240, y: up }, text));

  function remark() {
    const still = bent.some((each) => each.base === null) ? "seen from the base" : "base at rest";
    const frame = most > 0 ? `base ± ${metres(most)}` : still;
    const far = bent.some((each) => near(each).length < each.stops.length) ? "; a stop is beyond the figure" : "";
    const none = bent.some((each) => !each.stops.length) ? "; the stop, on the opposite beam, is not shown" : "";
    return `${frame}${far || none}; beam not to this scale`;
  }

  /** @type {(each: DrawnMotion, turn: number) => void} */
  function drawOne(each, turn) {
    const shape = shapeAt(each, turn), from = each.held ? 0 : 1, lift = base(each, turn);
    const at = each.places.slice(from).map((place, k) => [x(each, place), y(shape[k + from] + lift)]);
    const points = at.map((pair) => pair.map((value) => value.toFixed(1)).join(",")).join(" ");
    const look = { fill: "none", stroke: each.colour(), "stroke-dasharray": each.dash.join(" "), "stroke-width": 2.2 };
    svg.append(drawn("polyline", { ...look, points }));
  }

  /** @type {(turn: number) => void} */
  function move(turn) {
    svg.replaceChildren();
    if (!bent.length) return write("no places along a beam are known here", 130);
    svg.append(drawn("path", { d: `M20 ${y(0)}H460`, stroke: "#8a96a3", "stroke-dasharray": "4 3" }));
    for (const each of bent) drawOne(each, turn);
    for (const each of bent) {
      for (const [at, height, side] of near(each)) {
        const tip = `M${x(each, at).toFixed(1)} ${y(height + base(each, turn)).toFixed(1)}`;
        svg.append(drawn("path", { class: "stop", d: `${tip}l-5 ${-9 * side}h10z` }));
      }
    }
    const wall = { class: "wall", x: 10, y: (y(base(bent[0], turn)) - 14).toFixed(1), width: 8, height: 28 };
    if (most > 0) svg.append(drawn("rect", wall));
    write(`${short(turn % 12, 3)} drive periods, deflections ${metres(range[0])} … ${metres(range[1])}`, 14);
    write(remark(), 254);
  }

  return {
    move,
    draw(motions) {
      bent = motions.filter((each) => each.beam.length);
      range = [Infinity, -Infinity];
      for (const { beam } of bent) {
        for (const value of beam) { if (value < range[0]) range[0] = value; if (value > range[1]) range[1] = value; }
      }
      reach = FAR * Math.max(...range.map(Math.abs));
      most = Math.max(0, ...bent.map((each) => each.base || 0));
      const heights = [0, ...range, ...bent.flatMap((each) => near(each).map(([, height]) => height))];
      [low, high] = spanOf(heights.flatMap((value) => [value - most, value + most]));
    },
  };
}
