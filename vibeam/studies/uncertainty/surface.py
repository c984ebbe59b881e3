"""Quadratic response surface of a model's peak over the uncertain inputs: the cheapest of all models.

Fitted by least squares to runs of its own, so that it is independent of those that an estimate is made of. It may be
off by any amount (jumps, folds): as a control variate it need only follow the model, and its correlation tells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations_with_replacement
from time import thread_time

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.uncertainty.samples import Responses

Array = NDArray[np.float64]

RUNS = 3  # a coefficient


@dataclass(frozen=True)
class Surface:
    """Polynomial Σ ``coefficients`` · terms of the inputs about ``middle`` in units of ``scale``.

    ``seconds``: CPU time of the runs that it is fitted to.
    """

    middle: Array
    scale: Array
    coefficients: Array
    seconds: float

    @classmethod
    def of(cls, model: Callable[[str, Array], Responses], fidelity: str, inputs: Array) -> Surface | None:
        """Surface through a model's peaks at ``inputs`` (m, d); None where too few of them have a peak."""
        found = model(fidelity, inputs)
        known = np.isfinite(found.peak)
        middle, scale = inputs.mean(axis=0), inputs.std(axis=0)
        rows = terms((inputs - middle) / np.where(scale > 0, scale, 1.0))
        if known.sum() < 2 * rows.shape[1]:
            return None
        coefficients = np.asarray(np.linalg.lstsq(rows[known], found.peak[known], rcond=None)[0], dtype=float)
        return cls(middle, np.where(scale > 0, scale, 1.0), coefficients, float(found.seconds.sum()))

    def __call__(self, fidelity: str, inputs: Array) -> Responses:
        """Responses to inputs (m, d): their peaks alone."""
        begin = thread_time()
        peak = terms((inputs - self.middle) / self.scale) @ self.coefficients
        each = np.full(len(inputs), (thread_time() - begin) / max(len(inputs), 1))
        return Responses.of_amplitude(fidelity, inputs, np.full(1, np.nan), peak[:, None], each)


def runs(inputs: int) -> int:
    """Number of runs that a surface over so many inputs is fitted to."""
    return RUNS * (inputs + 1) * (inputs + 2) // 2


def terms(x: Array) -> Array:
    """Terms (m, k) of a polynomial of degree two in x (m, d)."""
    columns = [np.ones(len(x)), *x.T]
    columns += [x[:, i] * x[:, j] for i, j in combinations_with_replacement(range(x.shape[1]), 2)]
    return np.column_stack(columns)
