"""Entries that hold several values in a row."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from vibeam.entries.entry import Entry
from vibeam.entries.single import Quantity, Word
from vibeam.faults import shown


@dataclass(frozen=True)
class Several(Entry):
    """A list of at least one quantity; also one alone, or a word instead, where ``alone`` or ``words`` say so."""

    each: Quantity
    alone: bool = False
    words: tuple[str, ...] = ()
    limit: int = 1_000_000
    ascending: bool = False

    def parse(self, value: Any) -> str | tuple[float, ...]:
        """As ``Entry.parse``: the word or the numbers."""
        if isinstance(value, list):
            return self._numbers(value)
        if self.words:
            return self._word(value)
        return (self.each.parse(value),) if self.alone else self._refuse(value)

    def _word(self, value: Any) -> str:
        return Word(self.words).parse(value) if isinstance(value, str) else str(self._refuse(value))

    def _refuse(self, value: Any) -> Any:
        raise ValueError(f"must be {self.describe()}, not {shown(value)}")

    def _numbers(self, values: list[Any]) -> tuple[float, ...]:
        if not 0 < len(values) <= self.limit:
            raise ValueError(f"a list of {len(values)} numbers is outside [1, {self.limit}]")
        numbers = tuple(_items(self.each, values, "number"))
        if self.ascending and any(one >= two for one, two in pairwise(numbers)):
            raise ValueError("the list must ascend, each number once; the direction is said elsewhere")
        return numbers

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
class Each(Entry):
    """A list of at least one entry of a kind, each only once; also one ``alone``."""

    of: Entry
    alone: bool = False

    def parse(self, value: Any) -> tuple[Any, ...]:
        """As ``Entry.parse``."""
        if self.alone and isinstance(value, str):
            return (self.of.parse(value),)
        if not isinstance(value, list) or not value:
            raise ValueError(f"must be a {self.describe()}, not {shown(value) if value != [] else 'an empty list'}")
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


def _items(entry: Entry, values: list[Any], called: str) -> Iterator[Any]:
    for number, value in enumerate(values, 1):
        try:
            yield entry.parse(value)
        except ValueError as error:
            raise ValueError(f"{called} {number} of the list: {error}") from None
