"""Columns of a file of measured curves: those that are wanted, by their heads, and how a head says its unit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from vibeam.exchange.curves.record import factor
from vibeam.exchange.files import FormatError, shown
from vibeam_models.arrays import Array

SHOWN = 12  # heads named in a message
TIMES = ("time", "t", "zeit", "temps", "tiempo", "tempo", "seconds", "sec")  # usual heads of a column of times


class HeadError(FormatError):
    """File without a column that is wanted; ``heads``: those that it has."""

    def __init__(self, message: str, heads: Sequence[str], line: int | None = None) -> None:
        self.heads = tuple(heads)
        super().__init__(message, line)


@dataclass(frozen=True)
class WantedColumn:
    """Column that is wanted: its head or number from 1 (any of ``names``), whether ``needed``, whether of ``words``."""

    names: tuple[str | int, ...]
    needed: bool = True
    words: bool = False


@dataclass(frozen=True, eq=False)
class CurveColumn:
    """Column that was found: its head, its unit (empty: not said), its values, NaN where empty; or its ``words``.

    ``place``: where it is in the file, ``"column 2"``; ``origin``: where the unit is from, empty: from the head.
    ``complex_values``: those whose moduli the values are; None: the file has real ones.
    """

    head: str
    unit: str
    values: Array
    words: tuple[str, ...] = ()
    place: str = ""
    origin: str = ""
    complex_values: Array | None = None


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns by role, of equal length, the line or row of each entry, and all ``heads`` of a text.

    ``kind``: what the file says that they are, ``"power spectral density"``; empty: it does not.
    """

    columns: Mapping[str, CurveColumn]
    lines: Sequence[int]
    heads: tuple[str, ...] = ()
    kind: str = ""


def in_si(column: CurveColumn, wanted: str, unit: str | None, cure: str, scale_unit: str = "") -> Array:
    """Values of a column in SI; a ``unit`` that is said goes before the file's; FormatError with the ``cure``."""
    try:
        with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is said of samples and points
            return column.values * factor(column.unit if unit is None else unit, wanted, scale_unit)
    except ValueError as fault:
        raise FormatError(f"column {column.head!r}: {fault}; {cure}") from None


def size_in(unit: str, wanted: str) -> float | None:
    """Factor from a unit to the SI unit ``wanted``; None where it is not one of that."""
    with suppress(ValueError):
        return factor(unit, wanted)
    return None


_UNIT = r"[A-Za-zµμ%][\w%µμ²³⁻¹*/·^ -]{0,39}|1 ?/ ?[A-Za-z]+"

_HEADS = (
    re.compile(r"(?P<name>.*?)\s*[\[(]\s*(?P<unit>[^\[\]()]*?)\s*[\])]\s*", re.DOTALL),
    re.compile(rf"(?P<name>[^/]*?)\s*[/,]\s*(?P<unit>{_UNIT})\s*"),
    re.compile(r"(?P<name>.*?)_(?P<unit>k?[Hh]z|[muµ]?m)"),
)


def split_head(head: str) -> tuple[str, str]:
    """Name and unit of a head: ``f [Hz]``, ``x (mm)``, ``x / mm``, ``f, Hz``, ``frequency_hz``; unit empty if none."""
    for form in _HEADS:
        if found := form.fullmatch(head.strip()):
            return found["name"].strip(), found["unit"].replace("μ", "µ").replace("hz", "Hz")
    return head.strip(), ""


def find(heads: Sequence[str], wanted: WantedColumn) -> int | None:
    """Place of the head that is wanted, by its whole text or its name without unit; FormatError where it is twice."""
    for name in wanted.names:
        if isinstance(name, int):
            return name - 1 if 0 < name <= len(heads) else None
        for known in (_whole, _named):
            places = [place for place, head in enumerate(heads) if known(head) == _whole(name)]
            if len(places) > 1:
                raise FormatError(f"has {len(places)} columns {name!r}: say which by its number, from 1")
            if places:
                return places[0]
    return None


def _whole(head: str) -> str:
    return " ".join(head.split()).casefold()


def _named(head: str) -> str:
    return _whole(split_head(head)[0])


def missing(
    heads: Iterable[str], wanted: Mapping[str, WantedColumn], found: Mapping[str, int | None]
) -> HeadError | None:
    """Message about columns that are needed and not there; None where all are."""
    absent = [role for role, each in wanted.items() if each.needed and found.get(role) is None]
    if not absent:
        return None
    names = list(heads)
    there = ", ".join(map(shown, names[:SHOWN])) + (" …" if len(names) > SHOWN else "")
    first = wanted[absent[0]].names[0]
    what = f"number {first}" if isinstance(first, int) else repr(first)
    cure = ", ".join(f'{role} = "…"' for role in absent)
    told = f"has no column {what}: there are {there or 'none'}"
    return HeadError(f"{told}; say which in the case: columns = {{ {cure} }}", names)
