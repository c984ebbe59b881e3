"""Number read off a result, or why there is none."""

from __future__ import annotations

from dataclasses import dataclass

NAN = float("nan")


@dataclass(frozen=True)
class NumberRead:
    """Number read on one branch, NaN with the reason ``fault``; ``note``: what is to be known of it."""

    number: float
    fault: str = ""
    note: str = ""
    absent: bool = False  #: the frequency is not in the grid
