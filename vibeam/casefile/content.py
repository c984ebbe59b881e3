"""Content of a declared case as plain data, to be written as TOML or hashed: SI numbers, every default included."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from hashlib import sha256
from typing import Any

from pydantic import BaseModel

from vibeam.casefile.tables.table import note


def content(table: BaseModel, *parts: str, without: Collection[str] = ()) -> dict[str, Any]:
    """Keys of a table that belong to all of ``parts`` (``"physics"``, ``"numbers"``), less those in ``without``."""
    aside = _outside(table, parts) | dict.fromkeys(without, True)
    return table.model_dump(mode="json", by_alias=True, exclude_none=True, exclude=aside)


def _outside(table: BaseModel, parts: Collection[str]) -> dict[str, Any]:
    """Keys that do not belong to all of ``parts``, as pydantic excludes them."""
    found: dict[str, Any] = {}
    for name, field in type(table).model_fields.items():
        value = getattr(table, name)
        absent = note(field, "effect") and value == ()  # a list of tables of which the case names none
        if absent or any(note(field, part) is False for part in parts):
            found[name] = True
        elif isinstance(value, dict):
            named = {key: _outside(each, parts) for key, each in value.items() if isinstance(each, BaseModel)}
            found |= {name: named} if any(named.values()) else {}
    return found


def toml_text(content: Mapping[str, Any]) -> str:
    """Content as a case file."""
    import tomli_w

    return tomli_w.dumps(content)


def digest(*content: Any) -> str:
    """SHA-256, in hexadecimal, of content as JSON with sorted keys."""
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
