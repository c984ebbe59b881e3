"""A rig in growing numbers of modes, for each thing that can be held: what each model gives, and the limit N → ∞.

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
from math import isfinite, nan
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.fidelity import Fidelity, system
from vibeam.case.held import PLACES, Held, holding
from vibeam.case.source import of_source
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.observe.restitution import first_mode_restitution
from vibeam.periodic.motions import HARDER, SOFTER, Motions, closed_motions, unsuited
from vibeam.runs.closed_motions import without_closed_forms
from vibeam.runs.comparison.limit import LEAST_SHARE, resolving
from vibeam.solvers.collision import struck
from vibeam.studies.modes_needed.reduction import plan_asked
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array
from vibeam_models.beam import structure_of
from vibeam_models.scene import RigScene, Scene

if TYPE_CHECKING:
    from vibeam.case.case import Case


WITHIN = 0.01  # share of the limit at which there are modes enough

BARE = (
    "the contact has little or no mass of its own: its mobility grows with each mode more, mode 1 gets less of the "
    "impulse and in the end none"
)

MOVING_LAW = (
    "the stop's damping is the one that gives a free mass 1/S its restitution, S the mobility of the modes kept, which "
    "grows with each mode more: it is another stop each time. Give the damping itself"
)

NO_MOTION = "no stable motion with one impact a drive period in {0} modes at modes_needed.frequency: write another"


@dataclass(frozen=True, kw_only=True)
class ObservedLimit:
    """Limit with its ``uncertainty``, and the ``rate`` p of N⁻ᵖ; ``why``: it is refused, and the limit is NaN.

    ``extrapolated``: by the rate; else it is the last value, and the uncertainty bounds what is left.
    """

    limit: float = nan
    uncertainty: float = nan
    rate: float = nan
    extrapolated: bool = False
    why: str = ""


@dataclass(frozen=True)
class LimitRow(ObservedLimit):
    """One quantity with one thing held: its ``values`` in ``counts`` modes, SI units, and their limit.

    ``frequency`` (Hz) of the exact motion or ``speed`` (m/s) of the collision that it is of, NaN where of neither.
    ``enough``: least of the counts from which every value is within 1 % of the limit, 0 without. ``by_contact_time``:
    number of modes with less than one period in the contact time.
    """

    held: str
    quantity: str
    unit: str
    counts: tuple[int, ...]
    values: tuple[float, ...]
    frequency: float = nan
    speed: float = nan
    enough: int = 0
    by_contact_time: int = 0

    def observed(self) -> LimitRow:
        """The row with its limit, unless ``why`` says beforehand that there is none."""
        missing = [str(n) for n, value in zip(self.counts, self.values, strict=True) if not isfinite(value)]
        lost = NO_MOTION.format(", ".join(missing)) if missing else ""
        if self.why:
            return replace(self, why="; ".join(filter(None, [self.why, lost])))
        seen = observed_limit(self.counts, self.values)
        found: LimitRow = replace(self, **vars(seen))
        return replace(found, enough=found._enough(), why=lost or seen.why)

    def _enough(self) -> int:
        if not isfinite(self.limit) or not self.limit:
            return 0
        off = np.abs(np.asarray(self.values) - self.limit) + self.uncertainty
        far = np.flatnonzero(~(off <= WITHIN * abs(self.limit)))
        first = int(far[-1]) + 1 if len(far) else 0
        return self.counts[first] if first < len(self.counts) else 0


@of_source
def limit(case: Case, /, plan: ModesNeededPlan | None = None, **settings: Any) -> list[LimitRow]:
    """Limits of a case's rig over 1, 2, 4 … modes, with R and with R₁ held, or with its stop that yields.

    ``settings``: of the ``plan``, ``modes`` at most, ``frequency`` of the exact motions, ``speed`` of collisions, in SI
    or with units. ValueError for a case without modes to add, or a drive that no closed form takes.

    >>> import vibeam
    >>> rows = vibeam.limit("cases/dtu_neutral.toml", modes=8)
    >>> rows[0].quantity, rows[0].counts, round(rows[0].values[0], 2)  # one mode sees what the contact has
    ('R₁ of mode 1', (1, 2, 4, 8), 0.72)
    """
    asked, scene = plan_asked(case, plan, settings), case.scene
    if scene.given_mode is not None or not isinstance(scene, RigScene):
        raise ValueError("a single degree of freedom given directly has no more modes")
    most = asked.modes if isinstance(scene, Scene) else min(asked.modes, structure_of(scene).size)
    counts = tuple(2**k for k in range(most.bit_length()))
    if scene.stop.law is not None:
        return _of_law(scene, counts, asked.speed)
    at = float(np.median(case.sweep.frequency)) if asked.frequency is None else asked.frequency
    return list(_of_coefficient(case, scene, counts, at))


def _of_coefficient(case: Case, scene: RigScene, counts: tuple[int, ...], at: float) -> Iterator[LimitRow]:
    """Rows with R and with R₁ held."""
    omega = 2 * np.pi * at
    if why := without_closed_forms(scene, np.array([omega])):
        raise ValueError(why)
    base = float(np.ravel(case.amplitude_of(next(iter(case.fidelities)), np.array([omega])))[0])
    for held in PLACES:
        text = Held(held, scene.stop.usual_restitution).label
        try:
            found = models(holding(scene, held), counts)
        except ValueError as refusal:
            yield LimitRow(text, "all", "1", counts, (nan,) * len(counts), why=str(refusal))
            continue
        if why := next(filter(None, map(unsuited, found)), ""):
            raise ValueError(why)
        mobility = [each.mobility for each in found]
        bare = "" if mobility[-1] * LEAST_SHARE < mobility[len(mobility) // 2] else BARE
        there = [exact_motion(each, omega, base, case.sweep.output) for each in found]
        for quantity, unit, values in (
            _other_coefficient(found, held),
            ("amplitude", "m", _of(there, lambda each: each.amplitude)),
            ("impact velocity", "m/s", _of(there, lambda each: each.impact_velocity)),
        ):
            frequency = nan if unit == "1" else at
            yield LimitRow(text, quantity, unit, counts, values, frequency, why=bare).observed()


def _other_coefficient(found: Sequence[ImpactSystem], held: str) -> tuple[str, str, tuple[float, ...]]:
    if held == "contact":
        return "R₁ of mode 1", "1", tuple(map(first_mode_restitution, found))
    return "R of the contact", "1", tuple(each.restitution for each in found)


def models(scene: RigScene, counts: Sequence[int]) -> list[ImpactSystem]:
    """Systems of ``scene`` in so many modes, on elements that resolve them; ValueError where one cannot be built."""
    return [
        system(
            resolving(scene, count) if isinstance(scene, Scene) else scene, Fidelity(f"{count} modes", "modal", count)
        )
        for count in counts
    ]


def _of(there: Sequence[Motions | None], read: Callable[[Motions], Array]) -> tuple[float, ...]:
    return tuple(nan if each is None else float(read(each)[0]) for each in there)


def exact_motion(model: ImpactSystem, omega: float, base: float, output: str) -> Motions | None:
    """Stable exact motion with one impact a drive period, clear of the stop in between; None where there is none."""
    drive, amplitude = np.array([omega]), np.array([base])
    there = (closed_motions(model, drive, amplitude, output, kind) for kind in (HARDER, SOFTER))
    return next((each for each in there if each.stable[0]), None)


def _of_law(scene: RigScene, counts: tuple[int, ...], speed: float) -> list[LimitRow]:
    """Rows of one collision with a stop that yields: what mode 1 keeps of its velocity, and how long it lasts."""
    text = f'law "{scene.stop.law.name}"' if scene.stop.law is not None else ""
    found = models(scene, counts)
    try:
        seen = [struck(each, speed) for each in found]
    except ValueError as refusal:
        return [LimitRow(text, "all", "1", counts, (nan,) * len(counts), speed=speed, why=str(refusal))]
    why, lasted = moving_law(found), seen[-1].duration
    frequencies = np.sort(found[-1].omega) / (2 * np.pi)
    excited = int(np.count_nonzero(frequencies * lasted < 1)) if lasted > 0 else 0
    return [
        LimitRow(text, name, unit, counts, values, speed=speed, by_contact_time=excited, why=why).observed()
        for name, unit, values in (
            ("R₁ of mode 1", "1", tuple(each.mode_restitution for each in seen)),
            ("R of the contact", "1", tuple(each.restitution for each in seen)),
            ("contact time", "s", tuple(each.duration for each in seen)),
        )
    ]


def moving_law(found: Sequence[ImpactSystem]) -> str:
    """Reason why a stop is another one in each model; empty where it is the same."""
    if all(each.law == found[0].law for each in found):
        return ""
    share = found[len(found) // 2].mobility / found[-1].mobility
    return "" if share > LEAST_SHARE else MOVING_LAW


LEAST = 4  # values from which a rate is observed
SLOWEST = 0.4  # rate below which differences are not taken to sum up
STEADY = 0.25  # largest difference of two successive rates of a sequence that is extrapolated
ROUND_OFF = 1e-7  # relative difference at which a sequence has arrived
TOO_FEW = "too few numbers of modes to observe a rate"
DIVERGES = "no limit in sight: from N = {0} to {1} it still changes by {2:.2g} %, no less than before"


def observed_limit(counts: Sequence[int], values: Sequence[float]) -> ObservedLimit:
    """Limit of ``values`` at numbers of modes ``counts``, each twice the one before."""
    x = np.asarray(values, dtype=float)
    if len(x) < LEAST or not np.isfinite(x).all():
        return ObservedLimit(why=TOO_FEW)
    steps = np.diff(x)
    scale = max(abs(float(x[-1])), 1e-300)
    if np.all(np.abs(steps[-2:]) <= ROUND_OFF * scale):
        return ObservedLimit(limit=float(x[-1]), uncertainty=ROUND_OFF * scale)
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
    unsure = max(abs(here - there), abs(here - previous))
    return ObservedLimit(limit=here, uncertainty=unsure, rate=rate, extrapolated=True)


def _bounded(counts: Sequence[int], x: Array, steps: Array) -> ObservedLimit:
    """Last value, with the geometric bound on the rest by the decay of the largest later difference."""
    later = np.maximum.accumulate(np.abs(steps)[::-1])[::-1]
    rate = float(-np.polyfit(np.arange(len(later)), np.log2(np.maximum(later, 1e-300)), 1)[0])
    recent = float(np.log2(later[-3] / later[-1]) / 2) if len(later) > 2 else rate
    if min(rate, recent) <= SLOWEST:
        change = 100 * abs(float(steps[-1])) / max(abs(float(x[-1])), 1e-300)
        return ObservedLimit(rate=rate, why=DIVERGES.format(counts[-2], counts[-1], change))
    left = float(later[-1] / (2 ** min(rate, recent) - 1))
    return ObservedLimit(limit=float(x[-1]), uncertainty=left, rate=rate)
