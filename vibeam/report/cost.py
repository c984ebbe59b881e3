"""Error against CPU time as a sheet: the answer, the runs that no other beats, all runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from math import inf, isfinite, nan
from shlex import quote
from typing import TYPE_CHECKING

from rich.text import Text

from vibeam.case.held import held_of
from vibeam.case.study_plans import VerdictPlan
from vibeam.exchange.files import dotted
from vibeam.report.decision_figures import Decision, ErrorSize, ModelError
from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank
from vibeam.runs.comparison.differences import listed
from vibeam.runs.comparison.errors import Asked
from vibeam.system.number_text import percent, shown_in

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.cost.row import RunRow
    from vibeam.studies.cost.study import CostStudy


UNSETTLED = 1e-3  # error of flight from which on it has not settled
ROUND_OFF, EXACT = 1e-12, 1e-5  # errors that are no larger are none, or nearly none


def sheet(study: CostStudy, case: Case, within: float = VerdictPlan.accuracy) -> StudySheet:
    """Sheet of a study of ``case``; as CSV a row a run, nested values by names with a dot: ``total.rms``."""
    pictures = list(decision(study, case, within).pictures)
    return StudySheet(
        answer=answer(study, case, within),
        tables=[_runs(study, "Error against CPU time", [study.rows[index] for index in study.front])],
        notes=list(uncertain(study, case)),
        details=list(details(study)),
        more=[_runs(study, "All runs", study.rows)],
        data={"study": study},
        rows=[dict(dotted(plain(row))) for row in study.rows],
        draw=pictures[0].draw if pictures else None,
        pictures=pictures,
    )


def decision(study: CostStudy, case: Case, within: float) -> Decision:
    """Content of the picture: the largest error of amplitudes of each run, open where it has no motion somewhere."""
    sizes = [(row, ErrorSize(abs(row.total.worst), row.found < len(study.frequency))) for row in study.rows]
    errors = tuple(
        ModelError(row.fidelity, row.seconds, size, solver=row.solver) for row, size in sizes if size.value >= 0
    )
    known, every = {each.solver for each in errors}, dict.fromkeys(row.solver for row in study.rows)
    left_out = tuple(name for name in every if name not in known)
    return Decision(
        case, Asked.of(within), study.finest, errors=errors, reference_seconds=_exact(study), left_out=left_out
    )


def answer(study: CostStudy, case: Case, within: float = VerdictPlan.accuracy) -> str:
    """Sentence on the finest fidelity's time and the cheapest run ``within`` an error."""
    exact = _exact(study)
    if not isfinite(exact):
        return f"No run of {study.finest} by flight fits into {study.budget:g} s of CPU time."
    unit, factor = shown_in("s", exact)
    points = min((row.total.points for row in study.rows if row.total.points and not row.why), default=0)
    where = f", at the frequencies where motions repeat (at least {points} of {len(study.frequency)})"
    choice = held_of(case.scene)
    kept = f" {'The ' * (choice.coefficient is None)}{choice.label} is prescribed." * (len(case.fidelities) > 1)
    first = f"Exact flight of {study.finest} takes {exact * factor:.2g} {unit} a frequency"
    return f"{first}; {_cheaper(study, within, exact)}{where * (0 < points < len(study.frequency))}.{kept}"


def _exact(study: CostStudy) -> float:
    """CPU seconds a frequency of the finest fidelity's flight; NaN where it did not run."""
    return next((row.seconds for row in study.rows if (row.fidelity, row.solver) == (study.finest, "flight")), nan)


def _seconds(row: RunRow) -> float:
    return row.seconds if isfinite(row.seconds) else inf


def _worst(row: RunRow) -> float:
    """Largest error in amplitude, without its sign; ∞ where there is none."""
    return abs(row.total.worst) if isfinite(row.total.worst) else inf


def _cheaper(study: CostStudy, within: float, exact: float) -> str:
    """The cheapest run within the accuracy, or the nearest of those that cost less than the finest's flight.

    Nothing is said of a run whose error is known at less than half of the frequencies.
    """
    count = len(study.frequency)
    less = [row for row in study.rows if row.found == count and _seconds(row) < exact]
    known = [row for row in less if isfinite(_worst(row)) and 2 * row.total.points >= count]
    if not known:
        said = f"of cheaper runs the error is known at less than half of the {count} frequencies"
        return said if less else "nothing is cheaper"
    enough = [row for row in known if _worst(row) <= within]
    best = min(enough, key=_seconds) if enough else min(known, key=_worst)
    said = f"{best.fidelity} by {best.label}, {_ratio(exact / _seconds(best))} times faster and {_off(best)}"
    if enough:
        return f"the cheapest within {percent(within)} is {said}"
    return f"nothing cheaper is within {percent(within)}: the nearest is {said}"


def _off(row: RunRow) -> str:
    if _worst(row) > EXACT:
        return f"{percent(_worst(row))} off"
    return f"exact{f' to {share(_worst(row))}' * (_worst(row) > ROUND_OFF)}"


def _ratio(value: float) -> str:
    return f"{float(f'{value:.2g}'):g}"


def _runs(study: CostStudy, title: str, rows: Sequence[RunRow]) -> ReportTable:
    front, exact = [study.rows[index] for index in study.front], _exact(study)
    some = any(row.total.points < len(study.frequency) for row in rows)
    table = blank(title, "model", "solver", "off|", "rms|", "ms a frequency|", "times|", heads=2)
    table.add("points|", detail=not some)
    table.add("")
    table.add("modes|", "µs/period|", "CPU|", "why", detail=True)
    table.caption = (
        f"off, rms: amplitude, largest and root mean square, against {study.finest}, exact\n"
        f"{len(study.frequency)} frequencies of {study.settle} + {study.hold} periods; times: CPU over that of "
        f"{study.finest} by flight; >: given up before one\n"
        "*: no run that found every motion is both nearer (rms) and cheaper; all others with -v"
    )
    last = ""
    for row in rows:
        name, last = "" if row.fidelity == last else row.fidelity, row.fidelity
        table.add_row(name, *_run(row, exact, len(study.frequency), row in front))
    return table


def _run(row: RunRow, exact: float, frequencies: int, best: bool) -> Iterator[str | Text]:
    """Cells of a run behind its model."""
    over, seconds = ("> ", row.used) if not row.computed else ("", row.seconds)
    yield row.label
    yield from map(share, (abs(row.total.worst), row.total.rms))
    yield f"{over}{1e3 * seconds:.3g}"
    yield f"{over}{_ratio(seconds / exact)}" if isfinite(exact) else "–"
    yield f"{row.total.points}/{frequencies}"
    yield "*" * best
    yield from (str(row.modes), f"{over}{1e6 * seconds / row.periods:.3g}", f"{row.used:.2g} s")
    yield Text(row.why, "red")


def uncertain(study: CostStudy, case: Case) -> Iterator[str]:
    """Notes on what is uncertain, each with what to do about it."""
    yield from _without_time(study, case)
    failed = [row for row in study.rows if row.computed and not row.total.points]
    if failed:
        first = f"{failed[0].fidelity} by {failed[0].label}: {failed[0].why}"
        yield f"{len(failed)} of {len(study.rows)} runs gave no error ({first}); -v says of each why."
    flights = (row for row in study.rows if (row.fidelity, row.solver) == (study.finest, "flight"))
    off = max((abs(row.total.worst) for row in flights), default=0.0)
    if off > UNSETTLED:
        yield f"Flight is {percent(off)} off after {study.settle} periods: --set cost.settle=… settles longer."
    irregular = max((row.computed - row.total.points for row in study.rows if not row.why), default=0)
    if irregular:
        yield (
            f"At up to {irregular} of {len(study.frequency)} frequencies motions do not repeat and have no error of "
            "amplitude: cost.frequency chooses others."
        )


def _without_time(study: CostStudy, case: Case) -> Iterator[str]:
    """Note on the runs given up or left out for the budget, by solver, with the time that they had used."""
    short = [row for row in study.rows if row.computed < len(study.frequency)]
    count = len(short) + len(study.left_out)
    if count:
        used: dict[str, float] = {}
        for row in short:
            used[row.solver] = used.get(row.solver, 0.0) + row.used
        told = [f"{solver} ({seconds:.2g} s used)" for solver, seconds in used.items()]
        names = dict.fromkeys(each.run.partition(" ")[0] for each in study.left_out)
        rest = [name for name in names if name not in used]
        yield (
            f"{count} of {len(study.rows) + len(study.left_out)} runs did not fit into {study.budget:g} s, by "
            f"{listed([*told, *rest])}: vibeam verdict {quote(str(case.path))} --only solvers --budget "
            f"'{_ratio(10 * study.budget)} s' runs more of them."
        )
    if len(study.frequency) < study.asked:
        yield f"{len(study.frequency)} frequencies in place of {study.asked}, for the budget: --budget allows more."


def details(study: CostStudy) -> Iterator[str]:
    """Sentences on models and runs that are not there."""
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
