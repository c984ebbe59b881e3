"""Results as terminal tables."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import fields
from math import floor, isfinite, log10
from typing import TYPE_CHECKING, Any, cast

from rich.console import Console
from rich.text import Text

from vibeam.exchange.whole_files import naming_stdout
from vibeam.figures.units import METRIC, DisplayUnits
from vibeam.report.table_widths import ReportTable, fitted, needed
from vibeam.system.number_text import FREQUENCIES, percent, prefixed, signed, without_round_off

if TYPE_CHECKING:
    from vibeam.casefile.documentation import KeyRow
    from vibeam.runs.comparison.differences import HeldComparison
    from vibeam.runs.estimate.summary import EstimateTexts
    from vibeam.runs.summary import Summary
    from vibeam.studies.derive import DerivedParameter
    from vibeam.studies.identification.estimates import Identification
    from vibeam.studies.modes import ModeTable

WIDEST = 160
FEW_IMPACTS = 100  # so few tell nothing of what an impact costs
MARK = "*"  # of a peak at which the motion does not repeat
ARROWS = {"up": " ↑", "down": " ↓"}  # way of the sweep


def print_table(table: ReportTable) -> None:
    """Print a table on stdout, split where the terminal is too narrow; in full width into a file."""
    console = Console(file=sys.stdout, highlight=False, markup=False)
    if not console.is_terminal:
        console.width = max(80, min(WIDEST, needed(table)))
    with naming_stdout():
        _print(console, table)


def _print(console: Console, table: ReportTable) -> None:
    width = console.width
    for piece in fitted(table, width):
        title, piece.title = str(piece.title), None
        console.width = max(width, needed(piece))  # a single number may be wider than a very narrow terminal
        console.print(Text(title, style="bold"))
        console.print(piece)
        console.width = width
    if table.caption:
        console.print(Text(str(table.caption), style="dim italic"))
    console.print()


def responses(
    summaries: Sequence[Summary], units: DisplayUnits = METRIC, estimates: EstimateTexts | None = None
) -> ReportTable:
    """Table of every fidelity's peak and period-1 range.

    With ``estimates``: its error estimated against the full model as well.
    """
    swept = [branch for branch in ("up", "down") if any(branch in row.period_one for row in summaries)]
    hertz, length = (f" ({unit})" if unit else "" for unit in (units.frequency, units.length))
    table = blank("Response", "fidelity", "modes|", "R|", "R₁|", f"peak{length}|", f"at{hertz}|")
    table.add(*(f"period 1 {ARROWS[branch].strip()}{hertz}|" for branch in swept))
    cells = estimates.cells if estimates else {}
    table.caption = (
        "R: restitution of the contact; R₁: what mode 1 sees of it; ↑ ↓: way of the sweep\n"
        "period 1: the contiguous range with impacts around the largest amplitude"
    )
    table.caption += f"\n{MARK}: the motion at the peak does not repeat" * any(map(_irregular, summaries))
    if estimates and cells:
        table.add(f"{estimates.column}|")
        table.caption += f"\n{estimates.caption}"
    for row in summaries:
        peak = (plain(units.lengths(row.peak.amplitude)) + MARK * _irregular(row), _peak_frequency(row, units))
        coefficients = map(coefficient, (row.restitution, row.first_mode_restitution))
        ranges = (units.range(row.period_one.get(branch)) for branch in swept)
        table.add_row(
            row.fidelity, str(row.modes), *coefficients, *peak, *ranges, *filter(None, [cells.get(row.fidelity)])
        )
    return table


def _peak_frequency(row: Summary, units: DisplayUnits) -> str:
    return plain(units.frequencies(row.peak.frequency)) + ARROWS.get(row.peak.direction, "")


def _irregular(row: Summary) -> bool:
    """Test whether there is a peak at which the motion does not repeat."""
    return row.peak.point >= 0 and not row.peak.repeats


def plain(quantity: str) -> str:
    """Number without its unit, which the column's head has."""
    return quantity.partition(" ")[0]


def costs(summaries: Sequence[Summary], comparisons: Sequence[HeldComparison] = ()) -> ReportTable:
    """Table of every fidelity's distance from the finest, and its cost.

    With ``comparisons``: at the peak as well, with both choices of the restitution held, and in the row of the finest
    its distance from its own limit.
    """
    compared = [each for each in comparisons if each.other is not None]
    table = blank("Accuracy and cost", "fidelity", "max off|", "rms off|")
    if compared:
        table.add("at peak|", f"{_other_symbol(compared)} held|")
    table.add("CPU|", "ratio|", "impacts|", "ns each|", "failed|")
    table.caption = "off: in amplitude, where it and the finest are periodic; ratio: to the cheapest" + (
        "\nat peak: of its height, beside it with the other choice; [ ]: the finest off its own limit"
    ) * bool(compared)
    if any(0 < row.impacts < FEW_IMPACTS for row in summaries):
        table.caption += f"\nns each: of fewer than {FEW_IMPACTS} impacts it is no cost of impacts"
    related = len(summaries) == 1 or any(row.distance is not None for row in summaries)
    if not related:
        table.caption += "\nno two of the fidelities are of the same physics: none is off another"
    for row in summaries:
        per_impact = f"{row.nanoseconds_per_impact:.0f}" if row.impacts >= FEW_IMPACTS else "–"
        cost = (f"{row.cpu_seconds:.3g} s", f"{row.cost_ratio:.3g}", str(row.impacts), per_impact)
        table.add_row(row.fidelity, *_off(row, compared, "finest" if related else ""), *cost, _failed(row))
    return table


def _other_symbol(compared: Sequence[HeldComparison]) -> str:
    """Symbol of the coefficient that the other choice holds."""
    symbols = {each.other.symbol for each in compared if each.other is not None}
    return symbols.pop() if len(symbols) == 1 else "other"


def _off(row: Summary, compared: Sequence[HeldComparison], finest: str) -> tuple[str, ...]:
    """Cells of a fidelity's distance from the finest, of the finest from its limit; else it is called ``finest``."""
    for each in compared:
        if row.fidelity == each.finest and not each.limit.why:
            here, there = each.limit.held, each.limit.other
            cells = (percent(abs(here.worst)), percent(here.rms), signed(here.peak), signed(there.peak))
            return tuple(f"[{cell}]" for cell in cells)
        for other in each.rows:
            if other.fidelity == row.fidelity:
                return *_distance(row, finest), signed(other.held.peak), signed(other.other.peak)
    return *_distance(row, finest), *[""] * (2 * bool(compared))


def identified(found: Identification) -> ReportTable:
    """Table of identified parameters: value and 95 % interval, a dash where the data do not fix it."""
    table = blank("Identified", "parameter", "value|", "95 % interval|", "±|", "unit")
    table.caption = f"{found.method}; {found.points} points; rms residual {percent(found.residual)}"
    for row in found.rows:
        half = 0.5 * (row.high - row.low)
        digits = 4 if not half > 0 else max(2, min(9, 2 + floor(log10(abs(row.value) / half))))
        numbers = [
            f"{row.value:.{digits}g}",
            f"{row.low:.{digits}g} … {row.high:.{digits}g}",
            percent(half / row.value),
        ]
        unit = "" if row.unit == "1" else row.unit
        table.add_row(row.name, *(numbers if row.determined else ["not determined", "–", "–"]), unit)
    return table


def derivation(rows: Iterable[DerivedParameter]) -> ReportTable:
    """Table of SDOF parameters from geometry, each beside its finite-element value."""
    table = blank("SDOF parameters", "parameter", "symbol", "by formula|", "by FE|", "unit", "error|", "assumption")
    for row in rows:
        values = (f"{row.value:.5g}", f"{row.reference:.5g}")
        unit = "" if row.unit == "1" else row.unit
        error = signed(without_round_off(row.error, 1.0))
        table.add_row(row.name, row.symbol, *values, unit, error, row.assumption)
    return table


def modal(modes: ModeTable) -> ReportTable:
    """Modal table: participation of each mode at contact, sensor and drive, and the remaining restitution."""
    unit, factor = prefixed(FREQUENCIES, min((row.frequency for row in modes.rows), default=0.0), usual=-1)
    of = "finite elements" if len(modes.positions) else "structure"
    table = blank(f"Modes of the {of}", "mode|", f"{unit}|", "damping|")
    impulsive = any(isfinite(row.contact_restitution) for row in modes.rows)
    table.add("contact|", "sensor|", "load|", "Σ share|", *(["R₁ seen|", "R|"] * impulsive))
    shown = [(row.contact, row.sensor, row.load) for row in modes.rows]
    largest = [max(map(abs, column)) for column in zip(*shown, strict=True)]
    for row, numbers in zip(modes.rows, shown, strict=True):
        values = (f"{without_round_off(*pair):.4g}" for pair in zip(numbers, largest, strict=True))
        restitutions = [f"{row.first_mode_restitution:.4f}", f"{row.contact_restitution:.4f}"] * impulsive
        first = (str(row.number), f"{row.frequency * factor:.5g}", percent(row.damping_ratio))
        table.add_row(*first, *values, percent(row.share), *restitutions)
    table.caption = (
        f"contact, sensor: kg^-½; load: {modes.load_unit}; Σ share: of the contact mobility w M⁻¹ wᵀ, up to this mode"
        + "\nR: of the contact; R₁: what mode 1 sees of it where the model is cut off after this mode" * impulsive
    )
    return table


def keys(rows: Iterable[KeyRow]) -> ReportTable:
    """Table of every key of a case file, by table."""
    table = blank("Keys of a case file", "table", "key", "holds", "default", "meaning", heads=2)
    last = ""
    for row in rows:
        if last and row.table != last:
            table.add_section()
        default = "required" if row.required else row.default or "absent"
        table.add_row("" if row.table == last else row.table, row.key, row.unit, default, row.meaning)
        last = row.table
    return table


def blank(title: str, *names: str, heads: int = 1) -> ReportTable:
    """Empty table; a name that ends in | is a right-aligned column of numbers.

    The first ``heads`` columns are repeated where the others need a further table.
    """
    table = ReportTable(title, heads)
    table.add(*names)
    return table


def rows_of(title: str, rows: Sequence[object]) -> ReportTable:
    """Rows of one dataclass as a table, a column a field."""
    found = [{field.name: getattr(row, field.name) for field in fields(cast(Any, row))} for row in rows]
    columns = list(found[0]) if found else []
    numbers = {name for name in columns if all(isinstance(row[name], int | float) for row in found)}
    table = blank(title, *(f"{name}|" if name in numbers else name for name in columns))
    for row in found:
        table.add_row(*(f"{row[name]:.6g}" if name in numbers else str(row[name]) for name in columns))
    return table


def coefficient(value: float) -> str:
    """Coefficient of restitution as text; a dash where there is none."""
    return f"{value:.4f}" if isfinite(value) else "–"


def _distance(row: Summary, finest: str) -> tuple[str, str]:
    if row.distance is None:
        return finest, ""
    return percent(abs(row.distance.worst)), percent(row.distance.rms)


def _failed(row: Summary) -> Text:
    return Text(str(row.failed), style="bold red") if row.failed else Text("–")
