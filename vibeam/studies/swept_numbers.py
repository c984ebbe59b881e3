"""Numbers of one sweep beyond its comparison: its peak, the ends of period 1, ringing and apparent restitution.

Peak and ends are refined between the points of the sweep. What is read off a motion is read as ``vibeam check`` does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vibeam.case.case import Case
from vibeam.case.plans import ShowPlan
from vibeam.figures.sheet import sheet_at
from vibeam.periodic.motion_kind import IRREGULAR, UNKNOWN
from vibeam.runs.comparison.places import Simulator, SweptPlace, simulated
from vibeam.runs.comparison.responses import Response
from vibeam.system.impact_system import ImpactSystem

NAN = float("nan")
FINER, ROUNDS = 8, 2  # parts of the range around a peak, and how often they are refined
SMOOTH = 0.05  # tolerance, as a share of the parabola's height, between the motion at its top and that height
TOLERANCE = 1e-4  # relative width to which the ends of period 1 are bracketed
SAME = 0.01  # relative difference of the amplitudes of two motions that are one
UNSEEN = 1e-9  # share of the output's row below which a mode is not observable
EDGE = "at the end of the sweep: it may lie beyond"
CHANCE = "the motion at the peak does not repeat"
#: kind of the figure off which a number is read, and its column
OF_MOTION = {
    "ringing": ("ringing", "ringing_velocity"), "ringing_frequency": ("ringing", "ringing_frequency"),
    "apparent_restitution": ("restitution", "extrapolated_restitution"),
}  # fmt: skip


@dataclass(frozen=True)
class ReadNumber:
    """Number read off a sweep; NaN with the reason ``why``, or a number with a remark."""

    number: float
    why: str = ""


@dataclass(frozen=True)
class RefinedPeak:
    """Peak of a sweep, refined between its points: amplitude in the unit of the output, frequency in Hz."""

    amplitude: float
    frequency: float
    why: str = ""


def refined_peak(response: Response) -> RefinedPeak:
    """Peak of a response, refined where its motion repeats and the sweep goes on beyond it; else the sweep's own."""
    known = [(each.amplitude, each.frequency, way, i) for way, places in response.places.items()
             for i, each in enumerate(places) if each.kind.periods != UNKNOWN]  # fmt: skip
    if not known:
        return RefinedPeak(NAN, NAN, "no complete point")
    amplitude, frequency, way, i = max(known)
    places = response.places[way]
    if places[i].kind.periods == IRREGULAR:
        return RefinedPeak(amplitude, frequency, CHANCE)
    if not 0 < i < len(places) - 1:
        return RefinedPeak(amplitude, frequency, EDGE)
    if response.simulator is None or places[i - 1].state() is None:
        return RefinedPeak(amplitude, frequency)
    top = _top(response.simulator, _narrowed(response.simulator, places[i - 1 : i + 2]))
    return RefinedPeak(top.amplitude, top.frequency)


def _narrowed(simulator: Simulator, three: Sequence[SweptPlace]) -> Sequence[SweptPlace]:
    """Three neighbours around the top; each finer place is reached from the one before it, as in the sweep."""
    for _ in range(ROUNDS):
        found = [three[0]]
        for frequency in np.linspace(three[0].frequency, three[2].frequency, FINER + 1)[1:-1].tolist():
            found.append(simulated(simulator, frequency, found[-1]))
        top = max(range(1, len(found)), key=lambda i: _height(found[i]))
        three = [*found, three[2]][top - 1 : top + 2]
    return three


def _height(place: SweptPlace) -> float:
    """Amplitude; −∞ of a motion that does not repeat, between which nothing is refined."""
    return -np.inf if place.kind.periods in (IRREGULAR, UNKNOWN) else place.amplitude


def _top(simulator: Simulator, three: Sequence[SweptPlace]) -> SweptPlace:
    """Place at the top of the parabola through three; the middle one where they are not on one smooth curve.

    At a jump a parabola has a top as well, but the motion there differs from it.
    """
    y = np.array([_height(each) for each in three])
    if not (np.all(np.isfinite(y)) and y[0] - 2 * y[1] + y[2] < 0):
        return three[1]
    aside = (y[0] - y[2]) / (2 * (y[0] - 2 * y[1] + y[2]))
    frequency = three[1].frequency + float(aside) * (three[2].frequency - three[0].frequency) / 2
    found, height = simulated(simulator, frequency, three[0]), y[1] - (y[0] - y[2]) * aside / 4
    return found if abs(_height(found) - height) <= SMOOTH * (height - y.min()) else three[1]


def period_one_end(response: Response, upper: bool) -> ReadNumber:
    """End (Hz) of the range of period 1 with impacts around its largest amplitude, bracketed between the points.

    Each end is taken where the sweep reaches it: the lower one on the way down, where that is swept.
    """
    way = next(each for each in ("up", "down")[:: 1 if upper else -1] if each in response.places)
    for _ in range(ROUNDS):
        outer, beyond = _edge(response.places[way], upper)
        if outer is None:
            return ReadNumber(NAN, "no motion of period 1 with impacts")
        if beyond is None:
            return ReadNumber(outer.frequency, "still period 1 at the end of the sweep")
        middle = 0.5 * (outer.frequency + beyond.frequency)
        if not response.sharpen(way, middle, TOLERANCE):
            break
    return ReadNumber(middle)


def _edge(places: Sequence[SweptPlace], upper: bool) -> tuple[SweptPlace | None, SweptPlace | None]:
    """Outermost place of period 1 and the one beyond it, None where there is none."""
    ordered = sorted(places, key=lambda each: each.frequency if upper else -each.frequency)
    inside = [each.kind.periods == 1 and each.kind.impacts != 0 for each in ordered]
    if True not in inside:
        return None, None
    at = max((i for i, known in enumerate(inside) if known), key=lambda i: ordered[i].amplitude)
    last = next((i for i in range(at, len(ordered)) if not inside[i]), len(ordered))
    return ordered[last - 1], ordered[last] if last < len(ordered) else None


def numbers_of(
    case: Case, name: str, system: ImpactSystem, response: Response, wanted: Sequence[str], frequency: float | None
) -> dict[str, ReadNumber]:
    """Numbers of the sweep of a fidelity; those of a motion at ``frequency`` (Hz), None: at its peak."""
    top = refined_peak(response)
    known: dict[str, Callable[[], ReadNumber]] = {
        "peak": lambda: ReadNumber(top.amplitude, top.why),
        "peak_frequency": lambda: ReadNumber(top.frequency, top.why),
        "period_one_from": lambda: period_one_end(response, upper=False),
        "period_one_to": lambda: period_one_end(response, upper=True),
    }
    at = top.frequency if frequency is None else frequency
    settles = frequency is None and not known.keys() >= set(wanted)
    why = _elsewhere(response, top) if settles else ""

    def read(quantity: str) -> ReadNumber:
        if quantity in known:
            return known[quantity]()
        return ReadNumber(NAN, why) if why else _of_motion(case, name, system, quantity, at)

    return {each: read(each) for each in wanted}


def _elsewhere(response: Response, top: RefinedPeak) -> str:
    """Reason why no motion is read at a peak: settled from rest, another one is reached; else empty."""
    if response.simulator is None or not np.isfinite(top.frequency):
        return "there is no motion to settle at the peak"
    reached = simulated(response.simulator, top.frequency, None)
    same = abs(reached.amplitude - top.amplitude) <= SAME * top.amplitude
    return "" if same else "from rest another motion than that of the peak is reached: set influence.frequency"


def _of_motion(case: Case, name: str, system: ImpactSystem, quantity: str, frequency: float) -> ReadNumber:
    """Number of the settled motion at a frequency (Hz): mean over its impacts, or over the intervals between them."""
    if case.scene_of(name).harmonics:
        return ReadNumber(NAN, "the fit knows one harmonic of the drive")
    kind, column = OF_MOTION[quantity]
    near = next(_ringing_modes(system, case.sweep.output, frequency), None)
    if kind == "ringing" and near is None:
        return ReadNumber(NAN, "no faster mode that the output sees: nothing rings")
    plan = ShowPlan(
        name="", kind=kind, key="", fidelities=(name,), frequency=(frequency,), settle=case.sweep.settle,
        output=case.sweep.output, near=None if near is None else near / (2 * np.pi),
    )  # fmt: skip
    sheet = sheet_at(case, plan, name, frequency, ())
    values = sheet.of(column)[np.isfinite(sheet.of(column))]
    return ReadNumber(float(values.mean())) if len(values) else ReadNumber(NAN, sheet.fault or "there is none")


def _ringing_modes(system: ImpactSystem, output: str, frequency: float) -> Iterator[float]:
    """Angular frequencies of the modes faster than twice the drive that the output sees, the slowest first."""
    row = np.abs(system.output(output))
    for mode in np.argsort(system.omega):
        if system.omega[mode] >= 4 * np.pi * frequency and row[mode] > UNSEEN * row.max() and system.zeta[mode] < 1:
            yield float(system.omega[mode])
