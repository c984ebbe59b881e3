"""What does a part on my beam feel after a shock?

Much more than the beam's first mode tells, where the beam strikes its stop.

A shock of 5 g and 11 ms throws the beam off its stop; it comes back and strikes. A part of 101 Hz mounted on the beam
feels 7.9 g where it stands on the shock table itself, 21.4 g on a beam of one degree of freedom and 72.2 g on one of
eight modes: the impacts excite the second mode at 101 Hz, which one degree of freedom does not have. Two modes say
71.1 g. The impact that does it is the same for all, 318 mm/s: an impact velocity that agrees proves nothing of what
comes after it.

Above the highest mode of a model there is no answer: a rigid stop has no highest frequency.

[Five cases under a record](../inputs/README.md), [shock spectra](../../vibeam/flight/README.md#under-a-record). Asked
in [Engineering-Apps#21](https://github.com/fredbusher/Engineering-Apps/issues/21).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import vibeam

case = vibeam.load(Path(__file__).parents[1] / "inputs" / "half_sine.toml")
shock, part, g = case.input("sdof"), 101.0, 9.80665
print(f"shock: {shock.peak / g:.0f} g, {1e3 * case.keys.value('drive.duration'):.0f} ms, part of {part:.0f} Hz")
print(f"mode 2 of the beam: {case.system('beam').omega[1] / (2 * np.pi):.0f} Hz")

natural = np.append(np.geomspace(5, 300, 160), part)
*table, felt = vibeam.shock_spectrum(shock, natural).of("acceleration") / g
print(f"on the shock table: {felt:.1f} g")
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
axes.loglog(natural[:-1], table, ":", color="0.4", label="on the shock table")
for name, label in {"sdof": "one degree of freedom", "two_modes": "two modes", "beam": "eight modes"}.items():
    path = vibeam.simulate(case.system(name), shock, 1.0)
    *curve, felt = vibeam.shock_spectrum(path, natural, output="sensor").of("acceleration") / g
    print(f"on a beam of {label}: {felt:.1f} g, hardest impact {1e3 * path.impact_velocities.max():.0f} mm/s")
    axes.loglog(natural[:-1], curve, label=label)
axes.axvline(part, color="0.85", zorder=0)
axes.set(xlabel="natural frequency of the part [Hz]", ylabel="its largest acceleration [g]")
axes.set(title="A part on the beam, after a shock of 5 g and 11 ms")
axes.legend()
figure.savefig("shock.png", dpi=150)
