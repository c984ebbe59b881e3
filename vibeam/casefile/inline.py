"""One value or key as it stands in a line of TOML, for messages and the template."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any


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
