"""Which restitution do I put into my model?

The one that belongs to the velocity that you read it from. A coefficient of restitution is no property of two materials
alone: an impact also sets the beam ringing, so that the contact gives back more than the slow motion gets.

A sensor on this beam shows that the first mode keeps 0.72 of its velocity. One degree of freedom takes 0.72 as it is.
For eight modes the same measurement means 0.846 at the contact, and the peaks agree: one degree of freedom is 10.5 %
too low, two modes, with 0.757, are 1.5 % too low. Who types 0.72 into all three as the contact's own gets a first mode
that keeps 0.602 with eight modes, and finds one degree of freedom 32.1 % too high, though it has not changed at all.

`restitution_of = "first mode"` in the case does the conversion; `vibeam modes CASE` prints it
([what a comparison holds](../../vibeam/runs/README.md#what-a-comparison-holds)). Asked in
[mujoco#2080](https://github.com/google-deepmind/mujoco/issues/2080) and, of what an engine makes of it, in
[PhysX#351](https://github.com/NVIDIAGameWorks/PhysX/issues/351).
"""

from pathlib import Path

import matplotlib.pyplot as plt

import vibeam

figure, both = plt.subplots(1, 2, figsize=(9, 4), sharey=True, layout="constrained")
span = {"from": "14.8 Hz", "to": "15.8 Hz", "points": 41}
models = {"sdof": "one degree of freedom", "two_modes": "two modes", "beam": "eight modes"}
for axes, held in zip(both, ("first mode", "contact"), strict=True):
    given = {"sweep.frequency": span, "sweep.direction": "up", "stop.restitution_of": held}
    result = vibeam.run(vibeam.load(Path(__file__).parents[1] / "dtu_neutral.toml", given))
    print(f"0.72 held, of the {held}:")
    for name, label in models.items():
        up, (contact, first) = result[name].up, result.restitutions(name)
        off = 100 * (up.peak.amplitude / result["beam"].up.peak.amplitude - 1)
        print(f"  {label}: contact {contact:.3f}, first mode {first:.3f}, peak off by {off:.1f} %")
        axes.plot(up.frequency, 1e3 * up.amplitude, label=label)
    axes.set(xlabel="drive frequency, swept up [Hz]", title=f"R = 0.72 of the {held}")
both[0].set(ylabel="amplitude at the sensor [mm]")
both[0].legend()
figure.savefig("restitution.png", dpi=150)
