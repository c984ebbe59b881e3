"""Content of the pictures of a run: its fidelities over each other, their errors over the CPU time of a point."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from vibeam.report.decision_figures import Decision
from vibeam.report.error_panels import ModelError
from vibeam.report.run_answer import PhysicsGroup, groups_of
from vibeam.runs.comparison.errors import Asked, ResponseComparison
from vibeam.runs.summary import Summary, compare

if TYPE_CHECKING:
    from vibeam.runs.result import Result

MOST = 3  # groups of one physics that are drawn


def run_decisions(result: Result) -> list[Decision]:
    """Content of the pictures of a result, for each group of fidelities of one physics; none of one fidelity alone."""
    groups = groups_of(result, compare(result))[:MOST]
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
