"""Frequencies of Stuttgart's two beams by transfer matrices: uniform pieces, point masses, composite sections by hand.

    python tests/independent/stuttgart.py   # writes stuttgart.json

Nothing of vibeam's is imported. The state is deflection, slope, bending moment EI w″ and EI w‴; over a point mass m
with rotary inertia J the moment jumps by −Jω² times the slope, EI w‴ by mω² times the deflection.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mpmath as mp

E, DENSITY, LENGTH, WIDTH, HEIGHT = 210e9, 7720.0, 0.3925, 0.06, 0.006
BENDING, PER_LENGTH = E * WIDTH * HEIGHT**3 / 12, DENSITY * WIDTH * HEIGHT


def with_plates(thickness: float, sides: int, stiffens: bool) -> float:
    """EI with plates of 40 mm width on one side or both: strains linear across all, about their common neutral axis."""
    if not stiffens:
        return BENDING
    parts = [(E * WIDTH * HEIGHT, 0.0, BENDING)]
    offset = (HEIGHT + thickness) / 2
    for side in range(sides):
        own = E * 0.04 * thickness
        parts.append((own, offset if side == 0 else -offset, own * thickness**2 / 12))
    axis = sum(axial * z for axial, z, _ in parts) / sum(axial for axial, _, _ in parts)
    return sum(bending + axial * (z - axis) ** 2 for axial, z, bending in parts)


def uniform(omega: Any, length: float, bending: float, per_length: float) -> Any:
    """Transfer matrix of a uniform piece."""
    k = mp.sqrt(mp.sqrt(mp.mpf(per_length) * omega**2 / bending))

    def at(x: Any) -> Any:
        c, s, ch, sh = mp.cos(k * x), mp.sin(k * x), mp.cosh(k * x), mp.sinh(k * x)
        rows = [[c, s, ch, sh], [-s, c, sh, ch], [-c, -s, ch, sh], [s, -c, sh, ch]]
        factors = [1, k, bending * k**2, bending * k**3]
        return mp.matrix([[factor * value for value in row] for factor, row in zip(factors, rows, strict=True)])

    return at(mp.mpf(length)) * at(mp.mpf(0)) ** -1


def point(omega: Any, mass: float, inertia: float = 0.0) -> Any:
    """Transfer matrix over a point mass."""
    matrix = mp.eye(4)
    matrix[3, 0], matrix[2, 1] = mass * omega**2, -inertia * omega**2
    return matrix


def frequencies(bending: float, plates: float, masses: list[tuple[float, float, float]], count: int = 3) -> list[float]:
    """Hz of a cantilever with ``plates`` (kg) and ``bending`` from 290 to 330 mm, masses (m, kg, kg m²) beyond."""

    def determinant(f: Any) -> Any:
        omega = 2 * mp.pi * f
        whole = uniform(omega, 0.04, bending, PER_LENGTH + plates / 0.04) * uniform(omega, 0.29, BENDING, PER_LENGTH)
        x = 0.33
        for place, mass, inertia in masses:
            if place > x:
                whole = uniform(omega, place - x, BENDING, PER_LENGTH) * whole
            whole, x = point(omega, mass, inertia) * whole, place
        whole = uniform(omega, LENGTH - x, BENDING, PER_LENGTH) * whole
        return mp.det(whole[2:4, 2:4])

    found: list[float] = []
    f, before = mp.mpf(2), determinant(mp.mpf(2))
    while len(found) < count:
        after = determinant(f + 4)
        if before * after < 0:
            found.append(float(mp.findroot(determinant, (f, f + 4), solver="anderson", tol=1e-25, verify=False)))
        f, before = f + 4, after
    return found


def predicted() -> dict[str, Any]:
    """Both beams, with plates that stiffen and with plates that only weigh; the leaf by itself, clamped."""
    found: dict[str, Any] = {}
    for name, stiffens in (("stiffen", True), ("weigh", False)):
        left = frequencies(with_plates(0.001, 1, stiffens), 0.0427, [(0.381, 0.0133, 0.0)])
        right = frequencies(with_plates(0.00675, 2, stiffens), 0.2095, [(0.33, 0.01804, 1.954e-5)])
        found[name] = {"left": left, "right": right}
    wave = mp.findroot(lambda x: mp.cos(x) * mp.cosh(x) + 1, 1.875)
    found["leaf_first_mode_Hz"] = float(wave**2 / (2 * mp.pi) * mp.sqrt(E / DENSITY / 12) * 0.001 / 0.057**2)
    found["leaf_stiffness_kN_per_m"] = 3 * E * 0.04 * 0.001**3 / 12 / 0.057**3 / 1e3
    return found


if __name__ == "__main__":
    Path(__file__).with_suffix(".json").write_text(json.dumps(predicted(), indent=2) + "\n")
