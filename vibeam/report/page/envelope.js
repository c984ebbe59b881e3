// Drawing of histories: bins of least and greatest values, merged to what a screen has columns for; impacts likewise.
/** @import { Frame, Pen } from "./types.d.ts" */
/** @import { History, Impacts, StoredHistory } from "./histories.d.ts" */

const FINE = 1;  // columns a pixel, at least
const STEPS = 6;  // px of a bin from which on it is drawn as wide as it is

/** A history of its planes of bytes. @type {(stored: StoredHistory, planes: ArrayBuffer) => History} */
export function unfolded({ begin, width, bins, low, step }, planes) {
  const bytes = new Uint8Array(planes), least = new Float64Array(bins), greatest = new Float64Array(bins);
  /** @type {(plane: number, at: number) => number} */
  const word = (plane, at) => bytes[plane * bins + at] + 256 * bytes[(plane + 1) * bins + at];
  for (let at = 0, last = 0; at < bins; at += 1) {
    last = (last + word(0, at)) & 0xffff;
    least[at] = low + step * last;
    greatest[at] = low + step * (last + word(2, at));
  }
  return { begin, width, least, greatest };
}

/** First bin that meets a span, and the one behind the last. @type {(history: History, span: [number, number]) => [number, number]} */
export function binsOf({ begin, width, least }, [low, high]) {
  const from = Math.floor((low - begin) / width), to = Math.ceil((high - begin) / width);
  return [Math.min(Math.max(from, 0), least.length), Math.min(Math.max(to, 0), least.length)];
}

/** Least and greatest value of the bins that meet a span; none without any. @type {(history: History, span: [number, number]) => number[]} */
export function reachOf(history, span) {
  const [from, to] = binsOf(history, span), { least, greatest } = history;
  let low = Infinity, high = -Infinity;
  for (let bin = from; bin < to; bin += 1) { if (least[bin] < low) low = least[bin]; if (greatest[bin] > high) high = greatest[bin]; }
  return from < to ? [low, high] : [];
}

/** Outline of the least and the greatest values in the window; pale within: what lies behind is seen. @type {(pen: Pen, at: Frame, history: History, span: [number, number], look: {colour: string, wide: number}) => void} */
export function envelope(pen, at, history, span, { colour, wide: share }) {
  const [from, to] = binsOf(history, span), { begin, width, least, greatest } = history;
  const step = Math.max(1, Math.floor((to - from) / (FINE * (at.width / at.ratio))));
  const wide = (at.x(span[0] + width) - at.x(span[0])) / at.ratio > STEPS;
  /** @type {[number, number][]} */
  const below = [];
  pen.beginPath();
  let joined = false;
  /** @type {(time: number, low: number, high: number) => void} */
  const point = (time, low, high) => {
    if (joined) pen.lineTo(at.x(time), at.y(high)); else pen.moveTo(at.x(time), at.y(high));
    joined = true;
    below.push([at.x(time), at.y(low)]);
  };
  for (let first = Math.max(0, from - 1 - ((from - 1) % step)); first < Math.min(to + step, least.length); first += step) {
    let low = Infinity, high = -Infinity;
    for (let bin = first; bin < Math.min(first + step, least.length); bin += 1) { low = Math.min(low, least[bin]); high = Math.max(high, greatest[bin]); }
    const left = begin + first * width, right = begin + Math.min(first + step, least.length) * width;
    if (wide) { point(left, low, high); point(right, low, high); } else point((left + right) / 2, low, high);
  }
  for (const [x, y] of below.reverse()) pen.lineTo(x, y);
  pen.closePath();
  pen.setLineDash([]);
  [pen.fillStyle, pen.strokeStyle, pen.lineWidth] = [`${colour.trim()}26`, colour, share * at.ratio];
  pen.fill();
  pen.stroke();
}

/** Times and velocities of the impacts in a span: of each of ``columns`` the hardest. @type {(impacts: Impacts, span: [number, number], columns: number) => [number[], number[]]} */
export function hits({ time, velocity }, [low, high], columns) {
  const size = (high - low) / columns;
  /** @type {number[]} */
  const times = [];
  /** @type {number[]} */
  const speeds = [];
  let column = -1;
  for (let at = firstFrom(time, low); at < time.length && time[at] <= high; at += 1) {
    const own = size > 0 ? Math.floor((time[at] - low) / size) : at;
    if (own !== column) { times.push(time[at]); speeds.push(velocity[at]); }
    else if (velocity[at] > speeds[speeds.length - 1]) [times[times.length - 1], speeds[speeds.length - 1]] = [time[at], velocity[at]];
    column = own;
  }
  return [times, speeds];
}

/** Index of the first time that is not before ``low``. @type {(times: number[], low: number) => number} */
function firstFrom(times, low) {
  let from = 0, to = times.length;
  while (from < to) { const middle = (from + to) >> 1; if (times[middle] < low) from = middle + 1; else to = middle; }
  return from;
}
