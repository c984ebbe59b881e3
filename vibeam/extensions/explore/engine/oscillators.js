// A drive of several harmonics: the further ones as oscillators that no impact moves, two modes more for each (Python:
// solvers/several_harmonics.py). The modes' steady responses Im(H e^{iνt}) are taken out, and what the contact then
// misses is the oscillator's motion.
import { along, answered, heldWith } from "./following.js";
import { PackedSystem } from "./plain.js";
import { after } from "./segments.js";

/** @import { Slots } from "./slots.js" */
/** @import { Harmonic } from "./following.js" */
/** @import { Settings, State } from "./types.d.ts" */
/** @import { PlainModel } from "./plain.js" */
/** `harmonics`: order, share of the first one and phase of each.
 * @typedef {PlainModel & {harmonics: Float64Array}} DrivenModel */

const LIGHT = 1e-8; // contact row of an oscillator, as a share of the modes'

/** A plain system and its oscillators, packed for one drive. */
export class PackedHarmonics extends PackedSystem {
  /**
   * @param {Slots} slots
   * @param {DrivenModel} driven
   */
  constructor(slots, driven) {
    super(slots, widened(driven));
    this.driven = driven;
    this.modes = driven.omega.length;
    this.light = LIGHT * Math.hypot(...driven.contact);
    this.drive = { omega: NaN, amplitude: NaN, damping: NaN };
    /** @type {Harmonic[]} */
    this.harmonics = [];
  }

  /**
   * Pack for settings with their drive. Throws a sentence for what cannot be.
   * @param {Settings} settings
   * @param {number} omega
   */
  set(settings, omega) {
    const { drive, model, driven } = this, { amplitude, damping } = settings;
    if (settings.omega !== drive.omega || amplitude !== drive.amplitude || damping !== drive.damping) {
      this.drive.omega = NaN; // of none, until all is set
      model.zeta.set(driven.zeta.map((each) => each * damping));
      this.listen(settings);
      this.damping = NaN; // pack all anew
      this.drive = { omega: settings.omega, amplitude, damping };
    }
    super.set({ ...settings, damping: 1 }, omega);
  }

  /**
   * Set the oscillators to a drive: their rates, their share of the contact and of the outputs.
   * @param {Settings} settings
   */
  listen({ omega, amplitude }) {
    const { model, driven: { harmonics: given, ...driven }, modes: n, light } = this;
    this.harmonics = Array.from({ length: given.length / 3 }, (_, j) => {
      const [order, share, phase] = given.subarray(3 * j, 3 * j + 3), rate = order * omega;
      const force = driven.load.map((each) => each * share * omega ** 2 * amplitude);
      const response = answered(driven.omega, model.zeta, rate, force, phase), at = along(driven.contact, response);
      const seen = at.re !== 0 || at.im !== 0;
      const largest = Math.max(...response.re.map((each, k) => Math.hypot(each, response.im[k])));
      return { rate, response, seen, ...(seen ? at : { re: largest > 0 ? largest : 1, im: 0 }) };
    });
    this.harmonics.forEach((each, j) => {
      model.omega.fill(each.rate, n + 2 * j, n + 2 * j + 2);
      model.contact[n + 2 * j] = each.seen ? light : 0;
      for (const [name, row] of Object.entries(driven.outputs)) {
        const { re, im } = along(row, each.response), share = light / (each.re ** 2 + each.im ** 2);
        const [own, ahead] = [re * each.re + im * each.im, im * each.re - re * each.im];
        model.outputs[name].set([share * own, share * ahead], n + 2 * j);
      }
    });
    model.rest = heldWith(model, n, this.harmonics, light);
  }

  /**
   * A state of the modes at phase 0 as that of the system with its oscillators.
   * @param {State} state
   * @returns {State}
   */
  entered({ displacement, velocity, resting }) {
    const { place, rate } = this.forced(0), room = () => new Float64Array(this.size);
    const wide = { displacement: room(), velocity: room(), resting };
    wide.displacement.set(displacement.map((each, k) => each - place[k]));
    wide.velocity.set(velocity.map((each, k) => each - rate[k]));
    this.harmonics.forEach(({ rate: turn, re, im }, j) => {
      wide.displacement.set([im / this.light, re / this.light], this.modes + 2 * j);
      wide.velocity.set([(turn * re) / this.light, (-turn * im) / this.light], this.modes + 2 * j);
    });
    return wide;
  }

  /**
   * The state of the modes at phase 0.
   * @param {State} wide
   * @returns {State}
   */
  left({ displacement, velocity, resting }) {
    const { place, rate } = this.forced(0);
    for (let k = 0; k < this.modes; k++) [place[k], rate[k]] = [place[k] + displacement[k], rate[k] + velocity[k]];
    return { displacement: place, velocity: rate, resting };
  }

  /**
   * Steady responses of the modes to all harmonics at a time, and their rates.
   * @param {number} time
   */
  forced(time) {
    const place = new Float64Array(this.modes), rate = new Float64Array(this.modes);
    for (const { rate: turn, response: { re, im } } of this.harmonics) {
      const cosine = Math.cos(turn * time), sine = Math.sin(turn * time);
      for (let k = 0; k < this.modes; k++) {
        place[k] += im[k] * cosine + re[k] * sine;
        rate[k] += turn * (re[k] * cosine - im[k] * sine);
      }
    }
    return { place, rate };
  }
}

/**
 * The model with room for its oscillators, which nothing damps or drives.
 * @param {DrivenModel} model
 * @returns {PlainModel}
 */
function widened(model) {
  const more = (2 * model.harmonics.length) / 3;
  const longer = (/** @type {Float64Array} */ row) => after(row, new Float64Array(more));
  const outputs = Object.fromEntries(Object.entries(model.outputs).map(([name, row]) => [name, longer(row)]));
  const contact = longer(model.contact);
  for (let j = 0; j < more; j += 2) contact[model.contact.length + j] = 1; // that of one of the two, see `listen`
  return {
    ...model, outputs, contact, omega: longer(model.omega), zeta: longer(model.zeta), load: longer(model.load),
    static: longer(model.static),
  };
}
