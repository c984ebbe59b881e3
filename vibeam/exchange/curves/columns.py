"""Columns of a file of measured curves: those that are wanted, by their heads, and how a head says its unit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vibeam.exchange.curves.record import TakenColumn
from vibeam.exchange.files import LARGEST_TEXT, FormatError, shown, state_of
from vibeam.exchange.units import PLAIN, factor, known_unit, taking
from vibeam_models.arrays import Array
from vibeam_models.registry import loaded

UNSAID = "no unit in the file: taken so"
LONGEST = 300  # characters of a head with a unit: some expressions below take time with their square
SHOWN = 12  # heads named in a message
#: usual heads of a column of times
TIMES = ("time", "t", "zeit", "temps", "tiempo", "tempo", "seconds", "sec", "x_value", "x-axis")


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
    """Columns by role, of equal length, line or row of each entry, all ``heads`` of a text, ``notes`` on the file.

    ``kind``: what the file says that they are, ``"power spectral density"``; empty: it does not.
    """

    columns: Mapping[str, CurveColumn]
    lines: Sequence[int]
    heads: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    kind: str = ""


def in_si(column: CurveColumn, wanted: str, unit: str | None, cure: str, scale_unit: str = "") -> Array:
    """Values of a column in SI; a ``unit`` that is said goes before the file's; FormatError with the ``cure``."""
    try:
        with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is said of samples and points
            return column.values * factor(column.unit if unit is None else unit, wanted, scale_unit)
    except ValueError as fault:
        raise FormatError(f"column {column.head!r}: {fault}; {cure}") from None


def taken_column(column: CurveColumn, si: str, said: str | None = None) -> TakenColumn:
    """Column as it is taken: in the unit that is ``said`` for it, in its own, else in ``si``."""
    if said is not None:
        origin = "as said" + (f", not {column.unit}" if column.unit not in ("", said) else "")
        return TakenColumn(column.place, column.head, said, origin)
    return TakenColumn(column.place, column.head, column.unit or si, column.origin if column.unit else UNSAID)


def size_in(unit: str, wanted: str) -> float | None:
    """Factor from a unit to the SI unit ``wanted``; None where it is not one of that."""
    with suppress(ValueError):
        return factor(unit, wanted)
    return None


def is_unit(text: str) -> bool:
    """Test whether a word of a file is a unit that is known, and no usual name of a column or of a channel."""
    return re.split(" ?/", text.strip())[0] not in NO_UNITS and not text.startswith("in ") and _is_known(text)


def _is_known(text: str) -> bool:
    plain = taking((text.strip()[1:-1] if bracketed(text) else text).strip().replace("μ", "µ"))[0]
    return bool(re.search(r"[^\W\d]|%", plain)) and plain.casefold() not in PLAIN and known_unit(plain)


def bracketed(text: str) -> bool:
    """Test whether all of a text stands in brackets."""
    return bool(re.fullmatch(r"\s*(\[[^\[\]]+\]|\([^()]+\))\s*", text))


#: names of columns and channels that are units too: ampere, hour, minute, tonne … of a channel A, an amplitude, a least
NO_UNITS = ("A", "H", "J", "t", "amp", "Amp", "min", "Min", "MIN", "bar", "rev", "turn", "cycle", "cycles")
_UNIT = r"[A-Za-zµμ%][\w%µμ²³⁻¹*/·^ -]{0,39}|1 ?/ ?[A-Za-z]+"
_BRACKETS = re.compile(r"\[([^\[\]]*)\]|\(((?:[^()]|\([^()]*\))*)\)(?![/*·^])")
_DIVIDED = re.compile(rf"(?P<name>[^/]*?)\s*[/,]\s*(?P<unit>{_UNIT})\s*")
_ALSO_BRACKETS = str.maketrans("<>{}", "[][]")
_CHANNEL = re.compile(r"(ai|ao|ch|in|out|port|line)\d+(/.*)?", re.IGNORECASE)  # Dev1/ai0
_HOW = re.compile(r"(?<![^\W_])(rms|r\.m\.s\.|pk-pk|p-p|pp|peak[ -](?:to[ -])?peak)(?![^\W_])", re.IGNORECASE)


def split_head(head: str) -> tuple[str, str]:
    """Name and unit of a head: ``f [Hz]``, ``x / mm``, ``(g) ch1``, ``acc_g``, ``frequency_hz``; unit empty if none.

    A word on how values are taken (``taking``), ``acc rms [g]``, becomes part of the unit.
    """
    head = head.strip().translate(_ALSO_BRACKETS)
    how = _HOW.search(head)
    if len(head) > LONGEST:
        return head, ""
    if how is None:
        name, unit = _split(head)
    else:
        plain = head[: how.start()] + head[how.end() :]
        name, unit = _split(plain.strip(" _,") if how.end() == len(head) else head)
        unit = f"{_split(plain.strip(' _,'))[1]} {how[1]}".strip()
    return name or head, unit.replace("μ", "µ").replace("hz", "Hz")


def _split(head: str) -> tuple[str, str]:
    groups = [(found, (found[1] or found[2] or "").strip()) for found in _BRACKETS.finditer(head)]
    known = [each for each in groups if is_unit(each[1]) or (_is_known(each[1]) and each[0].end() == len(head))]
    odd = [each for each in groups if each[0].end() == len(head) or re.search(r"[/^²³√·]", each[1])]
    if said := known or odd[-1:]:
        name = head.replace(said[0][0][0], " ", 1)
        return " ".join(name.split()), " ".join(dict.fromkeys(unit for _, unit in said))
    if re.search(r"[][()]", _BRACKETS.sub("", head)):  # one alone: no part of a head is left out
        return head, head
    if is_unit(head) and " " not in head and (len(head) > 1 or head in "gGNsV"):
        return head, head
    if unit := _last_word(head):
        return re.sub(r"(\s+in|[\s_/,]+)$", "", head.removesuffix(unit).rstrip(" _/,")), unit.replace("_", "/")
    found = _DIVIDED.fullmatch(head)
    if found and not _CHANNEL.match(found["unit"]):
        return found["name"].strip(), found["unit"]
    return head, ""


def _last_word(head: str) -> str:
    """Unit that ends a head, behind a blank, a comma or a stroke below: ``acc_g``, ``acc_m_s2``, ``time in ms``."""
    for form in (r"[\s_,/](mm?_s(?:\^?2)?)$", r"[\s_,]([^\s_,]+)$", r"[/|]\s*([^\s/|]+)$"):
        if not (found := re.search(form, head)) or not found.start():
            continue
        word, name = found[1], head[: found.start()]
        if word == "m" or word.casefold() == "min":
            ended = head[found.start()] == "_" if word == "m" else name.casefold() in TIMES
        else:
            ended = (len(word) > 1 or word in "gGNsV") and is_unit(word.replace("_", "/"))
        if ended:
            return word
    return ""


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


@dataclass(frozen=True)
class TextForm:
    """Form of a text file; empty: found out from the file."""

    separator: str = ""
    decimal: str = ""


HERE = "vibeam.exchange.curves"
#: readers by the endings of files; of any other text
BINARY = {
    ".mat": f"{HERE}.arrays:read_matlab",
    ".tdms": f"{HERE}.tdms:read",
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".nc"), f"{HERE}.arrays:read_hdf5"),
}
READERS = (
    BINARY
    | dict.fromkeys((".uff", ".unv", ".uf", ".58"), f"{HERE}.universal:read")
    | dict.fromkeys((".wav", ".wave"), f"{HERE}.waves:read")
)


def read_columns(path: Path, wanted: Mapping[str, WantedColumn], form: TextForm | None = None) -> Columns:
    """The columns wanted of a file, by role; FormatError names what is wrong, where, and the cure."""
    state_of(path, LARGEST_TEXT)
    reader = READERS.get(path.suffix.lower())
    found: Columns = loaded(reader)(path, wanted) if reader else loaded(f"{HERE}.text:read")(path, wanted, form)
    return found


def is_text(path: Path) -> bool:
    """True where a file is read as text, by its ending."""
    return path.suffix.lower() not in READERS
