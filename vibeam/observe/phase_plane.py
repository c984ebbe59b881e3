"""Phase plane of a motion (paper Fig. 22–24): its portrait with jumps, sections once a drive period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.motion import Path, drive_period, impacts_within, last_periods, modes_around_impacts
from vibeam_models.arrays import Array, ValueRecord


@dataclass(frozen=True, eq=False, repr=False)
class StroboscopicSection(ValueRecord):
    """Points (m,) of a motion at one drive phase: ``time`` s, ``displacement`` m, ``velocity`` m/s."""

    time: Array
    displacement: Array
    velocity: Array


def stroboscopic_section(
    path: Path, output: str = "sensor", *, periods: int, phase: float = 0.0
) -> StroboscopicSection:
    """Stroboscopic section of an output at Ωt = ``phase`` (rad, modulo 2π) in the last ``periods`` drive periods.

    ValueError for more periods than available, KeyError for an unknown output.
    """
    begin, _ = last_periods(path, periods)
    omega = path.drive.omega
    first = np.ceil((omega * begin - phase) / (2 * np.pi) - 1e-9)
    times = (phase + 2 * np.pi * (first + np.arange(periods))) / omega
    times = np.clip(times, path.t_start, path.t_end)
    return StroboscopicSection(times, path.at(times, output), path.velocity_at(times, output))


JUST = 1e-9  # share of the drive's period


@dataclass(frozen=True, eq=False, repr=False)
class Portrait(ValueRecord):
    """Curve (m,): ``time`` s, ``displacement`` m, ``velocity`` m/s; an impact is two points at the same time.

    ``jumps`` (k,): the index of the first of each such two.
    """

    time: Array
    displacement: Array
    velocity: Array
    jumps: NDArray[np.int64]


def phase_portrait(path: Path, output: str = "sensor", *, periods: int, points: int = 1000) -> Portrait:
    """Portrait of the last ``periods`` drive periods of an output, about ``points`` a period and both sides of impacts.

    ValueError for more periods than available or ``points`` < 2, KeyError for an unknown output.
    """
    if points < 2:
        raise ValueError(f"points: {points} a period, there must be 2 or more")
    begin, end = last_periods(path, periods)
    hits = impacts_within(path, begin, end)
    if path.system.derivative(output) is not None:
        return _of_derivative(path, output, begin, end, hits[:, 0], points)
    row = path.system.output(output)
    even = np.linspace(begin, end, round((end - begin) / drive_period(path) * points) + 1)
    even = even[~np.isin(even, hits[:, 0])]
    before, after = modes_around_impacts(path, hits)
    times = np.concatenate([even, hits[:, 0], hits[:, 0]])
    rank = np.repeat([0, 0, 1], [len(even), len(hits), len(hits)])
    values = np.concatenate([path.modes_at(even), before, after]) @ row
    order = np.lexsort((rank, times))
    jumps = np.flatnonzero(rank[order] == 1) - 1
    return Portrait(times[order], values[order, 0], values[order, 1], jumps)


def _of_derivative(path: Path, output: str, begin: float, end: float, hits: Array, points: int) -> Portrait:
    """Portrait of a velocity or acceleration; the value before an impact is that a billionth of a period earlier."""
    period = drive_period(path)
    even = np.linspace(begin, end, round((end - begin) / period * points) + 1)
    times = np.concatenate([even[~np.isin(even, hits)], np.maximum(hits - JUST * period, begin), hits])
    order = np.argsort(times, kind="stable")
    seen = np.concatenate([times[: -len(hits) or None], hits])[order] if len(hits) else times
    first = np.flatnonzero(order >= len(times) - len(hits)) - 1 if len(hits) else np.zeros(0, dtype=np.int64)
    return Portrait(np.sort(seen), path.at(times[order], output), path.velocity_at(times[order], output), first)
