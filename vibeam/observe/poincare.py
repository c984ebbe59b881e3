"""Poincaré sections of a motion: once a drive period (paper Fig. 22–24), and at impacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.observe.motion import Path, impacts_within, last_periods
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class Section:
    """Points (m,) of a motion at one drive phase: ``time`` s, ``displacement`` m, ``velocity`` m/s."""

    time: Array
    displacement: Array
    velocity: Array


@dataclass(frozen=True)
class ImpactSection:
    """Impacts (m,): ``time`` s, drive ``phase`` 0 … 2π, contact ``velocity`` just before toward the stop, m/s."""

    time: Array
    phase: Array
    velocity: Array


def stroboscopic_section(path: Path, output: str = "sensor", *, periods: int, phase: float = 0.0) -> Section:
    """Stroboscopic section of an output at Ωt = ``phase`` (rad, modulo 2π) in the last ``periods`` drive periods.

    ValueError for more periods than available, KeyError for an unknown output.
    """
    begin, _ = last_periods(path, periods)
    omega = path.drive.omega
    first = np.ceil((omega * begin - phase) / (2 * np.pi) - 1e-9)
    times = (phase + 2 * np.pi * (first + np.arange(periods))) / omega
    times = np.clip(times, path.t_start, path.t_end)
    return Section(times, path.at(times, output), path.velocity_at(times, output))


def sampled_section(time: Array, displacement: Array, velocity: Array, omega: float, *, phase: float = 0.0) -> Section:
    """Stroboscopic section of samples (m,), by cubics through values and slopes; ``omega``: of the drive, rad/s."""
    from scipy.interpolate import CubicHermiteSpline

    first = np.ceil((omega * time[0] - phase) / (2 * np.pi) - 1e-9)
    last = np.floor((omega * time[-1] - phase) / (2 * np.pi) + 1e-9)
    times = np.clip((phase + 2 * np.pi * np.arange(first, last + 1)) / omega, time[0], time[-1])
    curve = CubicHermiteSpline(time, displacement, velocity)
    return Section(times, np.asarray(curve(times)), np.asarray(curve(times, 1)))


def impact_section(path: Path, *, periods: int) -> ImpactSection:
    """Impact section of the last ``periods`` drive periods; ValueError for more than available."""
    hits = impacts_within(path, *last_periods(path, periods))
    return ImpactSection(hits[:, 0], np.mod(path.drive.omega * hits[:, 0], 2 * np.pi), hits[:, 1])
