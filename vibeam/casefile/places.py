"""Where the keys of a case come from: lines of its file, or overrides."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from vibeam.case.faults import OVERRIDE, Complaint, Fault, KeyPath, shortened
from vibeam.casefile.inline import name_of
from vibeam.casefile.unnamed_map import as_written


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
