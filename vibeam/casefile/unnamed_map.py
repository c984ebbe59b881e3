"""A case's one map without a name: [map] with the keys of a map, which is [map.map]."""

from __future__ import annotations

from typing import Any

from vibeam.case.faults import KeyPath

MAP = "map"


def name_map(tables: dict[str, Any]) -> bool:
    """Give the map that [map] is, where it has keys that are no tables, the name "map", in place; whether there is one.

    No key of a map is a table, so that whatever is one is a map with a name. A name that is taken stays as it was.
    """
    given = tables.get(MAP)
    if not isinstance(given, dict):
        return False
    own = {key: value for key, value in given.items() if not isinstance(value, dict)}
    if not own or MAP in given:
        return False
    tables[MAP] = {MAP: own} | {key: value for key, value in given.items() if key not in own}
    return True


def as_written(path: KeyPath) -> KeyPath:
    """The path of a key of the map without a name as the file has it."""
    return (MAP, *path[2:]) if path[:2] == (MAP, MAP) else path
