"""Shock spectra of pulses and responses to random vibration of which handbooks and programs print numbers."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import pi

import numpy as np
from scipy.optimize import minimize_scalar

import vibeam
from tests.others.masses import FAR, masses
from tests.others.problem import Problem, spoiled
from tests.others.problems.beams_of_manuals import manual

HARRIS = "Harris' Shock and Vibration Handbook, 5th ed. 2002, chap. 8 (Ayre), p. 8.33: "
PYYETI = "pyYeti, twmacro/pyyeti 034fb7b, pyyeti/srs.py, doctest of "
HERE = "tests/others/problems/shocks.py, "
G = 386.4  # in/s², as the manual has it
PULSES = {  # 1 s long, peak 1
    "rectangle": vibeam.Record.step(1.0, 1.0),
    "sine": vibeam.Record.half_sine(1.0, 1.0),
    "versed sine": vibeam.Record.sine(-0.5, 1.0, 1.0, phase=pi / 2) + vibeam.Record.step(0.5, 1.0),
    "triangle": vibeam.Record.trapezoid(1.0, 1.0, rise=0.5, fall=0.5),
}


def peaks(pulse: vibeam.Record, when: str, frequencies: np.ndarray) -> np.ndarray:
    """Largest accelerations of oscillators that a spoiled damping turns from undamped ones."""
    spectrum = vibeam.shock_spectrum(pulse, np.atleast_1d(frequencies), spoiled() - 1)
    return np.abs(spectrum.of("acceleration", when) if when else spectrum.of("acceleration"))


def refined(pulse: vibeam.Record, when: str, sign: float, grid: np.ndarray) -> tuple[float, float]:
    """Frequency and value of the extreme on a grid, refined between its neighbours."""
    nearest = int(np.argmin(sign * peaks(pulse, when, grid)))
    bounds = (grid[max(nearest - 1, 0)], grid[min(nearest + 1, len(grid) - 1)])
    found = minimize_scalar(
        lambda f: sign * float(peaks(pulse, when, f)[0]), bounds=bounds, method="bounded", options={"xatol": 1e-10}
    )
    return float(found.x), sign * float(found.fun)


def silent() -> list[float]:
    """Lowest duration over period after which each pulse leaves the oscillator at rest; spoils the period."""
    grids = {"rectangle": (0.6, 1.4), "sine": (1.1, 1.9), "versed sine": (1.6, 2.4), "triangle": (1.6, 2.4)}
    found = []
    for name, (low, high) in grids.items():
        nearest = minimize_scalar(
            lambda f, pulse=PULSES[name]: float(np.abs(
                vibeam.shock_spectrum(pulse, [f * spoiled()], 0.0).of("acceleration", "residual")[0]
            )),
            bounds=(low, high), method="bounded", options={"xatol": 1e-10},
        )  # fmt: skip
        found.append(nearest.x)
    return found


def ratios() -> list[float]:
    """Largest of the peaks at any time over the largest of those after the pulse."""
    grid = np.linspace(0.2, 2.0, 91)
    names = ("sine", "versed sine", "triangle")
    return [refined(PULSES[n], "", -1.0, grid)[1] / refined(PULSES[n], "residual", -1.0, grid)[1] for n in names]


def tuned() -> float:
    """Peak of an oscillator of 15 Hz, Q = 20, on 5 s of a unit sine of 15 Hz."""
    sine = vibeam.Record.sine(1.0, 15.0, 5.0)
    return float(vibeam.shock_spectrum(sine, [15.0 * spoiled()], 1 / 40).of("acceleration")[0])


def shaped() -> list[float]:
    """Root mean squares of the accelerations of oscillators of 100, 200 and 1000 Hz, Q = 10, on 40 s of noise."""
    omega, ratio, rows = spoiled() * 2 * pi * np.array([100.0, 200.0, 1000.0]), 0.05, np.eye(3)
    system = vibeam.ImpactSystem.from_modes(
        omega, ratio, np.ones(3), np.ones(3), gap=FAR, restitution=0.5, outputs=dict(zip("012", rows, strict=True))
    )
    density = [(20.0, 0.0053), (150.0, 0.04), (600.0, 0.04), (2000.0, 0.0036)]
    path = vibeam.simulate(system, vibeam.Record.random(density, duration=40.0, seed=1, rate=5000.0), 40.0)
    times = np.arange(0.2, 40.0, 1 / 4999.3)
    moved = np.array([path.at(times, o) for o in "012"]), np.array([path.velocity_at(times, o) for o in "012"])
    felt = omega[:, None] ** 2 * moved[0] + 2 * ratio * omega[:, None] * moved[1]
    return list(felt.std(axis=1))


def two_masses() -> vibeam.ImpactSystem:
    """The masses of ½ and 1 lbf s²/in one after the other on a base that shakes."""
    chain = masses(
        [0.5, 1.0], [[42832.0 + 32416.0, -32416.0], [-32416.0, 32416.0]], [1.0, 0.0], [0.0, 0.0], [-0.5, -1.0]
    )
    accelerations = {f"a{o}": vibeam.TimeDerivative(chain.outputs[o], 2) for o in "01"}
    return replace(chain, zeta=np.full(2, 0.02), derivatives=accelerations)


def shaken() -> list[float]:
    """Standard deviations of both masses' accelerations relative to the base, in g, over 800 s."""
    noise = vibeam.Record.random([(10.0, 0.1 * G**2), (100.0, 0.1 * G**2)], duration=800.0, seed=1, rate=300.0)
    path = vibeam.simulate(two_masses(), noise, 800.0)
    times = np.arange(5.0, 800.0, 1 / 299.7)
    return [float(np.std(path.at(times, each)) / G) for each in ("a0", "a1")]


undamped = partial(Problem, problem="Pulses on an undamped oscillator", method="diagrams of closed forms")
undamped(
    quantity="lowest duration over period without a residual: rectangle, sine, versed sine, triangle",
    source=HARRIS + "item 7", theirs=("1.0", "1.5", "2.0", "2.0"), ours=silent, within=1e-6, why="root to 1e-7",
    adds="extremes of exact responses, between samples too", where=HERE + "silent",
)  # fmt: skip
undamped(
    quantity="largest of all peaks over largest after the pulse: sine, versed sine, triangle",
    source=HARRIS + "table 8.3", theirs=("1.04", "1.05", "1.06"), ours=ratios, within=0.013,
    why="theirs are read off diagrams", adds="theirs 1 % high", where=HERE + "ratios",
)  # fmt: skip
Problem(
    "Sine on an oscillator tuned to it", "peak acceleration over that of the base, Q = 20", PYYETI + "srs", ("20.0",),
    tuned, 2e-3, "three digits", "sampled at 1 kHz, upsampled", "exact response, no samples", HERE + "tuned",
)  # fmt: skip
Problem(
    "Oscillators on shaped noise", "root mean squares of acceleration in g, 100, 200 and 1000 Hz", PYYETI + "vrs",
    ("6.38", "11.09", "16.06"), shaped, 0.05, "statistics of 40 s: 2 % at 100 Hz", "integral of the spectrum",
    "a motion of that spectrum, not only its mean square", HERE + "shaped",
)  # fmt: skip
random = partial(
    Problem, problem="Two masses on a base that shakes at random", source=manual("vm68", "Vierck, chap. 7"),
    where=HERE + "two_masses",
)  # fmt: skip
random(
    quantity="f₁ and f₂ in Hz", theirs=("20.57", "64.88"), ours=lambda: two_masses().omega / (2 * pi), within=1.2e-4,
    why="four digits", method="closed form", adds="",
)  # fmt: skip
random(
    quantity="standard deviations of both accelerations relative to the base in g", theirs=("9.059", "10.63"),
    ours=shaken, within=0.04, why="statistics of 800 s", method="integral of the spectrum",
    adds="a motion of that spectrum, not only its mean square",
)  # fmt: skip
