"""Accuracy against time as a sheet: the answer, the runs worth a look, all runs, the parts of each model's error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from math import ceil, inf, isfinite
from shlex import quote
from typing import TYPE_CHECKING

from rich.text import Text

from vibeam.exchange.files import dotted
from vibeam.report.output import StudySheet, plain
from vibeam.report.run_answer import USUAL
from vibeam.report.tables import ReportTable, blank, coefficient
from vibeam.report.work_precision import work_precision
from vibeam.runs.comparison.differences import doubts, listed, settled
from vibeam.system.number_text import percent, shown_in, signed

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.cost.row import Part, RunRow, Split
    from vibeam.studies.cost.study import CostStudy


MOST_ROWS, MOST_NOTES = 15, 5
UNSETTLED = 1e-3  # error of an exact flight from which on it has not settled
ROUND_OFF, EXACT = 1e-12, 1e-5  # errors that are no larger are none, or nearly none


def sheet(study: CostStudy, case: Case, within: float = USUAL) -> StudySheet:
    """Sheet of a study of ``case``; as CSV a row a run, nested values by names with a dot: ``total.amplitude.rms``."""
    unsure = list(uncertain(study, case))
    return StudySheet(
        answer=answer(study, case, within),
        tables=[chosen(study, case)],
        notes=unsure[:MOST_NOTES],
        details=[*unsure[MOST_NOTES:], *details(study)],
        more=[runs(study), parts(study)],
        data={"study": study},
        rows=[dict(dotted(plain(row))) for row in study.rows],
        draw=lambda: work_precision(study, case),
        coarse=True,
    )


def answer(study: CostStudy, case: Case, within: float = USUAL) -> str:
    """Sentence on the finest fidelity's time, the cheapest run ``within`` an error, and the finest's other solvers."""
    exact = _exact(study)
    unit, factor = shown_in("s", exact / len(study.frequency))
    time = f"{exact / len(study.frequency) * factor:.2g} {unit} a frequency"
    rest = [_cheaper(study, case, within, exact), _other_solvers(study, exact)]
    said = "; ".join(filter(None, rest)) if study.rows else "no run had time"
    points = min((row.total.amplitude.points for row in study.rows if row.total.amplitude.points), default=0)
    some = f", at the frequencies where motions repeat (at least {points} of {len(study.frequency)})"
    where = some * (0 < points < len(study.frequency))
    return f"With {study.comparison.what} held, exact flight of {study.finest} takes {time}; {said}{where}."


def _exact(study: CostStudy) -> float:
    """CPU seconds of the finest fidelity's exact flight, of as many periods as the other runs where it ran so."""
    flown, whole = _flown(study), (split.cpu for split in study.splits if split.fidelity == study.finest)
    return flown.work.cpu_min if flown is not None and flown.work else next(whole)


def _flown(study: CostStudy) -> RunRow | None:
    """Row of the finest fidelity's flight."""
    return next((row for row in study.rows if (row.fidelity, row.solver) == (study.finest, "flight")), None)


def _seconds(row: RunRow) -> float:
    return row.work.cpu_min if row.work else float("inf")


def _worst(row: RunRow) -> float:
    """Largest error in amplitude, without its sign; ∞ where there is none."""
    return abs(row.total.amplitude.worst) if isfinite(row.total.amplitude.worst) else float("inf")


def _cheaper(study: CostStudy, case: Case, within: float, exact: float) -> str:
    """The cheapest run within the accuracy, or the nearest of those that cost less than the finest's flight.

    Nothing is told of a run whose error is known at less than half of the frequencies.
    """
    count = len(study.frequency)
    less = [row for row in study.rows if row.found == count and _seconds(row) < exact]
    known = [row for row in less if isfinite(_worst(row)) and 2 * row.total.amplitude.points >= count]
    if not known:
        told = f"of cheaper runs the error is known at less than half of the {count} frequencies"
        return told if less else "nothing is cheaper"
    enough = [row for row in known if _worst(row) <= within]
    best = min(enough, key=_seconds) if enough else min(known, key=_worst)
    name = best.fidelity if best.fidelity in case.fidelities else f"{study.finest} cut off after mode {best.modes}"
    said = f"{name} by {best.label}, {_ratio(exact / _seconds(best))} times faster and {_off(best)}"
    if enough:
        return f"the cheapest within {percent(within)} is {said}"
    return f"nothing cheaper is within {percent(within)}: the nearest is {said}"


def _off(row: RunRow) -> str:
    if _worst(row) > EXACT:
        return f"{percent(_worst(row))} off"
    return f"exact{f' to {share(_worst(row))}' * (_worst(row) > ROUND_OFF)}"


def _ratio(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}"


def _other_solvers(study: CostStudy, exact: float) -> str:
    """The cheapest and the dearest of the finest fidelity's other solvers, each at its best."""
    own = [row for row in study.rows if row.fidelity == study.finest and row.solver != "flight"]
    ran = sorted((row for row in _best(own) if row.work and isfinite(_worst(row))), key=_seconds)
    said = (
        f"{row.solver} takes {_ratio(_seconds(row) / exact)} times as long and is {_off(row)}"
        for row in ran[:1] + ran[1:][-1:]
    )
    return ", ".join(said)


def _best(rows: Iterable[RunRow]) -> list[RunRow]:
    """Row of least error of each solver, the cheapest of several; one that failed where all did."""
    best: dict[str, RunRow] = {}
    for row in sorted(rows, key=lambda row: (_worst(row), _seconds(row))):
        best.setdefault(row.solver, row)
    return list(best.values())


def chosen(study: CostStudy, case: Case) -> ReportTable:
    """Table of the runs on the Pareto front, and of the best of each solver."""
    front = [study.rows[index] for index in study.front]
    kept = [*_best(study.rows), *front][:MOST_ROWS]
    cut = any(row.fidelity not in case.fidelities for row in kept)
    further = f"; modes_1, 2, …: {study.finest} cut off after so many" if cut else ""
    return _runs(study, "Error against time", [row for row in study.rows if row in kept], further)


def runs(study: CostStudy) -> ReportTable:
    """Table of all runs: error against the reference and against the fidelity's exact motion, and the work."""
    further = (
        "\npath: Hausdorff distance to the exact motion of its own model over ten periods; impacts: worst velocity on "
        "it\nstatistics: where neither repeats, the worst of means and deciles (in brackets: of the exact one's halves)"
    )
    return _runs(study, "All runs", study.rows, further)


def _runs(study: CostStudy, title: str, rows: Sequence[RunRow], further: str) -> ReportTable:
    front, exact = [study.rows[index] for index in study.front], _exact(study)
    some = any(row.total.amplitude.points < row.total.amplitude.total for row in rows)
    table = blank(title, "model", "solver", "off|", "rms|", "by solver|", "ms a frequency|", "times|", heads=2)
    table.add("points|", detail=not some)
    table.add("")
    table.add("modes|", "path|", "impacts|", "statistics|", "µs/period|", "µs/impact|", "why", detail=True)
    table.caption = (
        f"off, rms: amplitude, largest and root mean square, against {study.truth}; by solver: against its own model"
        f"\n{len(study.frequency)} frequencies of {study.settle} + {study.hold} periods; times: CPU, the least of the "
        f"repeats, over flight of {study.finest}; *: no run that found every motion is both nearer (rms) and cheaper"
        + further
    )
    last = ""
    for row in rows:
        name, last = "" if row.fidelity == last else row.fidelity, row.fidelity
        table.add_row(name, *_run(row, exact, len(study.frequency), row in front))
    return table


def _run(row: RunRow, exact: float, frequencies: int, best: bool) -> Iterator[str | Text]:
    """Cells of a run behind its model; one of statistics is empty without them, so that the column is left out."""
    off, own, work = row.total.amplitude, row.numerical, row.work
    yield row.label
    yield from map(share, (abs(off.worst), off.rms, abs(own.amplitude.worst)))
    yield f"{1e3 * work.cpu_min / frequencies:.3g}" if work else "–"
    yield _ratio(work.cpu_min / exact) if work else "–"
    yield f"{off.points}/{off.total}" if off.total else "–"
    yield "*" * best
    yield str(row.modes)
    yield from map(share, (own.path, own.impact_velocities))
    yield f"{share(own.statistics)} ({share(own.scatter)})" if isfinite(own.statistics) else ""
    times = (work.per_period, work.per_impact) if work else (inf, inf)
    yield from (f"{1e6 * each:.3g}" if isfinite(each) else "–" for each in times)
    yield Text(row.why, "red")


def parts(study: CostStudy) -> ReportTable:
    """Table of every fidelity's error and its parts, a row each."""
    table = blank("Where the error comes from", "fidelity", "modes|", "R₁ seen|", "part", "mean|", "rms|", "lowest|")
    table.add("highest|", "at peak|", "by the solver|", "CPU, exact|", "")
    table.caption = (
        f"of amplitude over that of {study.truth}: means and values at its peak add up; R₁: restitution that the first "
        "mode sees\nby the solver: largest, against the exact motion of its own fidelity"
    )
    for split in study.splits:
        head = (split.fidelity, str(split.modes), coefficient(split.restitution))
        table.add_row(*head, "in all", *_numbers(split.total), _by_solver(study, split), f"{split.cpu:.3g} s", "")
        for each in split.parts:
            if each.worst > ROUND_OFF or each.note:
                table.add_row("", "", "", each.name, *_numbers(each), "", "", each.note)
        table.add_section()
    return table


def _numbers(part: Part) -> tuple[str, ...]:
    mean, low, high, top = (signed(each) for each in (part.mean, part.lowest, part.highest, part.peak))
    return mean, share(part.rms), low, high, top


def _by_solver(study: CostStudy, split: Split) -> str:
    """Smallest and largest of the largest numerical errors of the runs on a fidelity."""
    found = (abs(row.numerical.amplitude.worst) for row in study.rows if row.fidelity == split.fidelity)
    known = sorted(filter(isfinite, found))
    return f"{share(known[0])} … {share(known[-1])}" if known else "–"


def uncertain(study: CostStudy, case: Case) -> Iterator[str]:
    """Notes on what is uncertain, each with what to do about it."""
    yield from _left_out(study, case)
    failed = [row for row in study.rows if row.why]
    if failed:
        first = f"{failed[0].fidelity} by {failed[0].label}: {failed[0].why}"
        yield f"{len(failed)} of {len(study.rows)} runs gave no error ({first}); -v says of each why."
    if (flown := _flown(study)) is not None:
        off, others = abs(flown.numerical.amplitude.worst), flown.numerical.kind
        if off > UNSETTLED or others:
            told = (
                f"{percent(off)} off"
                if off > UNSETTLED
                else f"in another motion at {others} of {len(study.frequency)} frequencies"
            )
            yield f"Exact flight is {told} after {study.settle} periods: --set cost.settle=… settles longer."
    yield from doubts(study.comparison)
    if not isfinite(study.bound.value):
        why = study.bound.note.partition("; ")[0]
        yield f"No second solver bounds the reference's error ({why}): vibeam.simulate(…, certify=True) does."
    irregular = max((each.total - each.points for each in (row.total.amplitude for row in study.rows)), default=0)
    if irregular:
        yield (
            f"At up to {irregular} of {len(study.frequency)} frequencies motions do not repeat and have no error of "
            "amplitude: cost.frequency chooses others, -v compares their statistics."
        )


def _left_out(study: CostStudy, case: Case) -> Iterator[str]:
    if not study.left_out:
        return
    count, solvers = len(study.left_out), dict.fromkeys(each.run.partition(" ")[0] for each in study.left_out)
    known = sum(each.seconds for each in study.left_out if isfinite(each.seconds))
    enough = _ratio(ceil(1.1 * (max(study.budget, study.cpu) + (known or study.budget))))
    yield (
        f"{count} of {count + len(study.rows)} runs, by {listed(list(solvers))}, did not fit into {study.budget:g} s: "
        f"vibeam verdict {quote(str(case.path))} --only solvers --budget '{enough} s' runs them."
    )


def details(study: CostStudy) -> Iterator[str]:
    """Sentences on the reference, on models and runs that are not there."""
    yield f"Reference: {study.finest}. Solver error: {study.bound.sentence}."
    yield from settled(study.comparison)
    for name, twin in study.same.items():
        yield f"{name}: the same model as {twin}."
    for solver, found in groupby(sorted(study.refused, key=lambda each: each.run), key=lambda each: each.run):
        several = list(found)
        why = several[0].why.removeprefix(f"solver {solver!r} cannot take ")
        yield f"{solver} cannot take {', '.join(each.fidelity for each in several)}: {why}."


def share(value: float) -> str:
    """Share as text: in percent, a power of ten where small, 0 where it is round-off."""
    if not isfinite(value):
        return "–"
    return percent(value) if abs(value) >= 1e-3 else "0" if abs(value) <= ROUND_OFF else f"{value:.0e}"
