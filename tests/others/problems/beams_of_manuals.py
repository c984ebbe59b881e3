"""Beams of the verification manuals of Ansys, NAFEMS and code_aster: frequencies and deflections."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sin, sinh

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import brentq

from tests.others.beam_models import beam, hertz, tapered, tip_flexibility
from tests.others.problem import Problem
from vibeam_models.beams.beam import Beam
from vibeam_models.beams.shapes import General, Rectangle
from vibeam_models.space import bare_beam

MAPDL = "ansys/pymapdl, src/ansys/mapdl/core/examples/verif/"
ANSYS = "Ansys, Mechanical APDL Verification Manual, "
ASTER = "code_aster, ehmoussi/code_aster astest/"
PAGES = " and its page of the validation manual (the guide VPCS)"
FINITE = "finite elements beside the closed form"
CLOSED = "two meshes, extrapolated: an error bound"
WHERE = "tests/others/beam_models.py, hertz"
STEEL = (2e11, 7800.0)


def manual(name: str, of: str) -> str:
    """Source of a case of Ansys' manual, and the textbook that it is from."""
    return f"{ANSYS}{name.upper()} ({of}): {MAPDL}{name}.dat"


def deep(length: float, width: float, height: float, density: float) -> Beam:
    """Timoshenko's beam between pins."""
    section = Rectangle(width, height)
    return beam(length, section, 2e11, density, "pinned-pinned", poissons_ratio=0.3, shear=True)


def timoshenko_hertz(of: Beam, modes: int) -> list[float]:
    """Frequencies of a pinned Timoshenko beam: the lower root of its quadratic in ω², page V2.04.302 of code_aster."""
    area, second = of.shape.area_times(1.0), of.shape.second_moment_times(1.0)
    sheared = of.shape.sheared_area(0.3) * 2e11 / 2.6
    j, g = second / (area * of.length**2), 2e11 * second / (sheared * of.length**2)
    found = []
    for n in range(1, modes + 1):
        square = (n * pi) ** 2
        root = np.sqrt((g - j) ** 2 * square**2 + 2 * (g + j) * square + 1)
        eigenvalue = ((g + j) * square + 1 - root) / (2 * g * j)
        found.append(np.sqrt(eigenvalue * 2e11 * second / (of.density * area * of.length**4)) / (2 * pi))
    return found


def with_oscillator(share: float, count: int = 3) -> np.ndarray:
    """Frequencies of SDLL04: a pinned beam of 10 m, an oscillator tuned to its first mode at a quarter, in Hz."""
    whole, place = beam(10.0, General(0.01, 0.39e-5), *STEEL, "pinned-pinned"), 2.5
    mass, meshes = 780.0 * share, []
    stiffness = 75.9791e3 * share
    for elements in (40, 80):
        bare, space = bare_beam(replace(whole, elements=elements))
        row = np.append(space.row(place), -1.0)
        m, k = (np.pad(each, (0, 1)) for each in (bare.M, bare.K))
        m[-1, -1] = mass
        meshes.append(np.sqrt(eigh(k + stiffness * np.outer(row, row), m, eigvals_only=True)[:count]) / (2 * pi))
    return np.asarray((16 * meshes[1] - meshes[0]) / 15)


def oscillator_equation(frequency: float, share: float) -> float:
    """Frequency equation of SDLL04: λ rL [sin ra sin rb/sin rL − sh ra sh rb/sh rL] = 2(1 − ω²/ω_c²).

    Its page has the other sign on the right, with which its own results are no roots.
    """
    omega = 2 * pi * frequency
    r = np.sqrt(omega / 100.0)  # √(EI/ρA) = 100 m²/s
    a, b = 2.5 * r, 7.5 * r
    bracket = sin(a) * sin(b) / sin(10 * r) - sinh(a) * sinh(b) / sinh(10 * r)
    return float(share * 10 * r * bracket - 2 * (1 - omega**2 / (75.9791e3 / 780.0)))


def pointed(shape_factor: float) -> float:
    """det of w and w′ at the clamp, x = 1, of the two shapes of (x w″)″ = λ² x w that are free at the point x = 0."""
    total = np.zeros((2, 2))
    for which, first in enumerate((0, 1)):
        n, term = first, 1.0
        while n < 60:
            total[which] += term, n * term
            n += 4
            term *= shape_factor**2 / (n * (n - 1) ** 2 * (n - 2))
    return float(np.linalg.det(total))


POINT = brentq(pointed, 6.0, 8.0, xtol=1e-14) / (2 * pi * 16**2) * np.sqrt(30e6 / (12 * 728e-6))
Problem(
    "Simply supported beam", "f₁ in Hz, 80 in long", manual("vm50", "Thomson, ex. 1.5-1"), ("28.766",),
    lambda: hertz(beam(80.0, General(4.0, 4 / 3), 30e6, 728e-6, "pinned-pinned"), 1), 2e-5, "five digits", FINITE,
    CLOSED, WHERE,
)  # fmt: skip
Problem(
    "Simply supported beam", "f₁ in Hz, 240 in long", manual("vm70", "Biggs, art. 6.4"), ("6.0979",),
    lambda: hertz(beam(240.0, General(273.9726, 1000 / 3), 30e6, 73e-5, "pinned-pinned"), 1), 1e-5, "five digits",
    FINITE, CLOSED, WHERE,
)  # fmt: skip
Problem(
    "Flat cantilever 16 × 4 × 1 in", "f₁ in Hz", manual("vm66", "Timoshenko, art. 53"), ("128.09",),
    lambda: hertz(beam(16.0, Rectangle(4.0, 1.0), 30e6, 728e-6), 1), 6e-5, "1.875² in place of 1.87510² there", FINITE,
    CLOSED, WHERE,
)  # fmt: skip
Problem(
    "Wedge that goes to a point in width", "f₁ in Hz", manual("vm62", "Timoshenko, art. 62"), ("259.16",),
    lambda: hertz(tapered(16.0, Rectangle(4.0, 1.0), Rectangle(4e-6, 1.0), 30e6, 728e-6), 1), 2e-6,
    "a width of 4 millionths at the point", "an approximation of a textbook", CLOSED, WHERE, right=POINT,
    reason="Theirs is 0.6 % below the root of (x w″)″ = λ² x w by its power series, λ = 7.15646 (clamped at 1, free at "
    "the point), and no approximation by shapes can lie below",
)  # fmt: skip
Problem(
    "Deep simply supported beam", "f of bending modes 1, 2, 3 in Hz",
    f"NAFEMS, Selected Benchmarks for Forced Vibration R0016 (1993), test 5: {MAPDL}vmp09-t5-188.dat",
    ("42.65", "148.15", "283.47"), lambda: hertz(deep(10.0, 2.0, 2.0, 8000.0), 3), 1.3e-4,
    "rounded there to half a hundredth or more", "closed form", CLOSED, WHERE,
)  # fmt: skip
SHORT = "Short beam on simple supports"
Problem(
    SHORT, "f of bending modes 1 to 4 in Hz", f"{ASTER}sdll01a.comm, VALE_REFE (Timoshenko, Young & Weaver, p. 415)",
    ("431.555", "1498.295", "2870.661", "4377.837"), lambda: hertz(deep(1.0, 0.1, 0.2, 7800.0), 4), 1e-6,
    "two meshes", "a formula of a textbook", CLOSED, WHERE, right=timoshenko_hertz(deep(1.0, 0.1, 0.2, 7800.0), 4),
    reason="Right is the root of Timoshenko's own quadratic in ω², which page V2.04.302 of code_aster prints; its own "
    "elements give 431.892 Hz and 1500.76 Hz. Theirs is an approximate formula, up to 0.4 % off",
)  # fmt: skip
COUPLED = "Beam with a mass on a spring, tuned to its first mode"
Problem(
    COUPLED, "f₁ to f₃ in Hz, λ = 0.01", f"{ASTER}sdll04a.comm{PAGES}", ("1.4937", "1.6506", "6.2874"),
    lambda: with_oscillator(0.01), 4e-5, "five digits", "roots of the frequency equation", CLOSED,
    "tests/others/problems/beams_of_manuals.py, with_oscillator",
)  # fmt: skip
Problem(
    COUPLED, "f₁ to f₃ in Hz, λ = 0.001", f"{ASTER}sdll04a.comm{PAGES}", ("1.546", "1.5958", "6.2336"),
    lambda: with_oscillator(0.001), 1e-6, "two meshes", "roots of the frequency equation", CLOSED,
    "tests/others/problems/beams_of_manuals.py, with_oscillator",
    right=[brentq(oscillator_equation, *ends, args=(0.001,), xtol=1e-13)
           for ends in ((1.5, 1.565), (1.575, 1.65), (6.2833, 6.4))],
    reason="6.2336 is a slip for 6.2836: so has it the frequency equation, and code_aster's own result, 6.2817",
)  # fmt: skip
TAPER = "Cantilever that tapers both ways"
MABIE = f"{ASTER}sdll09a.comm{PAGES}; Mabie & Rogers, J. Acoust. Soc. Am. 51 (1972) 1771"
Problem(
    TAPER, "f₁ to f₅ in Hz, 4 : 1 both ways", MABIE, ("54.18", "171.94", "384.40", "697.24", "1112.28"),
    lambda: hertz(tapered(1.0, Rectangle(0.04, 0.04), Rectangle(0.01, 0.01), *STEEL), 5), 4e-4,
    "integrated numerically in 1972, λ₁ to five digits, λ₅ to four", "numerical integration", CLOSED, WHERE,
)  # fmt: skip
LAMBDAS = (24.308, 75.56, 167.21, 301.9, 480.4)  # of the page, 4 : 1 in height and 5 : 1 in width
Problem(
    TAPER, "f₁ to f₅ in Hz, 4 : 1 in height, 5 : 1 in width", MABIE,
    ("56.55", "175.19", "389.01", "702.36", "1117.63"),
    lambda: hertz(tapered(1.0, Rectangle(0.05, 0.04), Rectangle(0.01, 0.01), *STEEL), 5), 4e-4, "as above",
    "numerical integration", CLOSED, WHERE,
    right=np.array(LAMBDAS) * 0.01 / (2 * pi) * np.sqrt(STEEL[0] / (12 * STEEL[1])),
    reason="175.19 is a slip for 175.79: so has it the λ₂ = 75.56 of the same page, from which the others are",
)  # fmt: skip
STRAIGHT = "Straight cantilever of MacNeal and Harder"
Problem(
    STRAIGHT, "deflection under a force at the tip, in plane and out of it",
    f"Ansys, Mechanical APDL Verification Manual, VMD1 (MacNeal & Harder): {MAPDL}vmd1.dat", ("0.1081", "0.4321"),
    lambda: [tip_flexibility(beam(6.0, Rectangle(*sides), 1e7, 0.0, poissons_ratio=0.3, shear=True))
             for sides in ((0.1, 0.2), (0.2, 0.1))],
    2e-4, "four digits", "closed form", "shear by Cowper's coefficient", "tests/others/beam_models.py, tip_flexibility",
)  # fmt: skip
Problem(
    "Tapered cantilever under a force at its point", "deflection in in",
    manual("vm34", "Harris, prob. 61"), ("0.042667",),
    lambda: 10 * tip_flexibility(tapered(20.0, Rectangle(3.0, 0.5), Rectangle(1e-9, 0.5), 30e6, 0.0)), 1e-5,
    "five digits", "closed form", "elements that integrate the taper exactly",
    "tests/others/beam_models.py, tip_flexibility",
)  # fmt: skip
