"""Random drives of a rig: of its base, by a force or moment on the beam, through a platform, by a shaker."""

from __future__ import annotations

from typing import Any

import numpy as np
from draws import chosen, log
from numpy.random import Generator

Table = dict[str, Any]


def drive(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    """The contact moved by about ``motion`` m at ``frequency`` Hz: by the base, a force, a platform or a shaker."""
    ways = [_of_base, _of_base, _of_base, _on_beam, _on_platform, _on_platform, _calibrated, _by_shaker, _by_shaker]
    if "mass" in case:  # eq. 46 is of a beam with a mass
        ways.append(_by_gain)
    return chosen(rng, *ways)(rng, case, motion, frequency, stiffness)


def _of_base(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    """As the amplitude of displacement, velocity or acceleration; now and then none."""
    rate = 2 * np.pi * frequency
    own = chosen(rng, {"amplitude": motion}, {"velocity": rate * motion}, {"acceleration": rate**2 * motion})
    return {"drive": _tabled(rng, own, frequency) if rng.random() < 0.97 else {"amplitude": 0.0}}


def _by_gain(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    gain = log(rng, 1e-5, 1e-2)
    return {"drive": {"gain": gain, "voltage": motion / gain / case["beam"]["length"]}}


def _on_beam(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    """A force or a moment somewhere on the beam."""
    length, push = case["beam"]["length"], motion * stiffness * log(rng, 0.05, 2)
    own = chosen(rng, {"force": push}, {"moment": push * length})
    return {"drive": _tabled(rng, own, frequency) | {"at": length * rng.uniform(0.1, 1.0)}}


def _on_platform(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    platform = _platform(rng, case, frequency)
    return {"drive": {"force": _force(platform, motion, frequency, stiffness)}, "platform": platform}


def _calibrated(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    platform = _platform(rng, case, frequency) | {"calibrated_at": frequency * log(rng, 0.7, 1.4)}
    return {"drive": {"amplitude": motion}, "platform": platform}


def _by_shaker(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    platform = _platform(rng, case, frequency)
    shaker = {"resistance": log(rng, 0.5, 50), "force_factor": log(rng, 0.5, 100)}
    if platform["coupling"] == "one-way" and rng.random() < 0.5:
        shaker["inductance"] = log(rng, 1e-5, 1e-1)
    voltage = _force(platform, motion, frequency, stiffness) * shaker["resistance"] / shaker["force_factor"]
    return {"drive": {"voltage": voltage}, "platform": platform, "shaker": shaker}


def _force(platform: Table, motion: float, frequency: float, stiffness: float) -> float:
    """What moves the platform about as far."""
    inertia = platform["mass"] * 4 * np.pi**2 * abs(platform["frequency"] ** 2 - frequency**2)
    return float(motion * (inertia + 1e-3 * stiffness))


def _tabled(rng: Generator, own: Table, frequency: float) -> Table:
    """The same, now and then as a table over the frequency."""
    if rng.random() < 0.85:
        return own
    name = next(key for key in own if key != "at")
    values = [own[name] * rng.uniform(0.3, 1.5) for _ in range(3)]
    return own | {name: values, "frequency": [frequency * 0.9, frequency * 1.1, frequency * 1.5]}


def _platform(rng: Generator, case: Table, frequency: float) -> Table:
    carried = weight(case["beam"]) + case.get("mass", {}).get("mass", 0.0)
    return {
        "mass": carried * log(rng, 0.2, 100), "frequency": frequency * log(rng, 0.05, 3),
        "damping_ratio": log(rng, 1e-3, 1), "coupling": chosen(rng, "one-way", "two-way"),
    }  # fmt: skip


def weight(size: Table) -> float:
    return float(size["density"] * size["width"] * size["thickness"] * size["length"])
