"""Frequencies of Stuttgart's two beams by transfer matrices: uniform pieces, point masses, composite sections by hand.

    python tests/independent/stuttgart.py   # writes stuttgart.json, and stuttgart_measured.json with the leaf as a beam

Nothing of vibeam's is imported. With the leaf by Hermite elements in numpy; without by a state of deflection, slope,
bending moment EI w″ and EI w‴: over a point mass m with rotary inertia J the moment jumps by −Jω² times the slope,
EI w‴ by mω² times the deflection.
"""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
from scipy.linalg import block_diag, eigh

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


MEASURED = {  # Hz: maltekrack/NLtest, setUpLinearModalBeamModel, om_LB_ref and om_MBRB_ref
    "right_first": 28.2, "left_first": 30.95, "left_second": 199.04, "right_second": 205.54, "leaf": 277.74,
    "left_third": 556.82, "right_third": 594.98, "left_fourth": 1085.93, "right_fourth": 1168.62,
}  # fmt: skip
MASS_ELEMENT = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
STIFFNESS_ELEMENT = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])


def assembled(nodes: Any, bending: Any, per_length: Any) -> tuple[Any, Any]:
    """M and K of a beam that nothing holds, deflection and slope at each of ``nodes``, m; EI and ρA of each element."""
    M, K = np.zeros((2 * len(nodes),) * 2), np.zeros((2 * len(nodes),) * 2)
    for i, h in enumerate(np.diff(nodes)):
        turn, at = np.diag([1.0, h, 1.0, h]), slice(2 * i, 2 * i + 4)
        M[at, at] += per_length[i] * h * turn @ MASS_ELEMENT @ turn
        K[at, at] += bending[i] / h**3 * turn @ STIFFNESS_ELEMENT @ turn
    return M, K


def with_leaf(length: float = 0.057, mass: float = 0.01804) -> list[float]:
    """First nine frequencies in Hz of both beams, the right one with the leaf clamped to it at 330 mm.

    By M x = ω⁻² K x, which keeps the digits of the low ones.
    """
    parts = [(0.0, 0.29, 60), (0.29, 0.33, 9), (0.33, 0.381, 11), (0.381, LENGTH, 4)]
    nodes = np.unique(np.concatenate([np.linspace(*part) for part in parts]))
    nodes = nodes[np.append(True, np.diff(nodes) > 1e-6)]
    clamping, nut = (2 * int(np.argmin(np.abs(nodes - x))) for x in (0.33, 0.381))
    found: list[float] = []
    for thickness, sides, plates in ((0.001, 1, 0.0427), (0.00675, 2, 0.2095)):
        over = (nodes[:-1] > 0.2899) & (nodes[:-1] < 0.3299)
        stiff = np.where(over, with_plates(thickness, sides, True), BENDING)
        M, K = assembled(nodes, stiff, PER_LENGTH + over * plates / 0.04)
        if sides == 1:
            M[nut, nut] += 0.0133
        else:
            count, size = 20, len(M)
            leaf = assembled(
                np.linspace(0, length, count + 1),
                np.full(count, E * 0.04 * 0.001**3 / 12),
                np.full(count, mass / length),
            )
            basis = np.eye(size + len(leaf[0]))
            basis[size : size + 2, clamping : clamping + 2] = np.eye(2)
            basis = np.delete(basis, [size, size + 1], axis=1)
            M, K = (basis.T @ block_diag(own, its) @ basis for own, its in zip((M, K), leaf, strict=True))
        inverse = eigh(M[2:, 2:], K[2:, 2:], eigvals_only=True)[-6:]
        found += list(1 / (2 * np.pi * np.sqrt(inverse)))
    return [float(each) for each in np.sort(found)[:9]]


def beside_measured() -> dict[str, Any]:
    """Frequencies with the leaf, in percent off the measured; peaks of the case over the gap, and over ω₁."""
    frequencies = dict(zip(MEASURED, with_leaf(), strict=True))
    off = {name: 100 * (value / MEASURED[name] - 1) for name, value in frequencies.items()}
    case = tomllib.loads((Path(__file__).parents[2] / "cases" / "stuttgart" / "massive_leaf.toml").read_text())
    peaks = {name: float(each["value"].split()[0]) for name, each in case["expect"].items()}
    over = {
        name: value / (frequencies["right_first"] if name.endswith("_at") else 0.17) for name, value in peaks.items()
    }
    return {"frequencies": frequencies, "percent_off": off, "over_gap_or_first": over}


if __name__ == "__main__":
    Path(__file__).with_suffix(".json").write_text(json.dumps(predicted(), indent=2) + "\n")
    beside = Path(__file__).with_name("stuttgart_measured.json")
    beside.write_text(json.dumps(beside_measured(), indent=2) + "\n")
