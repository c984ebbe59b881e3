"""Short spellings that the families share."""

from __future__ import annotations

from typing import Any

import numpy as np
from agreement import Case, Tally, follow

import vibeam

NONE = vibeam.Drive(0.0, 0.0)
COMPLETE = vibeam.Ended.COMPLETE
EPSILON = float(np.finfo(float).eps)


def one(omega: float, zeta: float = 0.0, load: float = 1.0, **rest: Any) -> vibeam.ImpactSystem:
    """A system of one mode with contact 1."""
    return vibeam.ImpactSystem.from_modes(omega, zeta, 1.0, load, **rest)


def state(displacement: Any, velocity: Any, resting: bool = False) -> vibeam.State:
    """A state from numbers or lists."""
    return vibeam.State(np.atleast_1d(np.array(displacement, float)), np.atleast_1d(np.array(velocity, float)), resting)


def judged(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, start: vibeam.State, impacts: int, least: int | None = None
) -> Tally:
    """The motion agrees with the arbitrary-precision one, impact by impact, over at least ``least`` (all) impacts."""
    readout = follow(Case(system, drive, start), impacts)
    assert not readout.faults, readout.faults
    assert readout.impacts >= (impacts if least is None else least), readout
    return readout


def assert_lawful(path: vibeam.Trajectory, samples: int = 2001) -> None:
    """It ends as it should, is finite, in order, and never beyond the stop by more than round-off."""
    assert path.ended is COMPLETE
    hits = path.impact_times
    times = np.unique(np.concatenate([np.linspace(path.t_start, path.t_end, samples), hits]))
    poses = path.modes_at(times)
    assert np.all(np.isfinite(poses))
    assert np.all(np.isfinite(path.impact_velocities))
    assert np.all(path.impact_velocities >= 0)
    assert np.all(np.diff(hits) >= 0)
    assert np.all(path.rests[:, 0] <= path.rests[:, 1])
    size = np.abs(poses[:, 0] * path.system.contact).sum(axis=1).max() + abs(path.system.gap)
    late = EPSILON * path.t_end * np.abs(poses[:, 1] @ path.system.contact).max()
    assert (poses[:, 0] @ path.system.contact).max() - path.system.gap <= 64 * EPSILON * size + 4 * late
