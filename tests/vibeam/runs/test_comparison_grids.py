"""Answers of random rigs on three grids each: what suffices does not hang on the points of the sweep.

Rigs whose eight modes repeat everywhere, and make one motion wherever the sweep comes from: where several motions
coexist, or after motions that do not repeat, the one that a sweep comes to is chance.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

import vibeam

MODULUS, DENSITY, ELEMENTS = 70e9, 2700.0, 16
GRIDS = (41, 60, 97)
SEEDS = (
    5, 8, 9, 27, 33, 38, 41, 45, 46, 53, 54, 66, 67, 91, 99, 109, 113, 115, 118, 133, 135, 140, 152, 155, 162, 174, 176,
    177, 179, 184,
)  # fmt: skip
QUICK = (9, 67, 176)


def rig(seed: int, points: int) -> vibeam.Case:
    """Cantilever with a mass that strikes a rigid stop, swept over its resonance."""
    rng = np.random.default_rng(seed)
    length = rng.uniform(0.05, 0.4)
    thick, wide = length * rng.uniform(0.004, 0.02), length * rng.uniform(0.05, 0.2)
    own = DENSITY * length * wide * thick
    mass = own * rng.uniform(0.2, 4)
    stiffness = 3 * MODULUS * wide * thick**3 / 12 / length**3
    first = sqrt(stiffness / (mass + 0.24 * own)) / 2 / pi
    low, span, gap = rng.uniform(0.7, 1.3), rng.uniform(1.2, 1.6), rng.choice([0.0, 1.0]) * rng.uniform(0.2, 1.5)
    drive = rng.uniform(0.2, 1.2) * stiffness * 1e-3 * length / (mass + 0.24 * own)
    at = 0.98 * length
    tables: dict[str, Any] = {
        "units": "SI",
        "beam": {"length": length, "width": wide, "thickness": thick, "youngs_modulus": MODULUS, "density": DENSITY,
                 "damping_ratio": rng.uniform(0.005, 0.03), "elements": ELEMENTS},
        "mass": {"mass": mass, "position": at}, "sensor": {"position": at}, "drive": {"acceleration": drive},
        "stop": {"position": at, "gap": gap * 1e-3 * length, "restitution": rng.uniform(0.4, 0.9)},
        "sweep": {"frequency": {"from": first * low, "to": first * low * span, "points": points}, "settle": 200,
                  "hold": 40, "direction": "both"},
        "fidelity": {"sdof": {"reduction": "static_mode"}, **{f"m{n}": _modal(n) for n in (2, 4, 8)}},
    }  # fmt: skip
    return vibeam.Case.of(tables)


def _modal(modes: int) -> dict[str, Any]:
    return {"reduction": "modal", "modes": modes}


def is_determined(result: vibeam.Result) -> bool:
    """Test whether all motions of eight modes repeat, and are one motion swept up and down, but beside a jump."""
    up, down = result["m8"].up, result["m8"].down
    assert up is not None
    assert down is not None
    both = up.period[np.argsort(up.frequency)], down.period[np.argsort(down.frequency)]
    return bool(np.all(both[0] != 0) and np.all(both[1] != 0) and np.max(both) <= 2 and np.max(both) > 0)


def answers(seed: int, points: int) -> list[bool | None]:
    found = vibeam.run(rig(seed, points), show=False)
    return [each.suffices(found.asked) for each in found.compare() if each.reference]


@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=() if seed in QUICK else pytest.mark.slow) for seed in SEEDS]
)  # fmt: skip
def test_no_grid_turns_an_answer(seed: int) -> None:
    assert is_determined(vibeam.run(rig(seed, GRIDS[-1]), show=False, fidelities=["m8"]))
    first, *others = (answers(seed, points) for points in GRIDS)
    assert all(each == first for each in others)
