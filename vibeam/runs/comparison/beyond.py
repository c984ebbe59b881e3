"""Fuller model of a fidelity, by which its own error is estimated: more modes, on a finer mesh where there is one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity, gap_wear, system
from vibeam.runs.comparison.errors import GIVEN, Asked, ComparedFidelity
from vibeam.runs.comparison.places import Simulator, SweptPlace, simulated
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.comparison.simulator import simulator_of
from vibeam.runs.comparison.work import Work, WorkSpent
from vibeam.system.curves import evenly
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.beam import structure_of
from vibeam_models.scene import RigScene, Scene, line_of

LEAST, MOST = 16, 160  # modes of a fuller model
FEW = 8  # modes of a model, up to which a fuller one has four times as many, else twice
RESOLVED = 3  # elements a mode: the frequency of the highest is then within 0.1 %
MANY = 41  # coordinates, the contact's residual flexibility among them, that stand for all modes of a solid
PLACES = 31  # frequencies of its sweep
WORK = 1.5  # seconds that its sweep may take, counted; that with the other restitution too

WEARS = "each impact widens the gap, so that no motion repeats"
DEAR = "a sweep of {} modes takes longer than {:g} s"


@dataclass(frozen=True)
class FullerModel:
    """Model of more ``modes`` of a rig, on so many ``elements``; 0: its mesh is as given. ``make`` makes its system."""

    modes: int
    elements: int
    make: Callable[[], ImpactSystem]


def is_whole(case: Case, name: str, size: int) -> bool:
    """Test whether a fidelity is all that there is of its rig: its one mode, all modes of matrices or of few masses."""
    scene: Any = case.scene_of(name)
    if scene.given_mode is not None:
        return True
    if not isinstance(scene, RigScene) or not scene.all_modes or scene.in_three_dimensions:
        return False
    line = line_of(scene)
    if line is None:
        return size >= structure_of(scene).size
    most = case.model(name).most_modes or line.beam.elements
    return size >= most and most < line.beam.elements  # a massless beam: its masses alone make modes


def fuller_models(case: Case, name: str, size: int) -> Iterator[FullerModel]:
    """Fuller models of a fidelity of ``size`` modes, the largest first; ValueError where the case has none."""
    scene = case.scene_of(name)
    if gap_wear(scene) is not None:
        raise ValueError(WEARS)
    if not isinstance(scene, RigScene) or not scene.all_modes:
        raise ValueError(GIVEN)
    line, more = line_of(scene), (4, 2) if size <= FEW else (2,)
    if scene.in_three_dimensions:
        if size >= MANY:
            raise ValueError("more modes of a solid are not computed here")
        yield FullerModel(MANY, 0, partial(system, scene, Fidelity("fuller", "residual_flexibility", modes=MANY)))
    elif line is None:
        most = structure_of(scene).size
        for modes in dict.fromkeys(min(most, max(LEAST, by * size)) for by in more):
            yield FullerModel(modes, 0, partial(system, scene, Fidelity("fuller", "modal", modes=modes)))
    else:
        for modes in dict.fromkeys(min(MOST, max(LEAST, by * size)) for by in (*more, 1)):
            fine = resolving(line, modes)
            made = partial(system, fine, Fidelity("fuller", "modal", modes=modes))
            yield FullerModel(modes, fine.beam.elements, made)


def further(case: Case, name: str, size: int, modes: int) -> float:
    """Distance of a fidelity from infinitely many modes, over that from a fuller model of so many.

    With R held at a rigid contact what is left goes like one over the number of modes: each takes its share of the
    impulse. With R₁ held, and where the stop yields, it decays much faster.
    """
    stop: Any = case.scene_of(name).stop
    slow = stop is not None and stop.law is None and stop.restitution_of == "contact"
    return modes / (modes - size) if slow and modes > size else 1.0


def resolving(scene: Scene, modes: int) -> Scene:
    """The scene on an even number of elements that resolve so many modes."""
    elements = max(scene.beam.elements, RESOLVED * modes)
    return replace(scene, beam=replace(scene.beam, elements=elements + elements % 2))


def fuller_response(case: Case, name: str, size: int, work: float, a_place: float) -> tuple[FullerModel, Response]:
    """Response of the largest fuller model of a fidelity of ``size`` modes whose sweep fits into the ``work``, s.

    ``a_place``: work that each place of the fidelity's own sweep took. ValueError without one.
    """
    modes, places = 0, min(PLACES, len(case.sweep.frequency)) * (1 + (case.sweep.direction == "both"))
    for model in fuller_models(case, name, size):
        allowed, modes = Work(work), model.modes
        dear = allowed.surely_exceeded(places * a_place, modes / size)
        if not dear and (found := response_of(case, name, model.make(), PLACES, allowed)) is not None:
            return model, found
    raise ValueError(DEAR.format(modes, work))


def beside_fuller(
    case: Case, name: str, own: Response, size: int, asked: Asked, a_place: float, work: float = WORK
) -> ComparedFidelity:  # fmt: skip
    """Comparison of a fidelity with a fuller model, as ``fuller_response`` makes it; or the reason without one."""
    try:
        model, reference = fuller_response(case, name, size, work, a_place)
    except ValueError as refusal:
        return ComparedFidelity(name, "", None, why=str(refusal))
    more = further(case, name, size, model.modes)
    found = compared(own, reference, asked.frequency).carried_on(more)
    return ComparedFidelity(name, "", found, model.modes, model.elements, more > 1)


def response_of(case: Case, name: str, made: ImpactSystem, most: int, work: Work | None = None) -> Response | None:
    """Response of a system in place of that of a fidelity, at ``most`` of the sweep's frequencies.

    None where its sweep takes more than the ``work``, or will by its first places; what is left of it is for the ends
    of branches.
    """
    work = work or Work()
    simulator = simulator_of(case, name, made, work)
    if simulator is None:
        raise ValueError(WEARS)
    grid = np.sort(case.sweep.frequency)
    up = grid[evenly(0, len(grid) - 1, most)].tolist()
    ways = {"up": {"up": up}, "down": {"down": up[::-1]}, "both": {"up": up, "down": up[::-1]}}[case.sweep.direction]
    work.breaks = work.most < inf
    try:
        found = _places(simulator, ways, work)
    except WorkSpent:
        return None
    work.breaks = False
    return Response(found, simulator)


def _places(simulator: Simulator, ways: Mapping[str, list[float]], work: Work) -> dict[str, list[SweptPlace]]:
    """Places of the frequencies of a sweep in each direction; ``WorkSpent`` where it does not fit."""
    found, last, count, total = {way: list[SweptPlace]() for way in ways}, None, 0, sum(map(len, ways.values()))
    for way, frequencies in ways.items():
        for frequency in frequencies:
            last, count = simulated(simulator, frequency, last), count + 1
            found[way].append(last)
            if not work.fits(count, total):
                raise WorkSpent
    return found
