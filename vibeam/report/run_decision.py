"""What the pictures of a run show: its fidelities over each other, their errors over the CPU time of a point."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.report.decision_figures import Decision
from vibeam.report.error_panels import ModelError
from vibeam.report.run_answer import PhysicsGroup, groups_of
from vibeam.runs.comparison.errors import Asked
from vibeam.runs.summary import Summary, compare

if TYPE_CHECKING:
    from vibeam.runs.result import Result

MOST = 3  # groups of one physics that are drawn


def run_decisions(result: Result) -> list[Decision]:
    """What the pictures of a result show, for each group of fidelities of one physics; none of one fidelity alone."""
    groups = groups_of(result, compare(result))[:MOST]
    return [_of_group(result, each, f", {each.finest.fidelity}" * (len(groups) > 1)) for each in groups]


def _of_group(result: Result, group: PhysicsGroup, name: str) -> Decision:
    asked, top = result.asked, group.finest.fidelity
    rows = [row for row in group.others if group.compared[row.fidelity].comparison is not None]
    shown = [row.fidelity for row in recommended(group, asked)]
    curves = {(name, way): (each.frequency, each.amplitude)
              for name in [top, *shown] for way, each in result[name].items()}  # fmt: skip
    errors = [_error(result, group, row, asked) for row in rows]
    if group.own.comparison is not None:
        errors.append(_error(result, group, group.finest, asked, beyond=True))
    return Decision(
        result.case, asked, top, curves,
        {each: found for each in shown if (found := group.compared[each].comparison) is not None},
        tuple(errors) if len(group.others) > 1 else (), _seconds(result, group.finest),
        tuple(row.fidelity for row in group.others if row not in rows), name,
    )  # fmt: skip


def recommended(group: PhysicsGroup, asked: Asked) -> list[Summary]:
    """The cheapest fidelity that suffices, else the closest to the finest, and the next one with fewer modes."""
    known = [(row, found) for row in group.others if (found := group.compared[row.fidelity].comparison) is not None]
    less = [(row, found) for row, found in known if group.is_less(row)] or known
    if not less:
        return []
    enough = [row for row, found in less if found.suffices(asked)]
    best = enough[0] if enough else min(less, key=lambda each: each[1].worst(asked))[0]
    return [best, *[row for row, _ in less if row.modes < best.modes][-1:]]


def _error(result: Result, group: PhysicsGroup, row: Summary, asked: Asked, beyond: bool = False) -> ModelError:
    found = group.compared[row.fidelity].comparison
    assert found is not None  # those without are left out
    return ModelError.of(row.fidelity, found, asked, _seconds(result, row), row.fidelity, beyond)


def _seconds(result: Result, row: Summary) -> float:
    """CPU time of a point."""
    return row.cpu_seconds / max(sum(len(each) for _, each in result[row.fidelity].items()), 1)
