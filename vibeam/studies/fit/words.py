"""What a fit can and cannot say, in sentences: the misfit, open directions, the ridge along which keys make up for
each other.

Directions are those of the Jacobian in units of the bounds, J = U diag(s) Vᵀ: along v the keys are known to ± 1.96/s of
their bounds' width. One that is not known within the bounds is not determined. What stays the same along it is found on
the ridge itself, the path of the profile: a product of powers of two keys, or for gain and restitution the slow flow's
γ/(ζ₁ − ln R₁/π), each with how constant it is there.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import log, pi
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.apparent_restitution import first_mode_restitution
from vibeam.studies.fit.estimate import Minimum
from vibeam.studies.fit.problem import MOTIONS, Problem
from vibeam.studies.fit.profile import LEVEL, Profile

if TYPE_CHECKING:
    from vibeam.studies.fit.forward import Forward

Array = NDArray[np.float64]

UNLIKELY = 1e-3  # probability of a misfit from which on the model is said to miss

OPEN = 0.5  # half-width of a direction, share of the bounds, from which on it is not determined

TOGETHER = 0.95  # correlation of two keys from which on their ridge is told

CONSTANT = 0.03  # relative change along a ridge of a product of powers that is said to be constant

SLOW = 0.12  # the same of the slow flow's quotient, which averaging makes out to be constant

DRIVES = ("drive.gain", "drive.voltage", "drive.amplitude")


def on_misfit(problem: Problem, minimum: Minimum) -> Iterator[str]:
    """What the misfit says, and points on no actual motion."""
    from scipy.stats import chi2

    free = problem.count - len(problem.keys)
    if free < 0:
        yield f"{_points(problem.count)} cannot fix {len(problem.keys)} keys."
    elif free > 0:
        share = float(chi2.sf(minimum.misfit, free))
        told = f"Misfit: χ² = {minimum.misfit:.4g} for {free} degrees of freedom"
        if share < UNLIKELY:
            told += ": the model misses the points by more than their uncertainty, and the intervals do not hold"
        elif share > 1 - UNLIKELY:
            told += ": less than the uncertainty allows for, which may be too large"
        yield f"{told}."
    counts = [f"{n} with {MOTIONS[k]}" for k, n in enumerate(np.bincount(minimum.chosen, minlength=3)) if n]
    yield f"{_points(problem.count)}: {', '.join(counts)}."
    lost = int(np.sum(~minimum.actual))
    if lost:
        where = ", ".join(f"{f:.5g} Hz" for f in problem.frequency[~minimum.actual][:6])
        why = "it passes through the stop, is not stable, or exists at larger drives only"
        told = "a motion with several impacts until it repeats is not among those that a fit knows"
        yield f"At {lost} of them the nearest motion is none that the model has ({why}; {told}): {where}."


def _points(count: int) -> str:
    return "1 point" if count == 1 else f"{count} points"


def on_directions(problem: Problem, minimum: Minimum) -> Iterator[str]:
    """Directions that the points leave open."""
    _, singular, rows = np.linalg.svd(minimum.jacobian)
    half = np.sqrt(LEVEL) / np.maximum(np.append(singular, np.zeros(len(rows) - len(singular))), 1e-300)
    for each, direction in zip(half, rows, strict=True):
        if each > OPEN:
            part = np.flatnonzero(np.abs(direction) > 0.1 * np.abs(direction).max())
            names = " and ".join(problem.keys[k].key for k in part)
            if len(part) == 1:
                yield f"{names} is not determined by these points within its bounds."
            else:
                yield f"{names} are not separated by these points within the bounds: only a relation between them is."


def on_ridges(problem: Problem, minimum: Minimum, profiles: Sequence[Profile]) -> Iterator[str]:
    """What stays the same along the ridges of strongly correlated keys."""
    for k, j in ridges(problem, minimum):
        path = profiles[k].path
        path = path[path[:, -1] <= LEVEL * 1.1]
        if len(path) < 3:
            continue
        values = problem.low + path[:, :-1] * problem.width
        one, other = problem.keys[k].key, problem.keys[j].key
        head = (
            f"{one} and {other} make up for each other, from ({_pair(values[0], k, j)}) to ({_pair(values[-1], k, j)})"
        )
        kept = _constant(problem, values, k, j)
        alone = f"{one} alone is free between {_end(problem, profiles[k], k)}"
        alone += f", {other} between {_end(problem, profiles[j], j)}"
        yield f"{head}; {kept}; {alone}." if kept else f"{head}; {alone}."


def ridges(problem: Problem, minimum: Minimum) -> list[tuple[int, int]]:
    """Pairs of keys on a ridge, the least known first; of each key the partner with the strongest correlation."""
    from vibeam.studies.fit.profile import covariance

    spread = covariance(minimum)
    size = np.sqrt(np.diag(spread))
    correlation = np.abs(spread / size / size[:, None]) - np.eye(len(size))
    found: list[tuple[int, int]] = []
    for k in np.argsort(-size).tolist():
        j = int(np.argmax(correlation[k]))
        if correlation[k, j] > TOGETHER and (j, k) not in found:
            found.append((k, j))
    return found


def _end(problem: Problem, found: Profile, k: int) -> str:
    key = problem.keys[k]
    ends = [key.low + share * (key.high - key.low) for share in (found.low, found.high)]
    told = [f"{end:.4g}" + (" (its bound)" if is_open else "") for end, is_open in zip(ends, found.open, strict=True)]
    return " and ".join(told)


def _pair(values: Array, k: int, j: int) -> str:
    return f"{values[k]:.4g}, {values[j]:.4g}"


def _constant(problem: Problem, values: Array, k: int, j: int) -> str:
    """What is constant along a ridge, in words; empty where nothing simple is."""
    names = {problem.keys[k].key: values[:, k], problem.keys[j].key: values[:, j]}
    slow = _slow_flow(problem, names, values)
    if slow and slow[1] < SLOW:
        return f"what they share is {slow[2]} = {slow[0]:.4g}, to {100 * slow[1]:.2g} % along it"
    if (values[:, [k, j]] <= 0).any():
        return ""
    logs = np.log(values[:, [k, j]])
    logs = logs - logs.mean(axis=0)
    _, _, rows = np.linalg.svd(logs, full_matrices=False)
    along = rows[0]
    if min(abs(along)) < 1e-3:
        return ""
    power = -along[0] / along[1]  # ln other + power ln one is constant
    change = float(np.ptp(logs[:, 1] + power * logs[:, 0]))
    one, other = names
    sign = "·" if power > 0 else "/"
    if change > CONSTANT:
        return ""
    return f"what they share is {other} {sign} {one}^{abs(power):.3g}, to {100 * change:.2g} % along it"


def _slow_flow(problem: Problem, names: dict[str, Array], values: Array) -> tuple[float, float, str] | None:
    """Middle and relative change of drive/(ζ₁ − ln R₁/π) along a ridge."""
    drive = next((name for name in DRIVES if name in names), None)
    if drive is None or "stop.restitution" not in names:
        return None
    forward: Forward = next(iter(problem.forward.values()))
    found = []
    for row in values:
        made = forward.system(row)
        seen = first_mode_restitution(made)
        if seen <= 0:
            return None
        index = next(k for k, each in enumerate(problem.keys) if each.key == drive)
        found.append(row[index] / (made.zeta[0] - log(seen) / pi))
    mean = float(max(found) + min(found)) / 2
    return mean, float(np.ptp(found) / mean), f"{drive}/(ζ₁ − ln R₁/π)"
