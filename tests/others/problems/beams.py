"""Natural frequencies of beams as textbooks and papers print them: any ends, a tip mass, a mass that turns."""

from __future__ import annotations

from math import cos, cosh, sin, sinh

import numpy as np
from scipy.optimize import brentq

from tests.others.beam_models import omegas, unit_beam, wave_numbers
from tests.others.problem import Problem

AEROBEAMS = "Blevins' roots of frequency equations, as luizpancini/AeroBeams.jl has them, test/beamBendingVibration"
THOMSON = "Thomson, Theory of Vibration with Applications (2010), appendix D"
HODGES = "Hodges & Pierce, Introduction to Structural Dynamics and Aeroelasticity (2011), problem 3.14, as "
HODGES += "luizpancini/AeroBeams.jl has it, test/clampedSSBeamWIthTipInertia.jl"
HINDAWI = "Mathematical Problems in Engineering, 2017, article 1568019: Frequency Equation of Flexural Vibrating "
HINDAWI += "Cantilever Beam Considering the Rotary Inertial Moment of an Attached Mass, table 1, "
ROOTS = "roots of the frequency equation"
BEYOND = "the same for any beam that has no frequency equation"
UNIFORM = "Uniform beam of any ends"
WHERE = "tests/others/beam_models.py, wave_numbers"


def with_tip(mass: float, inertia: float, count: int) -> np.ndarray:
    """(βL)² of a cantilever with a mass at its tip, of so many masses of the beam and of m L³ as inertia."""
    return omegas(unit_beam("clamped-free"), count, ((mass, 1.0, 0), (inertia, 1.0, 1)))


def tip_equation(x: float, mass: float, inertia: float) -> float:
    """Frequency equation of that cantilever, by EI w‴ = −ω²M w and EI w″ = ω²J w′ at the tip."""
    down, turn = mass * x, inertia * x**3
    plain = 1 + cos(x) * cosh(x) + down * (cos(x) * sinh(x) - sin(x) * cosh(x))
    return plain - turn * (cos(x) * sinh(x) + sin(x) * cosh(x)) + down * turn * (1 - cos(x) * cosh(x))


def roots_with_tip(mass: float, inertia: float, between: tuple[tuple[float, float], ...]) -> list[float]:
    """(βL)² of the roots in the given ranges of βL."""
    return [brentq(tip_equation, *ends, args=(mass, inertia), xtol=1e-14) ** 2 for ends in between]


for ends, name, theirs in (
    ("clamped-free", "CF", ("1.87510407", "4.69409113", "7.85475744", "10.99554073", "14.13716839")),
    ("clamped-clamped", "CC", ("4.73004074", "7.85320462", "10.99560784", "14.13716549", "17.27875966")),
    ("clamped-pinned", "CP", ("3.92660231", "7.06858275", "10.21017612", "13.35176878", "16.49336143")),
    ("clamped-guided", "CS", ("2.36502037", "5.49780392", "8.63937983", "11.78097245", "14.92256510")),
):
    Problem(
        UNIFORM, f"βL, modes 1 to 5, {ends}", f"{AEROBEAMS}{name}.jl", theirs,
        lambda ends=ends: wave_numbers(ends, 5), 2e-8, "two meshes, extrapolated", ROOTS, BEYOND, WHERE,
    )  # fmt: skip
for ends, rigid, theirs in (
    ("clamped-clamped", 0, ("22.3733", "61.6728", "120.9034")),
    ("free-free", 2, ("22.3733", "61.6728", "120.9034")),
    ("clamped-free", 0, ("3.5160", "22.0345", "61.6972")),
):
    Problem(
        UNIFORM, f"(βL)², modes 1 to 3, {ends}", THOMSON, theirs,
        lambda ends=ends, rigid=rigid: wave_numbers(ends, 3, rigid) ** 2, 1e-5, "four decimals", ROOTS, BEYOND, WHERE,
    )  # fmt: skip
Problem(
    "Clamped and pinned beam whose pin turns an inertia m L³", "(βL)², mode 1", HODGES, ("1.99048",),
    lambda: omegas(unit_beam("clamped-pinned"), 1, ((1.0, 1.0, 1),)), 2e-6, "five decimals", ROOTS, BEYOND,
    "tests/others/beam_models.py, omegas",
)  # fmt: skip
Problem(
    "Cantilever with a tip mass as heavy as itself", "(βL)², modes 1 to 5", HINDAWI + "last columns",
    ("1.557298", "16.25009", "50.89584", "105.1983", "179.2320"), lambda: with_tip(1.0, 0.0, 5), 1e-6,
    "seven digits", ROOTS, BEYOND, "tests/others/problems/beams.py, with_tip",
)  # fmt: skip
Problem(
    "Cantilever with a tip mass that also turns", "(βL)², modes 1 and 2, mass m L, inertia m L³/1000",
    HINDAWI + "column 1, 0.001", ("1.55867", "16.57872"), lambda: with_tip(1.0, 1e-3, 2), 1e-7, "two meshes", ROOTS,
    BEYOND, "tests/others/problems/beams.py, with_tip",
    right=roots_with_tip(1.0, 1e-3, ((1.0, 1.5), (3.8, 4.1))),
    reason="Theirs rise when an inertia is added, and no inertia can raise a frequency (Rayleigh): the moment of the "
    "mass has the other sign in their equation. Right are the roots of the equation with w″ = +ω²J w′/EI",
)  # fmt: skip
