"""Motions of one model over the plane, swept up and down: how large, of which kind, how many coexist."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.maps.block import Values
from vibeam.maps.points import GridPoints
from vibeam_models.arrays import Array

Kinds = NDArray[np.int64]
WAYS = ("up", "down")
NO_CONTACT, IRREGULAR, CHAOTIC, FAILED = -1, 0, -2, -3  #: kinds beside the period 1 … 16
APART = 1e-3  # difference of two amplitudes, as a share, that makes two motions of one kind
SURE = 3.0  # standard errors by which means must differ for two motions of one kind


@dataclass(frozen=True)
class Motions:
    """Motions of a model, arrays (ways, rows, columns): up and down over the frequencies, a row a value of the key.

    ``value`` in the output's unit (mean of a motion that does not repeat, ``error`` its standard error, else 0);
    ``kind``: period 1 … 16, or one of the constants above; ``exponent`` in 1/s, known where it does not repeat.
    ``count`` (rows, columns): motions that coexist, among those that the two sweeps find. ``cpu``: seconds a point.
    """

    name: str
    modes: int
    value: Array
    error: Array
    kind: Kinds
    exponent: Array
    count: NDArray[np.int64]
    state: Array
    resting: NDArray[np.bool_]
    points: GridPoints
    cpu: float


def motions(name: str, points: GridPoints, found: Values) -> Motions:
    """Motions of a model from arrays (ways, rows, columns, …) by name: see ``irregular.judged``."""
    value, error, kind = found["value"], found["error"], found["kind"]
    return Motions(
        name, points.systems[0].size, value, error, kind, found["exponent"], _coexisting(value, error, kind),
        found["state"], found["resting"], points, float(np.mean(found["cpu_seconds"])),
    )  # fmt: skip


def _coexisting(value: Array, error: Array, kind: Kinds) -> NDArray[np.int64]:
    """Motions that coexist (rows, columns): 2 where up and down lead to different ones."""
    up, down = 0, 1
    apart = np.abs(value[up] - value[down])
    size = np.maximum(np.abs(value[up]), np.abs(value[down]))
    margin = np.maximum(APART * size, SURE * np.hypot(error[up], error[down]))
    return np.where((kind[up] != kind[down]) | (apart > margin), 2, 1).astype(np.int64)
