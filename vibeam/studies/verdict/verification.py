"""Places of the map at random, flown anew with more time to settle: is the verdict there what the map says?"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vibeam.batches.batch import batch
from vibeam.runs.parallel import run_parallel
from vibeam.studies.verdict.between import labels_between, points_at
from vibeam.studies.verdict.judgement import cheapest, doubtful
from vibeam.studies.verdict.motions import Motions, judged, motions
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.studies.verdict.axes import VerdictAxis


SEED = 20090101
LONGER = 2  # times the case's settling


@dataclass(frozen=True)
class Verification:
    """Places (m,): Hz, SI values of the key, label by the map and by flying all models anew.

    ``decided``: where neither hangs on the scatter of motions that do not repeat, nor kinds meet around the place of
    which one has no closed form.
    """

    frequency: Array
    key: Array
    predicted: NDArray[np.int64]
    flown: NDArray[np.int64]
    decided: NDArray[np.bool_]

    @property
    def right(self) -> int:
        """Number of the decided places where both agree."""
        return int(np.sum((self.predicted == self.flown) & self.decided))


class Judged(Protocol):
    """Parts of a fidelity map that are verified."""

    @property
    def case(self) -> Case:
        """Whose."""
        ...

    @property
    def axis(self) -> VerdictAxis:
        """Its second key."""
        ...

    @property
    def frequency(self) -> Array:
        """Its columns, Hz."""
        ...

    @property
    def accuracy(self) -> float:
        """Asked for, as a share."""
        ...

    @property
    def quantity(self) -> str:
        """Of what."""
        ...

    @property
    def models(self) -> tuple[Motions, ...]:
        """Cheapest first, the finest last."""
        ...


def verified(found: Judged, count: int, seed: int = SEED) -> Verification:
    """Fly all models anew at ``count`` places drawn from the whole plane, not from its grid."""
    draw = np.random.default_rng(seed).random((2, count))
    hertz = found.frequency[0] + draw[0] * np.ptp(found.frequency)
    values = found.axis.values[0] + draw[1] * np.ptp(found.axis.values)
    again = run_parallel(lambda model, _: _flown(found, model, hertz, values), found.models[::-1])[::-1]
    predicted, unclear = labels_between(
        found.case, found.models, found.axis, found.frequency, found.accuracy, found.quantity, hertz, values
    )
    decided = ~(unclear | doubtful(again, found.accuracy)[0])
    return Verification(hertz, values, predicted, cheapest(again, found.accuracy)[0], decided)


def _flown(found: Judged, model: Motions, hertz: Array, values: Array) -> Motions:
    """Both ways from the state of the nearest place that the sweep passed before."""
    points, plan = points_at(found.case, model, found.axis, hertz, values), found.case.sweep
    rows = np.abs(found.axis.values[:, None] - values).argmin(axis=0)
    left = np.clip(np.searchsorted(found.frequency, hertz) - 1, 0, len(found.frequency) - 2)
    systems: Any = points.systems[0] if len(points.systems) == 1 else points.system[0]  # type: ignore[index]
    responses = []
    for way, columns in enumerate((left, left + 1)):
        state = _onto_stops(model.state[way, rows, columns], points)
        responses.append(batch(
            systems, points.omega[0], points.amplitude[0], gap=points.gap[0],
            restitution=None if points.restitution is None else points.restitution[0], state=state,
            settle=LONGER * plan.settle, hold=plan.hold, output=plan.output,
        ))  # fmt: skip
    names = (found.quantity, "period", "ended", "state", "resting", "cpu_seconds")
    stacked = {name: np.stack([getattr(each, name) for each in responses])[:, None] for name in names}
    return motions(model.name, points, judged(plan, points, stacked, found.quantity))


def _onto_stops(state: Array, points: Any) -> Array:
    """States (places, 2n) whose contact lies beyond the stop of its place are put back onto it."""
    contacts = np.array([system.contact for system in points.systems])[points.which[0]]
    n = contacts.shape[1]
    beyond = np.maximum(np.sum(state[:, :n] * contacts, axis=1) - points.gap[0], 0.0)
    moved = state.copy()
    moved[:, :n] -= (beyond / np.sum(contacts**2, axis=1))[:, None] * contacts
    return moved
