"""A settled motion as it is looked at: through the measuring chain, or exact, evenly sampled."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.measurement import Chain, Record, measure
from vibeam.observe.path import impacts_within
from vibeam.show.motion import exact_motion, settled
from vibeam.show.plan import ShowPlan
from vibeam.simulate import Trajectory

if TYPE_CHECKING:
    from vibeam.case import Case

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Seen:
    """A motion from before its window [``begin``, ``end``] s (after which a drive period more) and its ``record``.

    The drive's phase is 0 at ``begin``; what a filter needs to settle has passed one drive period before.
    """

    path: Trajectory
    record: Record
    begin: float
    end: float
    chain: Chain

    @property
    def delay(self) -> float:
        """By how much the record lags, s."""
        return self.chain.low_pass.delay() if self.chain.low_pass else 0.0

    @property
    def window(self) -> Record:
        """The samples of the window alone."""
        inside = (self.record.time >= self.begin) & (self.record.time <= self.end)
        return Record(*(rows[inside] for rows in (self.record.time, self.record.displacement, self.record.velocity)))

    @property
    def hits(self) -> Array:
        """Times and contact velocities just before (m, 2) of the impacts in the window."""
        return impacts_within(self.path, self.begin, self.end)

    @property
    def exact(self) -> bool:
        """Whether the samples are the motion itself."""
        return self.chain.velocity == "exact"


def seen(case: Case, name: str, frequency: float, plan: ShowPlan, periods: int, chain: Chain) -> Seen:
    """A window of ``periods`` drive periods of the settled motion at ``frequency`` Hz; NoMotion where there is none."""
    begin = settled(case, name, frequency, plan)
    fading = chain.low_pass.settling() if chain.low_pass else 0.0
    lead = 1 + ceil(fading / begin.period)
    path = exact_motion(begin, lead + periods + 1)
    first, last = lead * begin.period, (lead + periods) * begin.period
    record = measure(path, chain, plan.output).after(first - begin.period)
    return Seen(path, record, first, last, chain)


def chain_or_exact(case: Case, name: str, rate: float) -> Chain:
    """The fidelity's measuring chain, or, where it has none, exact samples, ``rate`` a second."""
    return case.chain_of(name) or Chain(rate, velocity="exact")
