"""Motions of each model over the plane, their worth beside the finest model's place by place; a row of each model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.maps.irregular import FAILED, IRREGULAR, NO_CONTACT
from vibeam.maps.result import MapResult, StudyOfMap
from vibeam.periodic.motion_kind import LONGEST
from vibeam.runs.comparison.errors import Asked
from vibeam.store.blocks import Values
from vibeam.system.number_text import percent
from vibeam_models.arrays import Array, Flags, ValueRecord

Codes = NDArray[np.int64]
APART = 1e-3  # difference of two amplitudes, as a share, that makes two motions of one kind
SURE = 3.0  # standard errors by which means must differ for two motions of one kind
NOISE = 2.0  # standard errors by which a mean may miss the accuracy and still count as within it
SAME, IN_PERIOD, IN_NUMBER = range(3)  #: differences in kind, the gravest last

DIFFERENCES = {
    IN_PERIOD: "another period, or no contact",
    IN_NUMBER: "another number of coexisting motions",
}


@dataclass(frozen=True)
class MappedMotions:
    """Motions of a model, arrays (ways, rows, columns): up and down over the frequencies, a row a value of the key.

    ``value`` in the output's unit (mean of a motion that does not repeat, ``error`` its standard error, else 0);
    ``kind``: period 1 … 16, or one of the constants above. ``count`` (rows, columns): motions that coexist, among those
    that the two sweeps find. ``cpu``: seconds a point.
    """

    name: str
    modes: int
    value: Array
    error: Array
    kind: Codes
    count: NDArray[np.int64]
    cpu: float


def motions(name: str, modes: int, found: Values, quantity: str) -> MappedMotions:
    """Motions of a model from arrays (ways, rows, columns, …) by name: see ``irregular.judged``."""
    value, error, kind = found[quantity], found["error"], found["kind"].astype(np.int64)
    return MappedMotions(
        name, modes, value, error, kind, _coexisting(value, error, kind),
        float(np.mean(found["cpu_seconds"])),
    )  # fmt: skip


def _coexisting(value: Array, error: Array, kind: Codes) -> NDArray[np.int64]:
    """Motions that coexist (rows, columns): 2 where up and down lead to different ones."""
    up, down = 0, 1
    apart = np.abs(value[up] - value[down])
    size = np.maximum(np.abs(value[up]), np.abs(value[down]))
    margin = np.maximum(APART * size, SURE * np.hypot(error[up], error[down]))
    return np.where((kind[up] != kind[down]) | (apart > margin), 2, 1).astype(np.int64)


@dataclass(frozen=True, eq=False, repr=False)
class ComparedModels(StudyOfMap, ValueRecord):
    """Map whose ``models``, cheapest first and the finest last, are compared over frequency and a key of the case."""

    result: MapResult
    models: tuple[MappedMotions, ...]

    @property
    def finest(self) -> MappedMotions:
        """The model that the others are judged by."""
        return self.models[-1]

    @property
    def asked(self) -> Asked:
        """Errors allowed of a model that suffices."""
        return Asked.of(self.plan.accuracy, self.plan.frequency_accuracy)

    @property
    def touched(self) -> Flags:
        """Places (rows, columns) with impacts: where any of the models moves and touches the stop, either way."""
        moving = [(model.kind != NO_CONTACT) & (model.value != 0) for model in self.models]
        return np.asarray(np.any(moving, axis=(0, 1)))

    @property
    def frequency(self) -> Array:
        """Hz (columns,)."""
        return np.array(self.plan.axes[-1].values)

    @property
    def values(self) -> Array:
        """SI values of the other key (rows,)."""
        return np.array(self.plan.axes[-2].values)


def share(places: Flags, touched: Flags) -> float:
    """Share of the places with impacts, NaN without any: elsewhere all models swing alike, whatever the stop does."""
    return float(places[touched].mean()) if touched.any() else float("nan")


def difference(model: MappedMotions, finest: MappedMotions) -> Codes:
    """Difference in kind at each place (rows, columns), the gravest: the constants above; a failure is of the period.

    Motions that do not repeat within 16 periods are of one kind.
    """
    period = ((model.kind != finest.kind) | (model.kind == FAILED)).any(axis=0)
    number = model.count != finest.count
    return np.asarray(np.select([number, period], [IN_NUMBER, IN_PERIOD], SAME))


def within(model: MappedMotions, finest: MappedMotions, asked: Asked, frequency: Array | None = None) -> Flags:
    """Places (rows, columns) where both ways are of the same kind and their values agree as ``asked``.

    Means of motions that do not repeat may differ by two of their standard errors more. With the ``frequency`` of the
    columns, Hz: where an end of a branch that both have lies between, no further apart than asked, kinds may differ.
    """
    noise, ours, theirs = NOISE * np.hypot(model.error, finest.error), _plain(model.kind), _plain(finest.kind)
    with np.errstate(invalid="ignore"):
        near = np.abs(model.value - finest.value) <= asked.amplitude * np.abs(finest.value) + noise
    near &= (ours == theirs) & (ours != FAILED)
    for column, at in enumerate([] if frequency is None else frequency.tolist()):
        beside = np.abs(frequency - at) <= asked.frequency * at
        reached = (ours[..., beside] == theirs[..., [column]]) & (ours[..., [column]] != FAILED)
        left = (theirs[..., beside] == ours[..., [column]]) & (theirs[..., [column]] != FAILED)
        near[..., column] |= (ours != theirs)[..., column] & reached.any(axis=-1) & left.any(axis=-1)
    return np.asarray(near.all(axis=0))


def _plain(kind: Codes) -> Codes:
    """Kinds as two sweeps are compared by: all motions that do not repeat within ``LONGEST`` periods are of one."""
    return np.where(kind > LONGEST, IRREGULAR, kind)


def cheapest(models: Sequence[MappedMotions], asked: Asked, frequency: Array | None = None) -> Codes:
    """Index into ``models`` (cheapest first, finest last) of the cheapest that suffices at each place."""
    label = np.full(models[-1].count.shape, len(models) - 1, dtype=np.int64)
    for index in range(len(models) - 2, -1, -1):
        label[within(models[index], models[-1], asked, frequency)] = index
    return label


def doubtful(models: Sequence[MappedMotions], asked: Asked, frequency: Array | None = None) -> Flags:
    """Places whose label hangs on scatter: a model up to the one chosen is within its noise of what is asked."""
    label, finest = cheapest(models, asked, frequency), models[-1]
    found = np.zeros(label.shape, dtype=bool)
    for index, model in enumerate(models[:-1]):
        noise = np.hypot(model.error, finest.error)
        with np.errstate(invalid="ignore"):
            beyond = np.abs(model.value - finest.value) - asked.amplitude * np.abs(finest.value) - NOISE * noise
            near = (noise > 0) & (np.abs(beyond) <= SURE * noise)
        found |= near.any(axis=0) & (index <= label)
    return found


def relative(model: MappedMotions, finest: MappedMotions) -> NDArray[np.float64]:
    """Relative difference (rows, columns), of the way where it is larger."""
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = np.where(model.value == finest.value, 0.0, model.value / finest.value - 1)  # at rest both
    filled = np.where(np.isfinite(shares), shares, 0.0)
    worst = np.abs(filled).argmax(axis=0)
    return np.asarray(np.take_along_axis(shares, worst[None], axis=0)[0])


KINDS = {
    NO_CONTACT: "no contact", IRREGULAR: "no repeat", FAILED: "failed",
}  # fmt: skip


@dataclass(frozen=True)
class FidelityRow:
    """One model beside the finest one. Shares and relative differences as plain numbers.

    ``cost_ratio``: how many times cheaper a point is than of the finest (CPU time here); ``within``: share of the
    places with impacts where it suffices (NaN without any); ``bias``, ``rms``: mean and root mean square of the
    relative difference there, where both are of one kind; ``other_kind``: share of the places with impacts where it
    differs in kind, ``kinds``: of what the finest has there.
    """

    fidelity: str
    modes: int
    cpu: float
    cost_ratio: float
    within: float
    bias: float
    rms: float
    other_kind: float
    kinds: str


def fidelity_row(model: MappedMotions, found: ComparedModels) -> FidelityRow:
    """The row of one model."""
    finest, touched = found.finest, found.touched
    apart, near = difference(model, finest), within(model, finest, found.asked, found.frequency)
    alike = (model.kind == finest.kind) & (model.kind != FAILED) & (finest.value != 0) & touched
    shares = model.value[alike] / finest.value[alike] - 1
    bias = float(shares.mean()) if shares.size else float("nan")
    rms = float(np.sqrt(np.mean(shares**2))) if shares.size else float("nan")
    ratio = finest.cpu / model.cpu
    part, other = share(near, touched), share(apart != SAME, touched)
    return FidelityRow(
        model.name, model.modes, model.cpu, ratio, part, bias, rms, other,
        _kinds(finest, apart != SAME),
    )  # fmt: skip


def _kinds(finest: MappedMotions, places: NDArray[np.bool_]) -> str:
    """The commonest kinds of the finest model at some places, with their shares."""
    found = finest.kind[:, places].ravel()
    if not found.size:
        return ""
    kinds, counts = np.unique(found, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:2]
    names = [KINDS.get(kind, f"period {kind}") for kind in kinds.tolist()]
    return ", ".join(f"{names[i]} ({percent(round(counts[i] / found.size, 2))})" for i in order)
