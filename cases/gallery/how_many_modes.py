"""How many modes does an impact need?

Fewer than its force has frequencies, if the right thing is held, and no number at all for some questions.

The amplitude of this beam at 15.3 Hz, with the restitution held that its first mode shows: one mode is 10.7 % too low,
two modes 1.5 %, eight modes 0.06 %, beside 48 modes. With the contact's restitution held instead, each further mode
takes energy from the slow motion: eight modes are still 5.3 % above 48 modes, and the series falls on slowly, about as
one over the number of modes.

A rigid stop strikes all modes alike, so what is asked of the fast ones (peak forces, accelerations) has no limit.

`vibeam verdict CASE --only modes` names the number for a wanted accuracy
([how many modes are enough](../../vibeam/studies/README.md#how-many-modes-are-enough)); other bases than modes are
under [reductions](../../reductions/README.md). Asked in
[EXUDYN#100](https://github.com/jgerstmayr/EXUDYN/issues/100) and
[openfast#2844](https://github.com/OpenFAST/openfast/issues/2844).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import vibeam

counts, hertz = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48), 15.3
print(f"driven at: {hertz} Hz")
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for held, mark in (("first mode", "o-"), ("contact", "s-")):
    sizes = []
    for modes in counts:
        given = {"fidelity.beam.modes": modes, "beam.elements": 60, "stop.restitution_of": held}
        case = vibeam.load(Path(__file__).parents[1] / "dtu_neutral.toml", given)
        drive = vibeam.Drive(2 * np.pi * hertz, case.base_amplitude)
        [orbit] = [each for each in vibeam.orbits(case.system("beam"), drive) if each.stable]
        sizes.append(1e3 * orbit.amplitude("sensor"))
    print(f"restitution of the {held} held:")
    for modes, size in zip(counts, sizes, strict=True):
        print(f"  amplitude: {modes} modes, {size:.4f} mm, {100 * (size / sizes[-1] - 1):.2f} % from the last")
    axes.semilogx(counts, sizes, mark, label=f"restitution of the {held} held")
axes.set(xlabel="number of modes", ylabel="amplitude at the sensor [mm]", title=f"A beam at its stop, {hertz} Hz")
axes.set_xticks(counts, map(str, counts), minor=False)
axes.minorticks_off()
axes.legend()
figure.savefig("how_many_modes.png", dpi=150)
