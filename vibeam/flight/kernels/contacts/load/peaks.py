"""The largest force of a stop that pushes, panel by panel."""

from __future__ import annotations

from vibeam.flight.kernels.compiler import kernel
from vibeam.flight.kernels.contacts import course as row
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.contacts.load.panel import evaluate, set_functions
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.roots.newton import EPSILON
from vibeam.flight.kernels.roots.pair import power

ROUNDS = 60


@kernel
def note_push(engine: ContactEngine, regime: Regime, place: int, which: int, h: float, most: float) -> float:
    """The larger of ``most`` and a signal's largest value over h from the node on, in a panel that it was judged on."""
    watch = engine.course.watch
    order = int(watch[row.START_ORDER, place])
    first, rising = (0.0, 1.0) if order > 0 else (watch[row.AT, place], watch[row.SLOPE, place])
    last, falling = value_of(engine, regime, place, which, h)
    most = max(most, max(first, last))
    if not rising > 0.0 > falling:
        return most
    low, high = 0.0, h
    for i in range(ROUNDS):
        t = 0.5 * (low + high)
        if i % 3 > 0 and order == 0:
            t = low + (high - low) * min(max(rising / (rising - falling), 0.01), 0.99)
        value, slope = value_of(engine, regime, place, which, t)
        most = max(most, value)
        if abs(slope) * (high - low) <= EPSILON * value:
            break
        if slope > 0.0:
            low, rising = t, slope
        else:
            high, falling = t, slope
    return most


@kernel
def value_of(engine: ContactEngine, regime: Regime, place: int, which: int, t: float) -> tuple[float, float]:
    """A signal and its rate at t from the node on."""
    set_functions(regime, engine.course, t)
    value, slope = evaluate(engine, regime, engine.course, place, which, t)
    order = int(engine.course.watch[row.START_ORDER, place])
    if order == 0:
        return value, slope
    return value * power(t, order), slope * power(t, order) + order * value * power(t, order - 1)
