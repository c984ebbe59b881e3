"""Number of modes that a case needs: sweeps of 1, 2, 3 … modes beside one of all modes, compared as a run compares.

All modes are those of the case's own beam, solid or matrices; where their sweep does not fit into the budget, as many
of them as do. Their own error, of the mesh and of the modes left out, is estimated by a finer model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity, system
from vibeam.case.fineness import plain
from vibeam.case.source import of_source
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.casefile.tables.table import plan_with
from vibeam.runs.comparison.beyond import MANY, beside_fuller, is_whole, response_of
from vibeam.runs.comparison.errors import Asked, ComparedFidelity
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.comparison.work import Work
from vibeam.studies.changes import ModelVariant, of_comparison
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.labelled import ViewedTable
from vibeam_models.arrays import Array, Flags, ValueRecord
from vibeam_models.beam import structure_of
from vibeam_models.scene import RigScene

STEPS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)
PLACES = 61  # frequencies of a sweep, at most
REFERENCE, OWN = 0.3, 0.15  # shares of the budget: all modes; their own error
ENDS, LEAST_ENDS = 0.5, 0.025  # shares that the ends of branches may take: of the sweep's work, and of the budget
ROW = 0.3  # share of what is left for fewer modes, that each number of them may take
FIRST = 8  # modes of the reference at least, where those of more do not fit
COSTLY = "the sweep of {} modes does not fit into the budget of {:g} s"


@dataclass(frozen=True)
class ModesTried(ModelVariant):
    """Model of so many modes beside the reference, by ``reduction``; ``seconds``: CPU time of a point, or a motion."""

    reduction: str = "modal"

    def suffices(self, asked: Asked) -> bool | None:
        """Test whether it is within what is asked; None where that is not known."""
        if self.comparison is not None:
            return self.comparison.suffices(asked)
        return self.worst <= 1 if self.changes else None


@dataclass(frozen=True, eq=False)
class ModesCurve(ValueRecord):
    """Response of a model of ``modes`` in one ``direction``: ``amplitude`` over ``frequency`` in Hz, as swept.

    ``strikes`` (points,): the motion has contact.
    """

    modes: int
    direction: str
    frequency: Array
    amplitude: Array
    strikes: Flags


@dataclass(frozen=True, eq=False, repr=False)
class ModesNeeded(ValueRecord, ViewedTable):
    """``rows`` of more and more modes beside ``modes`` of them, of ``size`` that the case has; ``single``: one along
    the static deflection at the contact, None of a rig without one.

    ``own``: the reference beside a finer model. ``frequencies``: number of those swept, in every direction.
    ``curves``: of the reference, the number that is enough and the next fewer. ``seconds``: CPU time of a point of the
    reference, or of a motion under a record, of which there are ``realisations``, and ``left_out`` over the budget.
    """

    case: Case
    plan: ModesNeededPlan = field(repr=False)
    asked: Asked
    rows: tuple[ModesTried, ...]
    single: ModesTried | None
    own: ComparedFidelity
    modes: int
    size: int
    frequencies: int = field(repr=False)
    curves: tuple[ModesCurve, ...] = field(default=(), repr=False)
    seconds: float = field(default=0.0, repr=False)
    realisations: int = field(default=0, repr=False)
    left_out: int = field(default=0, repr=False)

    @property
    def enough(self) -> ModesTried | None:
        """Least number of modes from which on all that were swept suffice; None where there is none."""
        found = None
        for row in reversed([row for row in self.rows if not row.why]):
            if not row.suffices(self.asked):
                break
            found = row
        return found


@of_source
def modes_needed(
    case: Case, /, plan: ModesNeededPlan | None = None, *, budget: float = 20.0, frequencies: int = PLACES,
    own: bool = True, told: Callable[[int, int], None] | None = None, **settings: Any,
) -> ModesNeeded:  # fmt: skip
    """Number of modes that a case needs: ``vibeam.modes_needed(case, accuracy="1 %")``.

    ``settings``: of the ``plan``, in SI or with units. ``budget``: seconds of work, counted, about; ``frequencies`` of
    the sweep, at most; ``own``: estimate the error of all modes too. ``told`` the models swept and their total.
    ValueError for a case without modes to count.

    >>> import vibeam
    >>> found = vibeam.modes_needed("cases/dtu_neutral.toml", frequencies=9)
    >>> found.enough.modes, found.modes
    (2, 64)
    """
    asked = plan_with(plan or case.asked.get("modes_needed") or ModesNeededPlan(), settings)
    return _Sweeps(case, asked, budget, frequencies, told or (lambda done, total: None)).study(own)


class _Sweeps:
    """State of a study in progress: the work that is left, and the models swept."""

    def __init__(
        self, case: Case, plan: ModesNeededPlan, budget: float, frequencies: int, told: Callable[[int, int], None]
    ) -> None:
        self.case, self.plan, self.budget, self.frequencies, self.told = case, plan, budget, frequencies, told
        self.asked = Asked.of(plan.accuracy, plan.frequency_accuracy)
        names = plain(case) or list(case.fidelities)
        self.name = max(names, key=lambda name: case.fidelities[name].modes or 0)
        scene: Any = case.scene_of(self.name)
        if scene.given_mode is not None:
            raise ValueError(f"no modes to count: {scene.no_beam}")
        self.scene: RigScene = scene
        self.size = structure_of(scene).size if not scene.in_three_dimensions else MANY
        self.swept, self.work, self.took = dict[int, Response](), list[Work](), dict[int, float]()

    def study(self, with_own: bool) -> ModesNeeded:
        """The whole study."""
        counts = [n for n in STEPS if n < self.size and n <= self.plan.most]
        total = len(counts) + 3
        reference = self._reference([n for n in counts if n <= FIRST][-1:])
        self.told(1, total)
        single = self._single(reference)
        rows: list[ModesTried] = []
        for n in (n for n in counts if n < self.modes):
            rows.append(self._row(n, reference))
            self.told(len(rows) + 2, total)
            if len(rows) > 1 and all(row.suffices(self.asked) for row in rows[-2:]):
                break
        own = self._own(reference) if with_own else ComparedFidelity("", "", None, self.modes, why="not asked for")
        self.told(total, total)
        found = ModesNeeded(
            self.case, self.plan, self.asked, tuple(rows), single, own, self.modes, self.size,
            min(self.frequencies, len(self.case.sweep.frequency)), seconds=reference.cost,
        )  # fmt: skip
        return replace(found, curves=tuple(self._curves(found, reference)))

    def _curves(self, found: ModesNeeded, reference: Response) -> Iterator[ModesCurve]:
        """Curves of the reference, of the number that is enough, else the most, and of the next fewer."""
        tried = [row.modes for row in found.rows if row.modes in self.swept]
        best = tried[-1:] if found.enough is None else [found.enough.modes]
        fewer = [n for n in tried if best and n < best[0]][-1:]
        for modes, response in [(self.modes, reference), *((n, self.swept[n]) for n in (*best, *fewer))]:
            for way, places in response.places.items():
                columns = zip(*((each.frequency, each.amplitude, each.kind.strikes) for each in places), strict=True)
                yield ModesCurve(modes, way, *map(np.array, columns))

    def _system(self, modes: int) -> ImpactSystem:
        if self.scene.in_three_dimensions:
            return system(self.scene, Fidelity("modes", "residual_flexibility", modes=modes))
        return system(self.scene, Fidelity("modes", "modal", modes=modes))

    def _response(self, made: ImpactSystem, share: float) -> Response | None:
        """Response of a system; None where it takes more than a share of the budget, or of what is left of it."""
        self.work.append(work := Work(min(share * self.budget, self.left)))
        found = response_of(self.case, self.name, made, self.frequencies, work)
        self.took[made.size] = work.spent
        if share < REFERENCE:  # ends of the reference are compared with those of every other
            work.most = work.spent + max(ENDS * work.spent, LEAST_ENDS * self.budget)
        return found

    @property
    def left(self) -> float:
        """Rest of the budget, s."""
        return max(0.0, self.budget - sum(each.spent for each in self.work))

    def _fewer(self, made: ImpactSystem) -> Response | None:
        """Response of a model with fewer modes; None where it takes more than its share of what is left for these."""
        return self._response(made, ROW * (self.left / self.budget - OWN))

    def _reference(self, first: list[int]) -> Response:
        """Response of all modes, or of as many as fit into its share of the budget."""
        for n in first:
            self.swept[n] = self._required(self._system(n))
        for modes in self._most():
            dear = any(Work(REFERENCE * self.budget).surely_exceeded(self.took[n], modes / n) for n in first)
            found = None if dear else self._response(self._system(modes), REFERENCE)
            if found is not None:
                self.modes = modes
                return found
        self.modes = first[0] if first else self.size
        return self.swept[first[0]] if first else self._required(self._system(self.size))

    def _required(self, made: ImpactSystem) -> Response:
        if (found := self._response(made, REFERENCE)) is None:
            raise ValueError(COSTLY.format(made.size, self.budget))
        return found

    def _most(self) -> Iterator[int]:
        """Numbers of modes of the reference, the most first."""
        modes = self.size
        while modes > 2 * FIRST or modes == self.size:
            yield modes
            modes //= 2

    def _row(self, modes: int, reference: Response) -> ModesTried:
        try:
            found = self.swept.get(modes) or self._fewer(self._system(modes))
        except ValueError as refusal:  # a restitution of mode 1 that no contact gives
            return ModesTried(modes=modes, why=str(refusal))
        if found is None:
            return ModesTried(modes=modes, why=COSTLY.format(modes, self.budget))
        self.swept[modes] = found
        return self._tried(modes, "modal", found, reference)

    def _tried(self, modes: int, reduction: str, found: Response, reference: Response) -> ModesTried:
        beside = compared(found, reference, self.asked.frequency)
        return ModesTried(of_comparison(beside, self.asked), beside, modes, found.cost, reduction=reduction)

    def _single(self, reference: Response) -> ModesTried | None:
        """One degree of freedom along the static deflection at the contact; None of a rig that has none."""
        try:
            found = self._fewer(system(self.scene, Fidelity("single", "static_mode")))
        except ValueError:
            return None
        if found is None:
            return None
        return self._tried(1, "static_mode", found, reference)

    def _own(self, reference: Response) -> ComparedFidelity:
        """The reference beside a finer model."""
        if is_whole(self.case, self.name, self.modes):
            return ComparedFidelity(self.name, "", None, self.modes, whole=True)
        a_place = self.took[self.modes] / sum(map(len, reference.places.values()))
        return beside_fuller(self.case, self.name, reference, self.modes, self.asked, a_place, OWN * self.budget)
