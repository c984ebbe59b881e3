"""Figure kind ``chirp``: a swept-sine test beside the sweep's settled points.

The drive frequency runs over the sweep's range at a constant rate, from the motion settled at its begin; "both" goes up
and then down from where it came. It is Ω²B sin φ, φ̇ = Ω = Ω₀ + αt, with the Ω²B that settled points have there, as a
record (``Record.chirp``) to 10⁻⁶ of the largest. An amplitude is ½(max − min) over ``periods`` drive periods.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from vibeam.case.case import Case
from vibeam.case.fidelity import gap_drift, gap_wear
from vibeam.case.plans import ShowPlan
from vibeam.figures.panels import across_frequency, is_empty, say, start_upward
from vibeam.figures.response import draw_branch
from vibeam.figures.sheet import Column, Columns, Comparison, Sheet
from vibeam.figures.style import Look, looks_of, name_of
from vibeam.figures.units import DisplayUnits, amplitude_of, units_for
from vibeam.flight.extremes import extremes
from vibeam.flight.trajectory import simulate
from vibeam.solvers import SOLVERS, solver
from vibeam.system.number_text import percent
from vibeam.system.record import Record
from vibeam_models.arrays import Array, Index

SWEPT = {"up": 0.9, "down": 0.5}  # opacity of the line of a chirp
ERROR = 1e-6  # of the largest acceleration, by which cubic pieces may leave a chirp
WHOLE = 1e-9  # share of a period by which the last one may be cut off and still be there
size = (5.8, 4.2)  # inches: one panel


def sheets(case: Case, fidelity: str, plan: ShowPlan) -> list[Sheet]:
    """One sheet a direction; one alone with the reason where there is no such motion."""
    try:
        return [Sheet(fidelity, float("nan"), columns) for columns in _flown(case, fidelity, plan)]
    except ValueError as reason:
        return [Sheet(fidelity, float("nan"), fault=str(reason))]


def _flown(case: Case, name: str, plan: ShowPlan) -> Iterator[Columns]:
    scene, fidelity = case.scene_of(name), case.fidelities[name]
    if gap_drift(scene, [1.0]) is not None or gap_wear(scene) is not None:
        raise ValueError("a gap that drifts or wears is of settled points: a chirp has one gap")
    system, state = case.system(name), None
    if plan.output not in ("contact", *system.outputs, *system.derivatives):
        raise ValueError(f"there is no {plan.output} in this model")
    options: dict[str, Any] = dict(fidelity.options)
    made = solver(fidelity.solver, system, 2 * np.pi * min(plan.frequency), **options)

    def acceleration(frequency: Array) -> Array:
        omega = 2 * np.pi * frequency
        return np.asarray(-(omega**2) * case.amplitude_of(name, omega))

    for leg in _legs(plan):
        if state is None:
            first = leg.omega[:1]
            amplitude = float(np.ravel(case.amplitude_of(name, first))[0])
            _, state = made.steady(first, amplitude, None, max(plan.settle - 1, 0), 1, plan.output)
        low, high = (leg.omega[[0, -1]] / (2 * np.pi)).tolist()
        record = Record.chirp(acceleration, low, high, float(leg.times[-1]), error=ERROR)
        if SOLVERS[fidelity.solver].motion == "exact":
            path: Any = simulate(system, record, record.end, state)
            found = extremes(path, (plan.output,), leg.times)
            least, greatest = found.least[0], found.greatest[0]
        else:
            path = made.record_motion(record, state, 0.0, record.end)
            least, greatest = path.extremes_between(leg.times, plan.output)
        if path.t_end < record.end:
            raise ValueError(f"at {np.interp(path.t_end, leg.times, leg.omega) / (2 * np.pi):.5g} Hz: it ended early")
        state = path.state
        impacts = np.histogram(path.impact_times, leg.times)[0]
        yield _columns(leg, least, greatest, impacts, plan.periods or 1)


@dataclass(frozen=True)
class ChirpLeg:
    """Begins and ends of the drive periods of a linear chirp, ``times`` (n + 1,) s, and the frequency then, rad/s."""

    omega: Array
    times: Array

    @classmethod
    def of(cls, first: float, last: float, rate: float) -> ChirpLeg:
        """As many whole drive periods as there are from ``first`` to ``last`` rad/s at ``rate`` rad/s²."""
        turns = abs(last**2 - first**2) / (4 * np.pi * rate)
        if int(turns + WHOLE) < 1:
            raise ValueError(
                f"chirp: {turns:.3g} drive periods, at least 1 makes one: lower the rate, or sweep further"
            )
        signed = rate if last > first else -rate
        omega = np.sqrt(np.maximum(first**2 + 4 * np.pi * signed * np.arange(int(turns + WHOLE) + 1), 0.0))
        return cls(omega, (omega - first) / signed)


def _legs(plan: ShowPlan) -> Iterator[ChirpLeg]:
    """Chirps of the plan's directions; the way down begins where that up ends."""
    low, high = (2 * np.pi * edge(plan.frequency) for edge in (min, max))
    if low == high:
        raise ValueError("a chirp needs a range of frequencies, there is one")
    for direction in _directions(plan):
        leg = ChirpLeg.of(*((low, high) if direction == "up" else (high, low)), 2 * np.pi * plan.own["rate"])
        yield leg
        high = float(leg.omega[-1])


def _directions(plan: ShowPlan) -> tuple[str, ...]:
    """Directions of the plan's chirps, in the order in which they are flown."""
    asked = plan.own["direction"]
    return ("up", "down") if asked in (None, "both") else (asked,)


def _columns(leg: ChirpLeg, least: Array, greatest: Array, impacts: Index, periods: int) -> Columns:
    """Extremes over ``periods`` drive periods each, the last incomplete ones left out."""
    count = len(least) // periods
    if not count:
        raise ValueError(f"the chirp lasts {len(least)} drive periods, fewer than the {periods} of one amplitude")
    middle = (leg.omega[1:] + leg.omega[:-1]) / (4 * np.pi)
    rows = [each[: count * periods].reshape(count, periods) for each in (middle, greatest, least, impacts)]
    frequency, highest, lowest = rows[0].mean(1), rows[1].max(1), rows[2].min(1)
    amplitude = (highest - lowest) / 2
    top = [int(np.argmax(amplitude))]
    return {
        "time": Column(leg.times[: count * periods : periods], "s", "begin of the drive periods read"),
        "frequency": Column(frequency, "Hz", "drive frequency, their mean"),
        "amplitude": Column(amplitude, "q", "½(max − min) of the output over them, swept, not settled"),
        "maximum": Column(highest, "q", "max of the output"),
        "minimum": Column(lowest, "q", "min of the output"),
        "impacts": Column(rows[3].mean(1), "1", "impacts a drive period"),
        "swept_peak": Column(amplitude[top], "q", "largest amplitude"),
        "swept_peak_frequency": Column(frequency[top], "Hz", "drive frequency of the largest amplitude"),
    }


def draw(figure: Figure, result: Comparison, plan: ShowPlan, shown: tuple[Sheet, ...]) -> None:
    """Draw settled points, where they are of this output, as in the response curve, and the chirps as thin lines."""
    case, units, axes = result.case, units_for(result, plan.output), figure.subplots()
    for name, look in looks_of(case, plan.fidelities).items():
        if _has_settled(result, plan, name):
            _settled(axes, result, name, look, units)
    for name in plan.fidelities:
        own = (sheet for sheet in shown if sheet.fidelity == name and not sheet.fault)
        for direction, sheet in zip(_directions(plan), own, strict=False):
            _swept(axes, result, plan, sheet, direction, units)
    note = start_upward([axes])
    if is_empty(axes):
        say(axes, "no motion at any frequency")
    across_frequency(axes, units)
    axes.set_ylabel("\n".join(filter(None, [amplitude_of(plan.output, units), note])))


def _has_settled(result: Comparison, plan: ShowPlan, name: str) -> bool:
    """True where the sweep has points of this fidelity and output."""
    return name in set(result) and plan.output == result.case.sweep.output


def _settled(axes: Axes, result: Comparison, name: str, look: Look, units: DisplayUnits) -> None:
    axes.plot([], [], label=f"{name_of(result.case, name)}, settled", **look.keys())
    for direction, response in result[name].items():
        draw_branch(axes, response, direction, look, units.frequency_factor, units.length_factor)


def _swept(axes: Axes, result: Comparison, plan: ShowPlan, sheet: Sheet, direction: str, units: DisplayUnits) -> None:
    case, colour = result.case, looks_of(result.case, plan.fidelities)[sheet.fidelity].colour
    across, upward = sheet["frequency"] * units.frequency_factor, sheet["amplitude"] * units.length_factor
    label = f"{name_of(case, sheet.fidelity)}, swept {direction}{_beside(result, plan, sheet, direction, units)}"
    axes.plot(across, upward, color=colour, linewidth=0.6, alpha=SWEPT[direction], zorder=4, label=label)


def _beside(result: Comparison, plan: ShowPlan, sheet: Sheet, direction: str, units: DisplayUnits) -> str:
    """Distance of a chirp's peak from the settled one of the same way, as text; empty where that was not swept."""
    if not _has_settled(result, plan, sheet.fidelity):
        return ""
    settled = dict(result[sheet.fidelity].items()).get(direction)
    top = None if settled is None else settled.peak
    if top is None or top.point < 0:
        return ""
    higher = float(sheet["swept_peak"][0] / top.amplitude - 1) if top.amplitude else 0.0
    further = float(sheet["swept_peak_frequency"][0] - top.frequency) * units.frequency_factor
    shift = f"{further:+.2g} {units.frequency}".replace("-", "−").rstrip()
    return f": peak {'+' if higher >= 0 else '−'}{percent(abs(higher))}, {shift}"


def caption(plan: ShowPlan) -> str:
    """Caption of the figure."""
    return f"a swept-sine test at {plan.own['rate']:g} Hz/s, not settled, beside settled points"
