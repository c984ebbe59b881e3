"""Comparisons of a run: every fidelity with the finest of its rig, and that with a fuller model of it.

Only fidelities of the same physics are compared; a finest one that is all that the case gives has no fuller model.
"""

from __future__ import annotations

from collections.abc import Mapping
from time import thread_time

from vibeam.case.case import Case
from vibeam.runs.comparison.beyond import fuller_response, further, is_whole
from vibeam.runs.comparison.errors import Asked, ComparedFidelity, asked_of
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.comparison.simulator import simulator_of
from vibeam.runs.comparison.work import Work, WorkRate
from vibeam.system.response import Branches, modes_of
from vibeam.system.state import StatesAfter

INEXACT = 'solver "{}" is not exact'
LEAST, SHARE = 1.0, 1.0  # seconds of work, and share of that of its sweep, that a fidelity's ends may take


def compared_fidelities(
    case: Case, branches: Mapping[str, Branches], finest: Mapping[str, str],
    after: Mapping[str, Mapping[str, StatesAfter]],
) -> tuple[ComparedFidelity, ...]:  # fmt: skip
    """Comparisons of all fidelities by their ``branches``, with the states ``after`` their points.

    ``finest``: the reference of each, itself of a finest one.
    """
    found, allowed = list[ComparedFidelity](), asked_of(case)
    responses = {name: _response(case, name, each, after.get(name)) for name, each in branches.items()}
    for name, top in finest.items():
        begun, modes = thread_time(), modes_of(branches[top])
        if name != top:
            made = compared(responses[name], responses[top], allowed.frequency)
            found.append(ComparedFidelity(name, top, made, modes, cpu_seconds=thread_time() - begun))
        elif is_whole(case, name, modes):
            why = "" if (solver := case.fidelities[name].solver) == "flight" else INEXACT.format(solver)
            found.append(ComparedFidelity(name, "", None, modes, whole=not why, why=why))
        else:
            found.append(_beyond(case, name, responses[name], modes, allowed))
    return tuple(found)


def _response(case: Case, name: str, branches: Branches, after: Mapping[str, StatesAfter] | None) -> Response:
    """Response of a fidelity, which goes on from its states where they are known, for as much work as that was."""
    rate, periods = WorkRate.of(case.scene_of(name)), case.sweep.settle + case.sweep.hold
    swept = sum(float(rate.seconds(each, periods).sum()) for _, each in branches.items())
    simulator = None if after is None else simulator_of(case, name, work=Work(max(LEAST, SHARE * swept)))
    return Response.of(branches, after, simulator)


def _beyond(case: Case, name: str, own: Response, size: int, asked: Asked) -> ComparedFidelity:
    """Comparison of a finest fidelity with a fuller model, or the reason why there is none."""
    begun = thread_time()
    try:
        model, reference = fuller_response(case, name, size)
    except ValueError as refusal:
        return ComparedFidelity(name, "", None, why=str(refusal), cpu_seconds=thread_time() - begun)
    more = further(case, name, size, model.modes)
    found = compared(own, reference, asked.frequency).carried_on(more)
    return ComparedFidelity(name, "", found, model.modes, model.elements, more > 1, cpu_seconds=thread_time() - begun)
