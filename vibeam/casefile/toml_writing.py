"""TOML as it is written: a whole case, one value or key, the text of a case with the values of some keys replaced."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from vibeam.casefile.toml import key_parts, value_spans
from vibeam.exchange.faults import KeyPath

LINE = 94  # most letters of a table that stands inside a list


def toml_text(content: Mapping[str, Any]) -> str:
    """Content as a case file: of each table its values, then the tables inside it."""
    return "\n".join(_sections(content))


def _sections(table: Mapping[str, Any], name: str = "", listed: bool = False) -> Iterator[str]:
    """Text of a table, then of each inside it; a table of tables alone has no header."""
    inner = {key: tables for key, value in table.items() if (tables := _tables_of(value))}
    values = "".join(f"{name_of(key)} = {_over_lines(value)}\n" for key, value in table.items() if key not in inner)
    if name and (values or listed or not inner):
        values = (f"[[{name}]]\n" if listed else f"[{name}]\n") + values
    if values:
        yield values
    for key, tables in inner.items():
        for each in tables:
            yield from _sections(each, f"{name}.{name_of(key)}" if name else name_of(key), each is not table[key])


def _tables_of(value: Any) -> list[Mapping[str, Any]]:
    """The tables with headers of their own that a value is; none of a list of short tables, or of anything else."""
    if isinstance(value, Mapping):
        return [value]
    listed = isinstance(value, list | tuple) and all(isinstance(each, Mapping) for each in value)
    return list(value) if listed and not all(map(_is_short, value)) else []


def _is_short(table: Mapping[str, Any]) -> bool:
    return len(to_toml(table)) <= LINE and not any(isinstance(each, list | tuple) for each in table.values())


def _over_lines(value: Any, indent: str = "") -> str:
    """One value as TOML, each item of a list in a line of its own."""
    if not (isinstance(value, list | tuple) and value):
        return to_toml(value)
    items = "".join(f"{indent}    {_over_lines(each, indent + '    ')},\n" for each in value)
    return f"[\n{items}{indent}]"


def with_values(text: str, values: Mapping[str, str]) -> str:
    """Replace values by TOML text, ``{"stop.gap": '"0.1 mm"'}``; a key that is not there is added to its table.

    ValueError for a key that is not there and whose table is written inline.
    """
    spans, headers = value_spans(text)
    edits = [_edit(text, spans, headers, key, value) for key, value in values.items()]
    for begin, end, new in sorted(edits, reverse=True):
        text = text[:begin] + new + text[end:]
    return text


def _edit(
    text: str, spans: Mapping[KeyPath, tuple[int, int]], headers: Mapping[KeyPath, int], key: str, value: str
) -> tuple[int, int, str]:
    """Begin, end, and what is written there."""
    path: KeyPath = tuple(int(part) if part.isdigit() else part for part in key_parts(key))
    if path in spans:
        return *spans[path], value
    table, name = path[:-1], path[-1]
    if table in headers:
        below = (text + "\n").index("\n", headers[table])
        return below, below, f"\n{name} = {value}"
    if any(each[: len(table)] == table for each in (*spans, *headers)):
        raise ValueError(f"{key} is not in the file: write it there, with any value of its bounds")
    end = len(text)
    return end, end, f"\n[{'.'.join(map(str, table))}]\n{name} = {value}\n"


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


_QUANTITY = re.compile(r"[+-]?[0-9.]+(?:e[+-]?[0-9]+)? (?=\S)")


def to_fill_in(example: Any) -> str:
    """A value as TOML with … in place of the numbers that are another rig's; counts stay."""
    if isinstance(example, Mapping):
        return "{ " + ", ".join(f"{name_of(name)} = {to_fill_in(inner)}" for name, inner in example.items()) + " }"
    if isinstance(example, list | tuple):
        return f"[{', '.join(map(to_fill_in, example))}]"
    if isinstance(example, str):
        return to_toml(_QUANTITY.sub("… ", example, count=1))
    return "…" if isinstance(example, float) else to_toml(example)


def name_of(key: str) -> str:
    """A key as TOML: in quotes where it needs them."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else to_toml(key)
