"""LabVIEW's measurement files (.lvm): two heads, channels, times by X0 and Delta_X or by columns, segments."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from difflib import get_close_matches

import numpy as np

from vibeam.exchange.curves.columns import (
    TIMES,
    Columns,
    CurveColumn,
    WantedColumn,
    find,
    is_unit,
    missing,
    split_head,
)
from vibeam.exchange.curves.numbers import number, numeric
from vibeam.exchange.curves.units_said import one_unit
from vibeam.exchange.files import FormatError, Line, read_by, shown
from vibeam_models.arrays import Array

TITLE, END, CLOCK = "LabVIEW Measurement", "***End_of_Header***", "X_Value"
MARKS = {"Tab": "\t", "Comma": ","}
FILE: Mapping[str, Sequence[str]] = {
    "Separator": ("Tab", "Comma"), "Decimal_Separator": (".", ","), "Multi_Headings": ("Yes", "No"),
    "X_Columns": ("No", "One", "Multi"), "Date": (), "Time": (), "Time_Pref": (), "Description": (), "Project": (),
    "Writer_Version": (), "Reader_Version": (), "Operator": (),
}  # fmt: skip
SEGMENT = ("Channels", "Samples", "Date", "Time", "Y_Unit_Label", "X_Unit_Label", "X_Dimension", "X0", "Delta_X")
OVER = {"time": ("s", TIMES), "frequency": ("Hz", ("frequency", "freq", "f", "hz"))}  # unit, names, by X_Dimension
ROUNDED = 0.3  # of a step: times that lost digits when they were written


@dataclass
class Segment:
    """Segment: cells of each entry of its head with their line, heads of the columns, lines of numbers."""

    said: dict[str, tuple[int, list[str]]] = field(default_factory=dict)
    heads: list[str] = field(default_factory=list)
    rows: list[Line] = field(default_factory=list)
    decimal: str = "."
    alone: bool = True  # each segment has a head of its own

    def entry(self, name: str, column: int) -> str:
        """Entry of the head for a column; of all where there is one alone."""
        cells = self.said.get(name, (0, []))[1]
        own = cells[column - 1] if 0 < column <= len(cells) else ""
        return own or (cells[0] if len(list(filter(None, cells))) == 1 else "")

    def number(self, name: str, column: int) -> float | None:
        """Entry that is a number; None where there is none."""
        text = self.entry(name, column)
        return _number(self.said[name][0], text, self.decimal) if text else None


def read(lines: Sequence[Line], wanted: Mapping[str, WantedColumn]) -> Columns:
    """The columns wanted of all segments; FormatError, with the line, of what is missing, or unlike the format."""
    separator, segments = _segments(lines)
    first = segments[0]
    places = {role: find(first.heads, each) for role, each in wanted.items() if role != "frequency"}
    value = next((place for place in places.values() if place is not None), 0)
    if "frequency" in wanted:
        places["frequency"] = _abscissa(first, wanted["frequency"], value)
    if fault := missing(dict.fromkeys(first.heads), wanted, places):
        raise fault
    parts, lines_read, notes = list[dict[str, Array]](), list[int](), list[str]()
    there = {role: place for role, place in places.items() if place is not None}
    for segment in segments:
        if segment.heads != first.heads:
            raise FormatError("has other channels than the segment before: keep one of both", segment.rows[0][0])
        found = _numbers(segment, there, value, separator)
        if "frequency" in found:
            found["frequency"] = _times(segment, found["frequency"], value)
            if parts:
                found["frequency"] += _later(first, segment, parts[-1]["frequency"], found["frequency"], value)
        parts.append(found)
        lines_read += [line for line, _ in segment.rows[: len(next(iter(found.values())))]]
        samples = segment.number("Samples", value)
        if samples and (len(segment.rows) < samples or (segment.alone and len(segment.rows) > samples)):
            notes.append(f"{len(segment.rows)} samples for the {samples:.0f} that its head says")
    if len(segments) > 1:
        notes.append(f"{len(segments)} segments")
    whole = {role: np.concatenate([part[role] for part in parts]) for role in there}
    columns = {role: _column(first, place, value, whole[role], role == "frequency") for role, place in there.items()}
    return Columns(columns, tuple(lines_read), tuple(first.heads), tuple(notes))


def _segments(lines: Sequence[Line]) -> tuple[str, list[Segment]]:
    """Separator of the cells, and the segments with their numbers."""
    mark = next((found for _, text in lines if (found := re.match(r"Separator(.)(Tab|Comma)\b", text))), None)
    separator = "\t" if mark is None else MARKS[mark[2]]
    said, segments, state = dict[str, str](), list[Segment](), "file"
    for line, text in lines[1:]:
        cells = [cell.strip() for cell in text.split(separator)]
        if cells[0] == END and state in ("file", "head"):
            if state == "file":
                alone = said.get("Multi_Headings") != "No"
                segments.append(Segment(decimal=said.get("Decimal_Separator", "."), alone=alone))
            state = "head" if state == "file" else "names"
        elif cells[0].startswith("***"):
            raise FormatError(f"{shown(cells[0])} is not at its place in a LabVIEW file", line)
        elif state == "names":
            segments[-1].heads.extend(_channels(segments[-1], cells, line))
            state = "rows"
        elif state == "rows" and (not cells[0] or numeric(cells[0])):
            segments[-1].rows.append((line, text))
        elif state == "file":
            _require_entry(cells, line, FILE)
            said[cells[0]] = "".join(cells[1:2])
        elif any(cells):
            _require_entry(cells, line, dict.fromkeys(SEGMENT, ()))
            if state == "rows":
                if cells[0] not in SEGMENT and not cells[0].startswith(("Notes", "Test_", "UUT_")):
                    raise FormatError(f"{shown(text)} is no row of numbers, and begins no segment: delete it", line)
                segments.append(Segment(decimal=segments[0].decimal, alone=segments[0].alone))
                state = "head"
            segments[-1].said[cells[0]] = line, cells[1:]
    if not segments or not all(each.rows for each in segments):
        raise FormatError(f"has no numbers below its heads, each of which ends with {END}", lines[-1][0])
    return separator, segments


def _require_entry(cells: Sequence[str], line: int, known: Mapping[str, Sequence[str]]) -> None:
    """FormatError for an entry that is misspelt, or has another value than the format knows; others are remarks."""
    name, values = cells[0], known.get(cells[0], ())
    if values and "".join(cells[1:2]) not in values:
        raise FormatError(f"{name} is {shown(''.join(cells[1:2]))}, and must be one of {', '.join(values)}", line)
    near = [] if name in known else get_close_matches(name.casefold(), [each.casefold() for each in known], 1, 0.7)
    if near:
        meant = next(each for each in known if each.casefold() == near[0])
        raise FormatError(f"{shown(name)} is no entry of a LabVIEW file: {meant}?", line)


def _channels(segment: Segment, cells: list[str], line: int) -> list[str]:
    """Heads of the columns; FormatError where they are not as many as the head says."""
    heads = cells[: cells.index("Comment") + 1 if "Comment" in cells else len(cells)]
    heads = heads[: len(heads) - next((i for i, each in enumerate(reversed(heads)) if each), 0)]
    channels = len([each for each in heads if each not in (CLOCK, "Comment")])
    if heads[0] != CLOCK or channels != segment.number("Channels", 1):
        said = segment.entry("Channels", 1) or "no number of"
        raise FormatError(f"has {channels} heads of channels behind {shown(heads[0])}, and {said} Channels above", line)
    return heads


def _abscissa(segment: Segment, wanted: WantedColumn, value: int) -> int | None:
    """Column of the abscissa of a value: the next one to the left, by any usual name of its dimension."""
    dimension = (segment.entry("X_Dimension", value) or "Time").casefold()
    usual = {CLOCK.casefold(), dimension, *OVER.get(dimension, ("", ()))[1]}
    for name in wanted.names:
        if isinstance(name, int):
            return name - 1 if 0 < name <= len(segment.heads) else None
        if name.casefold() in usual:
            return max(place for place, head in enumerate(segment.heads[: value + 1]) if head == CLOCK)
    return find(segment.heads, wanted)


def _number(line: int, text: str, decimal: str) -> float:
    if ("," if decimal == "." else ".") in text:
        raise FormatError(f"{shown(text)} is not a number with the decimal sign {decimal!r} of the file", line)
    return number((line, text), decimal)


def _numbers(segment: Segment, places: Mapping[str, int], value: int, separator: str) -> dict[str, Array]:
    """Numbers by role, up to the last one of the value; NaN where a cell is empty."""
    most, found = len(segment.heads), {role: np.full(len(segment.rows), np.nan) for role in places}
    for row, (line, text) in enumerate(segment.rows):
        cells = text.split(separator)
        if len(cells) <= max(places.values()) or (len(cells) > most and any(map(numeric, cells[most:]))):
            raise FormatError(f"{len(cells)} cells for {most} columns, {shown(text)}: complete the line", line)
        for role, place in places.items():
            found[role][row] = _number(line, cells[place].strip(), segment.decimal)
    last = np.flatnonzero(~np.isnan(next((found[role] for role, place in places.items() if place == value))))
    if not len(last):
        raise FormatError(f"has no number in the column {shown(segment.heads[value])}", segment.rows[0][0])
    return {role: each[: last[-1] + 1] for role, each in found.items()}


def _times(segment: Segment, written: Array, value: int) -> Array:
    """Abscissa by X0 and Delta_X; as written where it is not these, but for digits that were lost."""
    first, step = segment.number("X0", value), segment.number("Delta_X", value)
    empty = bool(np.isnan(written).all())
    if step is None or not step > 0:
        if empty:
            raise FormatError("has no abscissa and no Delta_X above 0 in its head: say rate", segment.rows[0][0])
        return written
    start = (0.0 if empty else float(written[0])) if first is None else first
    even = np.asarray(start + np.arange(len(written)) * step)
    return even if empty or np.abs(written - even).max() < ROUNDED * step else written


def _later(first: Segment, segment: Segment, before: Array, own: Array, value: int) -> float:
    """Shift of the abscissa of a further segment: none where it goes on, else by the time at which it was begun."""
    step = float(np.median(np.diff(before))) if len(before) > 1 else 0.0
    due, zero, now = float(before[-1]) + step, _stamp(first, value), _stamp(segment, value)
    shift = 0.0 if zero is None or now is None else now - zero
    for each in (0.0, shift):
        if abs(own[0] + each - due) < 0.5 * step:
            return due - float(own[0]) if each else 0.0
    if not own[0] + shift > before[-1]:
        told = f"begins a segment at {own[0]:.6g}, before the end of the one ahead: keep one segment in the file"
        raise FormatError(told, segment.rows[0][0])
    return shift


def _stamp(segment: Segment, value: int) -> float | None:
    """Date and time at which a segment was begun, in s; None where it is not said."""
    date = re.fullmatch(r"(\d{4})/(\d\d)/(\d\d)", segment.entry("Date", value))
    time = re.fullmatch(r"(\d\d):(\d\d):(\d\d(?:[.,]\d*)?)", segment.entry("Time", value))
    if not (date and time):
        return None
    with read_by("has no date", ValueError, segment.said["Date"][0]):
        days = datetime(int(date[1]), int(date[2]), int(date[3])).toordinal()
    return days * 86400 + int(time[1]) * 3600 + int(time[2]) * 60 + float(time[3].replace(",", "."))


def _column(segment: Segment, place: int, value: int, values: Array, abscissa: bool) -> CurveColumn:
    head, own = segment.heads[place], split_head(segment.heads[place])[1]
    label = segment.entry("X_Unit_Label" if abscissa else "Y_Unit_Label", value if abscissa else place)
    said = [("from Y_Unit_Label" if not abscissa else "from X_Unit_Label", label)] * bool(label)
    if abscissa and not said:
        dimension = segment.entry("X_Dimension", value) or "Time"
        said = [("from X_Dimension", OVER.get(dimension.casefold(), (dimension,))[0])]
    unit, origin = one_unit(own if is_unit(own) else "", said)
    return CurveColumn(head, unit, values, (), f"column {place + 1}", origin)
