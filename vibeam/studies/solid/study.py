"""Verdict on the beam by the solid of the same rig: what each of the beam's assumptions changes, their sum the whole.

Each step is the difference of two models, over the solid's number, so that the steps of a quantity add up to what the
beam is off, to the bit of their rounding. Held is what the case holds, R of the contact or R₁ of mode 1; the other one
follows in each model. The mobility is that of as many modes as the beam has, told by their shapes: of a patch that of
all modes grows without limit as the mesh is refined, and is not compared. What half as many elements in each direction
change tells the error of the mesh, below which a step of the solid's is not resolved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, isfinite, nan
from time import process_time

from vibeam.case.case import Case
from vibeam.case.held import Held, held_of
from vibeam.case.source import of_source
from vibeam.runs.comparison.responses import Response
from vibeam.studies.solid.model import FIRST, LadderModel, SteppedModel, distance, with_peak
from vibeam.studies.solid.steps import LadderStep, coarser, ladder, solid_of
from vibeam.system.curves import evenly
from vibeam.system.labelled import ViewedTable
from vibeam.system.progress import telling
from vibeam_models.arrays import ValueRecord
from vibeam_models.scene import Scene
from vibeam_models.solid.scene import SolidScene, assumptions

USUAL, MOST = 8, 16  # modes of a beam whose fidelity does not count them, or counts more
POINTS = 31  # frequencies of the sweep at most
BUDGET = 20.0  # s
QUANTITIES = (
    *(f"f{number}" for number in range(1, FIRST + 1)), "twist", "flexibility", "mobility", "restitution",
    "first_mode_restitution", "peak", "peak_frequency", "rms",
)  # fmt: skip
JUDGED = (*QUANTITIES[:FIRST], "peak", "rms")
SAFE = 0.5  # of the change: ⅓ of it is the error where that is of second order, as in flat elements and at clamps
LEFT_OUT = "left out: over the budget"
MORE = (3, 8)  # halves of the beam's number of modes, in which the first ones are looked for
OF_RECORD = "is not compared under a record: vibeam verdict --only map has the peaks of all fidelities"


@dataclass(frozen=True)
class StepChange:
    """Change that a step's ``cause`` makes: of each quantity from the last model that has it, over the solid's number.

    NaN of what the model does not have, which the next step then has in it.
    """

    name: str
    cause: str
    changes: dict[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class SolidVerdict(ValueRecord, ViewedTable):
    """Beam and solid of a rig and what is between them: ``models``, the beam first, the solid last.

    ``coarser``: the solid with half as many elements in each direction; ``held``: the restitution; ``assumed``:
    sentences on what the case does not say; ``chosen``: keys that measured numbers chose; ``accuracy``: the largest
    error allowed. ``left_out`` models did not fit into ``budget`` s of CPU time of the ``seconds`` spent.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"beam.elements": 12, "sweep.frequency.points": 3})
    >>> [step.cause for step in vibeam.studies.solid_verdict(case, budget=1e-9).steps]
    ['shear', 'three dimensions', 'plate stiffening', 'the clamp']
    """

    case: Case
    fidelity: str
    accuracy: float
    held: Held
    models: tuple[LadderModel, ...]
    coarser: LadderModel
    assumed: tuple[str, ...] = ()
    chosen: tuple[str, ...] = ()
    seconds: float = nan
    budget: float = inf
    left_out: int = 0

    @property
    def beam(self) -> LadderModel:
        """The beam as the case has it."""
        return self.models[0]

    @property
    def solid(self) -> LadderModel:
        """The solid as the case has it."""
        return self.models[-1]

    def error(self, quantity: str) -> float:
        """Error of the beam in a quantity, relative to the solid's; NaN where one of the two has none."""
        return self._over(self.beam, self.solid.value(quantity), quantity)

    def mesh_error(self, quantity: str) -> float:
        """Error of the solid's quantity by its mesh, relative: ``SAFE`` times what half as many elements change."""
        return SAFE * abs(self._over(self.coarser, self.solid.value(quantity), quantity))

    @property
    def steps(self) -> tuple[StepChange, ...]:
        """Change by each step; of every quantity they add up to what the beam is off, with the other sign."""
        found, before = [], {name: self.beam.value(name) for name in QUANTITIES}
        for model in self.models[1:]:
            changes = {name: self._over(model, before[name], name) for name in QUANTITIES}
            before |= {name: model.value(name) for name in QUANTITIES if isfinite(model.value(name))}
            found.append(StepChange(model.name, model.cause, changes))
        return tuple(found)

    def _over(self, model: LadderModel, other: float, quantity: str) -> float:
        """Difference of a model's value from another one over the solid's; of the rms distance as it is."""
        whole = 1.0 if quantity == "rms" else self.solid.value(quantity)
        return (model.value(quantity) - other) / whole if whole else nan

    @property
    def worst(self) -> str:
        """Quantity, of those judged, in which the beam is off most; empty where none is known."""
        known = [name for name in JUDGED if isfinite(self.error(name))]
        return max(known, key=lambda name: abs(self.error(name)), default="")

    @property
    def largest(self) -> tuple[tuple[str, ...], float]:
        """Causes of the largest change in the quantity ``worst``, several where what is between is not known."""
        found: list[tuple[tuple[str, ...], float]] = []
        causes: tuple[str, ...] = ()
        for step in self.steps:
            causes, change = (*causes, step.cause), step.changes.get(self.worst, nan)
            if isfinite(change):
                found.append((causes, change))
                causes = ()
        return max(found, key=lambda each: abs(each[1]), default=((), nan))

    def quantity(self, number: float | None) -> str:
        """Quantity that is the natural frequency of the beam's mode ``number``; empty where it is none of them."""
        named = {at: f"f{place}" for place, at in enumerate(self.beam.numbers, 1)} | {self.beam.twist_number: "twist"}
        return named.get(int(number or -1), "")

    @property
    def beyond(self) -> bool:
        """Test whether the beam is beyond the accuracy by more than the mesh error."""
        return any(self._off(name, -1) > self.accuracy for name in JUDGED)

    @property
    def enough(self) -> bool:
        """Test whether the beam is within the accuracy in all of that, the mesh error counted, and the peak known."""
        within = all(self._off(name, 1) <= self.accuracy for name in JUDGED if isfinite(self.error(name)))
        return isfinite(self.error("peak")) and within and not self.beyond

    def _off(self, quantity: str, side: int) -> float:
        """Error of the beam in size with the mesh error, where that is known, on this side."""
        mesh = self.mesh_error(quantity)
        return abs(self.error(quantity)) + side * (mesh if isfinite(mesh) else 0.0)


@of_source
def solid_verdict(
    case: Case,
    /,
    fidelity: str = "",
    accuracy: float = 0.05,
    *,
    progress: Callable[[int, int], None] | bool | None = None,
    budget: float = inf,
) -> SolidVerdict:
    """Verdict on the beam of a case by the solid of the same rig; of the ``fidelity`` that is one, empty: the first.

    Where none is a solid, the beam of the finest fidelity becomes one, with [solid] as it is by default. The beam and
    the solid are made in any case, what is between them as far as ``budget`` s of CPU time allow. ValueError where the
    case has no beam, or no solid can be made of it.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"beam.elements": 12, "sweep.frequency.points": 3})
    >>> round(100 * vibeam.studies.solid_verdict(case, budget=1e-9).error("f1"), 1)  # %
    -0.8
    """
    scene, name = _solid(case, fidelity)
    begun = process_time()
    with telling(progress, "solid") as told:
        return _Ladder(_thinned(case), name, scene, budget, begun, told).verdict(accuracy)


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
        self, case: Case, fidelity: str, scene: SolidScene, budget: float, begun: float,
        told: Callable[..., None],
    ) -> None:  # fmt: skip
        self.case, self.fidelity, self.scene, self.budget, self.told = case, fidelity, scene, budget, told
        self.steps, self.begun, self.done = ladder(scene), begun, 0
        self.count = min(case.fidelities[fidelity].modes or USUAL, MOST)
        self.responses: dict[str, Response] = {}
        self.longest, self.left_out = 0.0, 0

    def verdict(self, accuracy: float) -> SolidVerdict:
        """The verdict; ValueError where beam or solid cannot be made."""
        self._told()
        reference = SteppedModel(self.steps[0], self.count)
        ends = [self._made(step, reference) for step in (self.steps[0], self.steps[-1])]
        for each in ends:
            if each.why:
                raise ValueError(f"{'no solid' if each.cause else 'no beam'}: {each.why}")
        fine = self._wide_enough(self.steps[-1], reference)  # of which the coarser mesh has the same modes
        rough = self._of(LadderStep("solid, half the elements", "the mesh", coarser(self.scene)), fine, True)
        between = [self._of(step, reference, True) for step in self.steps[1:-1]]
        chosen = {key for number in self.case.measured.values() for key in number.chose}
        return SolidVerdict(
            self.case, self.fidelity, accuracy, held_of(self.scene),
            tuple(map(self._with_distance, (ends[0], *between, ends[1]))), self._with_distance(rough),
            tuple(assumptions(self.scene)), tuple(sorted(chosen)), process_time() - self.begun, self.budget,
            self.left_out,
        )  # fmt: skip

    def _of(self, step: LadderStep, beam: SteppedModel, may_wait: bool = False) -> LadderModel:
        """Model of a step; left out where it may be and would take longer than the rest of the budget."""
        if may_wait and process_time() - self.begun + self.longest > self.budget:
            self.left_out += 1
            self._told()
            return LadderModel(step.name, step.cause, why=LEFT_OUT, unread=step.keys)
        return self._made(step, beam)

    def _made(self, step: LadderStep, beam: SteppedModel) -> LadderModel:
        begun = process_time()
        try:
            model = self._wide_enough(step, beam)
            found = model.linear()
        except ValueError as refusal:
            return LadderModel(step.name, step.cause, why=str(refusal), unread=step.keys)
        try:
            if self.case.record is not None:
                raise ValueError(OF_RECORD)
            self.responses[step.name] = model.response(self.case, self.fidelity)
            found = with_peak(found, self.responses[step.name])
        except ValueError as refusal:
            found = replace(found, why_no_peak=str(refusal))
        self.longest = max(self.longest, process_time() - begun)
        self._told()
        return replace(found, cpu_seconds=process_time() - begun)

    def _wide_enough(self, step: LadderStep, beam: SteppedModel) -> SteppedModel:
        """Model with the beam's modes among its own: of a solid some do not bend it, of a wide strip many."""
        if not step.scene.in_three_dimensions:
            return SteppedModel(step, self.count, beam)
        first, last = (SteppedModel(step, times * self.count // 2 + 4, beam) for times in MORE)
        return first if min(first.partners[0][:FIRST], default=0) >= 0 else last

    def _with_distance(self, model: LadderModel) -> LadderModel:
        """The model with its distance from the solid's amplitudes, where at least half of them can be compared."""
        ours, solid = (self.responses.get(name) for name in (model.name, self.steps[-1].name))
        return model if ours is None or solid is None else replace(model, rms=distance(ours, solid))

    def _told(self) -> None:
        self.told(min(self.done, len(self.steps) + 1), len(self.steps) + 1)
        self.done += 1
