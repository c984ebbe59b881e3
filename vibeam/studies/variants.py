"""Variants of one case with something changed, and their numbers: of sweeps, and of motions under a record.

A variant is a case and one of its fidelities. Under a record all of its motions are computed: every value of the factor
that the case varies, every seed. Variants of one case share the seeds, so that their differences are paired: what the
realisations scatter in all of them alike falls out. A sweep is an ensemble of one, with its response.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import plan_of_record
from vibeam.case.fidelity import gap_wear
from vibeam.case.fineness import finest, plain
from vibeam.case.transient_quantities import QUANTITIES
from vibeam.exchange.faults import suggest
from vibeam.runs.comparison.beyond import response_of
from vibeam.runs.comparison.responses import Response
from vibeam.runs.comparison.work import Work
from vibeam.runs.run import run
from vibeam.runs.transient.motions import MotionMaker, Realisation, motions_of
from vibeam.runs.transient.statistics import SampleMean, mean_of
from vibeam.runs.transient.transient import assembled
from vibeam.solvers import SOLVERS
from vibeam.solvers.steady import warm_up_once
from vibeam.store.blocks import Values
from vibeam.store.shares import are_shared, evaluate_each
from vibeam.studies.recorded_numbers import AskedNumber, few_numbers, suits
from vibeam.studies.swept_numbers import numbers_of
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array, ValueRecord

if TYPE_CHECKING:
    from vibeam.case.case import Case

Told = Callable[[int, int], None]
PEAK = "peak"  # quantity by which a model is judged: the others hang on each single impact
OF_IMPACTS = ("impacts", "hardest_impact", "lost_at_impacts")
SHARE = 1.0
KNOWN = tuple(name for name, each in QUANTITIES.items() if each.of != "pair")


class DearSweep(ValueError):
    """Sweep that takes longer than it may."""


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble(ValueRecord):
    """Motions of one variant over v values of the factor and s seeds; ``of`` a number (v, s), SI.

    NaN where a motion did not run to the record's end, or has no such number, for the reasons in ``why``. ``seconds``
    (v, s): CPU time of the motion and of what is read off it. A sweep is one motion, with its ``response`` and
    its ``work``, s, counted.
    """

    fidelity: str
    modes: int
    numbers: Mapping[AskedNumber, Array]
    seconds: Array
    work: float = 0.0
    response: Response | None = field(default=None, compare=False)
    why: Mapping[AskedNumber, str] = field(default_factory=dict)

    def of(self, number: AskedNumber) -> Array:
        """Values (v, s) of a number."""
        return self.numbers[number]

    def mean(self, number: AskedNumber) -> SampleMean:
        """Mean over all motions."""
        return mean_of(self.of(number))


def usual_numbers(case: Case) -> tuple[AskedNumber, ...]:
    """Peaks of all outputs kept, number of impacts, the hardest, energy lost at them; of a sweep its peak and where."""
    if case.record is None:
        return AskedNumber(PEAK), AskedNumber("peak_frequency")
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
    variants: Sequence[tuple[Case, str]], asked: Sequence[AskedNumber], told: Told | None = None, limit: float = inf
) -> list[Ensemble]:
    """Ensemble of every variant, several motions at once; ``told`` the motions done and their total, from any thread.

    CaseError for a variant that cannot be built, ValueError for a signal that there is not, DearSweep for a sweep
    that takes longer than ``limit`` seconds of work, counted.
    """
    if variants[0][0].record is None:
        return [swept(*each, asked, limit) for each in variants]
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


def swept(
    case: Case, name: str, asked: Sequence[AskedNumber], limit: float = inf, other: ImpactSystem | None = None
) -> Ensemble:  # fmt: skip
    """The sweep of a fidelity, of the ``other`` system in its place, by exact motions as an ensemble of one.

    That of a fidelity whose gap grows by impacts is run; DearSweep where it takes longer than ``limit`` s of work. Ends
    of branches, and means of motions that do not repeat, may take ``SHARE`` of the work of a sweep of another system.
    """
    system = case.system(name) if other is None else other
    omega = 2 * np.pi * case.sweep.frequency[:1]
    warm_up_once("flight", system, float(omega[0]), float(np.ravel(case.amplitude_of(name, omega))[0]), "contact", {})
    begun, work = time.thread_time(), Work(limit)
    if other is None and gap_wear(case.scene_of(name)) is not None:
        worn: Any = run(case, show=False, fidelities=[name])
        response: Response | None = Response.of(worn[name])
    else:
        response = response_of(case, name, system, len(case.sweep.frequency), work)
    if response is None:
        raise DearSweep(f"its sweep takes longer than {limit:.2g} s")
    seconds, spent = np.array([[time.thread_time() - begun]]), work.spent
    read = numbers_of(case, name, system, response, [each.quantity for each in asked], case.influence.frequency)
    values = {each: np.array([[read[each.quantity].number]]) for each in asked}
    why = {each: read[each.quantity].why for each in asked if read[each.quantity].why}
    work.most = limit if other is None else work.spent * (1 + SHARE)
    return Ensemble(name, system.size, values, seconds, spent, response, why)


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
        begun, record = time.thread_time(), maker.load(motion.value, motion.seed)
        path, _ = maker.path(motion.value, record)
        return [*few_numbers(path, record, asked, duration), time.thread_time() - begun, system.size]
    reading = maker.made(replace(motion, shown=False))
    one = assembled(maker.name, duration, maker.system(motion.value)[1], [[reading]])
    found = [float(one.of(each.quantity, each.signal or None)[0, 0]) for each in asked]
    return [*found, float(one.cpu_seconds[0, 0] + one.reading_seconds[0, 0]), system.size]


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


def plain_finest(case: Case) -> str:
    """Finest fidelity, the first of several, of those of the case's own rig."""
    return finest(case, {name: case.system(name).size for name in plain(case) or case.fidelities})
