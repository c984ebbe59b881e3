"""Verdict on the beam by the solid of the same rig: whether it suffices, and what each of its assumptions changes.

The models from the beam to the solid are variants of one rig, each with one assumption of the beam's less; the solid is
their reference. Held is what the case holds, R of the contact or R₁ of mode 1; the other one follows in each model.
The mobility is that of as many modes as the beam has, told by their shapes: of a patch that of all modes grows without
limit as the mesh is refined, and is not compared. What half as many elements in each direction change tells the error
of the mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import inf, isfinite, nan
from time import process_time
from typing import ClassVar

import numpy as np

from vibeam.case.case import Case
from vibeam.case.source import of_source
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam.extensions.solid.verdict.model import FIRST, SteppedModel
from vibeam.extensions.solid.verdict.steps import LadderStep, coarser, ladder, solid_of
from vibeam.runs.comparison.differences import listed
from vibeam.runs.comparison.errors import Asked, ResponseComparison
from vibeam.runs.comparison.responses import Response
from vibeam.studies.changes import COMPARED, ModelVariant, change_of, compared_by, of_comparison
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.system.curves import evenly
from vibeam.system.labelled import ViewedTable
from vibeam.system.progress import telling
from vibeam_models.arrays import ValueRecord
from vibeam_models.scene import Scene

USUAL, MOST = 8, 16  # modes of a beam whose fidelity does not count them, or counts more
POINTS = 31  # frequencies of the sweep at most
FREQUENCIES = tuple(f"f{number}" for number in range(1, FIRST + 1))
QUANTITIES = (
    *(each.quantity for each in COMPARED), *FREQUENCIES, "twist", "flexibility", "mobility", "restitution",
    "first_mode_restitution", "peak", "peak_frequency",
)  # fmt: skip
SAFE = 0.5  # of the change: ⅓ of it is the error where that is of second order, as in flat elements and at clamps
LEFT_OUT = "left out: over the budget"
MORE = (3, 8)  # halves of the beam's number of modes, in which the first ones are looked for
COARSER = "solid, half the elements", "the mesh"
OF_RECORD = "is not compared under a record: vibeam verdict --only map has the peaks of all fidelities"


@dataclass(frozen=True)
class SolidVariant(ModelVariant):
    """Model on the way to the solid, which ``cause`` leads to: its ``values``, and their changes from the solid's.

    ``numbers`` of the beam's bending modes among its own, ``twisted`` that of the first one in torsion, 0 without;
    ``unread``: keys of the case that it does not read.
    """

    name: str = ""
    cause: str = ""
    values: Mapping[str, float] = field(default_factory=dict)
    numbers: tuple[int, ...] = ()
    twisted: int = 0
    unread: tuple[str, ...] = ()

    def value(self, quantity: str) -> float:
        """Value of a quantity; NaN where it has none."""
        return self.values.get(quantity, nan)

    def error(self, quantity: str) -> float:
        """Error of a quantity beside the solid, as a share; NaN where one of the two has none."""
        return self.change(AskedNumber(quantity))


@dataclass(frozen=True, eq=False, repr=False)
class SolidVerdict(ValueRecord, ViewedTable):
    """Beam and solid of a rig and what is between them: ``models``, the beam first, the solid last.

    ``asked``: the errors allowed; ``coarser``: the solid with half as many elements in each direction, without numbers
    where it was left out. ``missing``: why models were not made, some to keep to ``budget`` s of CPU time of the
    ``seconds`` spent; the next one has their causes too.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"beam.elements": 12, "sweep.frequency.points": 3})
    >>> list(vibeam.solid_verdict(case, budget=1e-9).steps)
    ['shear, three dimensions, plate stiffening and the clamp']
    """

    shown_by: ClassVar[str] = "vibeam.extensions.solid.sheet:sheet"

    case: Case
    fidelity: str
    asked: Asked
    models: tuple[SolidVariant, ...]
    coarser: SolidVariant
    missing: dict[str, str] = field(default_factory=dict)
    seconds: float = nan
    budget: float = inf

    @property
    def left_out(self) -> int:
        """Number of models that did not fit into the budget."""
        return list(self.missing.values()).count(LEFT_OUT)

    @property
    def beam(self) -> SolidVariant:
        """The beam as the case has it."""
        return self.models[0]

    @property
    def solid(self) -> SolidVariant:
        """The solid as the case has it."""
        return self.models[-1]

    def error(self, quantity: str) -> float:
        """Error of the beam in a quantity, relative to the solid's; NaN where one of the two has none."""
        return self.beam.error(quantity)

    def mesh_error(self, quantity: str) -> float:
        """Error of the solid's quantity by its mesh, relative: ``SAFE`` times what half as many elements change."""
        return next((SAFE * each.size for each in self.coarser.changes if each.number.quantity == quantity), nan)

    @property
    def own(self) -> ResponseComparison | None:
        """The solid's own error by its mesh; None where it is not known."""
        return None if self.coarser.comparison is None else self.coarser.comparison.carried_on(SAFE)

    @property
    def steps(self) -> dict[str, dict[str, float]]:
        """Change of each error by its cause; of a quantity they add up to what the beam is off, with the other sign."""
        return {
            now.cause: {each: now.error(each) - before.error(each) for each in QUANTITIES}
            for before, now in pairwise(self.models)
        }

    @property
    def worst(self) -> str:
        """Error of the comparison in which the beam is off most, over what is allowed; empty where none is known."""
        known = [each for each in self.beam.changes if each.number in COMPARED and isfinite(each.change)]
        return max(known, key=lambda each: each.share).number.quantity if known else ""

    @property
    def largest(self) -> str:
        """Cause of the largest change in the error ``worst``; empty where the mesh resolves none."""
        found = {cause: abs(changes.get(self.worst, nan)) for cause, changes in self.steps.items()}
        least = max(0.0, self.mesh_error(self.worst))
        return max((cause for cause in found if found[cause] > least), key=lambda cause: found[cause], default="")

    def quantity(self, number: float | None) -> str:
        """Quantity that is the natural frequency of the beam's mode ``number``; empty where it is none of them."""
        named = {at: f"f{place}" for place, at in enumerate(self.beam.numbers, 1)} | {self.beam.twisted: "twist"}
        return named.get(int(number or -1), "")

    @property
    def enough(self) -> bool | None:
        """Sufficiency of the beam; None where the own error of the solid, or what is not known, leaves that open."""
        beside, own = self.beam.comparison, self.own
        within = None if beside is None else beside.suffices(self.asked)
        if beside is not None and within is False:
            mesh = 0.0 if own is None else own.worst(self.asked)
            return False if beside.worst(self.asked) > 1 + mesh else None
        return True if within and own is not None and own.suffices(self.asked) else None


@of_source
def solid_verdict(
    case: Case,
    /,
    fidelity: str = "",
    accuracy: float = 0.05,
    *,
    frequency_accuracy: float | None = None,
    progress: Callable[[int, int], None] | bool | None = None,
    budget: float = inf,
) -> SolidVerdict:
    """Verdict on the beam of a case by the solid of the same rig; of the ``fidelity`` that is one, empty: the first.

    Where none is a solid, the beam of the finest fidelity becomes one, with [solid] as it is by default. The beam and
    the solid are made in any case, what is between them as far as ``budget`` s of CPU time allow. ValueError where the
    case has no beam, or no solid can be made of it.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"beam.elements": 12, "sweep.frequency.points": 3})
    >>> round(100 * vibeam.solid_verdict(case, budget=1e-9).error("f1"), 1)  # %
    -0.8
    """
    scene, name = _solid(case, fidelity)
    asked, begun = Asked.of(accuracy, frequency_accuracy), process_time()
    with telling(progress, "solid") as told:
        return _Ladder(_thinned(case), name, scene, asked, told).verdict(begun, budget)


def _solid(case: Case, fidelity: str) -> tuple[SolidScene, str]:
    """Scene of the solid, and the fidelity that it is of."""
    names = [fidelity] if fidelity else list(case.fidelities)
    chosen = next((name for name in names if isinstance(case.scene_of(name), SolidScene)), "")
    if not chosen:
        names = [name for name in names if isinstance(case.scene_of(name), Scene)] or names
        plain = [name for name in names if not (case.fidelities[name].changes or case.fidelities[name].without)]
        chosen = max(plain or names, key=lambda name: case.fidelities[name].modes or 0)
    scene = case.scene_of(chosen)
    if not isinstance(scene, Scene):
        raise ValueError(f"nothing to compare with a solid: {scene.no_beam or 'the case gives no sections'}")
    if not scene.carrier.density:
        raise ValueError("a massless beam has no solid: take beam.massless out")
    return solid_of(scene), chosen


def _thinned(case: Case) -> Case:
    """The case with fewer frequencies of its sweep; itself under a record."""
    if case.swept is None:
        return case
    grid = case.sweep.frequency
    return replace(case, swept=replace(case.sweep, frequency=grid[evenly(0, len(grid) - 1, POINTS)]))


class _Ladder:
    """Models in the order in which they are made: beam and solid, the coarser mesh, then what is between."""

    def __init__(
        self, case: Case, fidelity: str, scene: SolidScene, asked: Asked, told: Callable[[int, int], None]
    ) -> None:  # fmt: skip
        self.case, self.fidelity, self.scene, self.asked, self.told = case, fidelity, scene, asked, told
        self.steps = ladder(scene)
        self.count = min(case.fidelities[fidelity].modes or USUAL, MOST)
        self.responses: dict[str, Response | None] = {}
        self.missing: dict[str, str] = {}

    def verdict(self, begun: float, budget: float) -> SolidVerdict:
        """The verdict; ValueError where beam or solid cannot be made."""
        reference, rough = SteppedModel(self.steps[0], self.count), LadderStep(*COARSER, coarser(self.scene))
        beam, solid = self._end(self.steps[0], reference), self._end(self.steps[-1], reference)
        fine = self._wide_enough(self.steps[-1], reference)  # of which the coarser mesh has the same modes
        found = dict[str, SolidVariant]()
        for step, beside in [(rough, fine), *((each, reference) for each in self.steps[1:-1])]:
            self._told()
            longest = max(each.seconds for each in (beam, solid, *found.values()))
            try:
                if process_time() - begun + longest > budget:
                    raise ValueError(LEFT_OUT)
                found[step.name] = self._made(step, beside)
            except ValueError as refusal:
                self.missing[step.name] = str(refusal)
        mesh = found.pop(rough.name, SolidVariant(name=rough.name, cause=rough.cause))
        between = _with_causes(self.steps[1:], found | {solid.name: solid})
        beam, mesh, *others = (self._beside(each, solid) for each in (beam, mesh, *between))
        return SolidVerdict(
            self.case, self.fidelity, self.asked, (beam, *others), mesh, self.missing, process_time() - begun, budget
        )

    def _end(self, step: LadderStep, beam: SteppedModel) -> SolidVariant:
        self._told()
        try:
            return self._made(step, beam)
        except ValueError as refusal:
            raise ValueError(f"{'no solid' if step.cause else 'no beam'}: {refusal}") from None

    def _made(self, step: LadderStep, beam: SteppedModel) -> SolidVariant:
        begun, model = process_time(), self._wide_enough(step, beam)
        values, remarks = model.linear(), tuple[str, ...]()
        try:
            if self.case.record is not None:
                raise ValueError(OF_RECORD)
            found = model.ensemble(self.case, self.fidelity)
            self.responses[step.name] = found.response
            values |= {each.quantity: found.mean(each).mean for each in found.numbers}
            remarks = tuple(dict.fromkeys(found.why.values()))
        except ValueError as refusal:
            remarks = (str(refusal),)
        return SolidVariant(
            modes=model.kept.size, seconds=process_time() - begun, remarks=remarks, name=step.name, cause=step.cause,
            values=values, numbers=tuple((model.partners[0] + 1).tolist()), twisted=model.twisted, unread=step.keys,
        )  # fmt: skip

    def _wide_enough(self, step: LadderStep, beam: SteppedModel) -> SteppedModel:
        """Model with the beam's modes among its own: of a solid some do not bend it, of a wide strip many."""
        if not step.scene.in_three_dimensions:
            return SteppedModel(step, self.count, beam)
        first, last = (SteppedModel(step, times * self.count // 2 + 4, beam) for times in MORE)
        return first if min(first.partners[0][:FIRST], default=0) >= 0 else last

    def _beside(self, model: SolidVariant, solid: SolidVariant) -> SolidVariant:
        """The model with what changes in it from the solid."""
        ours, theirs = (self.responses.get(each.name) for each in (model, solid))
        if ours is not None and model.cause not in ("", COARSER[1]):
            ours = Response(ours.places)  # ends of models between are known to the grid
        found = None if ours is None or theirs is None else compared_by(self.asked, ours, theirs, not model.cause)
        errors = () if found is None else of_comparison(found, self.asked)
        pairs = ((name, np.array([solid.value(name)]), np.array([value])) for name, value in model.values.items())
        changed = tuple(change_of(AskedNumber(name), *pair) for name, *pair in pairs)
        return replace(model, comparison=found, changes=(*errors, *changed))

    def _told(self) -> None:
        self.told(len(self.responses) + len(self.missing), len(self.steps) + 1)


def _with_causes(steps: Sequence[LadderStep], found: Mapping[str, SolidVariant]) -> Iterator[SolidVariant]:
    """Models of the steps; the cause of one that was not made goes to the next."""
    causes = list[str]()
    for step in steps:
        causes.append(step.cause)
        if step.name in found:
            yield replace(found[step.name], cause=listed(causes))
            causes = []
