"""What became of a motion: an enum whose value is the message."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

from vibeam.response import Ended
from vibeam.solvers.start import equilibrium

if TYPE_CHECKING:
    from vibeam.simulate import Trajectory

STILL = 1e-12  # share of the fastest modal velocity of the motion below which a mode no longer moves


class Outcome(Enum):
    """How a motion stands at its end."""

    MOVING = "still moving, off the stop"
    RESTING = "at rest on the stop, other modes or the drive still at work"
    SETTLED = "settled: at static equilibrium, off the stop"
    SETTLED_ON_STOP = "settled: at static equilibrium, pressed against the stop"
    EVENT_LIMIT = Ended.EVENT_LIMIT.value
    PENETRATED = Ended.PENETRATED.value
    NOT_FINITE = Ended.NOT_FINITE.value
    UNRESOLVED = Ended.UNRESOLVED.value


def outcome_of(path: Trajectory) -> Outcome:
    """The outcome of ``path``; how often it chattered to rest on the way is ``len(path.chatters)``."""
    if path.ended is not Ended.COMPLETE:
        return Outcome[path.ended.name]
    if path.drive.amplitude == 0 and _still(path):
        return Outcome.SETTLED_ON_STOP if path.state.resting or _pressed(path) else Outcome.SETTLED
    return Outcome.RESTING if path.state.resting else Outcome.MOVING


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
    return bool(speeds[-1] <= STILL * speeds.max())
