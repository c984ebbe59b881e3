"""Entries that hold one value: a quantity, a count, a flag, a word, a text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vibeam.entries.entry import Entry
from vibeam.entries.range import ANY, Range
from vibeam.faults import shown, suggestion
from vibeam.units import Kind, to_si

NUMBER_WITH_UNIT = r"^\s*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?(\s|[A-Za-zµμ%]|1\s*/|$)"


@dataclass(frozen=True)
class Quantity(Entry):
    """A number of one kind, in SI."""

    kind: Kind
    range: Range = ANY

    def parse(self, value: Any) -> float:
        """As ``Entry.parse``."""
        number = to_si(value, self.kind)
        self.range.check(number, value)
        return number

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " ".join(filter(None, [self.kind.unit or "number", self.range.describe()]))

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``: a number in SI units, or text that begins with one."""
        text = {"type": "string", "pattern": NUMBER_WITH_UNIT}
        return {"anyOf": [{"type": "number"} | self.range.schema(), text]} if self.kind.bare else text

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value if self.kind.bare or value is None else f"{value!r} {self.kind.unit}"


@dataclass(frozen=True)
class Count(Entry):
    """A whole number."""

    low: int
    high: int

    def parse(self, value: Any) -> int:
        """As ``Entry.parse``."""
        if not isinstance(value, int) or isinstance(value, bool):
            raise ValueError(f"must be a whole number, not {shown(value)}")
        Range(self.low, self.high).check(value, value)
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"whole number {Range(self.low, self.high).describe()}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "integer", "minimum": self.low, "maximum": self.high}


@dataclass(frozen=True)
class Flag(Entry):
    """Yes or no."""

    def parse(self, value: Any) -> bool:
        """As ``Entry.parse``."""
        if not isinstance(value, bool):
            raise ValueError(f"must be {self.describe()}, not {shown(value)}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "true | false"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "boolean"}


@dataclass(frozen=True)
class Word(Entry):
    """One of a few words."""

    words: tuple[str, ...]

    def parse(self, value: Any) -> str:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            raise ValueError(f"must be one of {self.describe()}, not {shown(value)}")
        if value not in self.words:
            near = suggestion(value, self.words)
            meant = f"; did you mean {near!r}?" if near else ""
            raise ValueError(f"{shown(value)} is not one of {self.describe()}{meant}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return " | ".join(f'"{word}"' for word in self.words)

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"enum": list(self.words)}


@dataclass(frozen=True)
class Text(Entry):
    """Free text."""

    def parse(self, value: Any) -> str:
        """As ``Entry.parse``."""
        if not isinstance(value, str):
            raise ValueError(f"must be text in quotes, not {shown(value)}")
        return value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "text"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "string"}
