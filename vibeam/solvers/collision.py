"""Collision with the stop at a given velocity, by flight.

The system moves toward the stop in one mode, all others at rest, without drive, load or gap.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vibeam.flight.trajectory import simulate
from vibeam.observe.restitution import Collision, collision_of
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.state import State

TURN = 0.25  # periods of the mode until it turns: what touches the stop before belongs to the one collision


def struck(system: ImpactSystem, speed: float, mode: int | None = None) -> Collision:
    """Collision of a system that moves at ``speed`` toward the stop, in one ``mode``, with nothing else acting.

    ``mode`` absent: that which takes most of the impulse.
    """
    mode = int(np.argmax(system.contact**2)) if mode is None else mode
    if not system.omega[mode] > 0:
        raise ValueError("the mode that strikes has no period: there is no end of the collision")
    still, rate = np.zeros(system.size), np.zeros(system.size)
    rate[mode] = speed / system.contact[mode]
    alone = replace(system, gap=0.0, static=still, second_gap=None)
    omega = float(system.omega[mode])
    path = simulate(alone, Drive(omega, 0.0), TURN * 2 * np.pi / omega, State(still, rate))
    return collision_of(path, path.contacts if system.contact_law.yields else None, mode)
