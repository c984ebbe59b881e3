"""Places of the keys of a case: lines of its file, or overrides; those of its one map without a name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from vibeam.casefile.toml_writing import name_of
from vibeam.exchange.faults import OVERRIDE, Complaint, Fault, KeyPath, shortened

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


@dataclass(frozen=True)
class Places:
    """Origins of the keys of a case: lines of the file, or overrides."""

    file: str
    lines: Mapping[KeyPath, int]
    overridden: set[KeyPath]
    unnamed_map: bool

    def fault(self, complaint: Complaint) -> Fault:
        """The fault of a key at its line, or in the override that set it."""
        path, message = complaint
        path = as_written(path) if self.unnamed_map else path
        key = ".".join(name_of(shortened(str(part))) for part in path)
        places = [path[:length] for length in range(len(path), 0, -1)]
        if self.overridden.intersection(places):
            return Fault(OVERRIDE, None, key, message)
        for place in places:
            if place in self.lines:
                return Fault(self.file, self.lines[place], key, message)
            if self._opened(place):
                return Fault(OVERRIDE, None, key, message)
        return Fault(self.file, None, key, message)

    def _opened(self, place: KeyPath) -> bool:
        """Test whether an override opened this table."""
        return any(path[: len(place)] == place for path in self.overridden)
