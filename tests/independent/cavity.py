"""Ball in a shaken cavity, by hand: the symmetric motion, where it exists and loses its symmetry, and what follows.

    python tests/independent/cavity.py   # writes cavity.json

Nothing of vibeam's is imported. Walls at ±d from the middle, base B sin Ωt, phases τ = Ωt, relative speeds over Ω:

    z″ = B sin τ,    z = z₀ + w (τ − τ₀) + B (sin τ₀ − sin τ + (τ − τ₀) cos τ₀),    w = R w′ after an impact at w′

A flight from wall to wall takes half a period where both impacts are alike. With A = (1 + R)/(1 − R):

    d/B = (π/2) A cos τ₀ + sin τ₀,    w′ = 2B cos τ₀/(1 − R)

Half the period maps (τ, w) by a Jacobian with determinant R² and trace 2R + q (1 + R), q = πB sin τ₀/w′: stable between
q = −(1 + R), where symmetry is lost, and q = (1 − R)²/(1 + R), where two motions meet and beyond which there is none:

    d/B = cos τ₀ (πA/2 − 2A/π) with tan τ₀ = −2A/π,    d/B = √(1 + (πA/2)²)
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mpmath as mp

R = mp.mpf("0.65")
A = (1 + R) / (1 - R)


def symmetric(play: Any) -> tuple[Any, Any]:
    """Phase and relative speed w′ over BΩ of the stable symmetric motion at d/B = ``play``."""
    best = mp.atan2(2, mp.pi * A)  # tan τ₀ = 2/(πA): the largest d/B
    phase = best - mp.acos(play / mp.sqrt(1 + (mp.pi * A / 2) ** 2))
    return phase, 2 * mp.cos(phase) / (1 - R)


def symmetry_lost() -> Any:
    """The d/B below which the symmetric motion is unstable."""
    return mp.cos(mp.atan(2 * A / mp.pi)) * (mp.pi * A / 2 - 2 * A / mp.pi)


def last() -> Any:
    """The largest d/B."""
    return mp.sqrt(1 + (mp.pi * A / 2) ** 2)


def pair(play: Any, start: tuple[Any, ...]) -> tuple[Any, Any]:
    """Relative speed w′, the same at both walls, and the longer flight's share of the period, of an asymmetric motion.

    ``start``: phase, speed after it, phase of the next impact. From w₁ = R w₂′ and w₂ = R w₁′: w′ (1 − R) is the base's
    change of speed from either impact to the next.
    """

    def faults(first: Any, speed: Any, second: Any) -> list[Any]:
        there, turn = second - first, mp.cos(first) - mp.cos(second)
        across = speed * there + mp.sin(first) - mp.sin(second) + there * mp.cos(first)
        back = 2 * mp.pi - there
        returned = -speed * back + mp.sin(second) - mp.sin(first) + back * mp.cos(second)
        return [across - 2 * play, returned + 2 * play, R * turn / (1 - R) - speed]

    first, speed, second = mp.findroot(faults, start, tol=1e-40)
    share = (second - first) / (2 * mp.pi)
    return speed / R, max(share, 1 - share)


def predicted() -> dict[str, Any]:
    """Numbers of the case, whose d/B is 1.5 at 10 Hz and grows with f²: limits, and speeds in m/s."""
    mp.mp.dps = 40
    found: dict[str, Any] = {"symmetry_lost": symmetry_lost(), "last": last()}
    found |= {f"{name}_Hz": 10 * mp.sqrt(found[name] / mp.mpf("1.5")) for name in ("symmetry_lost", "last")}
    for frequency in (9, 10, 11):
        play = mp.mpf("1.5") * frequency**2 / 100
        speed, share = symmetric(play)[1], mp.mpf("0.5")
        if play < symmetry_lost():
            speed, share = pair(play, (-1.7, 1.0, 2.4))
        found[f"speed_{frequency}"] = speed * mp.mpf("0.3") / play * 2 * mp.pi * frequency / 100
        found[f"longer_flight_{frequency}"] = share
    found["play_10"] = mp.mpf("1.5")
    found["phase_10"], found["relative_speed_10"] = symmetric(mp.mpf("1.5"))
    return {key: float(value) for key, value in found.items()}


if __name__ == "__main__":
    Path(__file__).with_suffix(".json").write_text(json.dumps(predicted(), indent=2) + "\n")
