"""Oscillators of Ansys' verification manual: decays, pulses, resonance and frequencies of masses on springs."""

from __future__ import annotations

from math import pi

import numpy as np

import vibeam
from tests.others.masses import flown, masses, one_mass, turned
from tests.others.problem import Problem, spoiled
from tests.others.problems.beams_of_manuals import manual

STEPS = "time steps, beside the closed form"
EXACT_FLOW = "no time step: the flow is exact"
TABLE = "tests/others/masses.py, "


def decays() -> list[float]:
    """Displacement after 90 ms of 0.0259067 lbf s²/in on 30 lbf/in let go at 1 in, ζ = 2, 1, 0.2 and 0."""
    dampings = (3.52636, 1.76318, 0.352636, 0.0)
    paths = (flown(one_mass(0.02590673, 30.0, c), 0.1, 1.0, 0.0) for c in dampings)
    return [float(path.at(0.09, "x")) for path in paths]


def struck(damping: float, times: list[float]) -> np.ndarray:
    """Displacement of ½ lbf s²/in on 200 lbf/in after an impulse of 10 lbf s."""
    return flown(one_mass(0.5, 200.0, damping), 0.2, 0.0, 20.0).at(times, "x")


def stepped(damping: float, times: list[float]) -> np.ndarray:
    """Displacement of the same under a force of 200 lbf from then on."""
    return flown(one_mass(0.5, 200.0, damping, 200.0), 0.3, 0.0, 0.0).at(times, "x")


def ramped() -> tuple[float, float]:
    """When and how far a mass at mid-span goes under a force that rises to 20 kip in 75 ms and stays."""
    stiffness = 48 * 30e3 * 1.647 * 18**3 / 12 / 240**3
    force = vibeam.Record.step(spoiled() * 20.0, 0.2, rise=0.075, quantity="force")
    return turned(flown(one_mass(0.0259067, stiffness), 0.1, 0.0, 0.0, force), "x", 0.08, 0.0999)


def shaken() -> float:
    """Amplitude of ½ lbf s²/in on 200 lbf/in and 6 lbf s/in under 10 sin 20 t lbf."""
    response = vibeam.sweep(
        one_mass(0.5, 200.0, 6.0 * spoiled()), omega=[20.0], amplitude=10 / 400, settle=60, hold=4, output="x"
    )
    return float(response.amplitude[0])


def pulsed() -> list[float]:
    """Displacements of two masses, 2 kg each, at 1.3 s and 2.4 s: 50 N on the first until 1.8 s."""
    chain = masses([2.0, 2.0], [[6.0, -6.0], [-6.0, 22.0]], [1.0, 0.0], [0.0, 0.0], [-1.0, 0.0])
    path = flown(chain, 2.5, [0.0, 0.0], [0.0, 0.0], vibeam.Record.step(50.0, 1.8, quantity="force"))
    return [float(path.at(time, output)) for time in (1.3, 2.4) for output in ("0", "1")]


def car() -> np.ndarray:
    """Frequencies in Hz of a car, 100 slug and 1600 slug ft², on springs 4.5 ft before and 5.5 ft behind its centre."""
    front, rear = 2400.0, 2600.0
    coupling = 5.5 * rear - 4.5 * front
    stiffness = [[front + rear, coupling], [coupling, 4.5**2 * front + 5.5**2 * rear]]
    return masses([100.0, 1600.0], stiffness, [1.0, 0.0], [0.0, 0.0], [1.0, 0.0]).omega / (2 * pi)


def pair() -> list[float]:
    """Frequencies in Hz of two masses between two walls, and the first's amplitude over the second's in each mode."""
    chain = masses([0.5, 1.0], [[1000.0, -800.0], [-800.0, 1000.0]], [1.0, 0.0], [0.0, 0.0], [1.0, 0.0])
    return [*chain.omega / (2 * pi), *(chain.outputs["0"] / chain.outputs["1"])]


Problem(
    "Decay of a mass let go, ζ = 2, 1, 0.2, 0", "displacement after 0.09 s in in", manual("vm71", "Thomson, ex. 2.2-1"),
    ("0.4742", "0.18998", "-0.52108", "-0.99688"), decays, 4e-5, "five digits", STEPS, EXACT_FLOW, TABLE + "one_mass",
)  # fmt: skip
STRUCK = "Mass after an impulse"
Problem(
    STRUCK, "displacement after 0.08 s and 0.1 s in in, ζ = 0", manual("vm74", "Thomson, art. 4.1"),
    ("0.99957", "0.90930"), lambda: struck(0.0, [0.08, 0.1]), 5e-6, "five decimals", STEPS, EXACT_FLOW,
    TABLE + "one_mass",
)  # fmt: skip
Problem(
    STRUCK, "displacement after 0.1 s in in, ζ = 0.7", manual("vm74", "Thomson, art. 4.1"), ("0.34180",),
    lambda: struck(14.0, [0.1]), 1.5e-5, "five decimals", STEPS, EXACT_FLOW, TABLE + "one_mass",
)  # fmt: skip
Problem(
    "Mass under a step of force", "displacement after 0.1575 s and 0.2 s in in, ζ = 0, after 0.2 s, ζ = 0.5",
    manual("vm75", "Thomson, art. 4.3"), ("2", "1.6536", "1.1531"),
    lambda: [*stepped(0.0, [0.1575, 0.2]), *stepped(10.0, [0.2])], 3e-5, "five digits", STEPS, EXACT_FLOW,
    TABLE + "one_mass",
)  # fmt: skip
Problem(
    "Mass at mid-span under a force with a rise time", "time of the largest deflection in s, and this in in",
    manual("vm77", "Biggs, example E"), ("0.092", "0.331"), ramped, 0.02, "read off a chart of Biggs' book", "chart",
    EXACT_FLOW, "tests/others/problems/oscillators.py, ramped",
)  # fmt: skip
Problem(
    "Damped mass at resonance", "amplitude in in", manual("vm86", "Thomson, ex. 3.1-2"), ("0.0833",), shaken, 5e-4,
    "three digits", "harmonic analysis", "settled by exact flow", "tests/others/problems/oscillators.py, shaken",
)  # fmt: skip
Problem(
    "Two masses under a pulse of force", "both displacements at 1.3 s, and at 2.4 s, in m",
    manual("vm182", "Vierck, sec. 5-8"), ("14.48", "3.99", "18.32", "6.14"), pulsed, 8e-4, "four digits and three",
    STEPS, EXACT_FLOW, "tests/others/problems/oscillators.py, pulsed",
)  # fmt: skip
Problem(
    "Car on its springs", "f₁ and f₂ in Hz", manual("vm52", "Thomson, ex. 6.7-1"), ("1.0981", "1.4406"), car, 4e-5,
    "five digits", "closed form", "", TABLE + "masses",
)  # fmt: skip
Problem(
    "Two masses between walls", "f₁ and f₂ in Hz, and ratios of the amplitudes", manual("vm89", "Thomson, ex. 6.2-2"),
    ("2.5814", "8.3263", "0.92116", "-2.1711"), pair, 4e-5, "five digits", "closed form", "", TABLE + "masses",
)  # fmt: skip
