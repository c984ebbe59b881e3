"""LabVIEW's measurement files (.lvm): two heads, channels, times by X0 and Delta_X or by columns, segments."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vibeam.exchange.curves.cells import number, numeric, one_unit, plain_table
from vibeam.exchange.curves.columns import TIMES, Columns, CurveColumn, WantedColumn, find, is_unit, missing, split_head
from vibeam.exchange.files import FormatError, Line, read_by, shown
from vibeam_models.arrays import Array

END, CLOCK, COMMENT = "***End_of_Header***", "X_Value", "Comment"
MARKS = {"Tab": "\t", "Comma": ","}
FILE = {
    "Separator": tuple(MARKS), "Decimal_Separator": (".", ","), "Multi_Headings": ("Yes", "No"),
    "X_Columns": ("No", "One", "Multi"),
}  # fmt: skip
SEGMENT = re.compile(r"Channels|Samples|Date|Time|[XY]_Unit_Label|[XY]_Dimension|X0|Delta_X|Notes|(Test|UUT)_.*")
OVER = {"time": ("s", TIMES), "frequency": ("Hz", ("frequency", "freq", "f", "hz"))}  # unit, names, by X_Dimension
ROUNDED = 0.3  # of a step: times that lost digits when they were written


@dataclass
class Segment:
    """Segment: entries of the file's head and of its own, with their line; heads of its columns; lines of numbers."""

    file: Mapping[str, str]
    entries: dict[str, tuple[int, list[str]]] = field(default_factory=dict)
    heads: list[str] = field(default_factory=list)
    rows: list[Line] = field(default_factory=list)

    def entry(self, name: str, column: int) -> str:
        """Entry of the head for a column; of all where there is one alone."""
        cells = self.entries.get(name, (0, []))[1]
        own = cells[column - 1] if 0 < column <= len(cells) else ""
        return own or (cells[0] if len(list(filter(None, cells))) == 1 else "")

    def number(self, name: str, column: int, absent: float = 0.0) -> float:
        """Entry that is a number."""
        text = self.entry(name, column)
        return self.value(self.entries[name][0], text) if text else absent

    def value(self, line: int, text: str) -> float:
        """Number with the decimal sign of the file, NaN of an empty cell."""
        sign = self.file.get("Decimal_Separator", ".")
        if ("," if sign == "." else ".") in text:
            raise FormatError(f"{shown(text)} is not a number with the decimal sign {sign!r} of the file", line)
        return number((line, text), sign)


def read(lines: Sequence[Line], wanted: Mapping[str, WantedColumn]) -> Columns:
    """The columns wanted of all segments; FormatError, with the line, of what is missing, or unlike the format."""
    segments = _segments(lines)
    first, heads = segments[0], segments[0].heads
    found = {role: find(heads, each) for role, each in wanted.items() if role != "frequency"}
    value = next((place for place in found.values() if place is not None), 0)
    if "frequency" in wanted:
        found["frequency"] = _abscissa(first, wanted["frequency"], value)
    if fault := missing(dict.fromkeys(each for each in heads if each != COMMENT), wanted, found):
        raise fault
    places = {role: place for role, place in found.items() if place is not None}
    parts, notes, kept = list[dict[str, Array]](), list[str](), list[int]()
    for segment in segments:
        part = _numbers(segment, places, value)
        if "frequency" in part:
            part["frequency"] = _times(segment, part["frequency"], value)
            if parts:
                later = _stamp(segment, value) - _stamp(first, value)
                part["frequency"] += _shift(segment, parts[-1]["frequency"], part["frequency"], later)
        parts.append(part)
        notes += _counted(segment, value)
        kept += [line for line, _ in segment.rows[: len(next(iter(part.values())))]]
    notes += [f"{len(segments)} segments"] * (len(segments) > 1)
    columns = {role: _column(first, place, value, np.concatenate([part[role] for part in parts]), role == "frequency")
               for role, place in places.items()}  # fmt: skip
    return Columns(columns, tuple(kept), tuple(heads), tuple(notes))


def _segments(lines: Sequence[Line]) -> list[Segment]:
    """Segments with their heads and lines of numbers."""
    mark = next((found for _, text in lines if (found := re.match(r"Separator.(Tab|Comma)\b", text))), None)
    said, segments, state = {"Separator": "Tab" if mark is None else mark[1]}, list[Segment](), "file"
    for line, text in lines[1:]:
        cells = [cell.strip() for cell in text.split(MARKS[said["Separator"]])]
        if not any(cells):
            continue
        if cells[0] == END and state in ("file", "head"):
            segments += [Segment(said)] * (state == "file")
            state = "head" if state == "file" else "names"
        elif cells[0].startswith("***"):
            raise FormatError(f"{shown(cells[0])} is not at its place in a LabVIEW file", line)
        elif state == "names":
            segments[-1].heads.extend(_channels(segments[-1], cells, line))
            state = "rows"
        elif state == "rows" and (not cells[0] or numeric(cells[0])):
            segments[-1].rows.append((line, text))
        elif state == "file":
            said[cells[0]] = value = "".join(cells[1:2])
            if value not in FILE.get(cells[0], (value,)):
                raise FormatError(f"{cells[0]} is {shown(value)}, and must be one of {', '.join(FILE[cells[0]])}", line)
        else:
            if not SEGMENT.fullmatch(cells[0]):
                raise FormatError(f"{shown(text)} is no row of numbers, and no entry of a head: delete it", line)
            segments += [Segment(said)] * (state == "rows")
            segments[-1].entries[cells[0]], state = (line, cells[1:]), "head"
    if not segments or not all(each.rows for each in segments):
        raise FormatError(f"has no numbers below its heads, each of which ends with {END}", lines[-1][0])
    return segments


def _channels(segment: Segment, cells: list[str], line: int) -> list[str]:
    """Heads of the columns; FormatError where they are not as many as the head says."""
    heads = cells[: 1 + max(place for place, each in enumerate(cells) if each or not place)]
    channels = len([each for each in heads if each not in (CLOCK, COMMENT)])
    if heads[0] != CLOCK or channels != segment.number("Channels", 1):
        said = segment.entry("Channels", 1) or "no number of"
        raise FormatError(f"has {channels} heads of channels behind {shown(heads[0])}, and {said} Channels above", line)
    return heads


def _abscissa(segment: Segment, wanted: WantedColumn, value: int) -> int | None:
    """Column of the abscissa of a value: the next one to the left, by any usual name of its dimension."""
    dimension = (segment.entry("X_Dimension", value) or "Time").casefold()
    usual = {CLOCK.casefold(), dimension, *OVER.get(dimension, ("", ()))[1]}
    if any(isinstance(name, str) and name.casefold() in usual for name in wanted.names):
        return max(place for place, head in enumerate(segment.heads[: value + 1]) if head == CLOCK)
    return find(segment.heads, wanted)


def _numbers(segment: Segment, places: Mapping[str, int], value: int) -> dict[str, Array]:
    """Numbers by role, up to the last one of the value; NaN where a cell is empty."""
    most, found = len(segment.heads), {role: np.full(len(segment.rows), np.nan) for role in places}
    mark, least = MARKS[segment.file["Separator"]], 1 + max(places.values())
    first = [*segment.rows[0][1].split(mark), *[""] * most]
    full = {role: place for role, place in places.items() if role != "frequency" or first[place].strip()}
    point = segment.file.get("Decimal_Separator") != ","
    texts = [text for _, text in segment.rows]
    if point and (plain := plain_table(texts, mark, range(least, most + 1), full)) is not None:
        return found | plain
    for row, (line, text) in enumerate(segment.rows):
        cells = text.split(mark)
        if len(cells) < least or (len(cells) > most and any(map(numeric, cells[most:]))):
            raise FormatError(f"{len(cells)} cells for {most} columns, {shown(text)}: complete the line", line)
        for role, place in places.items():
            found[role][row] = segment.value(line, cells[place].strip())
    there = next(np.flatnonzero(~np.isnan(found[role])) for role, place in places.items() if place == value)
    if not len(there):
        raise FormatError(f"has no number in the column {shown(segment.heads[value])}", segment.rows[0][0])
    return {role: each[: there[-1] + 1] for role, each in found.items()}


def _counted(segment: Segment, value: int) -> Sequence[str]:
    """A note where the head says another number of samples; one head alone says that of the first packet."""
    said, there = segment.number("Samples", value), len(segment.rows)
    more = there > said and segment.file.get("Multi_Headings") != "No"
    return [f"{there} samples for the {said:.0f} that its head says"] if said and (there < said or more) else []


def _times(segment: Segment, written: Array, value: int) -> Array:
    """Abscissa by X0 and Delta_X; as written where it is not these, but for digits that were lost."""
    step, empty = segment.number("Delta_X", value), bool(np.isnan(written).all())
    if not step > 0:
        if empty:
            raise FormatError("has no abscissa and no Delta_X above 0 in its head: say rate", segment.rows[0][0])
        return written
    first = segment.number("X0", value, 0.0 if empty else float(written[0]))
    even = np.asarray(first + np.arange(len(written)) * step)
    return even if empty or np.abs(written - even).max() < ROUNDED * step else written


def _shift(segment: Segment, before: Array, own: Array, later: float) -> float:
    """Shift of the abscissa of a further segment: none where it goes on, else by the time at which it was begun."""
    step = float(np.median(np.diff(before))) if len(before) > 1 else 0.0
    shift = 0.0 if own[0] > before[-1] else float(later)
    if abs(own[0] + shift - before[-1] - step) < 0.5 * step:
        return float(before[-1] + step - own[0])
    if not own[0] + shift > before[-1]:
        told = f"begins a segment at {own[0]:.6g}, before the end of the one ahead: keep one segment in the file"
        raise FormatError(told, segment.rows[0][0])
    return shift


def _stamp(segment: Segment, value: int) -> float:
    """Date and time at which a segment was begun, in s; 0 where it is not said."""
    date, time = (segment.entry(name, value) for name in ("Date", "Time"))
    if not (date and time):
        return 0.0
    with read_by("has no date", ValueError, segment.entries["Date"][0]):
        begun = np.datetime64(f"{date.replace('/', '-')}T{time.replace(',', '.')[:15]}", "us")
    return float(begun.astype(int)) / 1e6


def _column(segment: Segment, place: int, value: int, values: Array, abscissa: bool) -> CurveColumn:
    own, name = split_head(segment.heads[place])[1], "X_Unit_Label" if abscissa else "Y_Unit_Label"
    label = segment.entry(name, value if abscissa else place)
    if abscissa and not label:
        name, dimension = "X_Dimension", segment.entry("X_Dimension", value) or "Time"
        label = OVER.get(dimension.casefold(), (dimension,))[0]
    unit, origin = one_unit(own if is_unit(own) else "", [(f"from {name}", label)] if label else [])
    return CurveColumn(segment.heads[place], unit, values, (), f"column {place + 1}", origin)
