"""How hard will it hit on a random floor?

No single number: the hardest impact of a record is a draw, and a spectrum alone cannot tell it, for a stop makes the
response anything but normal. What can be told is how often an impact is harder than a limit, with an error.

A beam at its stop on the floor of a truck, in 8 records of 10 s with the same spectrum: the hardest impact of a record
lies anywhere between 380 mm/s and 540 mm/s. Impacts harder than 400 mm/s come 0.31 ± 0.09 times a second by one degree
of freedom, and as often by eight modes, 0.31 ± 0.08: here the small model suffices. The error falls with the root of
the time, so that 10 % of this rate takes some 600 s of floor.

[A record in a case](../inputs/README.md), [maps of a record](../../vibeam/studies/README.md#under-a-record). Asked in
[code-aster-examples#3](https://github.com/Jesusbill/code-aster-examples/issues/3).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import vibeam

case = vibeam.load(Path(__file__).parents[1] / "inputs" / "truck.toml")
loads = [case.input("sdof", seed=seed) for seed in range(1, 9)]
length, limit = loads[0].duration, 400.0
total = len(loads) * length
print(f"flown: {len(loads)} records of {length:.0f} s, limit {limit:.0f} mm/s")

figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for name, label in {"sdof": "one degree of freedom", "beam": "eight modes"}.items():
    paths = vibeam.simulate_records(case.system(name), loads, length)
    records = [1e3 * path.impact_velocities for path in paths]
    hardest = np.round([record.max() for record in records], -1)
    rates = np.array([np.sum(record > limit) for record in records]) / length
    rate, error = rates.mean(), rates.std(ddof=1) / len(rates) ** 0.5
    print(f"{label}: hardest of a record between {min(hardest):.0f} mm/s and {max(hardest):.0f} mm/s", end=", ")
    enough = round(total * (error / rate / 0.1) ** 2, -2)
    print(f"above the limit {rate:.2f} ± {error:.2f} a second, for 10 % {enough:.0f} s")
    hits = np.sort(np.concatenate(records))[::-1]
    axes.semilogy(hits, np.arange(1, len(hits) + 1) / total, label=label)
axes.axvline(limit, color="0.8", zorder=0)
axes.set(xlabel="impact velocity [mm/s]", ylabel="harder impacts a second", title="A beam at its stop on a truck floor")
axes.legend()
figure.savefig("random_floor.png", dpi=150)
