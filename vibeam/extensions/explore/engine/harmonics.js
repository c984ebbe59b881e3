// Motions under several harmonics: settled and read period by period in the system's own modes (Python:
// solvers/harmonic_point.py), for the oscillators of the further harmonics are larger by far than what they carry.
import { equilibrium } from "./equilibrium.js";
import { EventDriven } from "./flight.js";

/** @import { State } from "./types.d.ts" */
/** @import { Drive } from "./flight.js" */
/** @import { PackedHarmonics } from "./oscillators.js" */

const LONGEST = 16; // drive periods after which a motion may repeat
const REPEATS = 1e-5; // share of the motion's size by which states one period apart may differ

/** Motions of one system under several harmonics; states and poses are those of its own modes. */
export class HarmonicDriven extends EventDriven {
  /**
   * @param {PackedHarmonics} packed
   */
  constructor(packed) {
    super(packed);
    this.wide = packed;
  }

  /** Number of modes that poses have, and the user's number of each. */
  get shown() {
    return { size: this.wide.modes, order: Array.from({ length: this.wide.modes }, (_, k) => k) };
  }

  /**
   * @param {State | null} state
   */
  begun(state) {
    return this.wide.entered(state ?? equilibrium(this.wide.driven, this.wide.gap));
  }

  /**
   * @returns {State}
   */
  state() {
    return this.wide.left(super.state());
  }

  /**
   * @param {Drive} drive
   * @param {import("./segments.js").Segments} segments
   * @param {ArrayLike<number>} times
   * @returns {Float64Array}
   */
  posesAt(drive, segments, times) {
    const { wide, wide: { order, size, modes: n } } = this, found = super.posesAt(drive, segments, times);
    const own = new Float64Array(times.length * 2 * n);
    for (let i = 0; i < times.length; i++) {
      const { place, rate } = wide.forced(times[i]), at = 2 * size * i;
      order.forEach((mode, row) => {
        if (mode >= n) return;
        own[2 * n * i + mode] = found[at + row] + place[mode];
        own[2 * n * i + n + mode] = found[at + size + row] + rate[mode];
      });
    }
    return own;
  }

  /**
   * @param {Drive} drive
   * @param {State | null} state
   * @param {import("./flight.js").Schedule} schedule
   */
  watched(drive, state, { settle, hold, output, limit = 100000 }) {
    const { slots, wide, watch, slots: { rows: { layout } } } = this, first = Math.min(settle, 1);
    this.enter(state);
    watch.row.data.set(wide.output(output));
    watch.strobes = slots.fitted(watch.strobes, "f8", [2, 2, wide.size]);
    const strobes = [this.state()], total = new Float64Array(layout.RESULT_ROWS);
    for (let turn = 0; turn < first + hold; turn++) {
      this.counts.integers.fill(0n);
      wide.restart(this.pose.data, this.status.data, this.status.data[layout.KIND]);
      const [ended] = this.move(drive, Infinity, { settle: turn ? 0 : Math.max(settle - 1, 0), hold: 1, limit });
      if (ended !== layout.COMPLETE) {
        this.enter(null);
        return { ended, period: 0 };
      }
      if (turn < first) strobes.pop();
      strobes.push(this.state());
      if (turn >= first) gather(layout, total, watch.result.data, turn === first);
    }
    watch.result.data.set(total);
    return { ended: layout.COMPLETE, period: repetition(strobes, wide.driven.omega, drive.omega) };
  }
}

/**
 * Add one period's readings to those of the periods before.
 * @param {Record<string, number>} layout
 * @param {Float64Array} total
 * @param {Float64Array} found
 * @param {boolean} begun
 */
function gather({ HIGH, LEAST, CONTACT_LEAST, STRUCK, SPEED_SUM, REST_TIME }, total, found, begun) {
  total[HIGH] = begun ? found[HIGH] : Math.max(total[HIGH], found[HIGH]);
  for (const row of [LEAST, CONTACT_LEAST]) total[row] = begun ? found[row] : Math.min(total[row], found[row]);
  for (const row of [STRUCK, SPEED_SUM, REST_TIME]) total[row] += found[row];
}

/**
 * Least number of periods after which the last states repeat, else 0: observe/periodicity.py.
 * @param {State[]} strobes
 * @param {Float64Array} omega
 * @param {number} drive rad/s
 * @returns {number}
 */
function repetition(strobes, omega, drive) {
  const squared = (/** @type {(k: number) => [number, number]} */ parts) =>
    omega.reduce((sum, own, k) => sum + (own ** 2 + drive ** 2) * parts(k)[0] ** 2 + parts(k)[1] ** 2, 0);
  const size = Math.max(...strobes.map((each) => squared((k) => [each.displacement[k], each.velocity[k]])));
  const hold = strobes.length - 1;
  for (let k = 1; k <= Math.min(LONGEST, Math.floor(hold / 2)); k++) {
    const far = Math.max(...Array.from({ length: k }, (_, i) => {
      const [a, b] = [strobes[hold - i], strobes[hold - i - k]];
      return squared((j) => [a.displacement[j] - b.displacement[j], a.velocity[j] - b.velocity[j]]);
    }));
    if (far <= REPEATS ** 2 * size) return k;
  }
  return 0;
}
