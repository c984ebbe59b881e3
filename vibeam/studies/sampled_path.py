"""Motion of a solver that steps by itself, read like an exact one: by cubics between its own samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam.solvers.integration.samples import SampledMotion
from vibeam_models.arrays import Array


@dataclass(frozen=True)
class SampledPath:
    """Cubics through the displacements and velocities of a sampled ``motion``, which has both sides of its impacts."""

    motion: SampledMotion

    def at(self, times: Array) -> Array:
        """Modal displacements and velocities (k, 2, n) at times (k,) of the motion, just after an impact."""
        known = self.motion.times
        left = np.clip(np.searchsorted(known, times, side="right") - 1, 0, len(known) - 2)
        step = known[left + 1] - known[left]
        share = np.divide(times - known[left], step, out=np.zeros_like(times), where=step > 0)
        s, h = np.clip(share, 0.0, 1.0)[:, None], np.where(step > 0, step, 1.0)[:, None]
        (x, v), (y, w) = (self.motion.values[at].swapaxes(0, 1) for at in (left, left + 1))
        a, rise = h * v, y - x
        b, c = 3 * rise - 2 * a - h * w, a + h * w - 2 * rise
        return np.stack([x + s * (a + s * (b + s * c)), (a + s * (2 * b + 3 * s * c)) / h], axis=1)

    def shown(self, begin: float, points: int) -> tuple[Array, Array]:
        """Times (m,) and modal values (m, 2, n) at ``points`` even times from ``begin`` to the end, and at the impacts.

        An impact is two points at the same time.
        """
        known, values = self.motion.times, self.motion.values
        even = np.linspace(begin, known[-1], points)
        jumps = np.flatnonzero((np.diff(known) <= 0) & (known[1:] >= begin))
        jumps = jumps[(values[jumps] != values[jumps + 1]).any(axis=(1, 2))]
        even = even[~np.isin(even, known[jumps])]
        times = np.concatenate([even, known[jumps], known[jumps]])
        rank = np.repeat([0, 0, 1], [len(even), len(jumps), len(jumps)])
        order = np.lexsort((rank, times))
        return times[order], np.concatenate([self.at(even), values[jumps], values[jumps + 1]])[order]

    def energy_shares(self, begin: float) -> Array:
        """Shares (n,) of the modes in the mean energy from ``begin`` on, by the trapezoidal rule over the samples."""
        inside = self.motion.times >= begin
        values, times = self.motion.values[inside], self.motion.times[inside]
        energy = (values[:, 1] ** 2 + (self.motion.system.omega * values[:, 0]) ** 2) / 2
        total = np.asarray(np.trapezoid(energy, times, axis=0))
        return np.asarray(total / total.sum()) if total.sum() > 0 else np.full(len(total), np.nan)
