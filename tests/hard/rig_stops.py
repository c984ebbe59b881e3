"""Random stops of a rig: every contact law, one or two, with drift and wear."""

from __future__ import annotations

from typing import Any

import numpy as np
from draws import chosen, log
from numpy.random import Generator

Table = dict[str, Any]

SMOOTH = 0.4  # share of stops that have one coefficient of restitution


def stop(rng: Generator, case: Table, motion: float, frequency: float, stiffness: float) -> Table:
    """At the mass or elsewhere, its gap measured at the contact or at the sensor."""
    own = contact(rng, motion, frequency, stiffness)
    if "mass" not in case or rng.random() < 0.2:
        own["position"] = case["beam"]["length"] * rng.uniform(0.3, 1.0)
    if rng.random() < 0.15:
        own["gap_at"] = "sensor"
    return own


def contact(rng: Generator, motion: float, frequency: float, stiffness: float) -> Table:
    """Hard or yielding stops, one or two; gaps of the motion's size, of either sign, or none."""
    gap = motion * float(
        chosen(rng, 0.0, rng.uniform(-3, 3), rng.uniform(0, 10), rng.uniform(0, 3), rng.uniform(-1, 0))
    )
    own: Table = {"gap": gap} | law(rng, motion, 2 * np.pi * frequency * motion, stiffness)
    if rng.random() < 0.25:
        own["second_gap"] = -gap + motion * log(rng, 0.05, 20)
    if rng.random() < 0.15:
        own["drift_frequency"] = [frequency * 0.8, frequency, frequency * 1.3]
        own["drift"] = [motion * rng.uniform(-0.5, 0.5) for _ in range(3)]
    if rng.random() < 0.15:
        own["wear"] = motion * log(rng, 1e-8, 1e-2)
    return own


def law(rng: Generator, motion: float, speed: float, stiffness: float) -> Table:
    """What a stop does, for motions of that size and speed at a point of that stiffness."""
    if rng.random() < SMOOTH:
        return _restitution(rng)
    return chosen(rng, _power, _table, _linear, _linear, _hertz, _hunt_crossley)(rng, motion, speed, stiffness)


def _restitution(rng: Generator) -> Table:
    own: Table = {"restitution": float(chosen(rng, 0.0, 1.0, rng.uniform(), rng.uniform(), rng.uniform(0.5, 1)))}
    return own | {"restitution_of": "first mode"} if rng.random() < 0.2 else own


def _power(rng: Generator, motion: float, speed: float, stiffness: float) -> Table:
    own = {"law": "velocity restitution", "restitution": rng.uniform(0.05, 1), "velocity": speed * log(rng, 0.01, 30)}
    return own | {"exponent": log(rng, 0.05, 1.5)} if rng.random() < 0.5 else own


def _table(rng: Generator, motion: float, speed: float, stiffness: float) -> Table:
    speeds = np.cumsum(speed * np.exp(rng.uniform(-4, 1, rng.integers(2, 6))))
    values = np.sort(rng.uniform(0, 1, len(speeds)))[:: chosen(rng, -1, -1, 1)]
    return {"law": "velocity restitution", "speeds": speeds.tolist(), "restitutions": values.tolist()}


def _linear(rng: Generator, motion: float, speed: float, stiffness: float) -> Table:
    stiff = stiffness * log(rng, 0.3, 1e5)
    loss = (
        {"restitution": rng.uniform(0.02, 1.0)}
        if rng.random() < 0.5
        else {"damping": stiff * motion / speed * chosen(rng, 0.0, log(rng, 1e-3, 3))}
    )
    return {"law": "linear", "stiffness": stiff} | loss


def _hertz(rng: Generator, motion: float, speed: float, stiffness: float) -> Table:
    own: Table = {"law": "hertz"}
    power = 1.5
    if rng.random() < 0.3:
        own["exponent"] = power = rng.uniform(1.0, 3.0)
    return own | {"hertz_stiffness": stiffness * log(rng, 1, 3e4) * motion ** (1 - power)}


def _hunt_crossley(rng: Generator, motion: float, speed: float, stiffness: float) -> Table:
    own = _hertz(rng, motion, speed, stiffness) | {"law": "hunt-crossley"}
    return own | {"restitution": rng.uniform(0.05, 1.0), "velocity": speed * log(rng, 0.1, 10)}
