"""Reasons why a computation ended."""

from __future__ import annotations

from enum import Enum


class Ended(Enum):
    """Reason why a computation ended: the value is the message, the order is the code in kernels and files."""

    COMPLETE = "ran to the end"
    EVENT_LIMIT = "stopped at the limit of impacts: raise it, or look for an endless chatter (R = 1 on a pressed stop)"
    PENETRATED = "the start lies beyond the stop: start from a state with contact displacement ≤ gap"
    NOT_FINITE = "a number overflowed: the response grew beyond all bounds"
    NOT_RUN = "not run yet"
    NO_ORBIT = "no stable motion of the kind this solver looks for at this frequency"
    UNRESOLVED = (
        "the next event was not found in bounded work: some modes, or the contact's own damping, are far too fast "
        "beside it; keep fewer modes, or damp the contact less"
    )

    @property
    def code(self) -> int:
        """Number of the member in files and kernels."""
        return _CODES[self]

    @classmethod
    def of_code(cls, code: int) -> Ended:
        """Member with a given number."""
        return list(cls)[code]


_CODES = {member: code for code, member in enumerate(Ended)}
