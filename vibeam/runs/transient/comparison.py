"""Comparison of fidelities under a record: each against the finest on the same realisations.

Two motions with impacts that start from nearly the same part at a rate of their own: beyond their horizon no two models
agree in time, however good, and statistics alone compare. Before it, a model that is off differs in what it predicts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.runs.transient.statistics import paired
from vibeam.runs.transient.transient import ENERGIES, Transient
from vibeam_models.arrays import Array, Flags, Index, ValueRecord

if TYPE_CHECKING:
    from vibeam.runs.transient.reading import Reading

TOLERANCE = 0.05  # of the finest fidelity's first natural period, within which impacts pair
SMALLEST = 1e-3  # share of the energy put in below which an energy is not compared
COMPARED = ("hardest_impact", "impact_velocity", "impacts", "lost_at_impacts", "lost_by_damping", "energy_left")


@dataclass(frozen=True)
class PairedDifference:
    """Difference of a ``quantity`` from the finest's at the ``at``-th value, of the same realisations, as a share.

    ``signal``: empty of impacts and energies. ``error``: standard error of the ``mean`` over ``n`` realisations, NaN of
    one.
    """

    quantity: str
    signal: str
    at: int
    mean: float
    error: float
    n: int

    def is_within(self, accuracy: float) -> bool:
        """Test whether it is no larger, its error counted twice."""
        return abs(self.mean) + (2 * self.error if isfinite(self.error) else 0.0) <= accuracy


@dataclass(frozen=True, eq=False, repr=False)
class TransientComparison(ValueRecord):
    """Comparison of a ``fidelity`` with the ``finest`` over v values and s seeds.

    ``tolerance``, s, within which impacts pair; ``horizon`` (v, s), s: until when they do;
    ``own_horizon`` (v,), s: the same of the finest with itself under a load larger by 1e-6 (NaN: not known): where that
    is short no model agrees for longer. ``off`` (v, s, o): difference of the signals' peaks as
    a share, ``off_before``: of the peaks before the horizon. ``differences``: means over the seeds.
    """

    fidelity: str
    finest: str
    tolerance: float
    duration: float
    horizon: Array
    own_horizon: Array
    off: Array
    off_before: Array
    differences: tuple[PairedDifference, ...]

    @property
    def parts(self) -> Flags:
        """(v, s): whether the motions part before the end."""
        return np.asarray(self.horizon < self.duration)

    def difference(self, quantity: str, signal: str = "", at: int = 0) -> PairedDifference:
        """Difference of a quantity at the ``at``-th value; KeyError where there is none."""
        for each in self.differences:
            if (each.quantity, each.signal, each.at) == (quantity, signal, at):
                return each
        raise KeyError(f"no difference of {quantity} {signal}".strip())


def compared(own: Transient, finest: Transient, period: float, twins: Mapping[int, Reading]) -> TransientComparison:
    """Comparison of two fidelities; ``period``, s: the finest's first natural one.

    ``twins``: by value, the finest's motion of the first seed under a load larger by 1e-6.
    """
    tolerance, shape = TOLERANCE * period, own.ended.shape
    horizon = np.full(shape, np.nan)
    before = np.full((*shape, len(finest.signals)), np.nan)
    for place in zip(*np.nonzero(own.complete & finest.complete), strict=True):
        horizon[place] = agreement(_train(own, *place), _train(finest, *place), tolerance, finest.duration)
        before[place] = _off_before(own, finest, place, horizon[place])
    twin = np.full(shape[0], np.nan)
    for value, reading in twins.items():
        near = ImpactTrain(reading["impact_times"], reading["impact_velocities"], reading["impact_contacts"])
        twin[value] = agreement(_train(finest, value, 0), near, tolerance, finest.duration)
    off = _shares(_peaks(own, finest), finest.peak)
    differences = tuple(_differences(own, finest))
    return TransientComparison(
        own.fidelity, finest.fidelity, tolerance, finest.duration, horizon, twin, off, before, differences
    )


def _train(of: Transient, value: int, seed: int) -> ImpactTrain:
    return ImpactTrain(*(each[value][seed] for each in (of.impact_times, of.impact_velocities, of.impact_contacts)))


def _peaks(own: Transient, finest: Transient) -> Array:
    """Peaks of the finest's signals in another fidelity, NaN of a signal that it does not have."""
    names = [each.name for each in own.signals]
    blank = np.full(own.ended.shape, np.nan)
    return np.stack(
        [own.peak[..., names.index(each.name)] if each.name in names else blank for each in finest.signals], axis=2
    )


def _shares(one: Array, other: Array) -> Array:
    return np.asarray(np.divide(one, other, out=np.full(other.shape, np.nan), where=other > 0) - 1)


def _off_before(own: Transient, finest: Transient, place: tuple[int, int], horizon: float) -> Array:
    """Difference of the peaks in the bins of the time before the horizon, as a share; NaN where there is no bin."""
    bins = int(horizon / finest.duration * finest.outline_least.shape[-1])
    names = [each.name for each in own.signals]
    found = np.full(len(finest.signals), np.nan)
    for number, signal in enumerate(finest.signals):
        if bins and signal.name in names:
            there = _outline_peak(finest, place, number, bins)
            found[number] = _outline_peak(own, place, names.index(signal.name), bins) / there - 1 if there else np.nan
    return found


def _outline_peak(of: Transient, place: tuple[int, int], signal: int, bins: int) -> float:
    least, greatest = (each[place][signal, :bins] for each in (of.outline_least, of.outline_greatest))
    return float(np.max(np.maximum(-least, greatest)))


def _negligible(finest: Transient, energy: Array, at: int) -> bool:
    """Test whether an energy at one value is next to none of what was put in, so that its differences are dust."""
    put = np.nanmean(np.sum(finest.start[at] + np.abs(finest.work[at]), axis=-1))
    return not abs(float(np.nanmean(energy[at]))) > SMALLEST * put


def _differences(own: Transient, finest: Transient) -> Iterator[PairedDifference]:
    shared = [each.name for each in finest.signals if each in own.signals]
    asked = [*((quantity, name) for name in shared for quantity in ("peak", "rms")), *((each, "") for each in COMPARED)]
    for quantity, signal in asked:
        ours, theirs = (each.of(quantity, signal or None) for each in (own, finest))
        for at in range(len(ours)):
            found = paired(ours[at], theirs[at])
            if found.n and not (quantity in ENERGIES and _negligible(finest, theirs, at)):
                yield PairedDifference(quantity, signal, at, found.mean, found.error, found.n)


HARD = 0.1  # share of a motion's hardest impact below which one need not have a partner


@dataclass(frozen=True, eq=False)
class ImpactTrain:
    """Impacts of one motion: ``times`` (m,), s, ascending, ``velocities``, numbers of the ``contacts`` struck."""

    times: Array
    velocities: Array
    contacts: Index


def agreement(one: ImpactTrain, other: ImpactTrain, tolerance: float, end: float) -> float:
    """Horizon of agreement of two trains, s; ``end`` where all of it agrees.

    Every impact of either that is harder than ``HARD`` times its hardest has a partner: one of the other, of any
    velocity, at the same contact, within ``tolerance``, s. The horizon is the first that has none.
    """
    alone = [own.times[_hard(own) & ~_has_partner(own, mate, tolerance)] for own, mate in ((one, other), (other, one))]
    return min([end, *(float(times[0]) for times in alone if len(times))])


def _hard(train: ImpactTrain) -> Flags:
    return np.asarray(train.velocities > HARD * np.max(train.velocities, initial=0.0))


def _has_partner(own: ImpactTrain, mate: ImpactTrain, tolerance: float) -> Flags:
    """Impacts that have one of the mate's at the same contact within the tolerance."""
    found = np.zeros(len(own.times), dtype=bool)
    for contact in np.unique(own.contacts):
        mine, theirs = own.contacts == contact, mate.times[mate.contacts == contact]
        if len(theirs):
            after = np.searchsorted(theirs, own.times[mine])
            near = [np.abs(theirs[np.clip(at, 0, len(theirs) - 1)] - own.times[mine]) for at in (after - 1, after)]
            found[mine] = np.minimum(*near) <= tolerance
    return found
