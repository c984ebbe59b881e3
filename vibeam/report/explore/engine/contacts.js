// Contacts with a stop that yields, as segments of a motion have them.

/**
 * Begin, end (s) and largest force (N) of each contact with a stop that yields: Trajectory.contacts.
 * @param {import("./slots.js").Slots} slots
 * @param {import("./segments.js").Segments} segments
 * @returns {[number, number, number][]}
 */
export function contactsOf({ rows: { layout, regimes } }, { trace, count, columns }) {
  /** @type {[number, number, number][]} */
  const found = [];
  let before = -2;
  for (let i = 0; columns > regimes.PEAK && i < count; i++) {
    const at = i * columns, end = trace[at + layout.START] + trace[at + layout.DURATION];
    if (trace[at + layout.WHAT] !== regimes.CONTACT) continue;
    if (i === before + 1) {
      const last = found[found.length - 1];
      [last[1], last[2]] = [end, Math.max(last[2], trace[at + regimes.PEAK])];
    } else found.push([trace[at + layout.START], end, trace[at + regimes.PEAK]]);
    before = i;
  }
  return found;
}
