"""Comparisons of a run: every fidelity with the finest of its rig, and that with a fuller model of it.

Only fidelities of the same physics are compared; a finest one that is all that the case gives has no fuller model.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vibeam.case.case import Case
from vibeam.runs.comparison.beyond import beside_fuller, is_whole
from vibeam.runs.comparison.errors import ComparedFidelity, asked_of
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.comparison.simulator import simulator_of
from vibeam.runs.comparison.work import Work, WorkRate
from vibeam.system.response import Branches, modes_of
from vibeam.system.state import StatesAfter
from vibeam_models.arrays import Array

INEXACT = 'solver "{}" is not exact'
LEAST, SHARE = 1.0, 1.0  # seconds of work, and share of that of its sweep, that a fidelity's ends may take


def compared_fidelities(
    case: Case, branches: Mapping[str, Branches], finest: Mapping[str, str],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> tuple[ComparedFidelity, ...]:  # fmt: skip
    """Comparisons of all fidelities by their ``branches``, with the states ``after`` their points.

    ``finest``: the reference of each, itself of a finest one.
    """
    found = list[ComparedFidelity]()
    responses = {name: _response(case, name, each, after.get(name)) for name, each in branches.items()}
    for name, top in finest.items():
        modes = modes_of(branches[top])
        if name != top:
            made = compared(responses[name], responses[top], asked_of(case).frequency)
            found.append(ComparedFidelity(name, top, made, modes))
        elif is_whole(case, name, modes):
            why = "" if (solver := case.fidelities[name].solver) == "flight" else INEXACT.format(solver)
            found.append(ComparedFidelity(name, "", None, modes, whole=not why, why=why))
        else:
            a_place = float(_work(case, name, branches[name]).mean())
            found.append(beside_fuller(case, name, responses[name], modes, asked_of(case), a_place))
    return tuple(found)


def _response(case: Case, name: str, branches: Branches, after: Mapping[str, StatesAfter] | None) -> Response:
    """Response of a fidelity, which goes on from its states where they are known, for as much work as that was."""
    most = max(LEAST, SHARE * float(_work(case, name, branches).sum()))
    simulator = None if after is None else simulator_of(case, name, work=Work(most))
    return Response.of(branches, after, simulator)


def _work(case: Case, name: str, branches: Branches) -> Array:
    """Work of all places of a fidelity, s."""
    rate, periods = WorkRate.of(case.scene_of(name)), case.sweep.settle + case.sweep.hold
    return np.concatenate([rate.seconds(each, periods) for _, each in branches.items()])
