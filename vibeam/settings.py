"""Entries that name other keys of the case: what a fidelity sets, what it goes without, lists of names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from vibeam import units
from vibeam.canonical import name_of
from vibeam.entries.entry import Entry
from vibeam.entries.single import Quantity
from vibeam.faults import shown
from vibeam.lines import key_parts


@dataclass(frozen=True)
class Settings(Entry):
    """A table of dotted keys with values as in a case; nested tables mean the same."""

    def parse(self, value: Any) -> dict[str, Any]:
        """As ``Entry.parse``: keys are flat, values as written."""
        if not isinstance(value, dict):
            raise ValueError(f"must be {self.describe()}, not {shown(value)}")
        found = dict(flat(value))
        if not found:
            raise ValueError("sets nothing: name a key, or leave it away")
        return found

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return 'table { "stop.gap" = value, … }'

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "object", "minProperties": 1}


@dataclass(frozen=True)
class Names(Entry):
    """A list of names, each once."""

    what: str

    def parse(self, value: Any) -> tuple[str, ...]:
        """As ``Entry.parse``."""
        if not isinstance(value, list) or not value or not all(isinstance(each, str) for each in value):
            raise ValueError(f"must be a {self.describe()}, not {shown(value)}")
        if len(set(value)) < len(value):
            raise ValueError("names one twice")
        return tuple(value)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"list of {self.what}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "array", "items": {"type": "string"}, "minItems": 1, "uniqueItems": True}


@dataclass(frozen=True)
class Value(Entry):
    """A plain number, a percentage or a frequency."""

    def parse(self, value: Any) -> float:
        """As ``Entry.parse``."""
        try:
            return Quantity(units.RATIO).parse(value)
        except ValueError as error:
            return self._frequency(value, error)

    def _frequency(self, value: Any, error: ValueError) -> float:
        try:
            return Quantity(units.FREQUENCY).parse(value)
        except ValueError:
            raise error from None

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "number | Hz"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return Quantity(units.RATIO).schema()


def flat(tables: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and their values; a key in quotes that holds dots is the path that it spells."""
    for name, value in tables.items():
        key = above + _spelt(name)
        if isinstance(value, Mapping):
            yield from flat(value, f"{key}.")
        else:
            yield key, value


def _spelt(name: str) -> str:
    try:
        key_parts(name)
    except (ValueError, RecursionError):
        return name_of(name)
    return name
