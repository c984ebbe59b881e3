"""Entries of the case file that hold a table: values by name, dotted keys, a model, places of a structure, files."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from vibeam.casefile.fields import Entry, JsonSchema, Several, ValueEntry
from vibeam.casefile.quantities import UnitSystem
from vibeam.casefile.toml import key_parts
from vibeam.casefile.toml_writing import name_of
from vibeam.exchange.faults import as_shown_in_message, suggest
from vibeam.exchange.files import dotted
from vibeam_models.arguments import real


def _options(value: Any) -> dict[str, str | float] | None:
    if not isinstance(value, dict):
        return None
    wrong = [name for name, each in value.items() if not _is_plain(each)]
    if wrong:
        raise ValueError(f"{', '.join(wrong)}: must be a finite number or text in quotes")
    return dict(value)


def _is_plain(value: Any) -> bool:
    try:
        return isinstance(value, str) or (isinstance(value, int | float) and math.isfinite(value))
    except OverflowError:  # a whole number beyond the range of doubles
        return False


#: names and plain values, whose meaning is another's: a solver's options
OPTIONS = ValueEntry(
    _options,
    "table { name = value, … }",
    {"type": "object", "additionalProperties": {"type": ["number", "string", "boolean"]}},
)


@dataclass(frozen=True)
class TableOr(Entry):
    """A table of its own, or a list instead."""

    table: Any
    several: Several

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``, of the list alone: the table is read by its declaration."""
        if not isinstance(value, list):
            raise ValueError(
                f"must be {{ {', '.join(self.table.KEYS)} }} or a {self.describe()}, not {as_shown_in_message(value)}"
            )
        return self.several.read(value, units)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return self.several.describe()

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``, of the list alone."""
        return self.several.schema()


def settings(of: str = "value") -> ValueEntry:
    """Entry of dotted keys with values as in a case, or another ``of``; nested tables mean the same."""

    def read(value: Any) -> dict[str, Any] | None:
        if not isinstance(value, dict):
            return None
        found = dict(flat(value))
        if not found:
            raise ValueError("sets nothing: name a key, or leave it away")
        return found

    return ValueEntry(read, f'table {{ "stop.gap" = {of}, … }}', {"type": "object", "minProperties": 1})


def flat(tables: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Dotted keys and their values; a key in quotes that holds dots is the path that it spells."""
    return dotted(tables, spelt=_spelt)


def _spelt(name: str) -> str:
    try:
        key_parts(name)
    except (ValueError, RecursionError):
        return name_of(name)
    return name


DIRECTIONS = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
PLACE = '{ node = 12, direction = "z" }'


def file_name(name: str) -> str:
    """A file's name as shown in a message: in quotes where it is long, or holds characters that are not shown."""
    return name if name.isprintable() and len(name) <= 60 else as_shown_in_message(name)


def _in_file(value: Any, fault: str) -> dict[str, str]:
    if not (isinstance(value, dict) and isinstance(value.get("file"), str) and value["file"]):
        raise ValueError(fault)
    for key, each in value.items():
        if key not in ("file", "name"):
            raise ValueError(f"unknown key {as_shown_in_message(key)}; {suggest(str(key), ('file', 'name'))}")
        if not isinstance(each, str):
            raise ValueError(f"{key} must be text in quotes, not {as_shown_in_message(each)}")
    return dict(value)


def _matrix_file(value: Any) -> dict[str, str]:
    if isinstance(value, str) and value:
        return {"file": value}
    return _in_file(value, f"must be {FILE}, not {as_shown_in_message(value)}")


FILE = 'file | { file = "…", name = "…" }'
_FILE: JsonSchema = {"type": "string"}
_IN_FILE = {"type": "object", "properties": {"file": _FILE, "name": _FILE}, "required": ["file"]}

#: a matrix in a file: its name, or a table with the file and the name of the matrix in it
MATRIX_FILE = ValueEntry(_matrix_file, FILE, {"anyOf": [_FILE, _IN_FILE]})


def _as_list(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def row(words: tuple[str, ...] = ()) -> ValueEntry:
    """Entry of a row of coordinates: one of them, some with their values, or an array in a file; or one of ``words``.

    What it reads is a word, a table that names a file, or a tuple of tables, one for each coordinate.
    """
    kinds = ["number of a coordinate", PLACE, "list of { coordinate = 3, value = 0.5 }", 'file | { file = "…" }']
    said = " | ".join([*(f'"{word}"' for word in words), *kinds])
    one = [{"type": "integer", "minimum": 1}, {"type": "object"}]
    several = {"type": "array", "items": {"anyOf": one}, "minItems": 1}

    def read(value: Any) -> Any:
        if isinstance(value, str):
            return value if value in words else {"file": value}
        if isinstance(value, dict) and "file" in value:
            return _in_file(value, f"must be {said}")
        if isinstance(value, list) and not value:
            raise ValueError(f"an empty list reads nothing: it must be {said}")
        terms = [{"coordinate": each} if _is_whole(each) else each for each in _several(value)]
        return tuple(map(_term, terms)) if all(isinstance(each, dict) for each in terms) else None

    return ValueEntry(read, said, {"anyOf": [{"type": "string"}, *one, several]}, _as_list)


def _several(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


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


def _shape(value: Any) -> tuple[Any, ...] | None:
    if isinstance(value, list) and value and all(_is_number(each) for each in value):
        return tuple(float(each) for each in value)
    several = _several(value)
    places = several and all(isinstance(each, dict) and "node" in each for each in several)
    return tuple(_term(each) for each in several) if places else None


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and real(value) is not None


_NUMBER = {"anyOf": [{"type": "number"}, {"type": "object"}]}

#: one number for each mode, or places whose values in a file's shapes are added
SHAPE = ValueEntry(
    _shape,
    f"list of numbers, one for each mode | {PLACE}",
    {"anyOf": [{"type": "object"}, {"type": "array", "items": _NUMBER, "minItems": 1}]},
    _as_list,
)


def by_name(one: ValueEntry, called: str) -> ValueEntry:
    """Entry of a table of such entries by name."""

    def read(value: Any) -> dict[str, Any] | None:
        if not isinstance(value, dict):
            return None
        found = {}
        for name, each in value.items():
            try:
                found[name] = one.parse(each)
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None
        return found

    def written(value: Any) -> dict[str, Any]:
        return {name: one.canonical(each) for name, each in (value or {}).items()}

    schema = {"type": "object", "additionalProperties": one.schema()}
    return ValueEntry(read, f"table {{ name = {called}, … }}", schema, written)


ROWS, SHAPES = by_name(row(), "row"), by_name(SHAPE, "shape")
