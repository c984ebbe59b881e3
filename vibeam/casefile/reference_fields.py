"""Entries of a reference: heads of its columns, their units, the scale of its values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vibeam.case.faults import as_shown_in_message, suggest
from vibeam.case.reference_form import ROLES, known_unit
from vibeam.case.reference_record import QUANTITIES
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import NUMBER_WITH_UNIT, Entry

NAMES = (ROLES[0], *QUANTITIES, *ROLES[1:])


@dataclass(frozen=True)
class Heads(Entry):
    """A table of columns: the head of each, or its number from 1."""

    def parse(self, value: Any) -> dict[str, str | int]:
        """As ``Entry.parse``."""
        for name, head in _items(value, self).items():
            if isinstance(head, bool) or not isinstance(head, str | int) or not head:
                raise ValueError(
                    f"{name}: must be a head in quotes or a column's number, not {as_shown_in_message(head)}"
                )
            if isinstance(head, int) and not 0 < head <= 10_000:
                raise ValueError(f"{name}: columns are numbered from 1, not {as_shown_in_message(head)}")
        return dict(value)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return '{ frequency = "head", amplitude = 2 }'

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return _schema({"anyOf": [{"type": "string"}, {"type": "integer", "minimum": 1}]})


@dataclass(frozen=True)
class Units(Entry):
    """A table of the units of columns."""

    def parse(self, value: Any) -> dict[str, str]:
        """As ``Entry.parse``."""
        for name, unit in _items(value, self).items():
            if not isinstance(unit, str) or not known_unit(unit):
                raise ValueError(f'{name}: {as_shown_in_message(unit)} is no unit that is known: write "mm"')
        return dict(value)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return '{ frequency = "Hz", amplitude = "mm" }'

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return _schema({"type": "string"})


def _items(value: Any, entry: Entry) -> dict[str, Any]:
    if not isinstance(value, dict) or not value:
        raise ValueError(f"must be {entry.describe()}, not {as_shown_in_message(value)}")
    for name in value:
        if name not in NAMES:
            raise ValueError(f"{as_shown_in_message(name)} is no column of a reference; {suggest(name, NAMES)}")
    return value


def _schema(each: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": dict.fromkeys(NAMES, each),
        "minProperties": 1,
        "additionalProperties": False,
    }


@dataclass(frozen=True)
class Scale(Entry):
    """A number other than 0, with a unit where it turns one quantity into another: ``"2 mm/V"``."""

    def parse(self, value: Any) -> tuple[float, str]:
        """As ``Entry.parse``: number and unit."""
        text, unit = value, ""
        if isinstance(value, str):
            text, _, unit = value.strip().partition(" ")
            unit = unit.strip().replace("μ", "µ")
            if unit and not known_unit(unit):
                raise ValueError(f'{as_shown_in_message(value)} has an unknown unit: write "2 mm/V"')
        number = units.to_si(text, units.RATIO)
        if not number:
            raise ValueError("is 0: no value would be left")
        return number, unit

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "number ≠ 0 | mm/V …"

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value if not isinstance(value, tuple) else f"{value[0]!r} {value[1]}" if value[1] else value[0]

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": NUMBER_WITH_UNIT}]}
