"""Overrides: single keys of a case given beside its file, ``{"sweep.frequency.points": 31}``; where keys come from."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibeam.casefile.fields import Count, Several
from vibeam.casefile.quantities import SI
from vibeam.casefile.tables.cases import case_table
from vibeam.casefile.tables.table import content
from vibeam.casefile.toml import LONG_KEY, TOO_DEEP, key_lines, key_parts, too_deep
from vibeam.casefile.toml_writing import name_of
from vibeam.casefile.validation import ALIKE, MAP, Reading
from vibeam.exchange.faults import OVERRIDE, CaseError, Complaint, Fault, KeyPath, as_shown_in_message, shortened

_INDEX = re.compile("[0-9]{1,9}")


class OverrideError(ValueError):
    """An override that has no place in the case."""


def override(tables: dict[str, Any], key: str, value: Any, literal: bool = False) -> tuple[dict[str, Any], KeyPath]:
    """The tables with one key set (None: taken away), and its path; OverrideError if that cannot be.

    ``literal``: the value is a case's already; else text that is a TOML value is read as one.
    """
    parts = _parts(key)
    _require_list(tables, parts)
    made, path = _overridden(tables, parts, value, literal)
    return made, path


def _overridden(place: Any, parts: list[str], value: Any, literal: bool) -> tuple[Any, KeyPath]:
    """As ``override``, of a table or list and the path in it."""
    where, made = _where(place, parts[0]), copy(place)
    if not parts[1:]:
        _put(made, where, value, literal)
        return made, (where,)
    inner = place.get(where, {}) if isinstance(place, dict) else place[where]
    made[where], path = _overridden(inner, parts[1:], value, literal)
    return made, (where, *path)


def _parts(key: str) -> list[str]:
    try:
        key.encode()
        parts = [] if LONG_KEY.search(key) else key_parts(key)
    except (AttributeError, ValueError, RecursionError):
        raise OverrideError(f"{as_shown_in_message(key)} is not a key such as sweep.frequency.points") from None
    if not parts:
        raise OverrideError(TOO_DEEP)
    return parts


def _require_list(tables: dict[str, Any], parts: list[str]) -> None:
    """OverrideError for an index into a list of tables that the case does not have."""
    field = case_table("beam").KEYS.get(parts[0])
    if field and field.many is tuple and parts[0] not in tables and _INDEX.fullmatch("".join(parts[1:2])):
        raise OverrideError(f"the case has no [[{parts[0]}]]: give the whole list, {parts[0]} = [{{ … }}]")


def _where(place: Any, part: str) -> str | int:
    """The index in a list, the name in a table."""
    if isinstance(place, dict):
        return part
    if not isinstance(place, list):
        raise OverrideError(f"there is no {as_shown_in_message(part)} in {as_shown_in_message(place)}")
    if not _INDEX.fullmatch(part):
        raise OverrideError(f"{as_shown_in_message(part)} is no index of a list; {_indices(place)}")
    if int(part) >= len(place):
        raise OverrideError(f"the index {part} is out of range; {_indices(place)}")
    return int(part)


def _indices(place: list[Any]) -> str:
    indices = "index 0 alone" if len(place) == 1 else f"the indices 0 to {len(place) - 1}"
    return f"the list has {indices}" if place else "the list is empty"


def _put(place: Any, where: str | int, value: Any, literal: bool) -> None:
    if value is not None:
        place[where] = value if literal else _shallow(value)
    elif isinstance(where, str) and where not in place:
        raise OverrideError("cannot be taken away: it is not in the case")
    else:
        del place[where]


def _shallow(value: Any) -> Any:
    """As ``_toml_value``; OverrideError for a value that is nested deeper than any of a case."""
    return tables_of([value], read=None)[0]


def tables_of(content: Any, read: Callable[[str], Any] | None = str) -> Any:
    """The tables of a case given as Python's own, or its values; OverrideError for what no case can hold."""
    try:
        found = _toml_value(content, read)
    except RecursionError:
        raise OverrideError(TOO_DEEP) from None
    if too_deep(found):
        raise OverrideError(TOO_DEEP)
    return found


def _toml_value(value: Any, read: Callable[[str], Any] | None = None) -> Any:
    """The value as the parser would give it: numpy's numbers plain, text read as TOML where it is a TOML value."""
    value = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    if isinstance(value, str):
        return (read or _from_text)(value)
    if isinstance(value, tuple | list):
        return [_toml_value(inner, read) for inner in value]
    if isinstance(value, Mapping):
        return {str(name): _toml_value(inner, read) for name, inner in value.items()}
    if not isinstance(value, bool | int | float):
        raise OverrideError(f"a {type(value).__name__} is no value of a case")
    return value


def _from_text(text: str) -> Any:
    try:
        text.encode()
        if LONG_KEY.search(text):
            raise OverrideError(TOO_DEEP)
        found = tomllib.loads(f"value = {text}")
    except UnicodeEncodeError:
        raise OverrideError(f"{text!a} holds characters that are not text") from None
    except OverrideError:
        raise
    except (ValueError, RecursionError):
        return text
    return found["value"] if list(found) == ["value"] and "\n" not in text else text


@dataclass(frozen=True)
class Places:
    """Origins of the keys of a case: lines of the file's text, or overrides."""

    file: str
    text: str
    overridden: set[KeyPath]
    unnamed_map: bool

    @cached_property
    def lines(self) -> Mapping[KeyPath, int]:
        """Line of each key of the text."""
        return key_lines(self.text)

    def fault(self, complaint: Complaint) -> Fault:
        """The fault of a key at its line, or in the override that set it."""
        path, message = complaint
        path = (MAP, *path[2:]) if self.unnamed_map and path[:2] == (MAP, MAP) else path
        key = ".".join(name_of(shortened(str(part))) for part in path)
        spelt, name = ALIKE.get(str(path[0]), ("", ""))
        written = tuple(spelt if part == name else part for part in path)
        places = [each[:length] for length in range(len(path), 0, -1) for each in (path, written)]
        if self.overridden.intersection(places):
            return Fault(OVERRIDE, None, key, message)
        for place in places:
            if place in self.lines:
                return Fault(self.file, self.lines[place], key, message)
            if any(other[: len(place)] == place for other in self.overridden):  # which opened this table
                return Fault(OVERRIDE, None, key, message)
        return Fault(self.file, None, key, message)


def with_value(tables: Any, key: str, value: float) -> Any:
    """Tables with a key at another value; CaseError where that key by itself is wrong."""
    try:
        return _replaced(tables, key_parts(key), value)
    except LookupError:
        return _read_with(tables, key, value)
    except ValueError as fault:
        raise CaseError([Fault(OVERRIDE, None, key, str(fault))]) from None


def _replaced(table: Any, path: Sequence[str], value: float) -> Any:
    """A copy of a table with the number at a path changed; LookupError where it has none."""
    if not path:
        return value
    first, *rest = path
    if isinstance(table, Mapping):
        return {**table, first: _replaced(table[first], rest, value)}
    if isinstance(table, tuple):
        at = int(first) if first.isdigit() else len(table)
        return (*table[:at], _replaced(table[at], rest, value), *table[at + 1 :])
    field = table.KEYS[first]
    name, entry = field.attribute, field.entry
    inner = getattr(table, name)
    if rest and inner is None:
        raise LookupError(first)
    if rest:
        return table.with_(**{name: _replaced(inner, rest, value)})
    if entry is None:
        raise LookupError(first)
    given = int(value) if isinstance(entry, Count) and value.is_integer() else value
    alone = isinstance(entry, Several) and isinstance(inner, tuple) and len(inner) == 1
    return table.with_(**{name: entry.read([given] if alone else given, SI)})


def _read_with(tables: Any, key: str, value: float) -> Any:
    """Tables with a key that was not there, read anew; CaseError where they cannot be read with it."""
    plain = content(tables)
    try:
        plain, _ = override(plain, key, int(value) if value.is_integer() else value, literal=True)
    except OverrideError as fault:
        raise CaseError([Fault(OVERRIDE, None, key, str(fault))]) from None
    reading = Reading(SI)
    made = reading.table(type(tables), plain)
    if reading.complaints:
        raise CaseError(Fault(OVERRIDE, None, ".".join(map(str, path)), said) for path, said in reading.complaints)
    return made
