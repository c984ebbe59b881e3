"""Sentences on what a fit can and cannot say: the misfit, open directions, the ridge along which keys make up for each
other.

Directions are those of the Jacobian in units of the bounds, J = U diag(s) Vᵀ: along v the keys are known to ± 1.96/s of
their bounds' width. One that is not known within the bounds is not determined. What stays the same along it is found on
the ridge itself, the path of the profile: a product of powers of two keys, or for gain and restitution the slow flow's
γ/(ζ₁ − ln R₁/π), each with how constant it is there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from math import log, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.observe.restitution import first_mode_restitution
from vibeam.studies.fit.estimate import Minimum, probability
from vibeam.studies.fit.judgement import Judgement, Pattern, doubled
from vibeam.studies.fit.linear_estimates import directions_of
from vibeam.studies.fit.problem import Problem
from vibeam.studies.fit.profile import BOUND, LEVEL, FitRow, Profile
from vibeam.system.number_text import with_unit
from vibeam_models.arguments import counted
from vibeam_models.arrays import Array

if TYPE_CHECKING:
    from vibeam.studies.fit.surface import Forward


SMALL = 1e-3  # probability below which it is told as such; of less misfit than the uncertainty allows for
SHOWN = 6  # frequencies named
OPEN = 0.5  # half-width of a direction, share of the bounds, from which on it is not determined
TOGETHER = 0.95  # correlation of two keys from which on their ridge is told
CONSTANT = 0.03  # relative change along a ridge of a product of powers that is said to be constant
SLOW = 0.12  # the same of the slow flow's quotient, which averaging makes out to be constant
DRIVES = ("drive.gain", "drive.voltage", "drive.amplitude")


def facts(problem: Problem, minimum: Minimum, judgement: Judgement) -> list[str]:
    """The misfit where it can be judged, and the number of points on each motion."""
    found = [_verdict(minimum, judgement)] if minimum.freedom > 0 else []
    kinds = Counter(problem.called(each) for each in sorted(minimum.chosen[minimum.used].tolist()))
    counts = [f"{n} with {each}" for each, n in kinds.items()]
    counts += [f"{n} left out" for n in [int(np.sum(~minimum.used))] if n]
    return [*found, f"{counted(problem.count, 'point')}: {', '.join(counts)}."]


def on_misfit(problem: Problem, minimum: Minimum, judgement: Judgement) -> Iterator[str]:
    """Sentences on the model: if it does not describe the points what is known of the cause; points on no motion."""
    free = minimum.freedom
    *verdict, counts = facts(problem, minimum, judgement)
    yield from verdict
    yield from _on_outliers(problem, judgement)
    if not judgement.described:
        yield from _on_cause(problem, judgement)
        bound = [each.key for each, x in zip(problem.keys, minimum.x, strict=True) if min(x, 1 - x) < BOUND]
        yield from (f"{key} is at a bound of [fit.keys]: widen it." for key in bound)
        yield _on_intervals(judgement)
    explained = judgement.rejected or any(each.met for each in judgement.others)
    if not explained and any(each.significant for each in judgement.patterns):
        yield f"The residuals have a pattern {_pattern(judgement)}."
    if free < 0:
        yield f"{counted(free + len(problem.keys), 'point')} cannot fix {len(problem.keys)} keys."
    yield counts
    yield from _on_others(problem, minimum)
    lost = minimum.used & ~minimum.actual
    if lost.any():
        told = "the nearest motion is none that the model has at these keys (it has ended, exists at larger drives "
        yield f"At {_where(problem, lost)} {told}only, passes through the stop, is not stable, or has no derivative)."


def _verdict(minimum: Minimum, judgement: Judgement) -> str:
    free, share = minimum.freedom, probability(minimum.misfit, minimum.freedom)
    told = f"χ² = {minimum.misfit:.4g} for {free} degrees of freedom, p {_probability(share)}"
    if not judgement.described:
        return f"This model does not describe these points: {told}."
    if judgement.rejected:
        return f"The residuals reject this model {_pattern(judgement)}; {told}. Its intervals do not hold."
    if share > 1 - SMALL:
        told += ": less than the uncertainty allows for, which may be too large"
    return f"Misfit: {told}."


def _probability(share: float) -> str:
    return "below 0.1 %" if share < SMALL else "above 99 %" if share > 0.99 else f"= {100 * share:.2g} %"


def _on_outliers(problem: Problem, judgement: Judgement) -> Iterator[str]:
    """Points that contradict all others."""
    for each in judgement.outliers:
        side = "below" if each.residual > 0 else "above"
        yield (
            f"The point at {problem.frequency[each.index]:.5g} Hz contradicts all others and is left out: it is "
            f"{abs(each.residual):.3g} standard uncertainties {side} what they say "
            f"(p {_probability(each.probability)} among {problem.count})."
        )


def _on_cause(problem: Problem, judgement: Judgement) -> Iterator[str]:
    """Causes that are possible: a unit, the convention of the gap or of R, the number of modes."""
    if judgement.unit != 1.0:
        size = f"{max(judgement.unit, 1 / judgement.unit):.0f}"
        names = ", ".join(dict.fromkeys(each.reference for each in problem.groups))
        how = f"{size} times too {'small' if judgement.unit > 1 else 'large'}"
        told = f"multiplied by {judgement.unit:g} the model comes near to them"
        yield f"The values of {names} look {how}: {told}. Look at their unit."
    better = [each for each in judgement.others if each.met]
    if better:
        told = " or ".join(f"{each.called} (χ² = {each.misfit:.4g} for {each.freedom})" for each in better)
        yield f"It would describe them with {told}."
    elif judgement.others:
        yield f"Nor does it with {', nor with '.join(each.called for each in judgement.others)}."


def _on_intervals(judgement: Judgement) -> str:
    if judgement.withheld:
        return "Intervals are withheld: the values are those of the least misfit, and may be off by any amount."
    return (
        f"Intervals are scaled by {judgement.scale:.3g} = √(χ²/degrees of freedom): they hold if all uncertainties are "
        "larger by so much, and the model is right."
    )


def _pattern(judgement: Judgement) -> str:
    """Test of the most significant pattern, what it suggests, and those that are not told apart from it."""
    first, *rest = (each for each in judgement.patterns if each.significant)
    told = f"(F test, p {_probability(first.probability)}): {IN_WORDS[first.name](first)}"
    if rest:
        told += f"; not told apart from it: {', '.join(SHORT[each.name] for each in rest)}"
    return told


IN_WORDS: dict[str, Callable[[Pattern], str]] = {
    "factor": lambda each: f"all values as if times {1 + each.size:.4g}, a calibration",
    "frequency": lambda each: (
        f"over the frequency, {100 * doubled(each) / 10:+.3g} % for each 7 % of it (a tenth of an octave)"
    ),
    "amplitude": lambda each: f"over the value, {100 * doubled(each):+.3g} % for each doubling of it",
    "velocity": lambda each: (
        f"over the impact velocity v, as if R changed by {doubled(each):+.3g} ± {1.96 * log(2) * each.error:.2g} "
        "for each doubling of it: a law R(v)"
    ),
    "shift": lambda each: f"as if all frequencies were off by {100 * each.size:+.3g} %, those measured or the model's",
}

SHORT = {
    "factor": "a factor on all values", "frequency": "a trend over the frequency",
    "amplitude": "a trend over the value", "velocity": "R over the impact velocity", "shift": "a shift in frequency",
}  # fmt: skip


def _on_others(problem: Problem, minimum: Minimum) -> Iterator[str]:
    """Points outside the family, by what the model does there."""
    kinds: dict[str, list[int]] = {}
    for j, other in minimum.others.items():
        kinds.setdefault(other.called, []).append(j)
    for called, points in kinds.items():
        which = np.isin(np.arange(problem.count), points)
        off = np.sqrt([minimum.others[j].cost for j in points if np.isfinite(minimum.others[j].value)])
        told = f"At {_where(problem, which)} the motion has {called}, and cannot be followed"
        if len(off):
            far = f"{off.max():.2g} standard uncertainties off" + (" at most" if len(off) > 1 else "")
            told += f"; flown it is {far}"
        yield f"{told}: left out."


def _where(problem: Problem, which: NDArray[np.bool_]) -> str:
    found = [f"{each:.5g}" for each in problem.frequency[which]]
    more = f" … ({len(found)} points)" if len(found) > SHOWN else ""
    return f"{', '.join(found[:SHOWN])}{more} Hz"


def on_directions(problem: Problem, minimum: Minimum) -> Iterator[str]:
    """Directions that the points leave open."""
    singular, rows = directions_of(minimum.jacobian)
    half = np.sqrt(LEVEL) / np.maximum(singular, 1e-300)
    for each, direction in zip(half, rows, strict=True):
        if each > OPEN:
            part = np.flatnonzero(np.abs(direction) > 0.1 * np.abs(direction).max())
            names = " and ".join(problem.keys[k].key for k in part)
            if len(part) == 1:
                yield f"{names} is not determined by these points within its bounds."
            else:
                yield f"{names} are not separated by these points within the bounds: only a relation between them is."


class Ridge(NamedTuple):
    """Ridge of two keys in a sentence; ``shared``: what is known of both together, empty where nothing simple is."""

    said: str
    shared: str


def on_ridges(
    problem: Problem, minimum: Minimum, profiles: Sequence[Profile], rows: Sequence[FitRow]
) -> Iterator[Ridge]:  # fmt: skip
    """Ridges of strongly correlated keys, with what is invariant along each."""
    for k, j in ridges(problem, minimum):
        path = profiles[k].path
        path = path[path[:, -1] <= LEVEL * 1.1]
        if len(path) < 3:
            continue
        values = problem.low + path[:, :-1] * problem.width
        one, other = problem.keys[k].key, problem.keys[j].key
        ends = [_pair(problem, values[at], k, j) for at in (0, -1)]
        head = f"{one} and {other} make up for each other, from ({ends[0]}) to ({ends[1]})"
        kept = _constant(problem, values, k, j)
        alone = f"{one} alone is free between {rows[k].ends(' and ')}, {other} between {rows[j].ends(' and ')}"
        yield Ridge(f"{head}; {kept}; {alone}." if kept else f"{head}; {alone}.", kept)


def ridges(problem: Problem, minimum: Minimum) -> list[tuple[int, int]]:
    """Pairs of keys on a ridge, the least known first; of each key the partner with the strongest correlation."""
    spread = minimum.covariance
    size = np.sqrt(np.diag(spread))
    correlation = np.abs(spread / size / size[:, None]) - np.eye(len(size))
    found: list[tuple[int, int]] = []
    for k in np.argsort(-size).tolist():
        j = int(np.argmax(correlation[k]))
        if correlation[k, j] > TOGETHER and (j, k) not in found:
            found.append((k, j))
    return found


def _pair(problem: Problem, values: Array, k: int, j: int) -> str:
    return ", ".join(with_unit(float(values[each]), problem.keys[each].unit) for each in (k, j))


def _constant(problem: Problem, values: Array, k: int, j: int) -> str:
    """Invariant of a ridge in words; empty where nothing simple is constant."""
    names = {problem.keys[k].key: values[:, k], problem.keys[j].key: values[:, j]}
    slow = _slow_flow(problem, names, values)
    if slow and slow[1] < SLOW:
        return f"what they share is {slow[2]} = {slow[0]:.4g}, to {100 * slow[1]:.2g} % along it"
    if (values[:, [k, j]] <= 0).any():
        return ""
    logs = np.log(values[:, [k, j]])
    logs = logs - logs.mean(axis=0)
    along = np.linalg.svd(logs, full_matrices=False)[2][0]
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
    for row, size in zip(values, names[drive], strict=True):
        made = forward.system(row)
        if made.law is not None:
            return None
        seen = first_mode_restitution(made)
        if seen <= 0:
            return None
        found.append(size / (made.zeta[0] - log(seen) / pi))
    mean = float(max(found) + min(found)) / 2
    return mean, float(np.ptp(found) / mean), f"{drive}/(ζ₁ − ln R₁/π)"
