"""What became of a motion: an enum whose value is the message."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from vibeam.response import Ended
from vibeam.solvers.start import equilibrium
from vibeam_models.compliant import CompliantStop
from vibeam_models.contact import ViscousRestitution

if TYPE_CHECKING:
    from vibeam.simulate import Trajectory

STILL = 1e-11  # share of the motion's fastest velocity, and of ω times the static displacements, that is none
FADING = 1e-3  # loss of speed at an impact, as a share, that is next to none
LAST = 100  # impacts by which a motion that was given up is judged


class Outcome(Enum):
    """How a motion stands at its end."""

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


def outcome_of(path: Trajectory) -> Outcome:
    """The outcome of ``path``; how often it chattered to rest on the way is ``len(path.chatters)``."""
    if path.ended is Ended.EVENT_LIMIT and _endless(path):
        return Outcome.ENDLESS_CHATTER
    if path.ended is not Ended.COMPLETE:
        return Outcome[path.ended.name]
    if path.drive.amplitude == 0 and _still(path):
        return Outcome.SETTLED_ON_STOP if path.state.resting or _pressed(path) else Outcome.SETTLED
    return Outcome.RESTING if path.state.resting else Outcome.MOVING


def _endless(path: Trajectory) -> bool:
    """Whether it was given up in impacts that become weaker and lose next to nothing of their speed.

    With 1 − R ~ v^b the times 2v/a between impacts add up to a finite time for b < 1 alone: then it would have ended.
    """
    law, speeds = path.system.law, path.impact_velocities[-LAST:]
    if isinstance(law, CompliantStop) or (isinstance(law, ViscousRestitution) and law.exponent < 1):
        return False
    at = (lambda velocity: path.system.restitution) if law is None else law.at
    return len(speeds) == LAST and speeds[-1] < speeds[0] and at(0.0) == 1 and 1 - at(float(speeds[0])) <= FADING


def _pressed(path: Trajectory) -> bool:
    """Whether it stands within the range of a stop that yields."""
    place, system = float(path.system.contact @ path.state.displacement), path.system
    return place > system.gap or (system.second_gap is not None and -place > system.second_gap)


def _still(path: Trajectory) -> bool:
    """Whether the energy left above equilibrium is none, against the most that any segment began with."""
    system, last = path.system, np.stack([path.state.displacement, path.state.velocity])
    poses = np.concatenate([path.segments.poses, last[None]])
    away = poses[:, 0] - equilibrium(system).displacement
    speeds = np.sqrt(np.sum((system.omega * away) ** 2 + poses[:, 1] ** 2, axis=1))
    held = float(np.linalg.norm(system.omega * equilibrium(system).displacement))
    return bool(speeds[-1] <= STILL * max(speeds.max(), held))
