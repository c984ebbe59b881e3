"""Results as tables for the terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from math import isfinite

from rich import box
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from vibeam.compare import Summary
from vibeam.derive import Row
from vibeam.keys import Row as KeyRow
from vibeam.modes import ModeTable
from vibeam.references import CheckRow
from vibeam.report.units import METRIC, Units, percent
from vibeam.stability.rows import Crossing

WIDEST = 160


def show(table: Table) -> None:
    """Print a table on stdout; where that is no terminal, as wide as the table needs."""
    console = Console(file=sys.stdout, highlight=False, markup=False)
    if not console.is_terminal:
        needed = Measurement.get(console, console.options.update(max_width=WIDEST), table).maximum
        console.width = max(80, needed)
    console.print(table)


def responses(summaries: Sequence[Summary], units: Units = METRIC) -> Table:
    """Every fidelity: its peak and the range in which its motion with impacts has the drive's period."""
    ways = [way for way in ("up", "down") if any(way in row.period_one for row in summaries)]
    unit = f" ({units.frequency})" if units.frequency else ""
    table = blank("Response", "fidelity", "modes|", "R|", "R₁|", "peak|", "at|", "sweep")
    _columns(table, *(f"period 1, {way}{unit}|" for way in ways))
    table.caption = (
        "R: restitution of the contact; R₁: what mode 1 sees of it\n"
        "period 1: the contiguous range with impacts around the largest amplitude"
    )
    for row in summaries:
        peak = (units.lengths(row.peak_amplitude), units.frequencies(row.peak_frequency), row.peak_direction)
        seen = map(coefficient, (row.restitution, row.first_mode_restitution))
        table.add_row(
            row.fidelity, str(row.modes), *seen, *peak, *(units.range(row.period_one.get(way)) for way in ways)
        )
    return table


def costs(summaries: Sequence[Summary]) -> Table:
    """Every fidelity: how far from the finest, at what cost."""
    table = blank("Accuracy and cost", "fidelity", "max off|", "rms off|", "CPU|", "ratio|")
    _columns(table, "impacts|", "ns each|", "failed|")
    table.caption = "off: amplitude, where both it and the finest are periodic; ratio: to the cheapest"
    for row in summaries:
        per_impact = f"{row.nanoseconds_per_impact:.0f}" if row.impacts else "–"
        cost = (f"{row.cpu_seconds:.3g} s", f"{row.cost_ratio:.3g}", str(row.impacts), per_impact)
        table.add_row(row.fidelity, *_distance(row), *cost, _failed(row))
    return table


def checks(rows: Iterable[CheckRow], units: Units = METRIC) -> Table:
    """Every reference: passed or missed, by how much and where."""
    table = blank("References", "", "reference", "fidelity", "quantity", "points|", "worst|", "at|", "allowed|", "why")
    for row in rows:
        mark = Text("passed", style="green") if row.passed else Text("missed", style="bold red")
        points = str(row.points) if row.points == row.total else f"{row.points} of {row.total}"
        numbers = (points, percent(row.worst), units.frequencies(row.frequency), percent(row.tolerance))
        table.add_row(mark, row.reference, row.fidelity, row.quantity, *numbers, _why(row))
    return table


def crossings(rows: Sequence[Crossing], own: str, units: Units = METRIC) -> Table:
    """Every boundary that the case itself runs into as the frequency changes."""
    table = blank(f"Boundaries at the case's own {own}", "fidelity", "boundary", "motion", "at|", "velocity|")
    table.add_column("multipliers", justify="right")
    table.caption = "of motions with one impact a span that keep clear of the stop between; velocity: of the impact"
    for row in rows:
        speed = f"{row.velocity * units.length_factor:.4g} {units.length}{'/s' if units.length else ''}".strip()
        numbers = (f"{row.frequency * units.frequency_factor:.10g} {units.frequency}".strip(), speed)
        table.add_row(row.fidelity, row.boundary, row.motion, *numbers, row.multipliers)
    return table


def derivation(rows: Iterable[Row]) -> Table:
    """SDOF parameters from geometry, each beside its finite-element value."""
    table = blank("SDOF parameters", "parameter", "symbol", "by formula|", "by FE|", "unit", "error|", "assumption")
    for row in rows:
        values = (f"{row.value:.5g}", f"{row.reference:.5g}")
        unit = "" if row.unit == "1" else row.unit
        table.add_row(row.name, row.symbol, *values, unit, _signed(row.error), row.assumption)
    return table


def modal(modes: ModeTable) -> Table:
    """The modal table: what each mode brings to contact, sensor and drive, and the restitution that is left."""
    table = blank("Modes of the finite-element beam", "mode|", "Hz|", "damping|")
    _columns(table, "contact|", "sensor|", "load|", "Σ share|", "R₁ seen|", "R|")
    for row in modes.rows:
        values = (f"{value:.4g}" for value in (row.contact, row.sensor, row.load))
        restitutions = (f"{row.first_mode_restitution:.4f}", f"{row.contact_restitution:.4f}")
        first = (str(row.number), f"{row.frequency:.5g}", percent(row.damping_ratio))
        table.add_row(*first, *values, percent(row.share), *restitutions)
    table.caption = (
        "contact, sensor: kg^-½; load: kg^½; Σ share: of the contact mobility w M⁻¹ wᵀ, up to this mode\n"
        "R: of the contact; R₁: what mode 1 sees of it where the model is cut off after this mode"
    )
    return table


def keys(rows: Iterable[KeyRow]) -> Table:
    """Every key of a case file, by table."""
    table = blank("Keys of a case file", "table", "key", "holds", "default", "meaning")
    last = ""
    for row in rows:
        if last and row.table != last:
            table.add_section()
        default = "required" if row.required else row.default or "absent"
        table.add_row("" if row.table == last else row.table, row.key, row.unit, default, row.meaning)
        last = row.table
    return table


def blank(title: str, *names: str) -> Table:
    """An empty table; a name that ends in | is a column of numbers, to the right."""
    table = Table(title=title, box=box.SIMPLE_HEAD, collapse_padding=True, pad_edge=False)
    table.title_justify = table.caption_justify = "left"
    table.title_style = "bold"
    _columns(table, *names)
    return table


def _columns(table: Table, *names: str) -> None:
    """Add columns; a name that ends in | is a column of numbers, to the right."""
    for name in names:
        table.add_column(name.rstrip("|"), justify="right" if name.endswith("|") else "left")


def coefficient(value: float) -> str:
    """A coefficient of restitution; a dash where there is none."""
    return f"{value:.4f}" if isfinite(value) else "–"


def _distance(row: Summary) -> tuple[str, str]:
    if row.distance is None:
        return "finest", ""
    return percent(row.distance.worst), percent(row.distance.rms)


def _failed(row: Summary) -> Text:
    return Text(str(row.failed), style="bold red") if row.failed else Text("–")


def _signed(error: float) -> str:
    return f"{100 * error:+.3g} %" if isfinite(error) else "–"


def _why(row: CheckRow) -> str:
    if row.notes:
        return "; ".join(row.notes)
    return "" if row.passed else "off by more than allowed"
