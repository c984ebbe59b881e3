"""A rig in growing numbers of modes, for each thing that can be held: what each model gives, and the limit N → ∞.

With a coefficient of restitution, R of the contact or R₁ of mode 1: the other one, and an exact periodic motion at one
drive. With a stop that yields: one collision of mode 1 with it, and the exact motion. In closed form that is the one
with one impact a drive period; where there is none, the one that eight modes settle on, found in the other models from
its contact forces (``by_orbits``). Elements grow with the modes, three for each.

With x_N = x + a N⁻ᵖ + …, the differences d_k = x_{2N} − x_N fall by 2⁻ᵖ at each doubling, and

    p = log₂ |d_{k−1}/d_k|,        x = x_K + d_K/(2ᵖ − 1)        (Richardson, Aitken's Δ² with q = 2⁻ᵖ)

The rate of the last three differences must agree for that. Where it does not, as where single modes count more than
others, the remainder is bounded by the decay of the largest later difference; where that does not decay there is no
limit in sight.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import isfinite, nan
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity, gap_drift, system
from vibeam.case.held import PLACES, Held, holding
from vibeam.case.source import of_source
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.observe.restitution import first_mode_restitution
from vibeam.periodic.motions import HARDER, SOFTER, Motions, closed_motions, unsuited
from vibeam.periodic.orbit import Orbit
from vibeam.runs.comparison.limit import LEAST_SHARE, resolving
from vibeam.runs.estimate.by_orbits import ReadyModel
from vibeam.runs.estimate.of_case import without_orbits
from vibeam.solvers.collision import struck
from vibeam.studies.modes_needed.reduction import plan_asked
from vibeam.system.impact_system import Drive, ImpactSystem
from vibeam.system.response import FrequencyResponse
from vibeam_models.arrays import Array
from vibeam_models.beam import structure_of
from vibeam_models.scene import AnyScene, RigScene, line_of

WITHIN = 0.01  # share of the limit at which there are modes enough
BEGUN = 3  # place of the model, of eight modes, whose settled motion is looked for in the others

BARE = (
    "the contact has little or no mass of its own: its mobility grows with each mode more, mode 1 gets less of the "
    "impulse and in the end none"
)

MOVING_LAW = (
    "the stop's damping is the one that gives a free mass 1/S its restitution, S the mobility of the modes kept, which "
    "grows with each mode more: it is another stop each time. Give the damping itself"
)

NO_MOTION = "no stable motion of this kind in {0} modes at modes_needed.frequency: write another"


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
        missing = [k for k, value in enumerate(self.values) if not isfinite(value)]
        lost = NO_MOTION.format(", ".join(str(self.counts[k]) for k in missing)) if missing else ""
        if self.why:
            return replace(self, why="; ".join(filter(None, [self.why, lost])))
        known = slice(missing[-1] + 1 if missing else 0, None)  # a few modes may make another motion
        seen = observed_limit(self.counts[known], self.values[known])
        found: LimitRow = replace(self, **vars(seen))
        return replace(found, enough=found._enough(), why=(lost or seen.why) if seen.why else "")

    def _enough(self) -> int:
        if not isfinite(self.limit) or not self.limit:
            return 0
        off = np.abs(np.asarray(self.values) - self.limit) + self.uncertainty
        far = np.flatnonzero(~(off <= WITHIN * abs(self.limit)))
        first = int(far[-1]) + 1 if len(far) else 0
        return self.counts[first] if first < len(self.counts) else 0


@of_source
def limit(case: Case, /, plan: ModesNeededPlan | None = None, **settings: Any) -> Any:
    """Limits of a case's rig over 1, 2, 4 … modes, with R and with R₁ held, or with its stop that yields: a list of
    ``LimitRow``; of a case under a record ``RecordModes``, the numbers of its motions over the modes.

    ``settings``: of the ``plan``, ``modes`` at most, ``frequency`` of the exact motions, ``speed`` of collisions, in SI
    or with units. ValueError for a case without modes to add, or a drive that no closed form takes.

    >>> import vibeam
    >>> rows = vibeam.limit("cases/dtu_neutral.toml", modes=8)
    >>> rows[0].quantity, rows[0].counts, round(rows[0].values[0], 2)  # one mode sees what the contact has
    ('R₁ of mode 1', (1, 2, 4, 8), 0.72)
    """
    asked, scene = plan_asked(case, plan, settings), case.scene
    if case.record is not None:
        from vibeam.studies.record.ensembles import require_usual
        from vibeam.studies.record.modes import record_modes

        of_sweeps = ("bases", "most", "band", "contact_time", "modes", "frequency", "speed")
        require_usual("modes_needed", asked, *of_sweeps)
        return record_modes(case, asked.accuracy)
    if scene.given_mode is not None or not isinstance(scene, RigScene):
        raise ValueError("a single degree of freedom given directly has no more modes")
    most = asked.modes if line_of(scene) else min(asked.modes, structure_of(scene).size)
    counts = tuple(2**k for k in range(most.bit_length()))
    at = float(np.median(case.sweep.frequency)) if asked.frequency is None else asked.frequency
    if scene.stop.law is not None:
        return _of_law(case, scene, counts, asked.speed, at)
    return list(_of_coefficient(case, scene, counts, at))


def _of_coefficient(case: Case, scene: RigScene, counts: tuple[int, ...], at: float) -> Iterator[LimitRow]:
    """Rows with R and with R₁ held."""
    if why := without_orbits(scene):
        raise ValueError(why)
    for held in PLACES:
        text = Held(held, scene.stop.usual_restitution).label
        try:
            found = models(holding(scene, held), counts)
        except ValueError as refusal:
            yield LimitRow(text, "all", "1", counts, (nan,) * len(counts), why=str(refusal))
            continue
        mobility = [each.mobility for each in found]
        bare = "" if mobility[-1] * LEAST_SHARE < mobility[len(mobility) // 2] else BARE
        for quantity, unit, values in (
            _other_coefficient(found, held),
            *exact_motions(case, scene, found, at),
        ):
            frequency = nan if unit == "1" else at
            yield LimitRow(text, quantity, unit, counts, values, frequency, why=bare).observed()


def _other_coefficient(found: Sequence[ImpactSystem], held: str) -> tuple[str, str, tuple[float, ...]]:
    if held == "contact":
        return "R₁ of mode 1", "1", tuple(map(first_mode_restitution, found))
    return "R of the contact", "1", tuple(each.restitution for each in found)


def models(scene: RigScene, counts: Sequence[int]) -> list[ImpactSystem]:
    """Systems of ``scene`` in so many modes, on elements that resolve them; ValueError where one cannot be built."""
    line = line_of(scene)
    return [
        system(scene if line is None else resolving(line, count), Fidelity(f"{count} modes", "modal", count))
        for count in counts
    ]


Row = tuple[str, str, tuple[float, ...]]  # quantity, unit, its values in each model


def exact_motions(case: Case, scene: AnyScene, found: Sequence[ImpactSystem], at: float) -> list[Row]:
    """Amplitude and impact velocity of one stable exact motion at ``at`` Hz, in each model; NaN where it has none.

    Of plain models with one impact a drive period, in closed form; of any others the one that the model in the middle
    settles on, and from there through the models both ways.
    """
    omega, output = np.array([2 * np.pi * at]), case.sweep.output
    base = np.ravel(np.asarray(case.amplitude_of(next(iter(case.fidelities)), omega), dtype=float))[:1]
    drift = gap_drift(scene, omega)
    moved = found if drift is None else [replace(each, gap=each.gap + float(drift[0])) for each in found]
    there: Sequence[Motions | FrequencyResponse | None]
    if any(map(unsuited, moved)):
        through = _through([ReadyModel(each, omega[0]) for each in moved], Drive(omega[0], base[0]))
        there = [None if each is None else each.watched(output) for each in through]
    else:
        there = [_closed(each, omega, base, output) for each in moved]
    return [
        ("amplitude", "m", tuple(nan if each is None else float(each.amplitude[0]) for each in there)),
        ("impact velocity", "m/s", tuple(nan if each is None else float(each.impact_velocity[0]) for each in there)),
    ]


def _closed(model: ImpactSystem, omega: Array, base: Array, output: str) -> Motions | None:
    there = (closed_motions(model, omega, base, output, kind) for kind in (HARDER, SOFTER))
    return next((each for each in there if each.stable[0]), None)


def _through(found: Sequence[ReadyModel], drive: Drive) -> list[Orbit | None]:
    """The orbit that the model in the middle settles on, and those beside it in the others."""
    middle = min(BEGUN, len(found) - 1)
    through: list[Orbit | None] = [None] * len(found)
    begun = found[middle].settled(drive)
    if begun is None:
        return through
    through[middle] = begun
    for way in (range(middle + 1, len(found)), range(middle - 1, -1, -1)):
        last = begun
        for k in way:
            through[k] = found[k].orbit_from(last)[1]
            last = through[k] or last
    return through


def _of_law(case: Case, scene: RigScene, counts: tuple[int, ...], speed: float, at: float) -> list[LimitRow]:
    """Rows of one collision with a stop that yields, of mode 1, and of an exact motion."""
    text = f'law "{scene.stop.law.name}"' if scene.stop.law is not None else ""
    found = models(scene, counts)
    why, exact = moving_law(found), [] if without_orbits(scene) else exact_motions(case, scene, found, at)
    try:
        collisions = _collisions(found, speed)
    except ValueError as refusal:
        once = [LimitRow(text, "collision", "1", counts, (nan,) * len(counts), speed=speed, why=str(refusal))]
    else:
        lasted = collisions[-1][2][-1]
        excited = int(np.count_nonzero(found[-1].omega * lasted < 2 * np.pi)) if lasted > 0 else 0
        once = [
            LimitRow(text, *row[:2], counts, row[2], speed=speed, by_contact_time=excited, why=why).observed()
            for row in collisions
        ]
    return once + [LimitRow(text, *row[:2], counts, row[2], at, why=why).observed() for row in exact]


def _collisions(found: Sequence[ImpactSystem], speed: float) -> tuple[Row, ...]:
    seen = [struck(each, speed) for each in found]
    return (
        ("R₁ of mode 1", "1", tuple(each.mode_restitution for each in seen)),
        ("R of the contact", "1", tuple(each.restitution for each in seen)),
        ("contact time", "s", tuple(each.duration for each in seen)),
    )


def moving_law(found: Sequence[ImpactSystem]) -> str:
    """Reason why a stop is another one in each model; empty where it is the same."""
    if all(each.law == found[0].law for each in found):
        return ""
    share = found[len(found) // 2].mobility / found[-1].mobility
    return "" if share > LEAST_SHARE else MOVING_LAW


LEAST = 4  # values from which a rate is observed
SLOWEST = 0.4  # rate below which differences are not taken to sum up
STEADY = 0.25  # largest difference of two successive rates of a sequence that is extrapolated
LEAST_STEP = 1e-300  # for logarithms
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
    rates = -np.diff(np.log2(np.maximum(np.abs(steps), LEAST_STEP)))
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
    later = np.maximum(np.maximum.accumulate(np.abs(steps)[::-1])[::-1], LEAST_STEP)
    rate = float(-np.polyfit(np.arange(len(later)), np.log2(later), 1)[0])
    recent = float(np.log2(later[-3] / later[-1]) / 2) if len(later) > 2 else rate
    if min(rate, recent) <= SLOWEST:
        change = 100 * abs(float(steps[-1])) / max(abs(float(x[-1])), 1e-300)
        return ObservedLimit(rate=rate, why=DIVERGES.format(counts[-2], counts[-1], change))
    left = float(later[-1] / (2 ** min(rate, recent) - 1))
    return ObservedLimit(limit=float(x[-1]), uncertainty=left, rate=rate)
