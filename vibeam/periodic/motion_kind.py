"""Kinds of motion: how often a motion repeats and strikes, by which branches of a response are told apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vibeam.system.response import FrequencyResponse, complete
from vibeam_models.arguments import counted

LONGEST = 4  # drive periods after which a motion repeats, above which it counts as one that does not
MANY = 8  # impacts a drive period, above which their number is no mark of a motion: it chatters
JUMP = 0.2  # relative change of the amplitude between neighbours that may be a jump
FREE, IRREGULAR, UNKNOWN = -1, 0, -2  #: in place of the periods


class SteadyKind(NamedTuple):
    """Kind of a motion: ``periods`` until it repeats, ``impacts`` in these, −1: so many that it chatters.

    In place of the periods: ``FREE`` no contact, ``IRREGULAR`` no repetition within ``LONGEST``, ``UNKNOWN``.
    """

    periods: int
    impacts: int = 0

    @property
    def strikes(self) -> bool:
        """True of a known motion with contact."""
        return self.periods >= IRREGULAR

    @property
    def repeats(self) -> bool:
        """True of a motion with contact that repeats."""
        return self.periods > IRREGULAR

    def __str__(self) -> str:
        if not self.repeats:
            return {FREE: "no contact", IRREGULAR: "no repetition"}.get(self.periods, "unknown")
        often = "chatter" if self.impacts < 0 else counted(self.impacts, "impact")
        return f"period {self.periods} with {often}"


def kinds_of(response: FrequencyResponse) -> list[SteadyKind]:
    """Kind of each point of a response."""
    done = complete(response).tolist()
    rates = np.nan_to_num(response.impacts_per_period).tolist()
    return [
        _kind(periods, rate) if known else SteadyKind(UNKNOWN)
        for known, periods, rate in zip(done, response.period.tolist(), rates, strict=True)
    ]


def _kind(periods: int, rate: float) -> SteadyKind:
    if periods < 0:
        return SteadyKind(FREE)
    if not 0 < periods <= LONGEST:
        return SteadyKind(IRREGULAR)
    return SteadyKind(periods, -1 if rate > MANY else round(rate * periods))


def width(one: float, other: float) -> float:
    """Relative width between two frequencies."""
    return abs(other - one) / (0.5 * (one + other))
