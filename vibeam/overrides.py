"""Overrides: single keys of a case given beside its file, ``{"sweep.frequency.points": 31}``."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

from vibeam.faults import shown
from vibeam.lines import Path, key_parts


class OverrideError(ValueError):
    """An override that has no place in the case."""


def override(tables: dict[str, Any], key: str, value: Any, literal: bool = False) -> Path:
    """Set (None: take away) one key in ``tables``, in place; returns its path. OverrideError if that cannot be.

    ``literal``: the value is a case's already; else text that is a TOML value is read as one.
    """
    *above, last = _parts(key)
    place: Any = tables
    path: Path = ()
    for part in above:
        path = (*path, _where(place, part))
        place = _inside(place, path[-1])
    where = _where(place, last)
    _put(place, where, value, literal)
    return (*path, where)


def _parts(key: str) -> list[str]:
    try:
        key.encode()
        return key_parts(key)
    except (AttributeError, ValueError, RecursionError):
        raise OverrideError(f"{shown(key)} is not a key such as sweep.frequency.points") from None


def _where(place: Any, part: str) -> str | int:
    """The index in a list, the name in a table."""
    if isinstance(place, dict):
        return part
    if isinstance(place, list) and part.isascii() and part.isdigit() and int(part) < len(place):
        return int(part)
    raise OverrideError(f"there is no {shown(part)} in {shown(place)}")


def _inside(place: Any, where: str | int) -> Any:
    return place.setdefault(where, {}) if isinstance(place, dict) else place[where]


def _put(place: Any, where: str | int, value: Any, literal: bool) -> None:
    if value is not None:
        place[where] = value if literal else _toml_value(value)
    elif isinstance(where, str) and where not in place:
        raise OverrideError("cannot be taken away: it is not in the case")
    else:
        del place[where]


def _toml_value(value: Any) -> Any:
    """The value as the parser would give it: numpy's numbers plain, text read as TOML where it is a TOML value."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, str):
        return _from_text(value)
    if isinstance(value, tuple | list):
        return [_toml_value(inner) for inner in value]
    if isinstance(value, Mapping):
        return {str(name): _toml_value(inner) for name, inner in value.items()}
    if not isinstance(value, bool | int | float):
        raise OverrideError(f"a {type(value).__name__} is no value of a case")
    return value


def _from_text(text: str) -> Any:
    try:
        text.encode()
        found = tomllib.loads(f"value = {text}")
    except UnicodeEncodeError:
        raise OverrideError(f"{text!a} holds characters that are not text") from None
    except (ValueError, RecursionError):
        return text
    return found["value"] if list(found) == ["value"] and "\n" not in text else text
