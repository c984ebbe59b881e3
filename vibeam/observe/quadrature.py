"""Gauss–Legendre quadrature along a motion: time integrals of any function of it, to round-off.

Between events a motion is a sum of a few exponentials. In panels through which the fastest of them turns by ``TURN``
radians, 20 nodes are exact to round-off even for products of two; an exponential that has decayed below round-off since
the last event no longer counts, so that fast modes cost only where they still move.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.motion import Path, smooth_stretches
from vibeam_models.arrays import Array

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
    poles = _poles(path)
    floor = max(path.drive.omega, highest)
    edges = [
        _panels(a, b, born, poles, floor, DEAD_AT_REST if _resting(path, (a + b) / 2) else DEAD)
        for a, b, born in _since_events(path, begin, end)
    ]
    return np.concatenate([e[:-1] for e in edges]), np.concatenate([e[1:] for e in edges])


def _poles(path: Path) -> NDArray[np.complex128]:
    """Exponents of the 2n free modal solutions, rad/s."""
    omega = path.system.omega.astype(complex)
    sigma = path.system.zeta * omega
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
