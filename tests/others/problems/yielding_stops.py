"""Stops that yield: Hertz' contact time, NLvib's unilateral spring."""

from __future__ import annotations

from functools import cache, partial

import numpy as np

import vibeam
from tests.others.problem import Problem, spoiled
from tests.others.systems import modes, motion, two_masses
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import Hertz

NLVIB = "NLvib, 69598c5, EXAMPLES/03_twoDOFoscillator_unilateralSpring"
RUN = ", as run by julianjurai/NLvib-py 64ad450, examples/comparison/03_two_dof_unilateral.ipynb"

Problem(
    problem="duration of Hertz' impact", quantity="factor of (m²/(r E*² v))^{1/5}",
    source="LIGGGHTS, CFDEMproject/LIGGGHTS-PUBLIC, doc/fix_check_timestep_gran.html, dt_h", theirs=("2.87",),
    ours=lambda: hertz_factor(), within=1e-3, why="three digits", method="closed form",
    adds="contact integrated to 1e-12 a step, beside any number of modes", where="this module, hertz_factor",
)  # fmt: skip

spring = partial(
    Problem, problem="NLvib's two masses with a unilateral spring", source=NLVIB + RUN, where="this module, branch",
    method="harmonic balance, 21 harmonics, 1024 samples", adds="shooting on the exact flow, past folds and doublings",
)  # fmt: skip
spring(
    quantity="largest √(Σ of squared harmonics/2) of the mass at the spring, and at which Ω",
    theirs=("0.980930", "0.7541"), ours=lambda: peak(), within=2e-3,
    why="what 21 harmonics leave of a force with corners; its steps along the branch",
)  # fmt: skip
spring(
    quantity="its harmonics 1, 3 and 5 at Ω = 0.7541, an unstable motion", theirs=("1.326954", "0.093190", "0.026339"),
    ours=lambda: harmonics(0.7541)[[1, 3, 5]], within=2.5e-3, why="as above",
)  # fmt: skip


def hertz_factor() -> float:
    """Duration of the contact of a sphere of 1 kg and 20 mm, E* = 100 GPa, at 0.35 m/s, in Hertz' unit of time."""
    radius, modulus, speed = 0.02, 1e11, 0.35
    law = Hertz(4 / 3 * modulus * np.sqrt(radius) * spoiled())
    duration = motion(modes(0.0, law=law), 0.01, 0.0, speed).contacts[0, 1]
    return float(duration / (radius * modulus**2 * speed) ** -0.2)


@cache
def branch(factor: float) -> vibeam.Branch:
    """Motions of NLvib's two masses from Ω = 0.635 to 0.8; ``factor`` is ``spoiled()``."""
    system = two_masses()

    def setting(omega: float) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
        return system, vibeam.Drive(omega, 0.1 / omega**2)

    begun = next(each for each in vibeam.orbits(*setting(0.635)) if each.admissible)
    return vibeam.follow(begun, setting, 0.8, value=0.635)


def spectrum(orbit: vibeam.Orbit) -> Array:
    """Amplitudes of the mean and of the harmonics 1 … 40 of the contact's displacement."""
    period, count = 2 * np.pi / orbit.drive.omega, 4096
    samples = orbit.path().at(orbit.time + period * np.arange(count) / count, "contact")
    found = np.abs(np.fft.rfft(samples)[:41]) / count
    return np.concatenate([found[:1], 2 * found[1:]])


def harmonics(omega: float) -> Array:
    """Spectrum of the largest motion of the branch at Ω."""
    return max((spectrum(each) for each in branch(spoiled()).at(omega)), key=lambda each: each[1])


def peak() -> list[float]:
    """Largest root of half the sum of squares along the branch, by a parabola through three motions, and its Ω."""
    motions = branch(spoiled()).orbits
    sizes = np.array([np.sqrt(np.sum(spectrum(each) ** 2) / 2) for each in motions])
    rates = np.array([each.drive.omega for each in motions])
    near = slice(np.argmax(sizes) - 1, np.argmax(sizes) + 2)
    curve = np.polyfit(rates[near] - rates[near][1], sizes[near], 2)
    return [curve[2] - curve[1] ** 2 / (4 * curve[0]), rates[near][1] - curve[1] / (2 * curve[0])]
