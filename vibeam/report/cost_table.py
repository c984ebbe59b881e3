"""Accuracy against time as tables for the terminal, and in words."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from math import isfinite
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from vibeam.report.table import blank
from vibeam.report.units import percent

if TYPE_CHECKING:
    from vibeam.cost.schedule import LeftOut
    from vibeam.cost.split import Split
    from vibeam.cost.study import Row, Study

RATIO = 10.0  # times smaller: then a sentence says so


def runs(study: Study) -> Table:
    """Every run: its error against the reference and against its own fidelity's exact motion, and its work."""
    table = blank("Accuracy and time", "fidelity", "modes|", "solver", "off|", "rms|", "by solver|", "path|", "impacts|")
    for name in ("CPU|", "µs/period|", "µs/impact|", "", "why"):
        table.add_column(name.rstrip("|"), justify="right" if name.endswith("|") else "left")
    table.caption = (
        f"off, rms: sensor amplitude, largest and root mean square, against {study.finest} flown exactly\n"
        "by solver: the same against the exact motion of its own fidelity; path: Hausdorff distance to it over ten\n"
        f"periods; impacts: worst velocity on it. {len(study.frequency)} frequencies of {study.settle} + {study.hold} "
        "periods; CPU: least of the repeats; *: on the Pareto front of rms and CPU"
    )
    last = ""
    for index, row in enumerate(study.rows):
        if last and row.fidelity != last:
            table.add_section()
        table.add_row(*_run(row, row.fidelity == last, index in study.front))
        last = row.fidelity
    return table


def _run(row: Row, again: bool, best: bool) -> list[str | Text]:
    head: list[str | Text] = ["" if again else row.fidelity, "" if again else str(row.modes), row.label]
    cells = [share(row.total.amplitude_max), share(row.total.amplitude_rms), share(row.numerical.amplitude_max)]
    cells += [share(row.numerical.path), share(row.numerical.impact_velocities)]
    work = row.work
    cells += [f"{work.cpu_min:.3g} s", *map(_micro, (work.per_period, work.per_impact))] if work else ["–"] * 3
    gaps = row.total.total - row.total.points
    note = row.why or (f"{gaps} of {row.total.total} points do not repeat in both" if gaps else "")
    return [*head, *cells, "*" if best else "", Text(note, style="red" if row.why else "")]


def parts(study: Study) -> Table:
    """Every fidelity's error and its parts."""
    table = blank("Where the error comes from", "fidelity", "modes|", "R₁ seen|", "in all|")
    shown = [index for index in range(3) if any(_counts(split, index) for split in study.splits)]
    for index in shown:
        table.add_column(study.splits[0].parts[index].name, justify="right")
    for name in ("by the solver", "CPU, exact"):
        table.add_column(name, justify="right")
    table.caption = (
        f"signed means of amplitude over that of {study.finest}: they add up; R₁: restitution that the first mode sees"
    )
    for split in study.splits:
        cells = [signed(split.parts[index].mean) for index in shown]
        first = (split.fidelity, str(split.modes), f"{split.restitution:.4f}", signed(split.total.mean))
        table.add_row(*first, *cells, _range(study, split), f"{split.cpu:.3g} s")
    return table


def _counts(split: Split, index: int) -> bool:
    return split.parts[index].worst != 0


def _range(study: Study, split: Split) -> str:
    found = _solvers(study, split)
    return f"{share(found[0][0])} … {share(found[-1][0])}" if found else "–"


def _solvers(study: Study, split: Split) -> list[tuple[float, str]]:
    """Largest numerical error of every run on a fidelity, the smallest first."""
    rows = [row for row in study.rows if row.fidelity == split.fidelity and isfinite(row.numerical.amplitude_max)]
    return sorted((row.numerical.amplitude_max, row.label) for row in rows)


def sentences(study: Study) -> Iterator[str]:
    """What the figures say, a line each."""
    yield f"Reference: {study.finest}, {study.bound.sentence}."
    for split in study.splits:
        if split.fidelity != study.finest and split.points:
            yield _sentence(study, split)
    for name, twin in study.same.items():
        yield f"{name}: the same model as {twin}."
    yield from _refusals(study.refused)
    yield from _left_out(study.left_out)


def _sentence(study: Study, split: Split) -> str:
    told = [f"{signed(part.mean)} by the {part.name}" for part in split.parts if part.worst > 0]
    text = f"{split.fidelity}: {signed(split.total.mean)} in amplitude, {' and '.join(told)}"
    found = _solvers(study, split)
    if not found:
        return f"{text}."
    worse = sum(error * RATIO > abs(split.total.rms) for error, _ in found)
    (least, best), (most, worst) = found[0], found[-1]
    text += f"; the solver adds {share(least)} ({best}) to {share(most)} ({worst})"
    verdict = "the solver is not where the error is" if not worse else f"{worse} of {len(found)} runs are that coarse"
    return f"{text}: {verdict}." if not worse else f"{text}; only {verdict} that a tenth of it is the solver's."


def _refusals(refused: tuple[LeftOut, ...]) -> Iterator[str]:
    for solver, found in groupby(sorted(refused, key=lambda each: each.run), key=lambda each: each.run):
        several = list(found)
        yield f"{solver} cannot take {', '.join(each.fidelity for each in several)}: {several[0].why}."


def _left_out(left_out: tuple[LeftOut, ...]) -> Iterator[str]:
    if not left_out:
        return
    yield f"Left out, {len(left_out)} runs (--json names each; raise cost.budget):"
    for fidelity, found in groupby(sorted(left_out, key=lambda each: each.fidelity), key=lambda each: each.fidelity):
        names: dict[str, list[LeftOut]] = {}
        for each in found:
            names.setdefault(" ".join(each.run.split(" ")[:2]) if "rtol" in each.run else each.run.split(" ")[0], [])
            names[" ".join(each.run.split(" ")[:2]) if "rtol" in each.run else each.run.split(" ")[0]].append(each)
        told = [f"{name} from {several[0].run.removeprefix(name).strip()}" for name, several in names.items()]
        yield f"  {fidelity}: {', '.join(told)}"


def share(value: float) -> str:
    """A share to read: percent where it is one, else a power of ten."""
    if not isfinite(value):
        return "–"
    return percent(value) if abs(value) >= 1e-3 else "0" if value == 0 else f"{value:.0e}"


def signed(value: float) -> str:
    """A signed share."""
    if not isfinite(value):
        return "–"
    return f"{100 * value:+.3g} %" if abs(value) >= 1e-5 else "0" if value == 0 else f"{value:+.0e}"


def _micro(seconds: float) -> str:
    return f"{1e6 * seconds:.3g}" if isfinite(seconds) else "–"
