"""Why a computation ended."""

from __future__ import annotations

from enum import Enum


class Ended(Enum):
    """Why a computation ended: the value is the message; the order is the code that kernels and files use."""

    COMPLETE = "ran to the end"
    EVENT_LIMIT = "stopped at the limit of impacts: raise it, or look for an endless chatter (R = 1 on a pressed stop)"
    PENETRATED = "the start lies beyond the stop: start from a state with contact displacement ≤ gap"
    NOT_FINITE = "a number overflowed: the response grew beyond all bounds"
    NOT_RUN = "not run yet"
    NO_ORBIT = "no stable motion of the kind this solver looks for at this frequency"
    UNRESOLVED = "the next event was not found in bounded work: some modes are far too fast beside it; keep fewer modes"

    @property
    def code(self) -> int:
        """The member's number in files and kernels."""
        return _CODES[self]

    @classmethod
    def of_code(cls, code: int) -> Ended:
        """The member with that number."""
        return list(cls)[code]


_CODES = {member: code for code, member in enumerate(Ended)}
