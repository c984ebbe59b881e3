"""Is one degree of freedom enough for my relay?

To know where its open contact first closes, yes. To know how far up it goes on tapping, no.

The spring is a strip of 20 mm with a rivet at its tip, shaken at 4.5 g. The contact first closes where the amplitude
without a stop reaches the gap: at 141.16 Hz with one degree of freedom, at 141.02 Hz with eight modes. From there on
the stop carries the resonance up with the frequency, as the sweep shows: one degree of freedom goes on tapping up to
201 Hz, eight modes up to 183 Hz, because every impact also moves the modes that one degree of freedom does not have.
Two modes tell it: 183 Hz. Between 183 Hz and 201 Hz the smallest model predicts a contact that chatters where the
relay is quiet.

`vibeam verdict cases/rigs/relay.toml` finds the number of modes that a case needs
([the verdict](../../vibeam/studies/README.md#the-verdict)); the relay is one of the [rigs](../rigs/README.md).
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import vibeam

case = vibeam.load(Path(__file__).parents[1] / "rigs" / "relay.toml")
print(f"length of the spring: {1e3 * case.keys.value('beam.length'):.0f} mm")
print(f"acceleration of the base: {case.keys.value('drive.acceleration') / 9.80665:.2f} g")


def beyond(frequency, system):
    """Amplitude of the contact without a stop, less the gap."""
    omega = 2 * np.pi * frequency
    modes = system.load / (system.omega**2 - omega**2 + 2j * system.zeta * system.omega * omega)
    return case.keys.value("drive.acceleration") * abs(system.contact @ modes) - system.gap


result = vibeam.run(case)
models = {"sdof": "one degree of freedom", "two_modes": "two modes", "spring": "eight modes"}
figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
for name, label in models.items():
    up = result[name].up
    taps = up.frequency[up.impacts_per_period > 0]
    closes = brentq(beyond, 100, 150, args=(case.system(name),))
    print(f"{label}: closes at {closes:.2f} Hz, goes on tapping up to {taps[-1]:.0f} Hz")
    axes.plot(up.frequency, 1e3 * up.amplitude, label=label)

axes.set(xlabel="drive frequency, swept up [Hz]", ylabel="amplitude of the contact [mm]", title="A relay at 4.5 g")
axes.legend()
figure.savefig("relay.png", dpi=150)
