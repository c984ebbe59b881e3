"""Finding: one line of the check of an installation."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class State(StrEnum):
    """State of what was examined."""

    GOOD = "ok"
    FAULT = "fault"
    ABSENT = "absent"  # optional, and not there
    NOTE = "note"  # works, and may be better
    FACT = "fact"  # nothing to judge


@dataclass(frozen=True)
class Finding:
    """What was found of ``name`` in a ``topic``; ``cure``: what helps, where something does."""

    topic: str
    name: str
    state: State
    value: str
    cure: str = ""

    def __str__(self) -> str:
        """As one line."""
        head = {State.FAULT: "FAULT", State.FACT: ""}.get(self.state, self.state.value)
        said = f"{head:6}  {self.name}: {self.value}"
        return f"{said}; {self.cure}" if self.cure else said
