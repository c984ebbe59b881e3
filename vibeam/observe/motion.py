"""Interface of a motion for the observers, and the intervals on which the motion is smooth."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arguments import count, refuse
from vibeam_models.arrays import Array


class Path(Protocol):
    """Motion known at any time, whatever fidelity made it; a ``Trajectory`` is one. SI units."""

    @property
    def system(self) -> ImpactSystem:
        """Moving system."""
        ...

    @property
    def drive(self) -> Drive:
        """Drive of the motion; its phase is 0 at time 0."""
        ...

    @property
    def t_start(self) -> float:
        """Start time, s."""
        ...

    @property
    def t_end(self) -> float:
        """End time, s."""
        ...

    @property
    def impact_times(self) -> Array:
        """Impact times (m,), s."""
        ...

    @property
    def impact_velocities(self) -> Array:
        """Contact velocities (m,) just before impact, positive toward the stop, m/s."""
        ...

    @property
    def rests(self) -> Array:
        """Begin and end of each rest on the stop, (m, 2), s."""
        ...

    def at(self, t: ArrayLike, output: str = ...) -> Array:
        """Output at times t, m."""
        ...

    def velocity_at(self, t: ArrayLike, output: str = ...) -> Array:
        """Rate of an output at times t, m/s; at an impact its value just after."""
        ...

    def modes_at(self, t: ArrayLike) -> Array:
        """Modal displacements and velocities (…, 2, n)."""
        ...


def drive_period(path: Path) -> float:
    """Drive period 2π/Ω, s; ValueError without a drive."""
    if not path.drive.omega > 0:
        raise ValueError("drive: omega is 0, so the motion has no drive period")
    return 2 * np.pi / path.drive.omega


def last_periods(path: Path, periods: int) -> tuple[float, float]:
    """Begin and end (s) of the last ``periods`` drive periods; ValueError for a shorter motion."""
    faults: list[str] = []
    count("periods", periods, faults, least=1)
    refuse("", faults)
    begin = path.t_end - periods * drive_period(path)
    if begin < path.t_start - 1e-9 * drive_period(path):
        lasting = (path.t_end - path.t_start) / drive_period(path)
        raise ValueError(f"periods: the motion lasts {lasting:.6g} drive periods, {periods} are asked for")
    return max(begin, path.t_start), path.t_end


def smooth_stretches(path: Path, begin: float, end: float) -> Array:
    """Intervals (m, 2) of [begin, end] between impacts, begins and ends of rests, in order, s."""
    events = np.concatenate([path.impact_times, path.rests.ravel()])
    inside = np.unique(events[(events > begin) & (events < end)])
    marks = np.concatenate([[begin], inside, [end]])
    return np.stack([marks[:-1], marks[1:]], axis=1)


def impacts_within(path: Path, begin: float, end: float) -> Array:
    """Impact times and contact velocities just before (m, 2) in [begin, end)."""
    hits = np.stack([path.impact_times, path.impact_velocities], axis=1)
    return np.asarray(hits[(hits[:, 0] >= begin) & (hits[:, 0] < end)])


def modes_around_impacts(path: Path, hits: Array) -> tuple[Array, Array]:
    """Modal displacements and velocities (m, 2, n) just before and just after impacts ``hits`` of ``impacts_within``.

    An impact is one impulse p on the contact: η'⁺ − η'⁻ = contact·p with p = (v⁺ − v⁻)/S, whatever the law.
    """
    contact = path.system.contact
    after = path.modes_at(hits[:, 0])
    impulse = (after[:, 1] @ contact - hits[:, 1]) / (contact @ contact)
    before = after.copy()
    before[:, 1] -= impulse[:, None] * contact
    return before, after
