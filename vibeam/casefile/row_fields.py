"""Entries that name a matrix in a file, or a row of coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from vibeam.casefile.fields import Entry
from vibeam.exchange.faults import as_shown_in_message, suggest
from vibeam_models.arguments import real

DIRECTIONS = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
PLACE = '{ node = 12, direction = "z" }'


def file_name(name: str) -> str:
    """A file's name as shown in a message: in quotes where it is long, or holds characters that are not shown."""
    return name if name.isprintable() and len(name) <= 60 else as_shown_in_message(name)


@dataclass(frozen=True)
class InFile(Entry):
    """A matrix in a file: its name, or a table with the file and the name of the matrix in it."""

    def parse(self, value: Any) -> dict[str, str]:
        """As ``Entry.parse``: a table in either case."""
        if isinstance(value, str) and value:
            return {"file": value}
        return _in_file(value, f"must be {self.describe()}, not {as_shown_in_message(value)}")

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return 'file | { file = "…", name = "…" }'

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        text = {"type": "string"}
        return {"anyOf": [text, {"type": "object", "properties": {"file": text, "name": text}, "required": ["file"]}]}


def _in_file(value: Any, fault: str) -> dict[str, str]:
    if not (isinstance(value, dict) and isinstance(value.get("file"), str) and value["file"]):
        raise ValueError(fault)
    for key, each in value.items():
        if key not in ("file", "name"):
            raise ValueError(f"unknown key {as_shown_in_message(key)}; {suggest(str(key), ('file', 'name'))}")
        if not isinstance(each, str):
            raise ValueError(f"{key} must be text in quotes, not {as_shown_in_message(each)}")
    return dict(value)


@dataclass(frozen=True)
class Row(Entry):
    """A row of coordinates: one of them, some with their values, or an array in a file; or one of ``words``."""

    words: tuple[str, ...] = ()

    def parse(self, value: Any) -> Any:
        """As ``Entry.parse``: a word, a table that names a file, or a tuple of tables, one for each coordinate."""
        if isinstance(value, str):
            return value if value in self.words else {"file": value}
        if isinstance(value, dict) and "file" in value:
            return _in_file(value, f"must be {self.describe()}")
        if isinstance(value, list) and not value:
            raise ValueError(f"an empty list reads nothing: it must be {self.describe()}")
        return tuple(self._terms(value))

    def _terms(self, value: Any) -> Iterator[dict[str, Any]]:
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, int) and not isinstance(each, bool):
                each = {"coordinate": each}
            if not isinstance(each, dict):
                raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")
            yield _term(each)

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return list(value) if isinstance(value, tuple) else value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        words = [f'"{word}"' for word in self.words]
        kinds = ["number of a coordinate", PLACE, "list of { coordinate = 3, value = 0.5 }", 'file | { file = "…" }']
        return " | ".join([*words, *kinds])

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        one = {"anyOf": [{"type": "integer", "minimum": 1}, {"type": "object"}]}
        return {"anyOf": [{"type": "string"}, *one["anyOf"], {"type": "array", "items": one, "minItems": 1}]}


def _term(term: dict[str, Any]) -> dict[str, Any]:
    known = ("coordinate", "node", "direction", "value")
    for key in term:
        if key not in known:
            raise ValueError(f"unknown key {as_shown_in_message(key)}; {suggest(str(key), known)}")
    if ("coordinate" in term) == ("node" in term) or ("node" in term) != ("direction" in term):
        raise ValueError(f"must say a coordinate = 3, or a place {PLACE}, not {as_shown_in_message(term)}")
    for key in ("coordinate", "node"):
        if key in term and (not isinstance(term[key], int) or isinstance(term[key], bool)):
            raise ValueError(f"{key} must be a whole number, not {as_shown_in_message(term[key])}")
    direction = term.get("direction", 1)
    if isinstance(direction, bool) or direction not in (*DIRECTIONS, *DIRECTIONS.values()):
        raise ValueError(f"direction must be x, y, z, rx, ry, rz or 1 … 6, not {as_shown_in_message(direction)}")
    value = term.get("value", 1.0)
    if not _is_number(value):
        raise ValueError(f"value must be a finite number, not {as_shown_in_message(value)}")
    return dict(term)


@dataclass(frozen=True)
class Rows(Entry):
    """A table of rows by name."""

    def one(self) -> Entry:
        """The entry of each row."""
        return Row()

    def parse(self, value: Any) -> dict[str, Any]:
        """As ``Entry.parse``."""
        if not isinstance(value, dict):
            raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")
        found = {}
        for name, each in value.items():
            try:
                found[name] = self.one().parse(each)
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        return found

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return {name: self.one().canonical(each) for name, each in (value or {}).items()}

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "table { name = row, … }"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "object", "additionalProperties": self.one().schema()}


@dataclass(frozen=True)
class Shape(Entry):
    """One number for each mode, or places whose values in a file's shapes are added."""

    def parse(self, value: Any) -> Any:
        """As ``Entry.parse``: a tuple of numbers, or of places."""
        several = value if isinstance(value, list) else [value]
        if isinstance(value, list) and value and all(_is_number(each) for each in value):
            return tuple(float(each) for each in value)
        if not several or not all(isinstance(each, dict) and "node" in each for each in several):
            raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")
        return tuple(_term(each) for each in several)

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return list(value) if isinstance(value, tuple) else value

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f"list of numbers, one for each mode | {PLACE}"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        number = {"anyOf": [{"type": "number"}, {"type": "object"}]}
        return {"anyOf": [{"type": "object"}, {"type": "array", "items": number, "minItems": 1}]}


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and real(value) is not None


@dataclass(frozen=True)
class Shapes(Rows):
    """A table of shapes by name."""

    def one(self) -> Entry:
        """As ``Rows.one``."""
        return Shape()

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "table { name = shape, … }"
