"""Transient: the numbers of one fidelity under a record, over the values of the factor and the seeds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.case.transient_quantities import QUANTITIES
from vibeam.observe.decimation import History
from vibeam.runs.transient.reading import OUTLINE, READINGS, Reading
from vibeam.runs.transient.signals import TransientSignal
from vibeam.system.response import Ended
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array, Index, ValueRecord

Ragged = tuple[tuple[NDArray[Any], ...], ...]  # [value][seed]: an array (impacts,)
IMPACTS: Mapping[str, Callable[[Array], Any]] = {
    "first_impact": np.min, "hardest_impact": np.max, "impact_velocity": np.mean,
}  # fmt: skip
ENERGIES = {"work": "work", "lost_at_impacts": "lost", "lost_by_damping": "damping", "energy_left": "left"}


@dataclass(frozen=True, eq=False, repr=False)
class Transient(ValueRecord):
    """Motions of one fidelity over v values of the factor and s seeds, with o signals and n modes; SI units.

    Of shape (v, s, o): ``least``, ``greatest``, their times, ``mean`` and ``rms`` over the record. Of shape (v, s, n),
    J: energy at the ``start``, ``work`` of the load on the motion relative to the base, lost by ``damping``, ``lost``
    to the stop (which also hands it from mode to mode), ``left`` at the end. Of shape (v, s): ``rest``, the share of
    the time held on the stop; ``residual``, by which the energy balance is open; CPU times; ``ended``; ``proved``: 1,
    0 not all of it, −1 not asked. ``impact_times[i][j]`` (s), ``impact_velocities``, ``impact_contacts``: of each
    motion. ``outline_least``, ``outline_greatest`` (v, s, o, 512): extremes of equal bins of the time. ``spectrum``
    (v, s, o, f) at ``frequency`` (v, s, f) Hz: one-sided densities, unit²/Hz. ``history``: of one motion, by signal.
    What was not run yet is NaN, its ``ended`` NOT_RUN.
    """

    fidelity: str
    modes: int
    duration: float
    signals: tuple[TransientSignal, ...]
    frequency: Array
    least: Array
    greatest: Array
    least_time: Array
    greatest_time: Array
    mean: Array
    rms: Array
    outline_least: Array
    outline_greatest: Array
    spectrum: Array
    impact_times: Ragged
    impact_velocities: Ragged
    impact_contacts: Ragged
    rest: Array
    start: Array
    work: Array
    damping: Array
    lost: Array
    left: Array
    residual: Array
    ended: Index
    proved: Index
    cpu_seconds: Array = field(compare=False)
    reading_seconds: Array = field(compare=False)
    history: Mapping[str, History] = field(default_factory=dict)

    def __repr__(self) -> str:
        values, seeds = self.ended.shape
        many = f"{counted(self.modes, 'mode')}, {counted(values, 'value')}, {counted(seeds, 'realisation')}"
        return f"Transient({self.fidelity}: {many}, {counted(int(self.impacts.sum()), 'impact')})"

    @property
    def run(self) -> NDArray[np.bool_]:
        """(v, s): which motions were run, to the record's end or not."""
        return np.asarray(self.ended != Ended.NOT_RUN.code)

    @property
    def complete(self) -> NDArray[np.bool_]:
        """(v, s): which motions ran to the record's end."""
        return np.asarray(self.ended == Ended.COMPLETE.code)

    @property
    def peak(self) -> Array:
        """Largest absolute values (v, s, o)."""
        return np.maximum(-self.least, self.greatest)

    @property
    def peak_time(self) -> Array:
        """Times (v, s, o) of the largest absolute values, s."""
        return np.where(-self.least > self.greatest, self.least_time, self.greatest_time)

    @property
    def impacts(self) -> Index:
        """Numbers (v, s) of impacts, of contacts where the stop yields."""
        return np.array([[len(times) for times in row] for row in self.impact_times])

    def signal(self, name: str) -> int:
        """Index of a signal; KeyError names those that there are."""
        names = [each.name for each in self.signals]
        if name not in names:
            raise KeyError(f"no signal {name!r}: there are {', '.join(names)}")
        return names.index(name)

    def of(self, quantity: str, signal: str | None = None, mode: int | None = None) -> Array:
        """Numbers (v, s) of a quantity of ``QUANTITIES``: of a ``signal`` (None: the first), of a ``mode`` from 1 on.

        NaN where there is none, as of the first impact without one. KeyError for an unknown name.
        """
        kind = QUANTITIES[quantity]
        if kind.of == "signal":
            found = getattr(self, quantity)[..., 0 if signal is None else self.signal(signal)]
        elif quantity in ENERGIES:
            energy = getattr(self, ENERGIES[quantity])
            found = energy.sum(axis=2) if mode is None else energy[..., mode - 1]
        else:
            found = self._of_impacts(quantity)
        return np.where(self.complete, found, np.nan)

    def _of_impacts(self, quantity: str) -> Array:
        if quantity == "rest":
            return self.rest
        if quantity == "impacts":
            return self.impacts.astype(float)
        if quantity == "impact_rate":
            return self.impacts / self.duration
        read = IMPACTS[quantity]
        known = self.impact_times if quantity == "first_impact" else self.impact_velocities
        return np.array([[float(read(each)) if len(each) else np.nan for each in row] for row in known])


def assembled(
    fidelity: str,
    duration: float,
    signals: Sequence[TransientSignal],
    rows: Sequence[Sequence[Reading | None]],
    history: Mapping[str, History] | None = None,
) -> Transient:
    """Transient of the readings of all motions; None: not run yet."""
    known = [each for row in rows for each in row if each is not None and "left" in each]
    modes = max((len(each["left"]) for each in known), default=0)
    lines = max((len(each["frequency"]) for each in known), default=0)
    sizes = {"signal": len(signals), "mode": modes, "bin": OUTLINE, "frequency": lines}
    made: dict[str, Any] = {}
    for name, quantity in READINGS.items():
        if quantity.dimensions == ("impact",):
            empty = np.empty(0, dtype=np.int64 if name == "impact_contacts" else float)
            made[name] = tuple(tuple((each or {}).get(name, empty) for each in row) for row in rows)
        else:
            shape = tuple(sizes[each] for each in quantity.dimensions)
            made[name] = np.array([[_padded(each, name, shape) for each in row] for row in rows])
    return Transient(fidelity, modes, duration, tuple(signals), **made, history=dict(history or {}))


CODES = {"ended": Ended.NOT_RUN.code, "proved": -1}


def _padded(reading: Reading | None, name: str, shape: tuple[int, ...]) -> NDArray[Any]:
    """Numbers of a reading in the common ``shape``: NaN where it has no such mode or line, or was not run."""
    if name in CODES:
        return np.asarray((reading or {}).get(name, CODES[name]), dtype=np.int64)
    found = np.full(shape, np.nan)
    if reading is not None and name in reading:
        own = reading[name]
        found[tuple(slice(0, size) for size in own.shape)] = own
    return found
