"""Comparison of fidelities with either restitution held, beside the finest one's distance from its own limit."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from vibeam.case.held import Held, held_of, other_choice, with_other_choice
from vibeam.run.comparison.closed_curve import ClosedCurve, closed_curve
from vibeam.run.comparison.limit import Limit, limit
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.response import FrequencyResponse, complete, periodic
from vibeam_models.scene import Scene, SdofScene

Array = NDArray[np.float64]

NAN = float("nan")

SAME = 0.01  # share by which the amplitude of a run and that of the closed form of its motion may differ

SURE = 1e-4  # differences smaller than this share have no sign

SMALL = 0.1  # largest share of a difference that the finest's distance from its limit may be


@dataclass(frozen=True)
class Difference:
    """Relative difference in amplitude: of the ``peak``'s height, and over ``points`` of ``total`` frequencies.

    NaN where unknown; ``peak`` and ``worst`` are signed.
    """

    peak: float = NAN
    rms: float = NAN
    worst: float = NAN
    points: int = 0
    total: int = 0


@dataclass(frozen=True)
class ComparedModel:
    """Model of a comparison: its ``system`` and ``scene`` over ``omega`` (points,) rad/s, under ``base`` (points,) m.

    ``responses``: those of its run, by which its motions are told apart; none where it was not run. ``why``: a reason
    that excludes closed forms beside those of the system.
    """

    name: str
    scene: Scene | SdofScene
    system: ImpactSystem
    omega: Array
    base: Array
    output: str
    responses: Sequence[FrequencyResponse] = ()
    why: str = ""


@dataclass(frozen=True)
class OwnLimit:
    """Distance of a fidelity from its own limit, ``held`` and with the ``other`` choice; ``why``: it is not known.

    Computed with ``modes`` modes on ``elements`` elements.
    """

    held: Difference = field(default_factory=Difference)
    other: Difference = field(default_factory=Difference)
    modes: int = 0
    elements: int = 0
    why: str = ""


@dataclass(frozen=True)
class BothChoices:
    """Difference of a fidelity from the finest as ``held`` and with the ``other`` choice; ``why``: it is not known.

    ``uncertainty`` of the peak's (of the rms without one), held and other: the share that the finest's distance from
    its limit has in it, NaN where unknown. ``turns``: the peaks differ in opposite directions under the two choices,
    in each by more than that. ``small``: it is small against the difference held.
    """

    fidelity: str
    held: Difference
    other: Difference
    uncertainty: tuple[float, float] = (NAN, NAN)
    turns: bool = False
    small: bool = True
    why: str = ""


@dataclass(frozen=True)
class HeldComparison:
    """Comparison with the fidelity ``finest``: what is ``held``, the ``other`` choice (None: there is none)."""

    finest: str
    held: Held
    other: Held | None
    rows: tuple[BothChoices, ...]
    limit: OwnLimit
    cpu_seconds: float

    @property
    def turning(self) -> tuple[str, ...]:
        """Fidelities whose verdict turns with the choice."""
        return tuple(row.fidelity for row in self.rows if row.turns)


Closed = ClosedCurve | str  #: or the reason why there is none


def held_comparison(
    finest: ComparedModel, others: Iterable[ComparedModel], other_physics: bool = False
) -> HeldComparison:
    """Compare ``others`` with ``finest`` by closed-form motions, at a few frequencies and at the peaks.

    ``other_physics``: they have limits of their own, so that only the difference of two distances is uncertain.
    """
    begun = time.thread_time()
    held = held_of(finest.scene)
    here, there = _both(finest)
    own = _own_limit(finest, here, there)
    rows = tuple(_row(model, finest, (here, there), own, other_physics) for model in others)
    return HeldComparison(finest.name, held, other_choice(held), rows, own, time.thread_time() - begun)


def _both(model: ComparedModel) -> tuple[Closed, Closed]:
    """Closed-form curves of a model as held and with the other choice."""
    if why := _excluded(model):
        return why, why
    here = _curve(model, model.system)
    try:
        return here, _curve(model, with_other_choice(_beam(model), model.system))
    except ValueError as refusal:
        return here, str(refusal)


def _excluded(model: ComparedModel) -> str:
    """Reason why a model has no closed-form motions or no other choice; empty where it has both."""
    if isinstance(model.scene, SdofScene):
        return "a single degree of freedom given directly has no more modes"
    if model.system.beyond_plain:
        return f"no closed-form motions with {' or '.join(model.system.beyond_plain)}"
    if model.scene.platform is not None and model.scene.platform.coupling == "two-way":
        return "no closed-form motions on a platform that is pushed back"
    return model.why


def _beam(model: ComparedModel) -> Scene:
    assert isinstance(model.scene, Scene)
    return model.scene


def _curve(model: ComparedModel, system: ImpactSystem) -> ClosedCurve:
    return closed_curve(system, model.omega, model.base, model.output)


def _own_limit(finest: ComparedModel, here: Closed, there: Closed) -> OwnLimit:
    if isinstance(here, str):
        return OwnLimit(why=here)
    scene = _beam(finest)
    try:
        own = limit(scene, finest.system.size)
    except ValueError as refusal:
        return OwnLimit(why=str(refusal))
    kinds = _kinds(finest, here)
    if not kinds.any():
        return OwnLimit(why="no motion with at most one impact a drive period, and no other has a closed form")
    choices = ("contact", "first mode")
    held, other = choices if scene.stop.restitution_of == "contact" else choices[::-1]
    by_limit, by_other = (_limit_curve(finest, own, scene, choice) for choice in (held, other))
    distance = _difference(here, by_limit, kinds)
    if _peak_fault(finest, here):
        distance = replace(distance, peak=NAN)
    why = by_limit if isinstance(by_limit, str) else ""
    return OwnLimit(distance, _difference(there, by_other), own.modes, own.elements, why)


def _limit_curve(finest: ComparedModel, own: Limit, scene: Scene, choice: str) -> Closed:
    try:
        return _curve(finest, own.holding(scene, choice))
    except ValueError as refusal:
        return str(refusal)


def _kinds(model: ComparedModel, closed: ClosedCurve) -> NDArray[np.bool_]:
    """Mask (points, kinds) of the closed-form motions that a run has; all of them where there was no run."""
    if not model.responses:
        return np.isfinite(closed.amplitude)
    seen = np.zeros(closed.amplitude.shape, dtype=bool)
    for response in model.responses:
        run = np.where(periodic(response), response.amplitude, np.nan)[np.argsort(response.frequency)]
        seen |= np.abs(closed.amplitude / run[closed.which, None] - 1) < SAME
    return seen


def _difference(one: Closed, other: Closed, kinds: NDArray[np.bool_] | None = None) -> Difference:
    """Difference of ``one`` over ``other`` where both have motions of the same kind."""
    if isinstance(one, str) or isinstance(other, str):
        return Difference()
    counted = np.isfinite(one.amplitude) if kinds is None else kinds
    values = (one.amplitude / other.amplitude - 1)[counted & np.isfinite(other.amplitude)]
    peak, total = one.peak / other.peak - 1, int(np.count_nonzero(counted))
    if not len(values):
        return Difference(peak, total=total)
    worst = float(values[np.argmax(np.abs(values))])
    return Difference(peak, float(np.sqrt(np.mean(values**2))), worst, len(values), total)


def _row(
    model: ComparedModel, finest: ComparedModel, top: tuple[Closed, Closed], own: OwnLimit, other_physics: bool
) -> BothChoices:
    here, there = _both(model)
    held = _difference(here, top[0], None if isinstance(here, str) else _kinds(model, here))
    if model.responses and finest.responses:
        held = replace(held, peak=run_peak(model.responses) / run_peak(finest.responses) - 1)
    why = next((each for each in (*top, here, there) if isinstance(each, str)), "")
    why = why or _peak_fault(finest, top[0]) or _peak_fault(model, here)
    other = _difference(there, top[1])
    other = replace(other, peak=NAN) if why else other
    of_model = _own_limit(model, here, there) if other_physics else OwnLimit(held=AT_LIMIT, other=AT_LIMIT)
    margins = _margin(held, own.held, of_model.held), _margin(other, own.other, of_model.other)
    turns = _sign(held.peak, margins[0]) * _sign(other.peak, margins[1]) < 0
    small = not margins[0] > SMALL * abs(held.peak if isfinite(held.peak) else held.rms)
    return BothChoices(model.name, held, other, margins, turns, small, why)


AT_LIMIT = Difference(0.0, 0.0, 0.0)


def _margin(difference: Difference, finest: Difference, model: Difference) -> float:
    """Change of a difference where both models go to their limits, a model without one of its own staying as it is."""
    for off, one, other in ((getattr(each, name) for each in (difference, finest, model)) for name in ("peak", "rms")):
        if isfinite(off) and isfinite(one) and isfinite(other):
            return float(abs((1 + off) * (1 + one) / (1 + other) - 1 - off))
    return NAN


def _sign(difference: float, margin: float) -> int:
    """Sign of a difference that is larger than its uncertainty; else 0."""
    if not abs(difference) > max(SURE, margin if isfinite(margin) else 0.0):
        return 0
    return 1 if difference > 0 else -1


def run_peak(responses: Iterable[FrequencyResponse]) -> float:
    """Largest amplitude of complete points, NaN without any."""
    tops = [np.max(each.amplitude[complete(each)], initial=-np.inf) for each in responses]
    highest = max(tops, default=-np.inf)
    return float(highest) if isfinite(highest) else NAN


def _peak_fault(model: ComparedModel, closed: Closed) -> str:
    """Reason why the peak of a model's run is not that of its closed forms; empty where it is."""
    if isinstance(closed, str) or not model.responses or abs(closed.peak / run_peak(model.responses) - 1) < SAME:
        return ""
    return f"the peak of {model.name} is not that of an exact motion with one impact a drive period"
