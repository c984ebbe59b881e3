// One mode over a span of time, η'' + 2σ η' + ω² η = 0, free of cancellation: see flight/linear/propagator.py.
//
// [[p00, p01], [p10, p11]] carries (η, η') over the span; det(1 − P) and det(1 + P) are sums of squares, or products
// of two decays, and 1 − p00 is formed without the 1.

const APART = 0.3; // μ/σ from which the two decays of an overdamped mode are told apart

/**
 * The propagator, its determinant, 1 − p00, det(1 − P) and det(1 + P).
 * @typedef {{p00: number, p01: number, p10: number, p11: number, det: number, rise: number, closing: number,
 *   opening: number}} Propagator
 */

/**
 * The mode (ω, ζ) over `span` s, of any damping, ω = 0 included.
 * @param {number} omega rad/s
 * @param {number} zeta
 * @param {number} span
 * @returns {Propagator}
 */
export function propagator(omega, zeta, span) {
  const sigma = zeta * omega, disc = omega * omega * (zeta - 1) * (zeta + 1);
  const e = Math.exp(-sigma * span), rate = Math.sqrt(Math.abs(disc));
  const [cosine, sine, rise, closing, opening] =
    disc < 0 ? underdamped(sigma, rate, span, e) : overdamped(omega, sigma, rate, span, e);
  return {
    p00: cosine + sigma * sine, p01: sine, p10: -omega * omega * sine, p11: cosine - sigma * sine,
    det: e * e, rise, closing, opening,
  };
}

/**
 * e^{−σt} cos wt, e^{−σt} sin(wt)/w, 1 − p00, det(1 − P), det(1 + P) of a mode that oscillates at w.
 * @param {number} sigma
 * @param {number} w
 * @param {number} t
 * @param {number} e
 */
function underdamped(sigma, w, t, e) {
  const halfSine = Math.sin((w * t) / 2), halfCosine = Math.cos((w * t) / 2);
  const lost = -Math.expm1(-sigma * t), versine = 2 * e * halfSine * halfSine;
  const sine = (2 * e * halfSine * halfCosine) / w;
  const opening = lost * lost + 4 * e * halfCosine * halfCosine;
  return [e - versine, sine, lost + versine - sigma * sine, lost * lost + 2 * versine, opening];
}

/**
 * The same by the two decays σ ± μ, of which ω²/(σ + μ) is the slow one.
 * @param {number} omega
 * @param {number} sigma
 * @param {number} mu
 * @param {number} t
 * @param {number} e
 */
function overdamped(omega, sigma, mu, t, e) {
  const fast = sigma + mu, slow = fast > 0 ? (omega * omega) / fast : 0;
  const first = Math.exp(-slow * t), second = Math.exp(-fast * t);
  const lost = -Math.expm1(-slow * t), lostFast = -Math.expm1(-fast * t);
  const sine = mu > 0 ? (first * -Math.expm1(-2 * mu * t)) / (2 * mu) : t * e;
  const rise = mu > APART * sigma
    ? (fast * lost - slow * lostFast) / (2 * mu)
    : -Math.expm1(-sigma * t) - (first * Math.expm1(-mu * t) ** 2) / 2 - sigma * sine;
  return [(first + second) / 2, sine, rise, lost * lostFast, (1 + first) * (1 + second)];
}
