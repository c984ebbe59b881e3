"""Least squares over the estimated keys: from several starts, again with each point on its nearest actual motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.fit.assignment import nearest, nearest_actual
from vibeam.studies.fit.problem import Problem

Array = NDArray[np.float64]

Index = NDArray[np.int64]

STARTS = 16  # by Sobol's sequence, beside the case's own values

POLISHED = 3  # starts minimised from

ROUNDS = 6  # of choosing motions and minimising

FINE = 1e-9


@dataclass(frozen=True)
class Minimum:
    """Least squares at shares ``x`` (P,): ``misfit`` Σ r², residuals, Jacobian (rows, P), each point's motion.

    ``actual`` (points,): whether that motion is one.
    """

    x: Array
    misfit: float
    residual: Array
    jacobian: Array
    chosen: Index
    actual: NDArray[np.bool_]


def minimise(problem: Problem, x: Array, chosen: Index, fixed: dict[int, float] | None = None) -> tuple[Array, float]:
    """Minimise over the shares that are not ``fixed``, motions held: the minimum's shares and Σ r²."""
    from scipy.optimize import least_squares

    fixed = fixed or {}
    free = [k for k in range(len(x)) if k not in fixed]
    whole = x.copy()
    for k, value in fixed.items():
        whole[k] = value
    if not free:
        residual, _ = problem.residuals(whole, chosen)
        return whole, float(residual @ residual)
    seen: dict[bytes, tuple[Array, Array]] = {}

    def at(part: Array) -> tuple[Array, Array]:
        mark = part.tobytes()
        if mark not in seen:
            seen.clear()
            full = whole.copy()
            full[free] = part
            seen[mark] = problem.residuals(full, chosen)
        return seen[mark]

    found = least_squares(
        lambda part: at(part)[0], np.clip(whole[free], FINE, 1 - FINE), jac=lambda part: at(part)[1][:, free],
        bounds=(0.0, 1.0), xtol=1e-7, ftol=1e-7, gtol=1e-9, max_nfev=40,
    )  # fmt: skip
    whole[free] = found.x
    return whole, float(2 * found.cost)


def estimate(problem: Problem) -> Minimum:
    """Best of several minima."""
    tried = [problem.start, *_sobol(len(problem.keys))]
    ranked = sorted(tried, key=lambda x: nearest(problem, x)[1])
    found = [settled(problem, x) for x in ranked[:POLISHED]]
    return min(found, key=lambda each: (round(float(np.sum(~each.actual)) / max(problem.count, 1), 1), each.misfit))


def _sobol(dimensions: int) -> Array:
    from scipy.stats.qmc import Sobol

    return np.asarray(Sobol(dimensions, scramble=True, rng=19).random(STARTS))


def settled(problem: Problem, x: Array) -> Minimum:
    """Minimum from one start, with each point on the nearest actual motion of the last round."""
    chosen, _ = nearest(problem, x)
    x, misfit = minimise(problem, x, chosen)
    allowed = np.ones(problem.count, bool)
    for _ in range(ROUNDS):
        again, allowed = nearest_actual(problem, x)
        if np.array_equal(again, chosen):
            break
        chosen = again
        x, misfit = minimise(problem, x, chosen)
    residual, jacobian = problem.residuals(x, chosen)
    return Minimum(x, misfit, residual, jacobian, chosen, allowed)
