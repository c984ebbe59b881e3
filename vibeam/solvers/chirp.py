"""Swept-sine test: a linear chirp in pieces of one drive period, at each the chirp's mean frequency over it.

The chirp drives by Ω²B sin φ with φ̇ = Ω = Ω₀ + αt, with the acceleration (or force) amplitude Ω²B that settled points
have at the frequency Ω. Its phase passes 2πk at t_k, where Ω² = Ω₀² + 4πkα. A piece lasts from t_k to t_k+1 and has the
constant frequency ½(Ω(t_k) + Ω(t_k+1)), of which that is exactly one period: pieces gain and lose no phase, and the
drive is continuous at its zeros. Within a piece of T seconds

    |φ − φ_piece| ≤ |α|T²/8,    |Ω²B / (Ω²B)_piece − 1| ≤ p |α|T/2Ω    to first order in α, where Ω²B ~ Ω^p,

the parabola against its chord and the straight line against its middle: p is 2 for a held displacement, 1 for a
velocity, 0 for an acceleration or a force. Settled points differ from both by what a motion needs to settle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibeam.solvers import SOLVERS, solver
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, join
from vibeam.system.state import State
from vibeam_models.arrays import Array

Amplitude = Callable[[Array], ArrayLike]  # of the base (m), at frequencies in rad/s
MOST = 1_000_000  # pieces
WHOLE = 1e-9  # share of a period by which the last one may be cut off and still be there


@dataclass(frozen=True)
class Chirp:
    """Pieces of a chirp: ``omega`` (n,) rad/s of each; its ``edges`` (n + 1,) rad/s and their ``times`` (n + 1,) s."""

    omega: Array
    edges: Array
    times: Array

    @property
    def phase_error(self) -> Array:
        """By how many radians (n,) the phase leaves that of the chirp at most: |α|T²/8."""
        return np.asarray(np.abs(np.diff(self.edges)) * np.diff(self.times) / 8)

    def size_error(self, amplitude: Amplitude) -> Array:
        """By what share (n,) the size Ω²B leaves that of the chirp at most, at the ends of each piece."""
        middle, ends = (_level(amplitude, omega) * omega**2 for omega in (self.omega, self.edges))
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.abs(np.stack([ends[:-1], ends[1:]]) / middle - 1).max(axis=0)
        return np.asarray(np.where(middle == 0, 0.0, off))


def linear_chirp(first: float, last: float, rate: float) -> Chirp:
    """Pieces from ``first`` to ``last`` rad/s at ``rate`` rad/s² (positive either way), as many as are whole.

    ValueError for frequencies and a rate that are not positive, for less than one period and for more than a million.
    """
    if not (min(first, last, rate) > 0 and np.isfinite([first, last, rate]).all()):
        raise ValueError(f"chirp: {first:g} and {last:g} rad/s and {rate:g} rad/s² must be positive")
    turns = abs(last**2 - first**2) / (4 * np.pi * rate)
    count = int(turns + WHOLE)
    if not 1 <= count <= MOST:
        cure = "lower the rate, or sweep further" if count < 1 else "raise the rate, or sweep less far"
        raise ValueError(f"chirp: {turns:.3g} drive periods, and 1 to {MOST} make one: {cure}")
    signed = rate if last > first else -rate
    edges = np.sqrt(np.maximum(first**2 + 4 * np.pi * signed * np.arange(count + 1), 0.0))
    return Chirp((edges[:-1] + edges[1:]) / 2, edges, (edges - first) / signed)


def swept(
    system: ImpactSystem,
    chirp: Chirp,
    amplitude: Amplitude,
    *,
    settle: int = 200,
    solver_name: str = "flight",
    output: str = "contact",
    state: State | None = None,
    options: Mapping[str, Any] | None = None,
) -> tuple[FrequencyResponse, State]:
    """The motion over a chirp, one entry a piece: extremes and impacts of that one drive period; and its last state.

    Without a ``state`` it starts from the motion after ``settle`` drive periods at the chirp's first frequency.
    ValueError for a solver that knows settled motions alone.
    """
    declared = SOLVERS[solver_name]
    if declared.stationary:
        raise ValueError(f"chirp: solver {solver_name!r} knows settled motions alone: 'flight' flies a chirp")
    made = solver(solver_name, system, float(chirp.edges.min()), 0.0, **(options or {}))
    if state is None:
        first = chirp.edges[:1]
        _, state = made.steady(first, float(_level(amplitude, first)[0]), None, max(settle - 1, 0), 1, output)
    drives = _level(amplitude, chirp.omega)
    if declared.blocks:
        response, after = made.steady(chirp.omega, drives, state, 0, 1, output)
        return response, after
    parts: list[FrequencyResponse] = []
    for omega, drive in zip(chirp.omega, drives, strict=True):
        part, state = made.steady(np.array([omega]), float(drive), state, 0, 1, output)
        parts.append(part)
    return join(parts), state


def _level(amplitude: Amplitude, omega: Array) -> Array:
    return np.broadcast_to(np.asarray(amplitude(omega), dtype=float), omega.shape)
