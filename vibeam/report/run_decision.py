"""What the pictures of a run show: its fidelities over each other, their errors over the CPU time of a point."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vibeam.report.decision_figures import Decision, ModelCurve
from vibeam.report.error_panels import ErrorSize, ModelError
from vibeam.report.run_answer import PhysicsGroup, groups_of
from vibeam.report.transient_answer import FidelityAnswer, answers
from vibeam.runs.comparison.errors import Asked
from vibeam.runs.summary import Summary, compare

if TYPE_CHECKING:
    from vibeam.runs.result import Result
    from vibeam.runs.transient.comparison import PairedDifference
    from vibeam.runs.transient.result import TransientResult

FEW = 2  # fidelities whose errors over time are seen in the first picture
MOST = 3  # groups of one physics that are drawn


def run_decisions(result: Result) -> list[Decision]:
    """What the pictures of a result show, for each group of fidelities of one physics; none of one fidelity alone."""
    groups = groups_of(result, compare(result))[:MOST]
    return [_of_group(result, each, f", {each.finest.fidelity}" * (len(groups) > 1)) for each in groups]


def _of_group(result: Result, group: PhysicsGroup, name: str) -> Decision:
    asked, top = result.asked, group.finest.fidelity
    rows = [row for row in group.others if group.compared[row.fidelity].comparison is not None]
    shown = [row.fidelity for row in recommended(group, asked)]
    errors = [_error(result, group, row, asked) for row in rows]
    if group.own.comparison is not None:
        errors.append(_error(result, group, group.finest, asked, beyond=True))
    return Decision(
        result.case, asked, top, tuple(_curves(result, [top, *shown])),
        tuple((each, found) for each in shown if (found := group.compared[each].comparison) is not None),
        tuple(errors) if len(group.others) + 1 > FEW else (), _seconds(result, group.finest),
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


def _curves(result: Result, names: Iterable[str]) -> Iterator[ModelCurve]:
    for name in names:
        for direction, response in result[name].items():
            yield ModelCurve(name, direction, response.frequency, response.amplitude)


def _error(result: Result, group: PhysicsGroup, row: Summary, asked: Asked, beyond: bool = False) -> ModelError:
    found = group.compared[row.fidelity].comparison
    assert found is not None  # those without are left out
    return ModelError.of(row.fidelity, found, asked, _seconds(result, row), row.fidelity, beyond)


def _seconds(result: Result, row: Summary) -> float:
    """CPU time of a point."""
    return row.cpu_seconds / max(sum(len(each) for _, each in result[row.fidelity].items()), 1)


def record_decision(result: TransientResult, accuracy: float) -> Decision:
    """What the picture of a result under a record shows: errors of the peaks over the CPU time of a motion."""
    found = answers(result)
    finest = next(iter(result.comparison.values())).finest if found else ""
    errors = tuple(_of_record(result, each, accuracy) for each in found if each.principal)
    left_out = tuple(each.name for each in found if not each.principal)
    return Decision(
        result.case, Asked.of(accuracy), finest, errors=errors if len(found) + 1 > FEW else (), left_out=left_out,
        reference_seconds=_of_motion(result, finest) if found else float("nan"), of_peaks=True,
    )  # fmt: skip


def _of_record(result: TransientResult, found: FidelityAnswer, accuracy: float) -> ModelError:
    worst = max((peak_error(each, accuracy) for each in found.principal), key=lambda error: error.value)
    return ModelError(found.name, _of_motion(result, found.name), worst, mark=found.name)


def peak_error(found: PairedDifference, accuracy: float) -> ErrorSize:
    """Size of a paired difference; its bound where two standard errors leave open whether it is within."""
    spread = 2 * found.error if isfinite(found.error) else 0.0
    is_open = abs(found.mean) - spread <= accuracy < abs(found.mean) + spread
    return ErrorSize(abs(found.mean) + spread * is_open, is_open)


def _of_motion(result: TransientResult, name: str) -> float:
    """CPU time of a motion."""
    return float(np.nanmean(result[name].cpu_seconds))
