// Numbers as texts, ticks of axes, packed arrays.

export const short = (value, digits = 4) => (value === null || value === undefined || !isFinite(value) ? "–" : String(+value.toPrecision(digits)));
export const withUnit = (label, unit) => (unit ? `${label} (${unit})` : label);
export const percent = (value) => (value === null || value === undefined ? "–" : value > 10 ? "> 1000 %" : `${short(100 * value, 3)} %`);

export const metres = (value) => {
  const [unit, factor] = [["m", 1], ["mm", 1e3], ["µm", 1e6], ["nm", 1e9]].find(([, each]) => Math.abs(value) * each >= 0.1) || ["nm", 1e9];
  return `${short(value * factor, 2)} ${unit}`;
};

export function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  return Array.from(new Uint16Array(bytes.buffer), (whole) => packed.low + packed.step * whole);
}

export function increasing(values) {
  let last = -Infinity;
  return values.map((value) => (last = value > last ? value : last + 1e-9));
}

export function spanOf(values) {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  const room = (high - low || Math.abs(high) || 1) * 0.06;
  return [low - room, high + room];
}

export function ticks(low, high) {
  const rough = (high - low) / 5, size = 10 ** Math.floor(Math.log10(rough));
  const step = size * [1, 2, 5, 10].find((each) => each * size >= rough);
  const found = [];
  for (let at = Math.ceil(low / step); at * step <= high; at += 1) found.push(at * step);
  return found;
}

// Ticks of a logarithmic axis: powers of ten, with 2 and 5 times them over few decades, and even steps in less than one.
export function logTicks(low, high) {
  const decades = Math.log10(high / low), found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) for (const digit of decades > 3 ? [1] : [1, 2, 5]) found.push(+(digit * 10 ** power).toPrecision(3));
  const inside = found.filter((each) => each >= low && each <= high);
  return inside.length > 1 ? inside : ticks(low, high).map((each) => +each.toPrecision(6));
}
