"""Number of modes that suffice under a record: convergence of the motions' numbers with the modes of one fidelity."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

from vibeam.case.case import plan_of_record
from vibeam.studies.changes import NumberChange, changes, worst
from vibeam.studies.variants import PEAK, Ensemble, Told, ensembles, plain_finest, usual_numbers, within
from vibeam_models.arrays import ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case

STEPS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)  # numbers of modes that are flown
BEYOND = 2  # the reference has so many times the modes of the fidelity
LEAST = 8  # modes of the reference, where the mesh has them


@dataclass(frozen=True)
class ModesRow:
    """Model with that number of ``modes``: its ``changes`` from the reference, and CPU time of a motion, s."""

    modes: int
    changes: tuple[NumberChange, ...]
    seconds: float

    @property
    def worst(self) -> float:
        """Largest change of the peaks, as a share, its error counted twice."""
        return worst(self.changes)


@dataclass(frozen=True, eq=False, repr=False)
class RecordModes(ValueRecord):
    """``rows`` of fewer modes of a ``fidelity``, ascending, against its ``reference`` with ``modes`` of them.

    ``accuracy``: largest change allowed. ``realisations``: motions of each model; ``left_out``: of the case's seeds,
    over the budget.
    """

    case: Case
    fidelity: str
    accuracy: float
    rows: tuple[ModesRow, ...]
    reference: Ensemble
    realisations: int
    left_out: int = 0

    @property
    def modes(self) -> int:
        """Number of modes of the reference."""
        return self.reference.modes

    def enough(self, quantity: str = PEAK) -> int | None:
        """Least number of modes from which on all that were flown are within the accuracy; None where none is."""
        found = None
        for row in reversed(self.rows):
            if not worst(row.changes, quantity) <= self.accuracy:
                break
            found = row.modes
        return found


def record_modes(
    case: Case, accuracy: float, fidelity: str | None = None, told: Told | None = None, budget: float = inf
) -> RecordModes:
    """Fly one fidelity with more and more modes through the case's record, up to twice its own.

    ``budget``: CPU seconds, about, by which realisations are left out. ``fidelity``: None: the one with most modes that
    changes nothing of the rig. ValueError where its number of modes is no key of it, or where it has one alone.
    """
    name = plain_finest(case, fidelity)
    own = case.fidelities[name]
    if own.modes is None:
        raise ValueError(f'fidelity {name}: reduction = "{own.reduction}" says its modes itself: take one with modes')
    whole = case.alone(name)
    wanted = max(BEYOND * own.modes, LEAST)
    top = min(whole.model(name).most_modes or wanted, wanted)
    numbers = [*(count for count in STEPS if count < top), top]
    if len(numbers) < 2:
        raise ValueError(f"fidelity {name}: its rig has {top} mode: there are no fewer to compare with")
    finest = whole.with_keys({f"fidelity.{name}.modes": top})
    chosen = within(finest, name, budget, sum(numbers) / top)
    variants = [(chosen.with_keys({f"fidelity.{name}.modes": count}), name) for count in numbers]
    *fewer, reference = ensembles(variants, usual_numbers(whole), told)
    rows = tuple(ModesRow(each.modes, changes(reference, each), float(each.seconds.mean())) for each in fewer)
    left_out = len(plan_of_record(case).seeds) - len(plan_of_record(chosen).seeds)
    return RecordModes(case, name, accuracy, rows, reference, reference.seconds.size, left_out)
