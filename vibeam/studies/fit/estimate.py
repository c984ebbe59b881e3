"""Least squares over the estimated keys, with each point on the motion that explains it.

1. The bounds are scanned in closed form at quasi-random keys; the best of these, and the case's own, are minimised from
   by Gauss–Newton steps in a trust region (scipy's ``least_squares``), each point on its nearest motion, with Cauchy's
   loss, which no single foreign point turns (Huber, Robust Statistics, 1981, §7.8).
2. From the best of these the fit is settled: explain the points, minimise, and again, as long as the loss over all
   points falls, by steps cut to that end; so no explanation comes back.
3. Where that is not likely the model is flown at all keys of the scan, and settled from those nearest to the points.
4. The best is the one of the least loss over all points, those outside the family by the model's flown motion. One
   without any contact is taken only where it meets the points, or no other touches the stop.
5. Least squares proper follow; then surfaces over a smaller box, until the model itself confirms the residuals.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vibeam.store.blocks import Values
from vibeam.store.shares import evaluate_each
from vibeam.studies.fit.explanation import (
    UNTOLD,
    Explanation,
    costs,
    explained,
    flown_losses,
    nearest,
)
from vibeam.studies.fit.orbits import OtherMotion
from vibeam.studies.fit.problem import FOLLOWED, LEFT, SCALE, Problem, robust
from vibeam.studies.fit.surface import quasi_random
from vibeam_models.arrays import Array, Flags, Index

SCANNED = 32  # keys looked at, for each that is estimated
FLOWN_KEYS = 16  # the same, of models without closed forms
SAMPLES = 64  # a period, of the motions of the scan
TRIED, SETTLED = 6, 3  # starts minimised from; of these, settled
FEW, MANY = 8, 40  # evaluations of a minimisation
ROUNDS = 8  # of explaining and minimising
NEAREST = 4  # of these with every point on its nearest motion, to begin with
GAIN = 0.05  # decrease of the loss by which a round is worth while
SHARES = (1.0, 0.5, 0.2)  # of the way to a minimum that are tried
DOUBTFUL = 0.2  # probability of a misfit below which starts are looked for by flights
WORSE = 1.5  # loss a point above which they are too; 0.8 is expected of normal residuals
FLOWN = 5  # of these starts
APART = 0.02  # distance of two minima, share of the bounds
FINE = 1e-9
STILL = 1e-3  # share of the bounds within which the Jacobian of motions that are followed serves for the next step too
ROUGHLY = 1e-5  # tolerance of a minimisation between two explanations
NEARBY = 4.5  # standard errors to either side, of the box of the last surfaces
SURE = 1e-9  # tolerance of the modal data there
CONFIRMED = 0.02  # difference of residuals by the surfaces and by the model itself, in standard uncertainties
SMALLER = 6  # boxes at most


@dataclass(frozen=True)
class Minimum:
    """Least squares at shares ``x`` (P,): ``misfit`` Σ r², residuals, Jacobian (rows, P), each point's motion.

    ``actual`` (points,): whether the model has that motion. ``others``: what the points do that are left out.
    ``loss``: over all points. ``touches``: whether any has contact.
    """

    x: Array
    misfit: float
    residual: Array
    jacobian: Array
    chosen: Index
    actual: Flags
    others: dict[int, OtherMotion]
    loss: float
    touches: bool = True

    @classmethod
    def at(cls, problem: Problem, x: Array, chosen: Index, explanation: Explanation) -> Minimum:
        """Record of a minimum with the motions ``chosen``."""
        residual, jacobian = problem.residuals(x, chosen)
        actual = _had(problem, x, chosen, explanation.actual)
        return cls(
            x, float(residual @ residual), residual, jacobian, chosen, actual,
            explanation.others, explanation.loss, bool(problem.touching(chosen).any()),
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


def _had(problem: Problem, x: Array, chosen: Index, real: Flags) -> Flags:
    """Points (points,) whose motion the model has: those of the closed-form family that are ``real``, and followed."""
    found: Flags = real & (chosen != LEFT)
    for j in np.flatnonzero(chosen >= FOLLOWED).tolist():
        found[j] = problem.trails.exists(int(chosen[j]) - FOLLOWED, x, bool(problem.unstable[j]))
    return found


@dataclass(frozen=True)
class Scan:
    """Keys looked at over the bounds: shares (m, P), and values and ln(B*/B) (m, 3, points) of all motions."""

    x: Array
    value: Array
    beyond: Array

    @classmethod
    def of(cls, problem: Problem) -> Scan:
        """Scan of the case's own keys and of quasi-random ones."""
        count = (SCANNED if problem.surfaces else FLOWN_KEYS) * len(problem.keys)
        every = np.vstack([problem.start, quasi_random(count, len(problem.keys))])
        rows: list[tuple[Array, ...]] = []

        def at(x: Array) -> Values:
            try:
                value, beyond = problem.motions(x, SAMPLES)
            except ValueError:  # keys that make no system
                return {}
            return {"x": x, "value": value, "beyond": beyond}

        def keep(x: Array, found: Values) -> None:
            rows.extend([tuple(found.values())] if found else [])

        evaluate_each("starts", problem.key, list(every), at, keep, workers=1)
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
    seen: dict[tuple[bytes, bool], tuple[Array, Array]] = {}
    followed, kept = bool((chosen >= FOLLOWED).any()), list[tuple[Array, Array]]()

    def at(part: Array, slopes: bool) -> tuple[Array, Array]:
        mark = part.tobytes(), slopes or not followed
        if mark not in seen:
            seen.clear()
            full = whole.copy()
            full[free] = part
            seen[mark] = problem.residuals(full, chosen, slopes=slopes)
        return seen[mark]

    def jacobian(part: Array) -> Array:
        if not (followed and kept and np.abs(part - kept[0][0]).max() < STILL):
            kept[:] = [(part.copy(), at(part, True)[1][:, free])]
        return kept[0][1]

    found = least_squares(
        lambda part: at(part, False)[0], np.clip(whole[free], FINE, 1 - FINE), jac=jacobian,
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
    minima = list(_until_likely(problem, _apart([x for _, x in tried])[:SETTLED]))
    if _doubtful(minima[-1]):
        flown = scan.x[np.argsort(flown_losses(problem, scan.x), kind="stable")]
        minima += _until_likely(problem, flown[:FLOWN], nearby=True)
    return refined(problem, best(minima))


def _until_likely(problem: Problem, starts: Iterable[Array], *, nearby: bool = False) -> Iterator[Minimum]:
    """Minima from some starts, up to the first one that needs no other."""
    for x in starts:
        found = settled(problem, x, nearby=nearby)
        yield found
        if not _doubtful(found):
            break


def _apart(every: list[Array]) -> list[Array]:
    """Those of several shares that are not near to one before."""
    found: list[Array] = []
    for x in every:
        if all(np.abs(x - other).max() > APART for other in found):
            found.append(x)
    return found


def _doubtful(found: Minimum) -> bool:
    """Test whether a minimum is unlikely enough for others to be looked for by flights."""
    unlikely = found.freedom < 1 or probability(found.misfit, found.freedom) < DOUBTFUL
    far = any(each.cost > UNTOLD for each in found.others.values())
    return unlikely or far or found.loss > WORSE * len(found.chosen)


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
    """Minimum from one start: points explained and keys minimised in turn, as long as the loss over all points falls.

    ``dropped``: points that are left out whatever explains them; ``nearby``: the start is near to the minimum.
    """
    x = x if nearby else on_nearest(problem, x, dropped)
    found = explained(problem, x, dropped)
    for _ in range(ROUNDS):
        further, following = _descended(problem, x, found, dropped)
        if following.loss > found.loss - GAIN:
            break
        alike = np.array_equal(following.chosen, found.chosen)
        x, found = further, following
        if alike:  # the keys are at their minimum
            break
    final, _ = minimise(problem, x, found.chosen, tolerance=ROUGHLY)
    return Minimum.at(problem, final, found.chosen, found)


def _descended(problem: Problem, x: Array, found: Explanation, dropped: tuple[int, ...]) -> tuple[Array, Explanation]:
    """Keys that minimise with that explanation, and theirs; nearer ones where that has not lowered the loss."""
    goal, _ = minimise(problem, x, found.chosen, loss="cauchy", tolerance=ROUGHLY)
    for share in SHARES:
        further = x + share * (goal - x)
        following = explained(problem, further, dropped)
        if following.loss < found.loss - GAIN or np.array_equal(following.chosen, found.chosen):
            break
    return further, following


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


def refined(problem: Problem, minimum: Minimum, dropped: tuple[int, ...] = ()) -> tuple[Problem, Minimum]:
    """The problem with surfaces about a minimum that the model itself confirms, and the minimum by these."""
    half = np.clip(NEARBY * np.sqrt(np.diag(minimum.covariance)), 1e-4, 0.5)
    for _ in range(SMALLER):
        own = problem.about(minimum.x, half, SURE)
        x, _ = minimise(own, minimum.x, minimum.chosen)
        off = own.residuals(x, minimum.chosen, own.exact(x))[0] - own.residuals(x, minimum.chosen)[0]
        if np.abs(off).max() < CONFIRMED:
            break
        half = half / 3
    found = explained(own, x, dropped)
    chosen = minimum.chosen
    real = np.where(found.chosen == chosen, found.actual, minimum.actual)
    return own, replace(
        Minimum.at(own, x, chosen, found), actual=_had(own, x, chosen, real), others=minimum.others, loss=minimum.loss
    )
