"""Reference files: where their columns are, in which units, what is done with their values; lines as cells."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from os.path import relpath
from pathlib import Path

from vibeam.case.faults import CaseError, Fault
from vibeam.case.units import unit_size
from vibeam.exchange.files import LARGEST_TEXT, FormatError, numbered, reason, state_of

LONGEST = 100_000  # characters of a line
LINES = 2_100_000  # one for each direction of the longest sweep, and comments


def file_fault(path: Path) -> str | None:
    """Reason why a path cannot be read as a reference file, or None; it is not opened."""
    try:
        state_of(path, LARGEST_TEXT)
    except FormatError as fault:
        return fault.message
    return None


def cells_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of every line but empty ones and comments; CaseError where the file is unreadable."""
    number = 0
    try:
        state_of(path, LARGEST_TEXT)
        with path.open(encoding="utf-8-sig") as file:
            for number, line in numbered(file, LONGEST, LINES):
                if line.strip() and not line.startswith("#"):
                    yield number, [cell.strip() for cell in next(csv.reader([line]))]
    except FormatError as fault:
        raise CaseError([fault_in(path, fault.line, fault.message)]) from None
    except UnicodeDecodeError:
        raise CaseError([fault_in(path, None, "cannot be read: it is not UTF-8 text")]) from None
    except OSError as error:
        raise CaseError([fault_in(path, None, f"cannot be read: {reason(error)}")]) from None
    except csv.Error as error:
        raise CaseError([fault_in(path, number, f"is no line of a table: {error}")]) from None


def fault_in(path: Path, line: int | None, message: str, column: str = "") -> Fault:
    """Fault in a reference file, named by the shorter of its paths."""
    return Fault(shortest(path), line, column, message)


def shortest(path: Path) -> str:
    """Path from the working directory where that is shorter, else unchanged."""
    try:
        return min(str(path), relpath(path), key=len)
    except (OSError, ValueError):  # the working directory does not exist
        return str(path)


GRAVITY = 9.80665  # m/s² of a unit g of acceleration
ROLES = ("frequency", "direction", "period", "uncertainty")  # columns besides that of the quantity


@dataclass(frozen=True)
class ReferenceForm:
    """Columns of a reference file and their treatment: value = ``scale`` · column + ``offset``, in ``unit``.

    ``columns``: head, or number from 1, of each role: ``frequency``, the quantity's name, ``uncertainty``,
    ``direction``, ``period``. ``units`` of the roles go before what heads say; a column without one is in SI.
    ``unit``: the SI unit of the quantity, ``"1"`` in a case without units. ``scale_unit``: unit of the scale, such as
    ``mm/V``. ``window``: frequencies (Hz) kept. ``uncertainty``: standard uncertainty (one standard deviation) of every
    value, ``relative`` to it or in ``unit``. Empty ``separator`` or ``decimal``: found out from the file.
    """

    columns: Mapping[str, str | int] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    unit: str = ""
    scale: float = 1.0
    scale_unit: str = ""
    offset: float = 0.0
    window: tuple[float, float] | None = None
    uncertainty: float | None = None
    relative: bool = False
    separator: str = ""
    decimal: str = ""

    @property
    def own(self) -> bool:
        """Whether a file may be of vibeam's own form: no columns, units or signs are said."""
        return not (self.columns or self.units or self.separator or self.decimal or self.scale_unit)


def factor(unit: str, wanted: str, scale_unit: str = "") -> float:
    """Factor from a column's unit, times ``scale_unit``, to the SI unit ``wanted``; ValueError where they do not suit.

    A column without a unit is in ``wanted``; with a scale in volts.
    """
    if unit in ("g", "gn") and wanted == "m/s^2":
        return GRAVITY
    size, dimension = _sized(unit.replace("μ", "µ") if unit else "V" if "V" in scale_unit else "")
    if not unit and not scale_unit:
        return 1.0
    more, further = _sized(scale_unit)
    aim, target = _sized(wanted)
    product = _times(dimension, further)
    if product != target:
        by = f" times the scale's {scale_unit!r}" if scale_unit else ""
        raise ValueError(f"the unit {unit!r}{by} is not one of {wanted or 'a plain number'}")
    return float(size * more / aim)


def _sized(unit: str) -> tuple[Decimal, dict[str, float]]:
    if unit in ("", "1", "-"):
        return Decimal(1), {}
    found = unit_size(unit)
    if found is None:
        raise ValueError(f"the unit {unit!r} is not known")
    return found


def _times(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    powers = {name: one.get(name, 0.0) + other.get(name, 0.0) for name in {*one, *other}}
    return {name: power for name, power in powers.items() if power}


def known_unit(unit: str) -> bool:
    """Test whether a unit is known, ``%`` and a plain number (``1``) among them."""
    return unit in ("1", "%", "g") or unit_size(unit.replace("μ", "µ")) is not None
