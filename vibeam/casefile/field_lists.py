"""Entries that hold several values in a row, and one of several units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from vibeam.casefile.fields import Entry, EntryInUnits, Quantity, Word
from vibeam.casefile.unit_systems import SI, UnitSystem
from vibeam.exchange.faults import as_shown_in_message


@dataclass(frozen=True)
class Several(EntryInUnits):
    """A list of at least one quantity; also one alone, or a word instead, where ``alone`` or ``words`` say so."""

    each: Quantity
    alone: bool = False
    words: tuple[str, ...] = ()
    limit: int = 1_000_000
    ascending: bool = False

    def read(self, value: Any, units: UnitSystem | None) -> str | tuple[float, ...]:
        """As ``Entry.read``: the word or the numbers."""
        if isinstance(value, list):
            return self._numbers(value, units)
        if self.words:
            return self._word(value)
        return (self.each.read(value, units),) if self.alone else self._refuse(value)

    def _word(self, value: Any) -> str:
        return Word(self.words).parse(value) if isinstance(value, str) else str(self._refuse(value))

    def _refuse(self, value: Any) -> Any:
        raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")

    def _numbers(self, values: list[Any], units: UnitSystem | None) -> tuple[float, ...]:
        if not 0 < len(values) <= self.limit:
            raise ValueError(f"a list of {len(values)} numbers is outside [1, {self.limit}]")
        numbers = tuple(_items(self.each, values, "number", units))
        if self.ascending and any(one >= two for one, two in pairwise(numbers)):
            raise ValueError("the list must ascend, each number once; the direction is said elsewhere")
        return numbers

    def nondimensional(self) -> Several:
        """As ``Entry.nondimensional``."""
        return replace(self, each=self.each.nondimensional())

    def describe(self) -> str:
        """As ``Entry.describe``."""
        one = [self.each.describe()] if self.alone else []
        return " | ".join([*(f'"{word}"' for word in self.words), *one, f"list of {self.each.describe()}"])

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        several = {"type": "array", "items": self.each.schema(), "minItems": 1, "maxItems": self.limit}
        one = [self.each.schema()] if self.alone else []
        words = [Word(self.words).schema()] if self.words else []
        return {"anyOf": [*words, *one, several]} if words or one else several


@dataclass(frozen=True)
class OneOrSeveral(EntryInUnits):
    """A quantity, or a list of at least one."""

    each: Quantity
    limit: int = 1_000_000

    @property
    def _several(self) -> Several:
        return Several(self.each, limit=self.limit)

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``: a number, or a tuple of numbers."""
        return (self._several if isinstance(value, list) else self.each).read(value, units)

    def nondimensional(self) -> OneOrSeveral:
        """As ``Entry.nondimensional``."""
        return replace(self, each=self.each.nondimensional())

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"{self.each.describe()} | list of them"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"anyOf": [self.each.schema(), self._several.schema()]}


@dataclass(frozen=True)
class Each(Entry):
    """A list of at least one entry of a kind, each only once; also one ``alone``."""

    of: Entry
    alone: bool = False

    def parse(self, value: Any) -> tuple[Any, ...]:
        """As ``Entry.parse``."""
        if self.alone and isinstance(value, str):
            return (self.of.parse(value),)
        if not isinstance(value, list) or not value:
            raise ValueError(
                f"must be a {self.describe()}, not {as_shown_in_message(value) if value != [] else 'an empty list'}"
            )
        found = tuple(_items(self.of, value, "entry"))
        if len(set(found)) < len(found):
            raise ValueError("names one of its entries twice")
        return found

    def describe(self) -> str:
        """As ``Entry.describe``."""
        one = self.of.describe()
        return f"{one} | list of them" if self.alone else f"list of {one}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "array", "items": self.of.schema(), "minItems": 1, "uniqueItems": True}


def _items(entry: Entry, values: list[Any], called: str, units: UnitSystem | None = SI) -> Iterator[Any]:
    for number, value in enumerate(values, 1):
        try:
            yield entry.read(value, units)
        except ValueError as error:
            raise ValueError(f"{called} {number} of the list: {error}") from None


@dataclass(frozen=True)
class Names(Entry):
    """A list of names, each once; also one ``alone``."""

    what: str
    alone: bool = False

    def parse(self, value: Any) -> tuple[str, ...]:
        """As ``Entry.parse``."""
        value = [value] if self.alone and isinstance(value, str) else value
        if not isinstance(value, list) or not value or not all(isinstance(each, str) for each in value):
            raise ValueError(f"must be a {self.describe()}, not {as_shown_in_message(value)}")
        if len(set(value)) < len(value):
            raise ValueError("names one twice")
        return tuple(value)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"list of {self.what}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        several = {"type": "array", "items": {"type": "string"}, "minItems": 1, "uniqueItems": True}
        return {"anyOf": [{"type": "string"}, several]} if self.alone else several
