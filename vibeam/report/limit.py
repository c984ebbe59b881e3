"""Table and sentences of the limit of infinitely many modes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from vibeam.figures.units import METRIC, DisplayUnits
from vibeam.report.output import StudySheet
from vibeam.report.tables import ReportTable, blank
from vibeam.system.number_text import percent

if TYPE_CHECKING:
    from vibeam.studies.limit.study import LimitRow


LOOSE = 0.1  # share of a limit beyond which its uncertainty is no number to rely on
MORE = "its values are not settled over these numbers of modes, more may settle them (--modes)"


def sheet(rows: Sequence[LimitRow], units: DisplayUnits = METRIC) -> StudySheet:
    """Sheet of the limits, as CSV a row a quantity."""
    return StudySheet("", [limits(rows, units)], list(sentences(rows)), data={"limits": rows}, rows=rows)


def limits(rows: Sequence[LimitRow], units: DisplayUnits = METRIC) -> ReportTable:
    """Table of every quantity over the numbers of modes, its limit and the rate at which it gets there."""
    counts = rows[0].counts if rows else ()
    heads = [f"N = {counts[0]}|", *(f"{count}|" for count in counts[1:])] if counts else []
    table = blank("Limit of infinitely many modes", "held", "quantity", *heads, "limit|", "rate|", "1 % from|", heads=2)
    table.add("by t_c|")
    table.caption = _settings(rows, units) + (
        "rate p: what is left falls like N⁻ᵖ; 1 % from: fewest modes that are within 1 % of the limit from there on\n"
        "by t_c: modes with less than one period in the contact time t_c"
    )
    last = ""
    for row in rows:
        if last and row.held != last:
            table.add_section()
        table.add_row("" if row.held == last else row.held, row.quantity, *_cells(row, units))
        last = row.held
    return table


def _settings(rows: Sequence[LimitRow], units: DisplayUnits) -> str:
    """Motion and collision that the values are of."""
    frequencies = {row.frequency for row in rows if isfinite(row.frequency)}
    speeds = {row.speed for row in rows if isfinite(row.speed)}
    motion = [f"exact motion at {units.frequencies(each)}, one impact a period" for each in frequencies]
    collision = [f"one collision of mode 1 at {units.speeds(each)} where the stop yields" for each in speeds]
    return "; ".join([*motion, *collision]) + "\n"


def _cells(row: LimitRow, units: DisplayUnits) -> Iterator[str]:
    for value in (*row.values, row.limit):
        yield shown(value, row.unit, units)
    yield f"{row.rate:.1f}" if isfinite(row.rate) else "–"
    yield str(row.enough or "–")
    yield str(row.by_contact_time or "–")


def shown(value: float, unit: str, units: DisplayUnits) -> str:
    """A value to four digits, with its unit."""
    if not isfinite(value):
        return "–"
    if unit == "m":
        return units.lengths(value)
    if unit == "m/s":
        return units.speeds(value)
    return f"{value * 1e3:.4g} ms" if unit == "s" else f"{value:.4f}"


def sentences(rows: Sequence[LimitRow]) -> Iterator[str]:
    """Sentences on what has no limit, and how well the others are known."""
    reasons: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        if row.why:
            reasons.setdefault((row.held, row.why), []).append(row.quantity)
    for (held, why), quantities in reasons.items():
        yield f"{held}: no limit of {', '.join(quantities)} is given: {why}"
    known = [(row.uncertainty / abs(row.limit), row) for row in rows if isfinite(row.limit) and row.limit]
    well = [share for share, _ in known if share <= LOOSE]
    if well:
        which = "limits" if len(well) == len(known) else "the other limits"
        yield f"{which} are known to {percent(max(well))} or better: the last value, or by the rate where it is steady"
    for share, row in known:
        if share > LOOSE:
            how = f"by {percent(share)}" if share < 1 else "by as much as itself"
            yield f"{row.held}: the limit of {row.quantity} is hardly known, it may be off {how}: {MORE}"
