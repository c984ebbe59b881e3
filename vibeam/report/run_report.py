"""Report of a run: answer, table of its fidelities, what is uncertain, what its pictures that decide show."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from rich.text import Text

from vibeam.figures.units import METRIC, DisplayUnits, units_for
from vibeam.report.comparison_words import cells
from vibeam.report.decision_figures import Decision, ModelError
from vibeam.report.output import StudySheet
from vibeam.report.run_answer import PhysicsGroup, beyond, groups_of, run_answer
from vibeam.report.tables import ARROWS, ReportTable, blank, coefficient, plain
from vibeam.runs.comparison.differences import HeldComparison, doubts, listed, settled
from vibeam.runs.comparison.errors import Asked, ComparedFidelity, ResponseComparison
from vibeam.runs.result import Result
from vibeam.runs.summary import Summary, compare, remarks
from vibeam.system.curves import NAN
from vibeam.system.number_text import percent, signed, without_round_off

FEW_IMPACTS = 100  # so few tell nothing of what an impact costs
NOTES = 5
GROUPS = 3  # groups of one physics that are drawn
MARK = "*"  # of a peak at which the motion does not repeat


def run_report(result: Result) -> StudySheet:
    """Report of a result; its comparisons are made as far as it has them."""
    rows, units = compare(result), units_for(result)
    uncertain = [*remarks(result), *_faults(rows), *_at_ends(result, rows)]
    certain: list[str] = []
    for each in result.comparisons:
        uncertain += doubts(each)
        certain += settled(each)
    compared = {each.fidelity: each for each in result.compare()}
    finest = list(dict.fromkeys(result.finest.values()))
    return StudySheet(
        run_answer(result),
        [fidelities(rows, compared, units, finest)],
        uncertain[:NOTES],
        [*uncertain[NOTES:], *certain, *_not_compared(compared.values())],
        [details(rows, units, result.comparisons)],
        _data(result, rows),
        pictures=[picture for each in run_decisions(result) for picture in each.pictures],
    )


def _data(result: Result, rows: Sequence[Summary]) -> dict[str, Any]:
    """Content of the JSON object."""
    always = {"fidelities": rows, "remarks": remarks(result), "found": result.found, "total": result.total}
    known = {"curves": result.curves} if result.curves else {}
    return always | known | {"compared": result.compare(), "comparisons": result.comparisons}


def _not_compared(found: Iterable[ComparedFidelity]) -> Iterator[str]:
    """Sentences on fidelities whose own error is not known, those with one reason together."""
    reasons: dict[str, list[str]] = {}
    for each in found:
        if each.why:
            reasons.setdefault(each.why, []).append(each.fidelity)
    for why, names in reasons.items():
        yield f"{listed(names)}: no fuller model ({why})"


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
    summaries: Sequence[Summary], compared: Mapping[str, ComparedFidelity], units: DisplayUnits = METRIC,
    finest: Collection[str] = (),
) -> ReportTable:  # fmt: skip
    """Table of every fidelity: its peak, its errors, its cost; ``finest``: those whose errors are of a fuller model."""
    hertz, length = (f" ({unit})" if unit else "" for unit in (units.frequency, units.length))
    table = blank("Fidelities", "fidelity", "modes|", f"peak{length}|", f"at{hertz}|", "amplitudes|", "ends|", "kinds|")
    table.add("CPU ratio|")
    table.caption = "\n".join(_captions(summaries, [compared[name] for name in finest if name in compared]))
    for row in summaries:
        at = plain(units.frequencies(row.peak.frequency)) + ARROWS.get(row.peak.direction, "")
        first = (str(row.modes), plain(units.lengths(row.peak.amplitude)) + MARK * _irregular(row), at)
        own = compared.get(row.fidelity)
        errors = cells(None if own is None else own.comparison)
        if own is not None and not own.reference:
            errors = ("exact", "", "") if own.whole else tuple(f"[{each}]" for each in errors)  # type: ignore[assignment]
        table.add_row(row.fidelity, *first, *errors, f"{row.cost_ratio:.3g}")
    return table


def _captions(rows: Sequence[Summary], finest: Sequence[ComparedFidelity]) -> Iterator[str]:
    yield "amplitudes, ends of branches: largest errors against the finest; kinds: width in which the motion is another"
    known = [f"{each.fidelity} against {beyond(each).name}" for each in finest if each.comparison is not None]
    if known:
        yield f"[ ]: {listed(known)}"
    if any(map(_irregular, rows)):
        yield f"{MARK}: the motion at the peak does not repeat"


def _irregular(row: Summary) -> bool:
    """Test whether there is a peak at which the motion does not repeat."""
    return row.peak.point >= 0 and not row.peak.repeats


def details(
    summaries: Sequence[Summary], units: DisplayUnits = METRIC, comparisons: Sequence[HeldComparison] = ()
) -> ReportTable:  # fmt: skip
    """Table of every fidelity's restitution, period-1 range, distance from the finest over all points, and impacts."""
    swept = [branch for branch in ("up", "down") if any(branch in row.period_one for row in summaries)]
    hertz = f" ({units.frequency})" if units.frequency else ""
    other = {row.fidelity: row.other for each in comparisons if each.other is not None for row in each.rows}
    table = blank("Motions and impacts", "fidelity", "R|", "R₁|")
    table.add(*(f"period 1 {ARROWS[branch].strip()}{hertz}|" for branch in swept), "off at peak|")
    table.add(*["other held|"] * bool(other), "rms off|", "CPU|", "impacts|", "ns each|", "failed|")
    table.caption = (
        "R: restitution of the contact; R₁: what mode 1 sees of it; ↑ ↓: way of the sweep\n"
        "period 1: the contiguous range with impacts around the largest amplitude\n"
        "off: from the finest, where both repeat; other held: the same with the other restitution held\n"
        f"ns each: CPU time an impact, where there are {FEW_IMPACTS} or more"
    )
    for row in summaries:
        coefficients = map(coefficient, (row.restitution, row.first_mode_restitution))
        ranges = (units.range(row.period_one.get(branch)) for branch in swept)
        per_impact = f"{row.nanoseconds_per_impact:.0f}" if row.impacts >= FEW_IMPACTS else "–"
        failed = Text(str(row.failed), style="bold red") if row.failed else Text("–")
        table.add_row(
            row.fidelity, *coefficients, *ranges, *_off(row, other), f"{row.cpu_seconds:.3g} s", str(row.impacts),
            per_impact, failed,
        )  # fmt: skip
    return table


def _off(row: Summary, other: Mapping[str, float]) -> tuple[str, ...]:
    """Cells of the distance from the finest: at the peak, there with the other restitution held, rms."""
    if row.distance is None:
        return ("",) * (2 + bool(other))
    peak, rms = (without_round_off(each, 1.0) for each in (row.distance.peak, row.distance.rms))
    return signed(peak), *[signed(other.get(row.fidelity, NAN))] * bool(other), percent(rms)


def run_decisions(result: Result) -> list[Decision]:
    """Content of the pictures of a result, for each group of fidelities of one physics; none of one fidelity alone."""
    groups = groups_of(result, compare(result))[:GROUPS]
    return [_of_group(result, each, f", {each.finest.fidelity}" * (len(groups) > 1)) for each in groups]


def _of_group(result: Result, group: PhysicsGroup, name: str) -> Decision:
    asked, top = result.asked, group.finest.fidelity
    known = {name: each.comparison for name, each in group.compared.items() if each.comparison is not None}
    shown = [row.fidelity for row in recommended(group, known, asked)]
    curves = {(name, way): (each.frequency, each.amplitude)
              for name in [top, *shown] for way, each in result[name].items()}  # fmt: skip
    times = {row.fidelity: _seconds(result, row) for row in (*group.others, group.finest)}
    errors = tuple(
        ModelError.of(name, known[name], asked, each, name, name == top)
        for name, each in times.items()
        if name in known
    )
    return Decision(
        result.case, asked, top, curves, {each: known[each] for each in shown},
        errors if len(group.others) > 1 else (), times[top],
        tuple(row.fidelity for row in group.others if row.fidelity not in known), name,
    )  # fmt: skip


def recommended(group: PhysicsGroup, known: Mapping[str, ResponseComparison], asked: Asked) -> list[Summary]:
    """The cheapest fidelity that suffices, else the closest to the finest, and the next one with fewer modes."""
    rows = [row for row in group.others if row.fidelity in known]
    less = [row for row in rows if group.is_less(row)] or rows
    enough = [row for row in less if known[row.fidelity].suffices(asked)]
    best = enough[:1] or sorted(less, key=lambda row: known[row.fidelity].worst(asked))[:1]
    return [*best, *[row for row in less if row.modes < best[0].modes][-1:]]


def _seconds(result: Result, row: Summary) -> float:
    """CPU time of a point."""
    return row.cpu_seconds / max(sum(len(each) for _, each in result[row.fidelity].items()), 1)
