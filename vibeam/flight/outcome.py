"""Outcome of a motion: moving, at rest, settled, or why it ended before its time."""

from __future__ import annotations

from enum import Enum
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import Contacts, equilibrium
from vibeam.system.impact_system import Drive
from vibeam.system.response import Ended

STILL = 1e-11  # share of the motion's fastest velocity, and of ω times the static displacements, that is none
FADING = 1e-3  # loss of speed at an impact, as a share, that is next to none
LAST = 100  # impacts by which a motion that was given up is judged


class Outcome(Enum):
    """State of affairs at the end of a motion.

    >>> import vibeam
    >>> ball = vibeam.ImpactSystem.from_modes(0.0, 0.0, 1.0, 0.0, static=1.0, restitution=0.5)  # falls onto the stop
    >>> start = vibeam.State([-0.5], [0.0])
    >>> vibeam.simulate(ball, vibeam.Drive(1.0, 0.0), 4.0, start).outcome.name
    'SETTLED_ON_STOP'
    """

    MOVING = "still moving, off the stop"
    RESTING = "at rest on the stop, other modes or the drive still at work"
    SETTLED = "settled: at static equilibrium, off the stop"
    SETTLED_ON_STOP = "settled: at static equilibrium, pressed against the stop"
    EVENT_LIMIT = Ended.EVENT_LIMIT.value
    ENDLESS_CHATTER = (
        "stopped in a chatter without end: pressed on the stop, impacts become weaker and more frequent, and as R → 1 "
        "for the weakest the contact never comes to rest"
    )
    PENETRATED = Ended.PENETRATED.value
    NOT_FINITE = Ended.NOT_FINITE.value
    UNRESOLVED = Ended.UNRESOLVED.value


def _endless(path: Any) -> bool:
    """True where it was given up in impacts that become weaker and lose next to nothing of their speed.

    With 1 − R ~ v^b the times 2v/a between impacts add up to a finite time for b < 1 alone: then it would have ended.
    """
    law, speeds = path.system.contact_law, path.impact_velocities[-LAST:]
    if law.yields or law.converges or len(speeds) < LAST or speeds[-1] >= speeds[0]:
        return False
    return bool(law.at(0.0) == 1 and 1 - law.at(float(speeds[0])) <= FADING)


def _undriven(path: Any) -> bool:
    """True where nothing drives it at its end."""
    drive = path.drive
    return drive.amplitude == 0 if isinstance(drive, Drive) else drive.end <= path.t_end


def _still(path: Any) -> bool:
    """True where no energy is left above equilibrium, against the most that any segment began with."""
    system, last = path.system, np.stack([path.state.displacement, path.state.velocity])
    poses = np.concatenate([path.segments.poses, last[None]])
    away = poses[:, 0] - equilibrium(system).displacement
    speeds = np.sqrt(np.sum((system.omega * away) ** 2 + poses[:, 1] ** 2, axis=1))
    held = float(np.linalg.norm(system.omega * equilibrium(system).displacement))
    return bool(speeds[-1] <= STILL * max(speeds.max(), held))


def outcome_of(path: Any) -> Outcome:
    """The outcome of a ``Trajectory``."""
    if path.ended is Ended.EVENT_LIMIT and _endless(path):
        return Outcome.ENDLESS_CHATTER
    if path.ended is not Ended.COMPLETE:
        return Outcome[path.ended.name]
    if _undriven(path) and _still(path):
        pressed = np.any(Contacts.of(path.system).clearances(path.state.displacement) < 0)  # on a stop that yields
        return Outcome.SETTLED_ON_STOP if path.state.resting or pressed else Outcome.SETTLED
    return Outcome.RESTING if path.state.resting else Outcome.MOVING
