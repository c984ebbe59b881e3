"""Work of a simulation in seconds, counted by what was computed: the same on every machine, and on a busy one."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple

import numpy as np

from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array
from vibeam_models.scene import AnyScene

REGULAR = 5  # evaluations of the contact displacement in a drive period that is searched for impacts in one go
FIRST, ODD = 4, 2.0  # places by which a sweep is foreseen, and the share by which these may be dearer than the others
GROWTH, SURE = 1.7, 1.5  # exponent of work over modes, about; share by which that may mislead
PATIENCE, START = 4.0, 0.5  # CPU seconds a second of the work counted, and besides, that a simulation is given


class WorkRate(NamedTuple):
    """Seconds an evaluation of the contact displacement, alone and a mode, and what comes besides.

    ``searched``: each evaluation beyond the ``REGULAR`` of a period, alone and a mode; ``coupled``: each impact, a pair
    of modes.
    """

    evaluation: tuple[float, float]
    searched: tuple[float, float] = (0.0, 0.0)
    coupled: float = 0.0

    @classmethod
    def of(cls, scene: AnyScene) -> WorkRate:
        """Rate of a scene's models, by its contacts: within a factor of 4 of CPU time (tests/benchmarks)."""
        stop: Any = scene.stop
        law = None if stop is None else stop.law
        if law is not None and not law.integrated:
            return cls((1.5e-7, 3.5e-8), coupled=5e-8)
        one = stop is None or (law is None and stop.second_gap is None and not scene.named("further_stop"))
        return cls((5e-8, 1e-8), (3e-7, 1.7e-7)) if one else cls((9e-7, 1e-7))

    def seconds(self, found: FrequencyResponse, periods: int) -> Array:
        """Work at each point (points,), s, of a sweep with so many drive ``periods`` a point."""
        modes = found.mode_energy.shape[1]
        beyond = np.maximum(0, found.evaluations - REGULAR * periods)
        each = [alone + modes * a_mode for alone, a_mode in (self.evaluation, self.searched)]
        counted = each[0] * found.evaluations + each[1] * beyond + self.coupled * modes**2 * found.impacts
        return np.asarray(counted, dtype=float)


class WorkSpent(Exception):
    """More work was done than there may be."""


@dataclass
class Work:
    """Seconds of work that may be ``spent``; ``measured``: CPU seconds that it took.

    What hangs on it is the same on every machine but where that is ``PATIENCE`` times slower than what is counted.
    ``breaks``: ``WorkSpent`` as soon as nothing is left.
    """

    most: float = inf
    spent: float = 0.0
    measured: float = 0.0
    breaks: bool = False

    def surely_exceeded(self, known: float, growth: float) -> bool:
        """Test whether a sweep of ``growth`` times as many modes as one whose work is ``known`` will not fit."""
        return bool(known * growth**GROWTH > SURE * self.most)

    @property
    def done(self) -> bool:
        """True where nothing is left."""
        return self.spent >= self.most or self.measured >= PATIENCE * self.most + START

    def add(self, counted: float, measured: float) -> None:
        """Count what was done."""
        self.spent, self.measured = self.spent + counted, self.measured + measured
        if self.breaks and self.done:
            raise WorkSpent

    def fits(self, places: int, of: int) -> bool:
        """Test whether what all places of a sweep will take fits, by what the first ``places`` took."""
        share = min(1.0, ODD * places / of) if places >= FIRST else 1.0
        return self.spent <= share * self.most and self.measured <= share * PATIENCE * self.most + START
