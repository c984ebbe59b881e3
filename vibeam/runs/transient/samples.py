"""Samples of a motion's signals at even times: histories, mean and rms, spectral densities by Welch's method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.observe.decimation import History, history_of_samples
from vibeam.runs.transient.signals import TransientSignal, contacts_struck, values_at
from vibeam.system.record_pieces import blocks
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.observe.motion import Path
    from vibeam.system.impact_system import ImpactSystem

LEAST, MOST = 2**12, 2**20  # samples of a motion
A_PERIOD, PLENTY = 3, 10  # samples a period of the fastest mode: for spectra, and for all that is read
SEGMENTS = 8  # of a record, half overlapping: the resolution of a spectrum is 8 over the record's duration
BANDS = 400  # of a spectrum, evenly spaced over the logarithm of the frequency; a line each where they are narrower


@dataclass(frozen=True, eq=False)
class SignalSamples:
    """Values (m + 1, o) of o signals at even times from begin to end, and on both sides of impacts on rigid stops.

    ``struck`` (k,), s; ``before`` and ``after`` (k, o): the values there, between which velocities jump.
    """

    signals: tuple[TransientSignal, ...]
    times: Array
    values: Array
    struck: Array
    before: Array
    after: Array

    @property
    def rate(self) -> float:
        """Samples a second."""
        return (len(self.times) - 1) / float(self.times[-1] - self.times[0])

    @cached_property
    def all(self) -> tuple[Array, Array]:
        """Times (m + 1 + 2k,) and values of all samples, in order, both sides of each impact among them."""
        times = np.concatenate([self.times, self.struck, self.struck])
        order = np.argsort(times, kind="stable")
        same = np.concatenate([self.values, self.before, self.after])[order]
        return times[order], same

    def history(self, number: int, bins: int) -> History:
        """History of a signal: of cubics where its rate is the next signal, of lines else."""
        times, values = self.all
        own, rates = self.signals[number], None
        for at, each in enumerate(self.signals):
            if own.order >= 0 and each.output == own.output and each.order == own.order + 1:
                rates = values[:, at]
        return history_of_samples(times, values[:, number], rates, bins)

    def moments(self) -> tuple[Array, Array]:
        """Mean and root mean square (o,) over the time."""
        ends, steps = self.values[[0, -1]], len(self.values) - 1
        squares = np.einsum("mo,mo->o", self.values, self.values) - (ends**2).mean(axis=0)
        return (self.values.sum(axis=0) - ends.mean(axis=0)) / steps, np.sqrt(np.maximum(squares, 0.0) / steps)

    def spectrum(self) -> tuple[Array, Array]:
        """Frequencies (f,), Hz, and one-sided densities (o, f), unit²/Hz: means over the lines of each band."""
        size = (len(self.times) - 1) // SEGMENTS
        window = np.sin(np.pi * np.arange(size) / size)[:, None] ** 2
        density = np.zeros((size // 2 + 1, self.values.shape[1]))
        begins = range(0, len(self.values) - size, size // 2)
        for begin in begins:
            part = self.values[begin : begin + size]
            density += np.abs(np.fft.rfft(window * (part - part.mean(axis=0)), axis=0)) ** 2
        density[1:-1] *= 2
        density /= len(begins) * self.rate * np.sum(window**2)
        lines = np.arange(len(density)) * self.rate / size
        bands = np.unique(np.geomspace(1, len(lines), BANDS).astype(int))[:-1]
        many = np.diff(np.append(bands, len(lines)))
        means = [np.add.reduceat(each, bands, axis=0) for each in (lines, density)]
        return means[0] / many, (means[1] / many[:, None]).T


def samples_of(path: Path, record: Any, signals: Sequence[TransientSignal], a_period: int) -> SignalSamples:
    """Samples of the signals of a motion under ``record``: so many a period of its fastest mode, within bounds."""
    span = path.t_end - path.t_start
    times = path.t_start + np.linspace(0.0, 1.0, count_of(path.system, span, a_period) + 1) * span
    values = np.empty((len(times), len(signals)))
    for part in blocks(len(times)):
        values[part] = values_at(path, record, signals, times[part], path.modes_at(times[part]))
    struck, before, after = _around_impacts(path)
    sides = [
        values_at(path, record, signals, struck, poses) if len(struck) else np.empty((0, len(signals)))
        for poses in (before, after)
    ]
    return SignalSamples(tuple(signals), times, values, struck, *sides)


def count_of(system: ImpactSystem, span: float, a_period: int) -> int:
    """Number of samples of a motion of ``span`` s, so many a period of the fastest mode, within bounds."""
    fastest = float(np.max(system.omega[np.isfinite(system.omega)], initial=0.0)) / (2 * np.pi)
    return LEAST * int(np.clip(np.ceil(a_period * fastest * span / LEAST), 1, MOST // LEAST))


def _around_impacts(path: Path) -> tuple[Array, Array, Array]:
    """Times (k,) of the impacts on rigid stops and the modes (k, 2, n) just before and just after them."""
    contacts = Contacts.of(path.system)
    struck = contacts_struck(path)
    rigid = np.array([not law.yields for law in contacts.laws])[struck]
    times, speeds, rows = path.impact_times[rigid], path.impact_velocities[rigid], contacts.rows[struck[rigid]]
    after = path.modes_at(times)
    before = after.copy()
    impulse = (np.sum(after[:, 1] * rows, axis=1) - speeds) / np.sum(rows**2, axis=1)
    before[:, 1] -= impulse[:, None] * rows
    return times, before, after
