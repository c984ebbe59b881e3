"""Horizon of agreement: until when the impacts of two motions pair, so that chaos is told from a model that is off.

Two motions with impacts that start from nearly the same part at a rate of their own: beyond their horizon no two models
agree in time, however good, and statistics alone compare. Before it, a model that is off differs in what it predicts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibeam_models.arrays import Array, Flags, Index

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
