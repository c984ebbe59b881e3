"""Interface of a motion for the observers, the intervals on which the motion is smooth, and integrals along it.

Time integrals are by Gauss–Legendre quadrature, to round-off. Between events a motion is a sum of a few exponentials.
In panels through which the fastest of them turns by ``TURN`` radians, 20 nodes are exact to round-off even for products
of two; an exponential that has decayed below round-off since the last event no longer counts, so that fast modes cost
only where they still move."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam_models.arguments import count, refuse
from vibeam_models.arrays import Array


class Path(Protocol):
    """Motion known at any time, whatever fidelity made it; a ``Trajectory`` is one. SI units."""

    @property
    def system(self) -> ImpactSystem:
        """Moving system."""

    @property
    def drive(self) -> Drive:
        """Drive of the motion; its phase is 0 at time 0."""

    @property
    def t_start(self) -> float:
        """Start time, s."""

    @property
    def t_end(self) -> float:
        """End time, s."""

    @property
    def impact_times(self) -> Array:
        """Impact times (m,), s."""

    @property
    def impact_velocities(self) -> Array:
        """Contact velocities (m,) just before impact, positive toward the stop, m/s."""

    @property
    def rests(self) -> Array:
        """Begin and end of each rest on the stop, (m, 2), s."""

    def at(self, t: ArrayLike, output: str = ...) -> Array:
        """Output at times t, m."""

    def velocity_at(self, t: ArrayLike, output: str = ...) -> Array:
        """Rate of an output at times t, m/s; at an impact its value just after."""

    def modes_at(self, t: ArrayLike) -> Array:
        """Modal displacements and velocities (…, 2, n)."""


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


BLOCK = 512  # panels evaluated at once
NODES = 20  # nodes a panel: the error is about (TURN/2)^40/40! = 2e-17 of a product of two e^{λt}
TURN = 12.0  # |λ|h of the fastest live exponential in a panel
DEAD = 36.0  # e^{-36} = 2e-16
DEAD_AT_REST = 144.0  # wide margin: held on the stop, modes have other damping


def integral(
    path: Path, begin: float, end: float, integrand: Callable[[Array], Any], *, highest: float = 0.0
) -> NDArray[Any]:
    """∫ integrand dt over [begin, end] s; ``integrand`` takes times (m,) and gives values (m, …), real or complex.

    They may hold products of up to two of the motion's displacements or velocities, or of one with a harmonic of up to
    ``highest`` rad/s; anything faster is missed. Nodes come in blocks, so that large models fit in memory.
    """
    x, w = np.polynomial.legendre.leggauss(NODES)
    low, high = _all_panels(path, begin, end, highest)
    total: Any = 0.0
    for first in range(0, len(low), BLOCK):
        half = (high[first : first + BLOCK] - low[first : first + BLOCK]) / 2
        times = (low[first : first + BLOCK] + half)[:, None] + half[:, None] * x
        total = total + np.tensordot((half[:, None] * w).ravel(), integrand(times.ravel()), axes=1)
    return np.asarray(total)


def _all_panels(path: Path, begin: float, end: float, highest: float) -> tuple[Array, Array]:
    """Lower and upper ends of all panels."""
    poles = poles_of(path.system)
    floor = max(path.drive.omega, highest)
    edges = [
        _panels(a, b, born, poles, floor, DEAD_AT_REST if _resting(path, (a + b) / 2) else DEAD)
        for a, b, born in _since_events(path, begin, end)
    ]
    return np.concatenate([e[:-1] for e in edges]), np.concatenate([e[1:] for e in edges])


def poles_of(system: ImpactSystem) -> NDArray[np.complex128]:
    """Exponents of the 2n free modal solutions, rad/s."""
    omega = system.omega.astype(complex)
    sigma = system.zeta * omega
    root = np.sqrt(sigma**2 - omega**2)
    return np.concatenate([-sigma + root, -sigma - root])


def _since_events(path: Path, begin: float, end: float) -> list[tuple[float, float, float]]:
    """Smooth stretches of [begin, end], and the time when each began, which may lie before the window."""
    starts = smooth_stretches(path, path.t_start, path.t_end)[:, 0]
    return [
        (a, b, float(starts[np.searchsorted(starts, a, side="right") - 1]))
        for a, b in smooth_stretches(path, begin, end).tolist()
    ]


def _resting(path: Path, t: float) -> bool:
    return bool(np.any((path.rests[:, 0] <= t) & (t < path.rests[:, 1])))


def _panels(a: float, b: float, born: float, poles: NDArray[np.complex128], floor: float, dead: float) -> Array:
    """Panel edges from a to b: equal panels between two deaths of exponentials."""
    decay, rate = -poles.real, np.abs(poles)
    death = born + np.divide(dead, decay, out=np.full(len(decay), np.inf), where=decay > 0)
    marks = np.unique(np.clip(np.concatenate([[a, b], death]), a, b))
    edges = [np.array([a])]
    for low, high in pairwise(marks.tolist()):
        fastest = max(float(np.max(rate[death > low], initial=0.0)), floor)
        count = max(1, int(np.ceil((high - low) * fastest / TURN)))
        edges.append(np.linspace(low, high, count + 1)[1:])
    return np.concatenate(edges)
