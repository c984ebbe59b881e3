"""A case written back as TOML: SI numbers, every default said, so that equal cases have equal texts."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from pydantic import BaseModel


def canonical_text(case: BaseModel, without: Collection[str] = ()) -> str:
    """The case as text that loads as the same case, less the tables and keys in ``without``.

    ``TABLE.*.KEY`` is a key of every table that goes by that name.
    """
    content = case.model_dump(by_alias=True, exclude_none=True, exclude=_nested(without))
    return "\n".join(_tables("", content)).lstrip("\n") + "\n"


def _nested(without: Collection[str]) -> dict[str, Any]:
    """Dotted names as pydantic excludes them: {table: True} as a whole, {table: {"__all__": {key: True}}} its keys."""
    found: dict[str, Any] = {name: True for name in without if "." not in name}
    for table, _, key in (name.split(".") for name in without if "." in name):
        if found.get(table) is not True:
            found.setdefault(table, {"__all__": {}})["__all__"][key] = True
    return found


def to_toml(value: Any) -> str:
    """One value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{name_of(name)} = {to_toml(inner)}" for name, inner in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(to_toml, value))}]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)


def name_of(key: str) -> str:
    """A key as TOML: in quotes where it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else to_toml(key)


def _tables(name: str, content: Mapping[str, Any]) -> Iterator[str]:
    """A table's own values, then the tables in it; the grid of a sweep stays in its line."""
    inner = {key: value for key, value in content.items() if _is_table(key, value)}
    if name and len(inner) < len(content):
        yield f"\n[{name}]"
    yield from (f"{name_of(key)} = {to_toml(value)}" for key, value in content.items() if key not in inner)
    for key, value in inner.items():
        path = f"{name}.{name_of(key)}" if name else name_of(key)
        yield from _tables(path, value) if isinstance(value, Mapping) else _array(path, value)


def _array(path: str, tables: tuple[Mapping[str, Any], ...]) -> Iterator[str]:
    for table in tables:
        yield f"\n[[{path}]]"
        yield from (f"{name_of(key)} = {to_toml(value)}" for key, value in table.items())


def _is_table(key: str, value: Any) -> bool:
    if isinstance(value, Mapping):
        return key != "frequency"
    return isinstance(value, tuple) and (not value or isinstance(value[0], Mapping))
