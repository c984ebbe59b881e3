"""Accuracy against time as terminal tables and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import groupby
from math import isfinite
from typing import TYPE_CHECKING, Any

from rich.text import Text

from vibeam.exchange.files import dotted
from vibeam.report.output import StudySheet, plain
from vibeam.report.tables import ReportTable, blank, coefficient
from vibeam.report.work_precision import work_precision
from vibeam.runs.comparison.differences import headline, notes
from vibeam.system.number_text import percent, signed

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.cost.planning import LeftOut
    from vibeam.studies.cost.row import Part, RunRow, Split
    from vibeam.studies.cost.study import CostStudy


def sheet(study: CostStudy, case: Case) -> StudySheet:
    """Sheet of a study of ``case``; as CSV a row a run, nested values by names with a dot: ``total.amplitude.rms``."""
    said = list(sentences(study))
    return StudySheet(
        headline(study.comparison), [runs(study), parts(study)], said, data={"study": study},
        rows=[_cells(plain(row)) for row in study.rows], draw=lambda: work_precision(study, case), coarse=True,
    )  # fmt: skip


def _cells(row: Mapping[str, Any]) -> dict[str, Any]:
    parts = {part["name"]: {key: part[key] for key in ("mean", "rms", "worst", "peak")} for part in row["parts"]}
    return dict(dotted({**row, "parts": parts}))


ROUND_OFF = 1e-12  # parts that are no larger are left out
RATIO = 10.0  # ratio of solver error to model error below which a sentence says so


def runs(study: CostStudy) -> ReportTable:
    """Table of all runs: error against the reference and against the fidelity's exact motion, and the work."""
    chaos = any(isfinite(row.numerical.statistics) for row in study.rows)
    names = ["fidelity", "modes|", "solver", "points|", "off|", "rms|", "by solver|", "path|", "impacts|"]
    names += ["statistics|"] * chaos + ["CPU|", "µs/period|", "µs/impact|", "", "why"]
    table = blank("Accuracy and time", *names, heads=3)
    table.caption = _legend(study, chaos)
    last = ""
    for index, row in enumerate(study.rows):
        if last and row.fidelity != last:
            table.add_section()
        table.add_row(*_run(row, row.fidelity == last, index in study.front, chaos))
        last = row.fidelity
    return table


def _legend(study: CostStudy, chaos: bool) -> str:
    text = (
        f"off, rms: amplitude, largest and root mean square, against {study.truth}, where both repeat\n"
        "by solver: largest, against the exact motion of its own fidelity; path: Hausdorff distance to it over ten "
        "periods; impacts: worst velocity on it\n"
        f"{len(study.frequency)} frequencies of {study.settle} + {study.hold} periods; CPU: least of the repeats, the "
        "solver's making included; *: on the Pareto front of rms and CPU, for runs that found every motion"
    )
    notes = (
        "\nstatistics: where neither repeats, the worst of means and deciles (in brackets: of the exact one's halves)"
    )
    return text + notes * chaos


def _run(row: RunRow, again: bool, best: bool, chaos: bool) -> list[str | Text]:
    head: list[str | Text] = ["" if again else row.fidelity, "" if again else str(row.modes), row.label]
    total, own, work = row.total, row.numerical, row.work
    off, alone = total.amplitude, abs(own.amplitude.worst)
    cells = [f"{off.points}/{off.total}" if off.total else "–", share(abs(off.worst))]
    cells += map(share, (off.rms, alone, own.path, own.impact_velocities))
    statistics = f"{share(own.statistics)} ({share(own.scatter)})" if isfinite(own.statistics) else "–"
    cells += [statistics] * chaos
    cells += [f"{work.cpu_min:.3g} s", *map(_micro, (work.per_period, work.per_impact))] if work else ["–"] * 3
    return [*head, *cells, "*" if best else "", Text(row.why, style="red")]


def parts(study: CostStudy) -> ReportTable:
    """Table of every fidelity's error and its parts, a row each."""
    table = blank("Where the error comes from", "fidelity", "modes|", "R₁ seen|", "part", "mean|", "rms|", "lowest|")
    table.add("highest|", "at peak|", "by the solver|", "CPU, exact|")
    table.caption = (
        f"of amplitude over that of {study.truth}: means and values at its peak add up; R₁: restitution that the first "
        "mode sees\nby the solver: largest, against the exact motion of its own fidelity"
    )
    for split in study.splits:
        head = (split.fidelity, str(split.modes), coefficient(split.restitution))
        table.add_row(*head, "in all", *_numbers(split.total), _range(study, split), f"{split.cpu:.3g} s")
        for each in split.parts:
            if each.worst > ROUND_OFF:
                table.add_row("", "", "", each.name, *_numbers(each), "", "")
        table.add_section()
    return table


def _numbers(part: Part) -> tuple[str, ...]:
    return signed(part.mean), share(part.rms), signed(part.lowest), signed(part.highest), signed(part.peak)


def _range(study: CostStudy, split: Split) -> str:
    found = _solvers(study, split)
    return f"{share(found[0][0])} … {share(found[-1][0])}" if found else "–"


def _solvers(study: CostStudy, split: Split) -> list[tuple[float, str]]:
    """Largest numerical error of every run on a fidelity, the smallest first."""
    found = [(abs(row.numerical.amplitude.worst), row.label) for row in study.rows if row.fidelity == split.fidelity]
    return sorted(each for each in found if isfinite(each[0]))


def sentences(study: CostStudy) -> Iterator[str]:
    """Sentences that interpret the numbers, a line each."""
    yield f"Reference: {study.finest}. Solver error: {study.bound.sentence}."
    yield from notes(study.comparison)
    for split in study.splits:
        if (study.reference or split.fidelity != study.finest) and split.points:
            yield _sentence(study, split)
    for name, twin in study.same.items():
        yield f"{name}: the same model as {twin}."
    yield from _refusals(study.refused)
    yield from _left_out(study.left_out)


def _sentence(study: CostStudy, split: Split) -> str:
    parts = [f"{signed(part.peak)} by the {part.name}" for part in split.parts if part.worst > ROUND_OFF]
    parts += [f"no part for the {part.name} ({part.note})" for part in split.parts if part.note]
    total = split.total
    text = f"{split.fidelity}: {signed(total.peak)} in amplitude at the peak ({signed(total.mean)} in the mean)"
    text += f", {' and '.join(parts)}" if parts else ""
    found = _solvers(study, split)
    if not found:
        return f"{text}."
    large = sum(error * RATIO > split.total.rms for error, _ in found)
    (least, best), (most, worst) = found[0], found[-1]
    text += f"; the solver's part is {share(least)} ({best}) to {share(most)} ({worst})"
    if not large:
        return f"{text}: the solver is not where the error is."
    return f"{text}, more than a tenth of it in {large} of {len(found)} runs."


def _refusals(refused: tuple[LeftOut, ...]) -> Iterator[str]:
    for solver, found in groupby(sorted(refused, key=lambda each: each.run), key=lambda each: each.run):
        several = list(found)
        why = several[0].why.removeprefix(f"solver {solver!r} cannot take ")
        yield f"{solver} cannot take {', '.join(each.fidelity for each in several)}: {why}."


def _left_out(left_out: tuple[LeftOut, ...]) -> Iterator[str]:
    """One line a fidelity, with the first setting of each series that was left out."""
    if not left_out:
        return
    yield f"Left out for want of time, {len(left_out)} runs (--json has each; [cost] budget gives more):"
    for fidelity in dict.fromkeys(each.fidelity for each in left_out):
        first: dict[str, str] = {}
        for run in [each.run for each in left_out if each.fidelity == fidelity]:
            series, rtol, setting = run.partition(" rtol ")
            first.setdefault(series if rtol else run.partition(" ")[0], f"{rtol}{setting}" if rtol else "")
        names = [f"{series} from{setting}" if setting else series for series, setting in first.items()]
        yield f"  {fidelity}: {', '.join(names)}"


def share(value: float) -> str:
    """Share as text: in percent, or a power of ten where small."""
    if not isfinite(value):
        return "–"
    return percent(value) if abs(value) >= 1e-3 else "0" if value == 0 else f"{value:.0e}"


def _micro(seconds: float) -> str:
    return f"{1e6 * seconds:.3g}" if isfinite(seconds) else "–"
