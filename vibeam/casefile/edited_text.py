"""Text of a case file with the values of some keys replaced; comments, order and all other values stay."""

from __future__ import annotations

from collections.abc import Mapping

from vibeam.case.faults import KeyPath
from vibeam.casefile.toml import key_parts, value_spans


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
