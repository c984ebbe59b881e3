"""How far a number may go."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from vibeam.faults import shown


@dataclass(frozen=True)
class Range:
    """Numbers from ``low`` to ``high``, ``low`` itself only where ``closed``."""

    low: float = -math.inf
    high: float = math.inf
    closed: bool = True

    def check(self, number: float, value: Any) -> None:
        """ValueError, with the value as it was written, if the number is outside."""
        if not (self.low <= number <= self.high) or (number == self.low and not self.closed):
            raise ValueError(f"{shown(value)} {'is outside' if math.isfinite(self.high) else 'must be'} {self}")

    def describe(self) -> str:
        """The range after a unit: ``"> 0"``, ``"in [0, 1]"``, empty where all numbers will do."""
        return f"in {self}" if math.isfinite(self.high) else str(self)

    def schema(self) -> dict[str, float]:
        """The range as JSON schema has it."""
        low = {"minimum" if self.closed else "exclusiveMinimum": self.low} if math.isfinite(self.low) else {}
        return low | ({"maximum": self.high} if math.isfinite(self.high) else {})

    def __str__(self) -> str:
        if self.low == -math.inf:
            return ""
        if self.high == math.inf:
            return f"{'≥' if self.closed else '>'} {self.low:g}"
        return f"[{self.low:g}, {self.high:.0f}]"


ANY = Range()
POSITIVE = Range(0, closed=False)
NOT_NEGATIVE = Range(0)
