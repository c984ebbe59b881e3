// Outputs that are velocities or accelerations: as a regime's signal, and along a motion (Python: block_regime.py,
// disturbance/derivatives.py). Every derivative of the modes follows from the two before it:
// η'' = l Ω²B sin φ + s − D η' − Λ η − c F, F the force of a stop that holds or pushes.
import { dot } from "./equilibrium.js";
import { place } from "./segments.js";

/** @import { SlotArray, Slots } from "./slots.js" */
/** @import { Drive } from "./flight.js" */
/** @import { Segments } from "./segments.js" */
/** @import { PackedRegimes } from "./regimes.js" */
/**
 * row·η', or row·η'' + base·b̈, by its `order`.
 * @typedef {{row: Float64Array, order: number, base: number}} Derivative
 */

/**
 * Make a derivative the output of a regime.
 * @param {Slots} slots
 * @param {Record<string, SlotArray>} regime
 * @param {Derivative} wanted
 */
export function fillDerivative({ rows: { layout } }, { blocks: { data: blocks }, outof, signals }, wanted) {
  const { row, order, base } = wanted, n = row.length, width = outof.shape[1], m = width / 2;
  const weights = new Float64Array(width);
  for (let i = 0; i < width; i++)
    for (let k = 0; k < n; k++) weights[i] += row[k] * outof.data[(n + k) * width + i];
  let constant = 0, load = 0;
  for (let k = 0; order === 2 && k < m; k++) {
    const [first, second] = [weights[2 * k], weights[2 * k + 1]];
    /** @param {number} one @param {number} two rows */
    const both = (one, two) => first * blocks[one * m + k] + second * blocks[two * m + k];
    weights[2 * k] = both(layout.A11, layout.A21);
    weights[2 * k + 1] = both(layout.A12, layout.A22);
    constant += both(layout.CONSTANT1, layout.CONSTANT2);
    load += both(layout.LOAD1, layout.LOAD2);
  }
  signals.data.set([...weights, constant, load - base], layout.OUTPUT_SIGNAL * (width + 2));
}

/**
 * A derivative, or its rate (`more` 1), at times within the segments whose poses (m, 2, n) are known: after an event.
 * @param {PackedRegimes} packed
 * @param {Drive} drive
 * @param {Segments} segments
 * @param {ArrayLike<number>} times
 * @param {Float64Array} poses
 * @param {Derivative} wanted
 * @param {0 | 1} more
 * @returns {Float64Array}
 */
export function derivativeAlong(packed, drive, { trace, count, columns }, times, poses, { row, order, base }, more) {
  const { layout, regimes: rows } = packed.slots.rows, n = packed.size, wanted = order + more;
  return Float64Array.from(times, (time, i) => {
    const at = place(trace, columns, layout.START, count, time) * columns;
    const clock = trace[at + layout.AT_CLOCK] + time - trace[at + layout.START];
    const pose = poses.subarray(2 * n * i, 2 * n * (i + 1));
    const stop = { what: trace[at + layout.WHAT], side: trace[at + rows.AT_SIDE] };
    const known = derivativesOf(packed, drive, clock, stop, [pose.slice(0, n), pose.slice(n)], wanted);
    const turn = turned(drive.omega * clock, wanted - 2), swing = base * drive.amplitude * drive.omega ** wanted;
    return dot(row, known[wanted]) - (wanted > 1 ? swing * turn : 0);
  });
}

/**
 * Displacements of the modes and their derivatives up to `highest`.
 * @param {PackedRegimes} packed
 * @param {Drive} drive
 * @param {number} clock
 * @param {{what: number, side: number}} stop
 * @param {Float64Array[]} known displacements and velocities (n,)
 * @param {number} highest
 * @returns {Float64Array[]}
 */
function derivativesOf(packed, { omega, amplitude }, clock, { what, side }, known, highest) {
  const { tuple, size: n, slots: { rows: { layout, regimes } } } = packed;
  const of = (/** @type {string} */ name) => /** @type {Float64Array} */ (tuple[name].data);
  const [law, load, damper, spring] = [of("law"), of("load"), of("damper"), of("spring")];
  const row = of("contact").subarray(side * n, (side + 1) * n), gap = of("gaps")[side];
  for (let j = 0; j + 2 <= highest; j++) {
    const [place, rate] = known.slice(j), driven = amplitude * omega ** (j + 2) * turned(omega * clock, j);
    const next = place.map((each, k) => load[k] * driven + (j ? 0 : of("static")[k])
      - dot(damper.subarray(k * n, (k + 1) * n), rate) - spring[k] * each);
    let force = 0;
    if (what === layout.RESTING) force = dot(row, next) / dot(row, row);
    else if (what === regimes.CONTACT)
      force = law[regimes.STIFFNESS] * (dot(row, place) - (j ? 0 : gap)) + law[regimes.DAMPING] * dot(row, rate);
    known.push(next.map((each, k) => each - row[k] * force));
  }
  return known;
}

/**
 * Derivative j of sin φ by φ.
 * @param {number} phase
 * @param {number} j
 * @returns {number}
 */
function turned(phase, j) {
  return [Math.sin(phase), Math.cos(phase), -Math.sin(phase), -Math.cos(phase)][j];
}
