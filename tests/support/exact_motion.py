"""The arbitrary-precision motion of tests/independent for one ImpactSystem: what other tests compare with."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import mpmath
import numpy as np

import vibeam

sys.path.insert(0, str(Path(__file__).parent.parent / "independent"))

import events

EPSILON = float(np.finfo(float).eps)
NUDGE = 1e-12  # of the state's size: how far the start of the second motion is moved


def exact_motion(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, state: vibeam.State, *, digits: int = 30, tiny: float = 1e-10
) -> events.Motion:
    """The motion from time 0, to be run on; a chatter is followed until its flights are ``tiny`` of all times."""
    rows = [getattr(system, name).tolist() for name in ("omega", "zeta", "contact", "load")]
    modes = events.Modes(*rows, gap=system.gap, restitution=system.restitution, static=system.static.tolist())
    start = events.State(state.displacement.tolist(), state.velocity.tolist(), state.resting)
    return events.Motion(modes, events.Drive(drive.omega, drive.amplitude), start, digits=digits, tiny=tiny)


def exact_impacts(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, state: vibeam.State, *, count: int | None, t_end: float | None
) -> np.ndarray:
    """Times and velocities (m, 2) of the impacts up to whichever of ``count`` and ``t_end`` comes first."""
    return _hits(exact_motion(system, drive, state), count, t_end)


def impacts_and_bar(
    system: vibeam.ImpactSystem, drive: vibeam.Drive, state: vibeam.State, *, count: int | None, t_end: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """The impacts (m, 2), and for each the share of its time and of the fastest velocity that round-off may cost.

    Round-off is what the motion makes of it: the growth of a small change of the start, from a second motion. Where
    that one has other impacts, the bar is infinite from there on.
    """
    expected = exact_impacts(system, drive, state, count=count, t_end=t_end)
    motion = exact_motion(system, drive, state)
    rate = max(system.omega.max(), drive.omega, 1e-300)
    reach = abs(system.gap) / np.abs(system.contact).max()
    size = max(np.abs(state.displacement).max(), np.abs(state.velocity).max() / rate, reach)
    nudged = [mpmath.mpf(x) - mpmath.mpf(NUDGE * size * np.sign(c)) for x, c in zip(
        state.displacement.tolist(), system.contact, strict=True
    )]  # fmt: skip
    other = _hits(
        events.Motion(motion.system, motion.drive, replace(motion.start, displacement=nudged), digits=30, tiny=1e-10),
        count, t_end,
    )  # fmt: skip
    bar, both = np.full(len(expected), np.inf), min(len(expected), len(other))
    if both:
        change = np.abs(expected[:both] - other[:both]) / np.stack(
            [expected[:both, 0], np.full(both, expected[:, 1].max())], axis=1
        )
        bar[:both] = 1e-11 + 64 * EPSILON * np.maximum.accumulate(change.max(axis=1)) / NUDGE
    return expected, bar


def _hits(motion: events.Motion, count: int | None, t_end: float | None) -> np.ndarray:
    motion.run(count=count, t_end=t_end)
    found = [(float(event.time), float(event.speed)) for event in motion.events if event.kind == "impact"]
    return np.array(found).reshape(-1, 2)
