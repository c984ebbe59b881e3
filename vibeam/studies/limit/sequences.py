"""A rig in growing numbers of modes, with something held: what each model gives, and the limit of the sequence.

With a coefficient of restitution, R of the contact or R₁ of mode 1: the other one, and the exact motion with one impact
a drive period. With a stop that yields: one collision of mode 1 with it. Elements grow with the modes, three for each.

With x_N = x + a N⁻ᵖ + …, the differences d_k = x_{2N} − x_N fall by 2⁻ᵖ at each doubling, and

    p = log₂ |d_{k−1}/d_k|,        x = x_K + d_K/(2ᵖ − 1)        (Richardson, Aitken's Δ² with q = 2⁻ᵖ)

The rate of the last three differences must agree for that. Where it does not, as where single modes count more than
others, the remainder is bounded by the decay of the largest later difference; where that does not decay there is no
limit in sight.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any, Literal

import numpy as np

from vibeam.case.fidelity import Fidelity, system
from vibeam.observe.restitution import first_mode_restitution
from vibeam.periodic.predicted_response import OrbitKind, PredictedResponse
from vibeam.runs.closed_motions import HARDER, SOFTER, closed_motion
from vibeam.runs.comparison.limit import LEAST_SHARE, RESOLVED
from vibeam.solvers.collision import struck
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.laws import ContactLaw
from vibeam_models.scene import RigScene, Scene

BARE = (
    "the contact has little or no mass of its own: its mobility grows with each mode more, mode 1 gets less of the "
    "impulse and in the end none"
)

MOVING_LAW = (
    "the stop's damping is the one that gives a free mass 1/S its restitution, S the mobility of the modes kept, which "
    "grows with each mode more: it is another stop each time. Give the damping itself"
)


@dataclass(frozen=True)
class ModeSequence:
    """Values of one quantity over the numbers of modes; ``why``: it is known beforehand to have no limit."""

    quantity: str
    unit: str
    values: tuple[float, ...]
    why: str = ""


def models(scene: RigScene, counts: Sequence[int]) -> list[ImpactSystem]:
    """Systems of ``scene`` in so many modes, on elements that resolve them; ValueError where one cannot be built."""
    return [system(_resolving(scene, count), Fidelity(f"{count} modes", "modal", count)) for count in counts]


def _resolving(scene: RigScene, count: int) -> Any:
    if not isinstance(scene, Scene):
        return scene
    elements = max(scene.beam.elements, RESOLVED * count)
    return replace(scene, beam=replace(scene.beam, elements=elements + elements % 2))


def with_restitution(scene: RigScene, held: Literal["contact", "first mode"]) -> Any:
    """The scene with its coefficient of restitution held of ``"contact"`` or ``"first mode"``."""
    given: Any = scene
    return replace(given, stop=replace(scene.stop, restitution_of=held))


def with_law(scene: RigScene, law: ContactLaw) -> Any:
    """The scene with a stop that yields in place of its own."""
    given: Any = scene
    return replace(given, stop=replace(scene.stop, restitution=None, restitution_of="contact", law=law))


def of_restitution(
    found: Sequence[ImpactSystem], held: str, omega: float, base: float, output: str
) -> Iterator[ModeSequence]:
    """The other coefficient, and amplitude and impact velocity of the exact motion at one drive."""
    mobility = [each.mobility for each in found]
    bare = "" if mobility[-1] * LEAST_SHARE < mobility[len(mobility) // 2] else BARE
    if held == "contact":
        yield ModeSequence("R₁ of mode 1", "1", tuple(map(first_mode_restitution, found)), bare)
    else:
        yield ModeSequence("R of the contact", "1", tuple(each.restitution for each in found), bare)
    there = [exact_motion(each, omega, base, output) for each in found]
    yield ModeSequence("amplitude", "m", _of(there, lambda each: each.amplitude), bare)
    yield ModeSequence("impact velocity", "m/s", _of(there, lambda each: each.impact_velocity), bare)


def _of(there: Sequence[PredictedResponse | None], read: Callable[[PredictedResponse], Array]) -> tuple[float, ...]:
    return tuple(nan if each is None else float(read(each)[0]) for each in there)


def exact_motion(model: ImpactSystem, omega: float, base: float, output: str) -> PredictedResponse | None:
    """Stable exact motion with one impact a drive period, clear of the stop in between; None where there is none."""
    drive, amplitude = np.array([omega]), np.array([base])
    there = (closed_motion(model, drive, amplitude, output, kind) for kind in (HARDER, SOFTER))
    return next((each for each in there if each.found[0] == OrbitKind.ORBIT.code), None)


def moving_law(found: Sequence[ImpactSystem]) -> str:
    """Reason why a stop is another one in each model; empty where it is the same."""
    if all(each.law == found[0].law for each in found):
        return ""
    share = found[len(found) // 2].mobility / found[-1].mobility
    return "" if share > LEAST_SHARE else MOVING_LAW


def of_collision(found: Sequence[ImpactSystem], speed: float) -> Iterator[ModeSequence]:
    """Share of its velocity that mode 1 keeps in one collision at ``speed`` m/s, and how long the contact lasts."""
    seen, why = [struck(each, speed) for each in found], moving_law(found)
    yield ModeSequence("R₁ of mode 1", "1", tuple(each.mode_restitution for each in seen), why)
    yield ModeSequence("R of the contact", "1", tuple(each.restitution for each in seen), why)
    yield ModeSequence("contact time", "s", tuple(each.duration for each in seen), why)


def modes_by_contact_time(model: ImpactSystem, duration: float) -> int:
    """Number of modes with less than one period in the contact time ``duration``, s: those that it can excite."""
    return int(np.count_nonzero(np.sort(model.omega) / (2 * np.pi) * duration < 1))


LEAST = 4  # values from which a rate is observed
SLOWEST = 0.4  # rate below which differences are not taken to sum up
STEADY = 0.25  # largest difference of two successive rates of a sequence that is extrapolated
ROUND_OFF = 1e-9  # relative difference at which a sequence has arrived
TOO_FEW = "too few numbers of modes to observe a rate"
DIVERGES = "no limit in sight: from N = {0} to {1} it still changes by {2:.2g} %, no less than before"


@dataclass(frozen=True)
class ObservedLimit:
    """Limit with its ``uncertainty``, and the ``rate`` p of N⁻ᵖ; ``why``: it is refused, and the limit is NaN.

    ``extrapolated``: by the rate; else it is the last value, and the uncertainty bounds what is left.
    """

    limit: float
    uncertainty: float
    rate: float
    extrapolated: bool = False
    why: str = ""


def observed_limit(counts: Sequence[int], values: Sequence[float]) -> ObservedLimit:
    """Limit of ``values`` at numbers of modes ``counts``, each twice the one before."""
    x = np.asarray(values, dtype=float)
    if len(x) < LEAST or not np.isfinite(x).all():
        return ObservedLimit(nan, nan, nan, why=TOO_FEW)
    steps = np.diff(x)
    scale = max(abs(float(x[-1])), 1e-300)
    if np.all(np.abs(steps[-2:]) <= ROUND_OFF * scale):
        return ObservedLimit(float(x[-1]), ROUND_OFF * scale, nan)
    with np.errstate(divide="ignore"):
        rates = np.log2(np.abs(steps[:-1] / steps[1:]))
    one_way = bool(np.all(steps[-3:] > 0) or np.all(steps[-3:] < 0))
    if one_way and rates[-1] > SLOWEST and abs(rates[-1] - rates[-2]) < STEADY:
        return _extrapolated(x, steps, float(rates[-1]), float(rates[-2]))
    return _bounded(counts, x, steps)


def _extrapolated(x: Array, steps: Array, rate: float, before: float) -> ObservedLimit:
    """Richardson's limit; uncertain by what it changes with the rate observed before."""
    here, there = (float(x[-1] + steps[-1] / (2**p - 1)) for p in (rate, max(before, SLOWEST)))
    previous = float(x[-2] + steps[-2] / (2 ** max(before, SLOWEST) - 1))
    return ObservedLimit(here, max(abs(here - there), abs(here - previous)), rate, extrapolated=True)


def _bounded(counts: Sequence[int], x: Array, steps: Array) -> ObservedLimit:
    """Last value, with the geometric bound on the rest by the decay of the largest later difference."""
    later = np.maximum.accumulate(np.abs(steps)[::-1])[::-1]
    rate = float(-np.polyfit(np.arange(len(later)), np.log2(np.maximum(later, 1e-300)), 1)[0])
    recent = float(np.log2(later[-3] / later[-1]) / 2) if len(later) > 2 else rate
    if min(rate, recent) <= SLOWEST:
        change = 100 * abs(float(steps[-1])) / max(abs(float(x[-1])), 1e-300)
        return ObservedLimit(nan, nan, rate, why=DIVERGES.format(counts[-2], counts[-1], change))
    return ObservedLimit(float(x[-1]), float(later[-1] / (2 ** min(rate, recent) - 1)), rate)
