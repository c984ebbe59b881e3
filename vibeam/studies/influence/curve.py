"""Quantities of interest, and the sweep that they are read from: its peaks and range ends are refined by flight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite
from typing import Literal

import numpy as np

from vibeam.case.case import Case
from vibeam.case.fidelity import gap_drift
from vibeam.case.study_plans import InfluencePlan
from vibeam.runs.sweep import march
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import Branches, FrequencyResponse, join, periodic
from vibeam.system.state import State
from vibeam_models.arrays import Array

NAN = float("nan")
How = Literal["relative", "absolute"]


@dataclass(frozen=True)
class Interest:
    """Quantity: ``label`` in words; ``unit`` in SI; ``how`` its change is computed; ``tolerance`` of the change."""

    name: str
    label: str
    unit: str
    how: How
    tolerance: float


@dataclass(frozen=True)
class ValueRead:
    """Value of a quantity in one model; NaN with the reason ``why``, or a number with a remark."""

    number: float
    why: str = ""


@dataclass(frozen=True)
class Change:
    """Change from the complete model: ``value``, ``amount`` as the quantity defines it, ``share``: of the
    tolerance, in absolute value; ∞ where only one of the two models has the quantity. ``why``: the remarks.
    """

    quantity: str
    value: float
    amount: float
    share: float
    why: str = ""


def quantities(plan: InfluencePlan) -> tuple[Interest, ...]:
    """Quantities that the case asks for, with its tolerances."""
    ratio = plan.tolerance
    shift = ratio / 5 if plan.frequency_accuracy is None else plan.frequency_accuracy
    known = (
        Interest("peak", "the peak", "m", "relative", ratio),
        Interest("peak_frequency", "its frequency", "Hz", "relative", shift),
        Interest("period_one_from", "the lower end of period 1", "Hz", "relative", shift),
        Interest("period_one_to", "the upper end of period 1", "Hz", "relative", shift),
        Interest("ringing", "the ringing", "m/s", "relative", ratio),
        Interest("ringing_frequency", "its frequency", "Hz", "relative", ratio),
        Interest("apparent_restitution", "the apparent R", "1", "absolute", plan.restitution_tolerance),
    )
    return tuple(each for each in known if each.name in plan.quantities)


def change(quantity: Interest, ours: ValueRead, whole: ValueRead) -> Change:
    """Change from the complete model's value to another one's; none where neither has one."""
    reasons = "; ".join(dict.fromkeys(filter(None, (ours.why, f"all effects: {whole.why}" if whole.why else ""))))
    present = isfinite(ours.number), isfinite(whole.number)
    if present == (False, False):
        return Change(quantity.name, ours.number, NAN, 0.0, reasons)
    if not all(present):
        return Change(quantity.name, ours.number, NAN, inf, reasons)
    amount = ours.number - whole.number
    if quantity.how == "relative":
        if not whole.number:
            return Change(quantity.name, ours.number, NAN, inf if amount else 0.0, reasons)
        amount /= abs(whole.number)
    return Change(quantity.name, ours.number, amount, abs(amount) / quantity.tolerance, reasons)


FINER, ROUNDS, HALVINGS = 8, 2, 8
SMOOTH = 0.05  # tolerance, as a share of the parabola's height, between the motion at its top and that height
EDGE = "at the end of the sweep: it may lie beyond"


@dataclass(frozen=True)
class Step:
    """One point (a response of length 1) and the state after it."""

    response: FrequencyResponse
    state: State

    @property
    def frequency(self) -> float:
        """Frequency, Hz."""
        return float(self.response.frequency[0])

    @property
    def amplitude(self) -> float:
        """Amplitude, m; −∞ for an aperiodic or failed point, between which nothing is refined."""
        return float(self.response.amplitude[0]) if periodic(self.response)[0] else -np.inf

    @property
    def is_period_one(self) -> bool:
        """True for a motion of period 1 with impacts."""
        return self.response.period_one is not None


@dataclass(frozen=True)
class Curve:
    """Branches of one model in the order swept; ``cpu``: seconds of these points alone."""

    case: Case
    fidelity: str
    system: ImpactSystem
    branches: dict[str, list[Step]]

    @property
    def swept(self) -> Branches:
        """Responses of the points as swept."""
        ways = {way: join([step.response for step in steps]) for way, steps in self.branches.items()}
        return Branches(ways.get("up"), ways.get("down"))

    @property
    def cpu(self) -> float:
        """CPU seconds of the sweep, without the refinement of peaks and ends."""
        return float(sum(step.response.cpu_seconds[0] for steps in self.branches.values() for step in steps))

    def on(self, frequencies: Array, state: State | None) -> list[Step]:
        """Compute further points (Hz) from a state."""
        omega = 2 * np.pi * frequencies
        plan, own = self.case.sweep, self.case.fidelities[self.fidelity]
        points = march(
            self.system, omega, self.case.amplitude_of(self.fidelity, omega), settle=plan.settle, hold=plan.hold,
            solver=own.solver, options=own.options, output=plan.output, state=state,
            slowest=2 * np.pi * float(plan.frequency.min()), drift=gap_drift(self.case.scene, omega),
            harmonics=self.case.scene_of(self.fidelity).harmonics,
        )  # fmt: skip
        return [Step(response, after) for response, after in points]


def swept(case: Case, fidelity: str, system: ImpactSystem) -> Curve:
    """Branches of the fidelity, to the bit those of an ordinary run."""
    curve = Curve(case, fidelity, system, {})
    up, state = np.sort(case.sweep.frequency), None
    for direction in ("up", "down") if case.sweep.direction == "both" else (case.sweep.direction,):
        curve.branches[direction] = curve.on(up if direction == "up" else up[::-1].copy(), state)
        state = curve.branches[direction][-1].state
    return curve


@dataclass(frozen=True)
class RefinedPeak:
    """Peak of a sweep, refined between its points; a point near it to start from."""

    amplitude: ValueRead
    frequency: ValueRead
    near: Step | None


def refined_peak(curve: Curve) -> RefinedPeak:
    """Peak of the sweep (``Branches.peak``), refined where its motion repeats and the sweep goes on beyond it.

    By successive refinement between its neighbours and a parabola through the last three; else it is the sweep's own.
    """
    top = curve.swept.peak
    if top.point < 0:
        none = ValueRead(NAN, "no complete point")
        return RefinedPeak(none, none, None)
    steps = curve.branches[top.direction]
    edge = not 0 < top.point < len(steps) - 1
    if edge or not top.repeats:
        why = EDGE if top.repeats else "the motion at the peak does not repeat"
        return RefinedPeak(ValueRead(top.amplitude, why), ValueRead(top.frequency, why), steps[top.point])
    found = _top(curve, _narrowed(curve, steps[top.point - 1 : top.point + 2]))
    return RefinedPeak(ValueRead(found.amplitude), ValueRead(found.frequency), found)


def _narrowed(curve: Curve, three: list[Step]) -> list[Step]:
    """Refine three neighbours around the top; each finer point starts from the one before it, as in the sweep."""
    for _ in range(ROUNDS):
        grid = np.linspace(three[0].frequency, three[2].frequency, FINER + 1)[1:-1]
        steps = [three[0], *curve.on(grid, three[0].state), three[2]]
        top = max(range(1, len(steps) - 1), key=lambda i: steps[i].amplitude)
        three = steps[top - 1 : top + 2]
    return three


def _top(curve: Curve, three: list[Step]) -> Step:
    """Point at the top of the parabola through three; the middle one where they are not on one smooth curve.

    At a jump a parabola has a top as well, but the motion there differs from it.
    """
    y = np.array([step.amplitude for step in three])
    if not np.all(np.isfinite(y)):
        return three[1]
    bend = y[0] - 2 * y[1] + y[2]
    if not bend < 0:
        return three[1]
    aside = (y[0] - y[2]) / (2 * bend)
    frequency = three[1].frequency + aside * (three[2].frequency - three[0].frequency) / 2
    found = curve.on(np.array([frequency]), three[0].state)[0]
    height = y[1] - (y[0] - y[2]) * aside / 4
    return found if abs(found.amplitude - height) <= SMOOTH * (height - y.min()) else three[1]


def ends(curve: Curve) -> tuple[ValueRead, ValueRead]:
    """Lower and upper end (Hz) of the period-1 range around its largest amplitude.

    Each end is taken where the sweep reaches it: the lower one on the way down, if swept, the upper one on the way up.
    """
    down = curve.branches.get("down", curve.branches.get("up", []))
    up = curve.branches.get("up", down)
    return _end(curve, down, min), _end(curve, up, max)


def _end(curve: Curve, steps: list[Step], pick: Callable[..., Step]) -> ValueRead:
    found = join([step.response for step in steps]).period_one_points
    if found is None:
        return ValueRead(NAN, "no motion of period 1 with impacts")
    first, last = found
    outer = pick((steps[first], steps[last]), key=lambda step: step.frequency)
    at_last = outer is steps[last]
    beyond = last + 1 if at_last else first - 1
    if not 0 <= beyond < len(steps):
        return ValueRead(outer.frequency, "still period 1 at the end of the sweep")
    bracket = (outer, steps[beyond]) if at_last else (steps[beyond], outer)
    return ValueRead(_crossing(curve, *bracket))


def _crossing(curve: Curve, before: Step, after: Step) -> float:
    """Boundary (Hz) between a point of period 1 and its neighbour, by bisection from the first."""
    for _ in range(HALVINGS):
        middle = curve.on(np.array([(before.frequency + after.frequency) / 2]), before.state)[0]
        before, after = (middle, after) if middle.is_period_one == before.is_period_one else (before, middle)
    return (before.frequency + after.frequency) / 2


def nearest(curve: Curve, frequency: float) -> Step:
    """Point of the first branch nearest to a frequency in Hz."""
    return min(next(iter(curve.branches.values())), key=lambda step: abs(step.frequency - frequency))
