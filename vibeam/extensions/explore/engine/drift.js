// A gap that drifts with the drive frequency: linear between the places of its table, constant beyond its ends.

/**
 * Gap added at a frequency, as numpy.interp.
 * @param {{frequency: ArrayLike<number>, gap: ArrayLike<number>}} drift Hz, m
 * @param {number} frequency Hz
 * @returns {number}
 */
export function driftAt({ frequency: places, gap }, frequency) {
  const last = places.length - 1;
  if (!(frequency > places[0])) return gap[0];
  if (frequency >= places[last]) return gap[last];
  let i = 0;
  while (places[i + 1] <= frequency) i++;
  return gap[i] + ((gap[i + 1] - gap[i]) / (places[i + 1] - places[i])) * (frequency - places[i]);
}
