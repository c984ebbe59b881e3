"""Basis of an error estimate at a point: what was estimated, or the reason why nothing was."""

from __future__ import annotations

from enum import Enum


class Basis(Enum):
    """The value says in words what an estimate is of, or why there is none; the order is the code in arrays."""

    ORBIT = "along the exact orbit"
    NO_ORBIT = "the full model has no such motion near: too close to a fold, or beyond it"
    STRIKES = "the full model strikes the stop in between"
    UNSTABLE = "the full model's motion is unstable there"
    TOUCHES = "the full model touches the stop, this one does not"
    APERIODIC = "the motion does not repeat, and of its means nothing can be claimed without flying the full model"
    RESTS = "the motion rests on the stop"
    SEVERAL = "too many impacts before the motion repeats"
    UNSETTLED = "no exact orbit agrees with the point"
    FAILED = "the point failed"
    RESONANT = "an undamped mode is driven at a resonance"
    FREE = "clear of the stop, as the full model"
    ANOTHER = "the full model makes another motion"

    @property
    def code(self) -> int:
        """Number in arrays and files."""
        return _CODES[self]

    @classmethod
    def of_code(cls, code: int) -> Basis:
        """Member with a given number."""
        return list(cls)[code]


KNOWN = (Basis.ORBIT, Basis.FREE)  # those with an estimate

WITHOUT_IMPACTS = (Basis.FREE, Basis.FAILED)  # neither model is known to touch the stop

_CODES = {member: code for code, member in enumerate(Basis)}
