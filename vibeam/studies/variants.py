"""Ensembles of motions under a record: numbers of a case and of its variants, their changes on the same realisations.

A variant is a case and one of its fidelities. All of its motions are flown: every value of the factor that the case
varies, every seed. Variants of one case share the seeds, so that their differences are paired: what the realisations
scatter in all of them alike falls out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from time import thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.case.fineness import finest, plain
from vibeam.case.transient_quantities import QUANTITIES
from vibeam.exchange.faults import suggest
from vibeam.runs.transient.motions import MotionMaker, Realisation, motions_of
from vibeam.runs.transient.statistics import SampleMean, mean_of, paired
from vibeam.runs.transient.transient import assembled
from vibeam.solvers import SOLVERS
from vibeam.store.blocks import Values
from vibeam.store.shares import are_shared, evaluate_each
from vibeam.studies.record.readings import AskedNumber, few_numbers, suits
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case

Told = Callable[[int, int], None]
PEAK = "peak"  # quantity by which a model is judged: the others hang on each single impact
OF_IMPACTS = ("impacts", "hardest_impact", "lost_at_impacts")
KNOWN = tuple(name for name, each in QUANTITIES.items() if each.of != "pair")


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble(ValueRecord):
    """Motions of one variant over v values of the factor and s seeds; ``of`` a number (v, s), SI.

    NaN where a motion did not run to the record's end, or has no such number. ``seconds`` (v, s): CPU time of the
    motion and of what is read off it.
    """

    fidelity: str
    modes: int
    numbers: Mapping[AskedNumber, Array]
    seconds: Array

    def of(self, number: AskedNumber) -> Array:
        """Values (v, s) of a number."""
        return self.numbers[number]

    def mean(self, number: AskedNumber) -> SampleMean:
        """Mean over all motions."""
        return mean_of(self.of(number))


@dataclass(frozen=True)
class NumberChange:
    """Change of a number in another model, as a share of the reference's ``mean``: the worst value of the factor.

    ``error``: standard error of the paired ``change``, NaN of one realisation; NaN throughout where either has none.
    """

    number: AskedNumber
    mean: float
    change: float
    error: float

    @property
    def size(self) -> float:
        """Size of the change, its error counted twice; NaN where it is not known."""
        return abs(self.change) + (2 * self.error if isfinite(self.error) else 0.0)


def usual_numbers(case: Case) -> tuple[AskedNumber, ...]:
    """Peak of every output that is kept, number of impacts, the hardest, energy lost at them."""
    outputs = plan_of_record(case).outputs
    return (*(AskedNumber(PEAK, name) for name in outputs), *map(AskedNumber, OF_IMPACTS))


def asked_number(case: Case, text: str) -> AskedNumber:
    """Number of a quantity by its name, of the first output; ``"peak of tip_acceleration"`` names the signal.

    ValueError names the quantities that there are.
    """
    quantity, _, signal = (part.strip() for part in text.partition(" of "))
    quantity = quantity.replace(" ", "_")
    if quantity not in KNOWN:
        raise ValueError(f"--quantity: no quantity {quantity!r} of a record; {suggest(quantity, KNOWN)}")
    if QUANTITIES[quantity].of != "signal":
        return AskedNumber(quantity)
    return AskedNumber(quantity, signal or plan_of_record(case).outputs[0])


def ensembles(
    variants: Sequence[tuple[Case, str]], asked: Sequence[AskedNumber], told: Told | None = None
) -> list[Ensemble]:
    """Ensemble of every variant, several motions at once; ``told`` the motions done and their total, from any thread.

    CaseError for a variant that cannot be built, ValueError for a signal that there is not.
    """
    makers = [MotionMaker(case, name) for case, name in variants]
    jobs = [(at, each) for at, (case, name) in enumerate(variants) for each in motions_of(case, name)]
    for maker in {each.name: each for each in makers}.values():
        _require_signals(maker, asked)
    for maker in [] if are_shared() else makers:  # a part makes those of its own motions
        for value in range(len(plan_of_record(maker.case).values)):
            maker.system(value)
    shapes = [(len(plan.values), max(len(plan.seeds), 1)) for plan in (plan_of_record(case) for case, _ in variants)]
    rows = [np.full((len(asked) + 2, *shape), np.nan) for shape in shapes]

    def fly(job: tuple[int, Realisation]) -> Values:
        at, motion = job
        return {"numbers": np.array(_numbers(makers[at], motion, asked))}

    def keep(job: tuple[int, Realisation], found: Values) -> None:
        at, motion = job
        rows[at][:, motion.value, motion.seed] = found["numbers"]

    of = repr((asked, [(at, motion.key) for at, motion in jobs]))
    evaluate_each("motions", of, jobs, fly, keep, told)
    return [
        Ensemble(name, int(row[-1].flat[0]), dict(zip(asked, row[:-2], strict=True)), row[-2])
        for (_, name), row in zip(variants, rows, strict=True)
    ]


def _require_signals(maker: MotionMaker, asked: Sequence[AskedNumber]) -> None:
    known = [each.name for each in maker.signals]
    for each in asked:
        if each.signal and each.signal not in known:
            said = f"--quantity: fidelity {maker.name} has no signal {each.signal!r}"
            raise ValueError(f"{said}; {suggest(each.signal, known)}")


def _numbers(maker: MotionMaker, motion: Realisation, asked: Sequence[AskedNumber]) -> list[float]:
    """Numbers of one motion, behind them its CPU time and the number of its modes."""
    duration, system = float(plan_of_record(maker.case).duration), maker.system(motion.value)[0]
    if SOLVERS[maker.case.fidelities[maker.name].solver].motion == "exact" and suits(asked):
        begun, record = thread_time(), maker.load(motion.value, motion.seed)
        path, _ = maker.path(motion.value, record)
        return [*few_numbers(path, record, asked, duration), thread_time() - begun, system.size]
    reading = maker.made(replace(motion, shown=False))
    one = assembled(maker.name, duration, maker.system(motion.value)[1], [[reading]])
    found = [float(one.of(each.quantity, each.signal or None)[0, 0]) for each in asked]
    return [*found, float(one.cpu_seconds[0, 0] + one.reading_seconds[0, 0]), system.size]


def changes(reference: Ensemble, other: Ensemble) -> tuple[NumberChange, ...]:
    """Changes of all numbers, each at the value of the factor at which it is largest."""
    return tuple(_largest(number, reference, other) for number in reference.numbers)


def _largest(number: AskedNumber, reference: Ensemble, other: Ensemble) -> NumberChange:
    rows = zip(reference.of(number), other.of(number), strict=True)
    found = [change_of(number, theirs, ours) for theirs, ours in rows]
    return max(found, key=lambda each: each.size if each.size == each.size else -1.0)


def change_of(number: AskedNumber, theirs: Array, ours: Array) -> NumberChange:
    """Change of a number from ``theirs`` to ``ours``, (s,) each, on the same realisations; ∞ of one that was 0."""
    known = np.isfinite(theirs) & np.isfinite(ours)
    mean = float(np.mean(theirs[known])) if known.any() else float("nan")
    if mean == 0:
        return NumberChange(number, mean, float("inf") if np.any(ours[known]) else 0.0, float("nan"))
    found = paired(ours, theirs)
    return NumberChange(number, mean, found.mean, found.error)


def worst(found: Sequence[NumberChange], quantity: str = PEAK) -> float:
    """Largest size of the changes of a quantity that are known; NaN without any."""
    sizes = [each.size for each in found if each.number.quantity == quantity]
    return max((each for each in sizes if each == each), default=float("nan"))


def within(case: Case, fidelity: str, budget: float, weight: float) -> Case:
    """The case with as many of its realisations, one at least, as take ``budget`` CPU seconds.

    ``weight``: models that fly each of its values, in units of this one, whose first motion is timed.
    """
    plan = plan_of_record(case)
    if len(plan.seeds) < 2 or not isfinite(budget):
        return case
    one = case.with_keys({"record.over": plan.over, "record.values": [plan.values[-1]], "record.realisations": 1})
    [timed] = ensembles([(one, fidelity)], usual_numbers(one))
    count = int(budget / (float(timed.seconds.sum()) * len(plan.values) * weight))
    return case if count >= len(plan.seeds) else case.with_keys({"record.realisations": max(count, 1)})


def require_usual(table: str, plan: Any, *names: str) -> None:
    """ValueError where a plan says keys that are of a sweep: they would not count."""
    usual = type(plan)()
    if said := [name for name in names if getattr(plan, name) != getattr(usual, name)]:
        raise ValueError(f"{', '.join(f'{table}.{name}' for name in said)}: of a [sweep]: take it away beside [record]")


def plain_finest(case: Case, named: str | None = None) -> str:
    """Finest fidelity, the first of several, of those of the case's own rig, or the one that is ``named``.

    ValueError where that changes the rig.
    """
    names = plain(case)
    if named is not None and named not in names:
        raise ValueError(f"fidelity {named!r} changes the rig: name one of the rig itself")
    return named or finest(case, {name: case.system(name).size for name in names or case.fidelities})
