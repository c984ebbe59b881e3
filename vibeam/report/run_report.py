"""Report of a run: answer, table of its fidelities, what is uncertain; the same on the terminal and the page."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Any

from rich.text import Text

from vibeam.figures.units import METRIC, DisplayUnits, units_for
from vibeam.report.output import StudySheet
from vibeam.report.run_answer import USUAL, groups_of, run_answer
from vibeam.report.tables import ARROWS, ReportTable, blank, coefficient, plain
from vibeam.runs.comparison.differences import HeldComparison, doubts, listed, settled
from vibeam.runs.estimate.records import EstimateTexts, estimate_texts
from vibeam.runs.result import Result
from vibeam.runs.summary import Summary, compare, remarks
from vibeam.system.number_text import percent, signed, without_round_off

FEW_IMPACTS = 100  # so few tell nothing of what an impact costs
NOTES = 5
MARK = "*"  # of a peak at which the motion does not repeat


def run_report(result: Result, accuracy: float | None = None) -> StudySheet:
    """Report of a result; its errors are estimated and its comparisons made as far as it has them.

    ``accuracy``: what suffices, None: 5 %.
    """
    rows, units, estimated = compare(result), units_for(result), estimate_texts(result.estimates)
    uncertain = [*remarks(result), *_faults(rows), *_at_ends(result, rows)]
    certain: list[str] = []
    groups = groups_of(result, rows)
    for each in result.comparisons:
        uncertain += doubts(each)
        certain += settled(each)
    if estimated.unknown:
        uncertain.append(f"{listed(estimated.unknown)}: est. off is not known, -v says why")
    return StudySheet(
        run_answer(result, accuracy or USUAL),
        [fidelities(rows, result.comparisons, units, estimated, [each.finest.fidelity for each in groups])],
        uncertain[:NOTES],
        [*uncertain[NOTES:], *certain, *estimated.sentences],
        [details(rows, units)],
        _data(result, rows, estimated),
    )


def _data(result: Result, rows: Sequence[Summary], estimated: EstimateTexts) -> dict[str, Any]:
    """Content of the JSON object."""
    always = {"fidelities": rows, "remarks": remarks(result), "found": result.found, "total": result.total}
    known = {"curves": result.curves, "estimates": estimated.rows}
    return always | {"comparisons": result.comparisons} | {name: value for name, value in known.items() if value}


def _faults(rows: Sequence[Summary]) -> Iterator[str]:
    """Sentences on points that failed, and on peaks that hang on the length of the hold."""
    failed = [f"{row.fidelity} ({row.failed})" for row in rows if row.failed]
    if failed:
        yield f"points failed of {listed(failed)}: the results file says why, ended"
    if irregular := [row.fidelity for row in rows if _irregular(row)]:
        yield f"{listed(irregular)}: no motion that repeats at the peak: its height hangs on sweep.hold, hold longer"


def _at_ends(result: Result, rows: Sequence[Summary]) -> Iterator[str]:
    """Sentence on peaks at the first or the last frequency of a sweep, beyond which the curve may go on rising."""
    grid, units = result.case.sweep.frequency, units_for(result)
    for end in (grid.min(), grid.max()):
        if len(grid) > 1 and (there := [row.fidelity for row in rows if row.peak.frequency == end]):
            at = units.frequencies(float(end))
            yield f"{listed(there)}: the peak is at the end of the sweep, {at}, and may rise beyond it: sweep further"


def fidelities(
    summaries: Sequence[Summary], comparisons: Sequence[HeldComparison] = (), units: DisplayUnits = METRIC,
    estimates: EstimateTexts | None = None, finest: Collection[str] = (),
) -> ReportTable:  # fmt: skip
    """Table of every fidelity: its peak, its distance from the finest and from the full model, its cost.

    With ``comparisons``: at the peak with the other restitution held as well, and in the row of the finest its distance
    from its own limit. With ``estimates``: the error against the full model. ``finest``: those called so.
    """
    compared = [each for each in comparisons if each.other is not None]
    cells = estimates.cells if estimates else {}
    hertz, length = (f" ({unit})" if unit else "" for unit in (units.frequency, units.length))
    table = blank("Fidelities", "fidelity", "modes|", f"peak{length}|", f"at{hertz}|", "off at peak|")
    table.add(*[f"{_other_symbol(compared)} held|"] * bool(compared), "rms off|")
    table.add(*["est. off|"] * bool(cells), "CPU ratio|")
    table.caption = "\n".join(_captions(summaries, bool(compared), estimates if cells else None))
    for row in summaries:
        at = plain(units.frequencies(row.peak.frequency)) + ARROWS.get(row.peak.direction, "")
        first = (str(row.modes), plain(units.lengths(row.peak.amplitude)) + MARK * _irregular(row), at)
        estimated = [cells.get(row.fidelity, "–")] * bool(cells)
        table.add_row(row.fidelity, *first, *_off(row, compared, finest), *estimated, f"{row.cost_ratio:.3g}")
    return table


def _captions(rows: Sequence[Summary], compared: bool, estimates: EstimateTexts | None) -> Iterator[str]:
    if any(row.distance is not None for row in rows):
        limit = "; [ ]: the finest off its own limit" if compared else ""
        yield f"off: from the finest, where both repeat{limit}"
    if estimates:
        yield estimates.caption
    if any(map(_irregular, rows)):
        yield f"{MARK}: the motion at the peak does not repeat"


def _irregular(row: Summary) -> bool:
    """Test whether there is a peak at which the motion does not repeat."""
    return row.peak.point >= 0 and not row.peak.repeats


def _other_symbol(compared: Sequence[HeldComparison]) -> str:
    """Symbol of the coefficient that the other choice holds."""
    symbols = {each.other.symbol for each in compared if each.other is not None}
    return symbols.pop() if len(symbols) == 1 else "other"


def _off(row: Summary, compared: Sequence[HeldComparison], finest: Collection[str]) -> tuple[str, ...]:
    """Cells of a fidelity's distance from the finest, of the finest from its limit."""
    own = ("finest" * (row.fidelity in finest), "")
    if row.distance is not None:
        off = (without_round_off(each, 1.0) for each in (row.distance.peak, row.distance.rms))
        own = signed(next(off)), percent(next(off))
    for each in compared:
        if row.fidelity == each.finest and not each.limit.why:
            here, there = each.limit.held, each.limit.other
            return tuple(f"[{cell}]" for cell in (signed(here.peak), signed(there.peak), percent(here.rms)))
        for other in each.rows:
            if other.fidelity == row.fidelity:
                return own[0], signed(other.other.peak), own[1]
    return own[:1] + ("",) * bool(compared) + own[1:]


def details(summaries: Sequence[Summary], units: DisplayUnits = METRIC) -> ReportTable:
    """Table of every fidelity's restitution, period-1 range, largest distance from the finest, and impacts."""
    swept = [branch for branch in ("up", "down") if any(branch in row.period_one for row in summaries)]
    hertz = f" ({units.frequency})" if units.frequency else ""
    table = blank("Motions and impacts", "fidelity", "R|", "R₁|")
    table.add(*(f"period 1 {ARROWS[branch].strip()}{hertz}|" for branch in swept))
    table.add("max off|", "CPU|", "impacts|", "ns each|", "failed|")
    table.caption = (
        "R: restitution of the contact; R₁: what mode 1 sees of it; ↑ ↓: way of the sweep\n"
        "period 1: the contiguous range with impacts around the largest amplitude\n"
        f"ns each: CPU time an impact, where there are {FEW_IMPACTS} or more"
    )
    for row in summaries:
        coefficients = map(coefficient, (row.restitution, row.first_mode_restitution))
        ranges = (units.range(row.period_one.get(branch)) for branch in swept)
        worst = "" if row.distance is None else percent(abs(without_round_off(row.distance.worst, 1.0)))
        per_impact = f"{row.nanoseconds_per_impact:.0f}" if row.impacts >= FEW_IMPACTS else "–"
        cpu = f"{row.cpu_seconds:.3g} s"
        failed = Text(str(row.failed), style="bold red") if row.failed else Text("–")
        table.add_row(row.fidelity, *coefficients, *ranges, worst, cpu, str(row.impacts), per_impact, failed)
    return table
