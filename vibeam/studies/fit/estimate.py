"""Least squares over the estimated keys, with each point on the motion that explains it.

1. The bounds are scanned in closed form at quasi-random keys; the best of these, and the case's own, are minimised from
   by Gauss–Newton steps in a trust region (scipy's ``least_squares``), each point on its nearest motion, with Cauchy's
   loss, which no single foreign point turns (Huber, Robust Statistics, 1981, §7.8).
2. From the best of these the fit is settled: explain the points, minimise, and again, until the explanation stays.
   Where explanations come back in a cycle, what one of them leaves out stays out.
3. The best is the one of the least loss over all points, those outside the family by the model's flown motion. One
   without any contact is taken only where it meets the points, or no other touches the stop.
4. Least squares proper follow; then surfaces over a smaller box, until the model itself confirms the residuals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vibeam.studies.fit.explanation import SCALE, Explanation, costs, explained, nearest, robust
from vibeam.studies.fit.other_motions import OtherMotion
from vibeam.studies.fit.problem import IMPOSSIBLE, LEFT, NO_CONTACT, Index, Problem
from vibeam.studies.fit.surface import quasi_random

Array = NDArray[np.float64]

SCANNED = 32  # keys looked at, for each that is estimated

SAMPLES = 64  # a period, of the motions of the scan

TRIED, SETTLED = 6, 3  # starts minimised from; of these, settled

FEW, MANY = 8, 40  # evaluations of a minimisation

ROUNDS = 8  # of explaining and minimising

NEAREST = 4  # of these with every point on its nearest motion, to begin with

NEAR = 4.0  # residual up to which a point that is left out may belong to the family

APART = 0.02  # distance of two minima, share of the bounds

FINE = 1e-9

ROUGHLY = 1e-5  # tolerance of a minimisation between two explanations

NEARBY = 4.5  # standard errors to either side, of the box of the last surfaces

SURE = 1e-9  # tolerance of the modal data there

CONFIRMED = 0.02  # difference of residuals by the surfaces and by the model itself, in standard uncertainties

SMALLER = 6  # boxes at most


@dataclass(frozen=True)
class Minimum:
    """Least squares at shares ``x`` (P,): ``misfit`` Σ r², residuals, Jacobian (rows, P), each point's motion.

    ``actual`` (points,): whether the model has that motion. ``others``: what the points do that are left out as outside
    the family. ``loss``: over all points.
    """

    x: Array
    misfit: float
    residual: Array
    jacobian: Array
    chosen: Index
    actual: NDArray[np.bool_]
    others: dict[int, OtherMotion]
    loss: float

    @classmethod
    def at(cls, problem: Problem, x: Array, chosen: Index, explanation: Explanation) -> Minimum:
        """Record of a minimum with the motions ``chosen``."""
        residual, jacobian = problem.residuals(x, chosen)
        return cls(
            x, float(residual @ residual), residual, jacobian, chosen, explanation.actual & (chosen != LEFT),
            explanation.others, explanation.loss,
        )  # fmt: skip

    @property
    def used(self) -> NDArray[np.bool_]:
        """Points (points,) that are not left out."""
        return np.asarray(self.chosen != LEFT)

    @property
    def freedom(self) -> int:
        """Degrees of freedom."""
        return int(np.count_nonzero(self.used)) - len(self.x)

    @property
    def covariance(self) -> Array:
        """Linearised covariance (P, P) of the shares, with the bounds as a weak prior: a uniform distribution."""
        curvature = self.jacobian.T @ self.jacobian
        return np.asarray(np.linalg.inv(curvature + 12 * np.eye(len(curvature))))

    @property
    def touches(self) -> bool:
        """Whether any point has contact."""
        return bool(np.any(self.chosen != NO_CONTACT))


@dataclass(frozen=True)
class Scan:
    """Keys looked at over the bounds: shares (m, P), and values and ln(B*/B) (m, 3, points) of all motions."""

    x: Array
    value: Array
    beyond: Array

    @classmethod
    def of(cls, problem: Problem) -> Scan:
        """Scan of the case's own keys and of quasi-random ones."""
        count = SCANNED * len(problem.keys)
        every = np.vstack([problem.start, quasi_random(count, len(problem.keys))])
        rows = []
        for x in every:
            try:
                rows.append((x, *problem.motions(x, SAMPLES)))
            except ValueError:  # keys that make no system
                continue
        return cls(*(np.array(each) for each in zip(*rows, strict=True)))

    def losses(self, problem: Problem, factor: float = 1.0) -> Array:
        """Losses (m,) against the measured values times a ``factor``."""
        found = zip(self.value, self.beyond, strict=True)
        return np.array([robust(costs(problem, *each, factor).min(axis=0)) for each in found])


def minimise(
    problem: Problem, x: Array, chosen: Index, fixed: dict[int, float] | None = None, *, loss: str = "linear",
    most: int = MANY, tolerance: float = 1e-7,
) -> tuple[Array, float]:  # fmt: skip
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
        bounds=(0.0, 1.0), xtol=tolerance, ftol=tolerance, gtol=1e-9, max_nfev=most, loss=loss, f_scale=SCALE,
    )  # fmt: skip
    whole[free] = found.x
    return whole, float(found.fun @ found.fun)


def estimate(problem: Problem, scan: Scan) -> tuple[Problem, Minimum]:
    """Best of several minima, and the problem with surfaces about it."""
    ranked = scan.x[np.argsort(scan.losses(problem), kind="stable")]
    tried = []
    for x in np.vstack([problem.start, ranked[:TRIED]]):
        found, _ = minimise(problem, x, nearest(problem, x)[0], loss="cauchy", most=FEW)
        tried.append((nearest(problem, found)[1], found))
    tried.sort(key=lambda each: each[0])
    starts: list[Array] = []
    for _, x in tried:
        if all(np.abs(x - other).max() > APART for other in starts):
            starts.append(x)
    return refined(problem, returned(problem, best([settled(problem, x) for x in starts[:SETTLED]])))


def best(found: list[Minimum]) -> Minimum:
    """The minimum of the least loss; one without contact only where it meets the points, or no other touches."""
    first = min(found, key=lambda each: each.loss)
    touching = [each for each in found if each.touches]
    if first.touches or not touching or met(first.misfit, first.freedom):
        return first
    return min(touching, key=lambda each: each.loss)


UNLIKELY = 0.01  # probability of a misfit from which on a model is said not to describe the points


def met(misfit: float, freedom: int) -> bool:
    """Test whether a misfit is as likely as ``UNLIKELY`` by the uncertainties alone."""
    return freedom < 1 or probability(misfit, freedom) >= UNLIKELY


def probability(misfit: float, freedom: int) -> float:
    """Probability of a χ² of so many degrees of freedom at least as large."""
    from scipy.special import chdtrc

    return float(chdtrc(freedom, misfit))


def settled(problem: Problem, x: Array, dropped: tuple[int, ...] = (), *, nearby: bool = False) -> Minimum:
    """Minimum from one start: points explained and keys minimised in turn until the explanation stays.

    ``dropped``: points that are left out whatever explains them; ``nearby``: the start is near to the minimum.
    """
    seen: list[bytes] = []
    x = x if nearby else on_nearest(problem, x, dropped)
    chosen, found = np.zeros(problem.count, dtype=np.int64), explained(problem, x, dropped)
    for _ in range(ROUNDS):
        left = found.chosen == LEFT
        if seen and np.array_equal(found.chosen, chosen):
            break
        cycle = found.chosen.tobytes() in seen
        chosen = np.where(left | ((chosen == LEFT) if cycle else False), LEFT, found.chosen)
        seen.append(found.chosen.tobytes())
        x, _ = minimise(problem, x, chosen, loss="cauchy", tolerance=ROUGHLY)
        x, _ = minimise(problem, x, chosen, tolerance=ROUGHLY)
        found = explained(problem, x, dropped)
        if cycle:
            break
    return Minimum.at(problem, x, chosen, found)


def on_nearest(problem: Problem, x: Array, dropped: tuple[int, ...]) -> Array:
    """Keys of the least robust loss with each point on its nearest motion, whether the model has it or not."""
    before = np.zeros(0, dtype=np.int64)
    for _ in range(NEAREST):
        chosen, _ = nearest(problem, x)
        chosen[list(dropped)] = LEFT
        if np.array_equal(chosen, before):
            break
        x, _ = minimise(problem, x, chosen, loss="cauchy", tolerance=ROUGHLY)
        before = chosen
    return x


def returned(problem: Problem, found: Minimum, dropped: tuple[int, ...] = ()) -> Minimum:
    """The same minimum, or that from keys for which points near to the family are in it, where the loss is less.

    Next to the end of a branch a point may be left out at one set of keys, and in the family at the next.
    """
    if not found.others:
        return found
    chosen = found.chosen.copy()
    value, beyond = problem.motions(found.x)
    cost = np.where(beyond == 0, costs(problem, value, beyond), np.inf)
    near = [j for j in found.others if cost[:, j].min() < NEAR**2]
    if not near:
        return found
    chosen[near] = np.argmin(cost[:, near], axis=0)
    x, _ = minimise(problem, found.x, chosen, loss="cauchy", tolerance=ROUGHLY)
    other = settled(problem, x, dropped, nearby=True)
    return other if other.loss < found.loss else found


def refined(problem: Problem, minimum: Minimum, dropped: tuple[int, ...] = ()) -> tuple[Problem, Minimum]:
    """The problem with surfaces about a minimum that the model itself confirms, and the minimum by these."""
    half = np.clip(NEARBY * np.sqrt(np.diag(minimum.covariance)), 1e-4, 0.5)
    for _ in range(SMALLER):
        middle = np.clip(minimum.x, half, 1 - half)
        own = problem.within(middle - half, middle + half, SURE)
        x, _ = minimise(own, minimum.x, minimum.chosen)
        off = own.residuals(x, minimum.chosen, own.exact(x))[0] - own.residuals(x, minimum.chosen)[0]
        if np.abs(off).max() < CONFIRMED:
            break
        half = half / 3
    found = explained(own, x, dropped)
    return own, Minimum.at(own, x, minimum.chosen, found)


__all__ = ["IMPOSSIBLE", "Minimum", "Scan", "best", "estimate", "met", "minimise", "refined", "settled"]
