"""What a model's motions are worth beside the finest model's, place by place of the plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.verdict.motions import CHAOTIC, FAILED, IRREGULAR, SURE, Motions
from vibeam_models.arrays import Flags

Codes = NDArray[np.int64]
NOISE = 2.0  # standard errors by which a mean may miss the accuracy and still count as within it
SAME, IN_PERIOD, IN_NUMBER, IN_CHAOS = range(4)  #: differences in kind, the gravest last

DIFFERENCES = {
    IN_PERIOD: "another period, or no contact",
    IN_NUMBER: "another number of coexisting motions",
    IN_CHAOS: "chaos in one alone",
}


def difference(model: Motions, finest: Motions) -> Codes:
    """Difference in kind at each place (rows, columns), the gravest: the constants above; a failure is of the period.

    Motions that do not repeat and are not chaotic (quasiperiodic, or longer than 16 periods) are of one kind.
    """
    chaos = ((model.kind == CHAOTIC) != (finest.kind == CHAOTIC)).any(axis=0)
    period = ((model.kind != finest.kind) | (model.kind == FAILED)).any(axis=0)
    number = model.count != finest.count
    return np.asarray(np.select([chaos, number, period], [IN_CHAOS, IN_NUMBER, IN_PERIOD], SAME))


def within(model: Motions, finest: Motions, accuracy: float) -> Flags:
    """Whether both ways (rows, columns) are of the same kind and their values agree to ``accuracy``.

    Means of motions that do not repeat may differ by two of their standard errors more.
    """
    noise = NOISE * np.hypot(model.error, finest.error)
    with np.errstate(invalid="ignore"):
        near = np.abs(model.value - finest.value) <= accuracy * np.abs(finest.value) + noise
    return np.asarray(near.all(axis=0) & (difference(model, finest) == SAME))


def cheapest(models: Sequence[Motions], accuracy: float) -> Codes:
    """Index into ``models`` (cheapest first, finest last) of the cheapest that suffices at each place."""
    label = np.full(models[-1].count.shape, len(models) - 1, dtype=np.int64)
    for index in range(len(models) - 2, -1, -1):
        label[within(models[index], models[-1], accuracy)] = index
    return label


def doubtful(models: Sequence[Motions], accuracy: float) -> Flags:
    """Where the label hangs on scatter: a model up to the one chosen is within its noise of the accuracy, or of chaos.

    Of chaos: neither motion repeats, and only one exponent is positive beyond its error.
    """
    label, finest = cheapest(models, accuracy), models[-1]
    found = np.zeros(label.shape, dtype=bool)
    for index, model in enumerate(models[:-1]):
        noise = np.hypot(model.error, finest.error)
        with np.errstate(invalid="ignore"):
            beyond = np.abs(model.value - finest.value) - accuracy * np.abs(finest.value) - NOISE * noise
            near = (noise > 0) & (np.abs(beyond) <= SURE * noise)
        open_ = np.isin(model.kind, (CHAOTIC, IRREGULAR)) & np.isin(finest.kind, (CHAOTIC, IRREGULAR))
        found |= (near | (open_ & (model.kind != finest.kind))).any(axis=0) & (index <= label)
    return found


def relative(model: Motions, finest: Motions) -> NDArray[np.float64]:
    """Relative difference (rows, columns), of the way where it is larger."""
    with np.errstate(invalid="ignore", divide="ignore"):
        shares = model.value / finest.value - 1
    filled = np.where(np.isfinite(shares), shares, 0.0)
    worst = np.abs(filled).argmax(axis=0)
    return np.asarray(np.take_along_axis(shares, worst[None], axis=0)[0])
