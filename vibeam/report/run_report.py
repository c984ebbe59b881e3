"""Report of a run: headlines, tables and sentences, the same on the terminal and on the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.text import Text

from vibeam.figures.units import METRIC, DisplayUnits, units_for
from vibeam.report.output import StudySheet
from vibeam.report.tables import ARROWS, ReportTable, blank, coefficient, plain
from vibeam.runs.comparison.differences import headline, notes
from vibeam.runs.estimate.records import estimate_texts
from vibeam.runs.summary import Summary, compare, remarks
from vibeam.system.number_text import percent, signed

if TYPE_CHECKING:
    from vibeam.runs.comparison.differences import HeldComparison
    from vibeam.runs.estimate.records import EstimateTexts
    from vibeam.runs.result import Result


FEW_IMPACTS = 100  # so few tell nothing of what an impact costs
MARK = "*"  # of a peak at which the motion does not repeat


def run_report(result: Result) -> StudySheet:
    """Report of a result; its errors are estimated and its comparisons made as far as it has them."""
    rows, units, compared = compare(result), units_for(result), result.comparisons
    choice = () if result.accuracy is None else result.accuracy.sentences()
    estimated = estimate_texts(result.estimates)
    below = [*(line for each in compared for line in notes(each)), *estimated.sentences, *remarks(result)]
    shown = [responses(rows, units, estimated), costs(rows, compared)]
    return StudySheet("\n".join([*choice, *map(headline, compared)]), shown, below)


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
        at = plain(units.frequencies(row.peak.frequency)) + ARROWS.get(row.peak.direction, "")
        peak = (plain(units.lengths(row.peak.amplitude)) + MARK * _irregular(row), at)
        coefficients = map(coefficient, (row.restitution, row.first_mode_restitution))
        ranges = (units.range(row.period_one.get(branch)) for branch in swept)
        table.add_row(
            row.fidelity, str(row.modes), *coefficients, *peak, *ranges, *filter(None, [cells.get(row.fidelity)])
        )
    return table


def _irregular(row: Summary) -> bool:
    """Test whether there is a peak at which the motion does not repeat."""
    return row.peak.point >= 0 and not row.peak.repeats


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
        failed = Text(str(row.failed), style="bold red") if row.failed else Text("–")
        table.add_row(row.fidelity, *_off(row, compared, "finest" if related else ""), *cost, failed)
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


def _distance(row: Summary, finest: str) -> tuple[str, str]:
    if row.distance is None:
        return finest, ""
    return percent(abs(row.distance.worst)), percent(row.distance.rms)
