"""Verdict study (``vibeam verdict``): over frequency and another key, the cheapest model that is good enough."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.case.case import require_one_harmonic
from vibeam.case.source import of_source
from vibeam.casefile.quantities import RATIO, UnitError, to_si
from vibeam.flight.disturbance.tangent import tangent_fault
from vibeam.runs.comparison.differences import listed
from vibeam.runs.systems import Systems
from vibeam.studies.verdict import axes
from vibeam.studies.verdict.axes import ExactBoundary, VerdictAxis
from vibeam.studies.verdict.between import Verification, verified
from vibeam.studies.verdict.judgement import FidelityRow, cheapest, difference, doubtful, fidelity_row, relative
from vibeam.studies.verdict.motions import Motions
from vibeam.studies.verdict.planes import computed, plane_of
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.system.impact_system import ImpactSystem


Codes = NDArray[np.int64]
QUANTITIES = ("amplitude", "reach")


@dataclass(frozen=True)
class PlacePoint:
    """One place of the map: Hz, SI value of the key, model that suffices, and of each way and model kind and value."""

    frequency: float
    key: float
    suffices: str
    fidelity: str
    way: str
    kind: int
    value: float
    error: float
    exponent: float
    coexist: int


@dataclass(frozen=True, eq=False, repr=False)
class Verdict(ValueRecord):
    """Fidelity map of a case: ``models`` by their modes, cheapest first, the finest last; arrays (rows, columns).

    ``label``: index of the cheapest model that suffices; ``differences``: of each model in kind (``judgement``);
    ``relative``: of each model in value, the way where it is larger. ``frequency`` (columns,) Hz.
    """

    case: Case
    axis: VerdictAxis
    frequency: Array
    accuracy: float
    quantity: str
    models: tuple[Motions, ...]
    label: Codes
    differences: tuple[Codes, ...]
    relative: tuple[Array, ...]
    rows: tuple[FidelityRow, ...]
    boundaries: tuple[ExactBoundary, ...]
    refused: tuple[str, ...] = ()
    verification: Verification | None = None

    @property
    def doubtful(self) -> float:
        """Share of the map where the label hangs on the scatter of motions that do not repeat."""
        return float(doubtful(self.models, self.accuracy).mean())

    @property
    def finest(self) -> Motions:
        """The model that the others are judged by."""
        return self.models[-1]

    @property
    def shares(self) -> dict[str, float]:
        """Share of the map where each model is the cheapest that suffices."""
        return {model.name: float((self.label == index).mean()) for index, model in enumerate(self.models)}

    @property
    def points(self) -> list[PlacePoint]:
        """All motions of all models, place by place."""
        return [
            PlacePoint(
                float(self.frequency[column]), float(self.axis.values[row]), self.models[self.label[row, column]].name,
                model.name, way, int(model.kind[at, row, column]), float(model.value[at, row, column]),
                float(model.error[at, row, column]), float(model.exponent[at, row, column]),
                int(model.count[row, column]),
            )
            for row, column in np.ndindex(self.label.shape) for model in self.models
            for at, way in enumerate(("up", "down"))
        ]  # fmt: skip


@of_source
def verdict(
    case: Case,
    over: str = "frequency,gap",
    low: str | float | None = None,
    high: str | float | None = None,
    points: int = 61,
    frequencies: int = 61,
    accuracy: str | float = "1 %",
    quantity: str = "amplitude",
    fidelities: Sequence[str] | None = None,
    verify: int = 24,
    tell: Callable[[str], None] | None = None,
    folder: str | Path | None = None,
) -> Verdict:
    """Compute the fidelity map of a case over its frequencies and another of its keys.

    ``over``: "frequency," and "gap", "drive", "restitution" or any dotted key; ``low``, ``high``: its range, as a case
    has it, with unit (None: chosen, for gap and drive). ``accuracy`` of ``quantity`` ("amplitude" of the sweep's output
    or "reach" of the contact) against the fidelity with most modes. ``fidelities``: which, also where they change the
    rig; None: all that do not. ``verify``: at how many places, drawn at random from the whole plane, all models are
    flown anew. ``tell``: hears how far it is, from any thread. ``folder``: where finished blocks of rows are kept, so
    that the same call goes on with those that are there; to be deleted by the caller. ValueError for arguments or a
    case that make no sense, fewer than two models included; CaseError for values of the key that the case may not have;
    StoreError for a folder with another map's blocks.
    """
    share = _accuracy(accuracy)
    if quantity not in QUANTITIES:
        raise ValueError(f"--quantity: {quantity!r} is none of {', '.join(QUANTITIES)}")
    grid = case.sweep.frequency
    if not grid.min() < grid.max():
        raise ValueError("sweep.frequency: a map needs a range of frequencies, there is one")
    key = axes.keys_of(case, over)
    unknown = [name for name in fidelities or () if name not in case.fidelities]
    if unknown:
        raise ValueError(f"no fidelity {', '.join(map(repr, unknown))}: there are {', '.join(case.fidelities)}")
    require_one_harmonic(case, "a fidelity map", fidelities or ())
    systems, refused = _models(case, fidelities)
    axis = axes.second_axis(case, key, low, high, points, next(iter(systems.values())))
    hertz = np.linspace(grid.min(), grid.max(), frequencies)
    planes = [plane_of(case, name, axis, hertz, quantity) for name in systems]
    flown, known = computed(case, planes, axis, hertz, quantity, None if folder is None else Path(folder), tell)
    found = _judged(case, axis, hertz, share, quantity, flown, known, refused)
    return replace(found, verification=verified(found, verify)) if verify > 0 else found


def _judged(
    case: Case, axis: VerdictAxis, hertz: Array, accuracy: float, quantity: str, flown: list[Motions],
    known: list[ExactBoundary], refused: tuple[str, ...],
) -> Verdict:  # fmt: skip
    models = tuple(sorted(flown, key=lambda model: model.modes))  # the cost grows with them; measured, it is noisy
    finest = models[-1]
    rows = tuple(fidelity_row(model, finest, hertz, axis, accuracy) for model in models)
    return Verdict(
        case, axis, hertz, accuracy, quantity, models, cheapest(models, accuracy),
        tuple(difference(model, finest) for model in models), tuple(relative(model, finest) for model in models),
        rows, tuple(known), refused,
    )  # fmt: skip


def _accuracy(given: str | float) -> float:
    try:
        share = to_si(given, RATIO)
    except UnitError as fault:
        raise ValueError(f"--accuracy: {fault}") from None
    if not 0 < share < 1:
        raise ValueError(f"--accuracy: must lie between 0 and 100 %, not {given}")
    return float(share)


def _models(case: Case, asked: Sequence[str] | None) -> tuple[dict[str, ImpactSystem], tuple[str, ...]]:
    """Distinct systems by name, and sentences on the fidelities left out; ValueError where fewer than two remain."""
    built, found, notes = Systems(case), dict[str, "ImpactSystem"](), list[str]()
    usual = min((len(case.fidelities[name].changes) for name in case.fidelities), default=0)
    for name, fidelity in case.fidelities.items():
        if asked is not None and name not in asked:
            continue
        twin = next((other for other, system in found.items() if built[name].moves_as(system)), None)
        if twin is not None:
            notes.append(f"{name}: the same model as {twin}")
        elif fidelity.solver != "flight":
            notes.append(f'{name}: left out, for its solver is "{fidelity.solver}" and not flight')
        elif asked is None and len(fidelity.changes) > usual:
            changed = ", ".join(fidelity.changes)
            notes.append(f"{name}: left out, for it changes the rig ({changed}): name it by --fidelity")
        else:
            found[name] = built[name]
    if len(found) < 2:
        raise ValueError("; ".join([f"a verdict compares two models or more, and the case has {len(found)}", *notes]))
    untold = [name for name, system in found.items() if tangent_fault(system)]
    if untold:
        reason = tangent_fault(found[untold[0]])
        notes.append(f"{listed(untold)}: chaos is not told from other motions that do not repeat, for {reason}")
    return found, tuple(notes)
