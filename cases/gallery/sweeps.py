"""Why does my sweep up not match my sweep down?

Because two motions are possible at the same frequency, and a sweep stays on the one that it is on.

The stop of this harvester makes its resonance stiffer, so the tapping motion leans to the right. Swept up, one degree
of freedom taps up to 67.00 Hz; swept down, it is free until 57.25 Hz. Between 57.36 Hz, where the free motion grazes
the stop, and 67.19 Hz, where the tapping motion meets an unstable one in a fold and both vanish, either is right. No
sweep shows the unstable motion, but it says how far a disturbance may go: at 60 Hz, of states within 0.5 mm of rest and
0.2 m/s, 63 % lead to the tapping motion.

A sweep tells its own history, so `vibeam run` sweeps both ways; `vibeam map` has
[basins and exact boundaries](../../vibeam/maps/README.md), and `vibeam.follow` goes
[past the fold](../../vibeam/periodic/README.md#branches). Asked in
[roadrunner#1235](https://github.com/sys-bio/roadrunner/issues/1235), where a diagram has one state and the model two.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import vibeam

case = vibeam.load(Path(__file__).parents[1] / "rigs" / "harvester.toml")
system = case.system("sdof")
swept = vibeam.run(case, fidelities=["sdof"])["sdof"]
taps = {name: branch.frequency[branch.impacts_per_period > 0].max() for name, branch in swept.items()}
print(f"taps: swept up to {taps['up']:.2f} Hz, swept down from {taps['down']:.2f} Hz on")


def at(hertz):
    """The system and its drive at one frequency of the case."""
    omega = 2 * np.pi * hertz
    return system, vibeam.Drive(omega, float(case.amplitude(omega)))


figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
left.plot(swept.up.frequency, 1e3 * swept.up.amplitude, "C0>", ms=4, label="swept up")
left.plot(swept.down.frequency, 1e3 * swept.down.amplitude, "C1<", ms=3, label="swept down")
hertz, close = 60.0, 1e-9
for orbit in vibeam.orbits(*at(hertz)):
    branch = vibeam.follow(orbit, at, 70.0 if orbit.stable else 50.0, value=hertz)
    met = branch.boundaries[0]
    print(f"{met.kind.name.lower()}: {met.value:.2f} Hz")
    sizes = np.array([1e3 * each.amplitude("sensor") for each in branch.orbits])
    left.plot(branch.values, np.where(branch.stable, np.nan, sizes), "C3-", label=None if orbit.stable else "unstable")
left.set(xlabel="drive frequency [Hz]", ylabel="amplitude of the tip [mm]", title="Both sweeps, and what lies between")
left.legend()

reach, fast = 1e3 * system.gap, 0.2  # mm, m/s
places, velocities = np.linspace(-system.gap, system.gap, 81), np.linspace(-fast, fast, 81)
row = system.contact[0]
starts = np.stack(np.meshgrid(places / row, velocities / row), axis=-1)
_, drive = at(hertz)
settled = vibeam.batch(system, drive.omega, drive.amplitude, state=starts, settle=400, hold=20)
tapping = settled.impacts_per_period > 0
print(f"driven at: {hertz:.0f} Hz, of states within {reach:.1f} mm and {fast} m/s", end=" ")
print(f"{100 * tapping.mean():.0f} % lead to tapping")
right.pcolormesh(1e3 * places, velocities, tapping, cmap="Blues", vmin=0, vmax=1.6)
right.set(xlabel="contact point at the start [mm]", ylabel="its velocity [m/s]", title="60 Hz: dark starts end tapping")
figure.savefig("sweeps.png", dpi=150)
