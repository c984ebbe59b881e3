"""Sets of contacts that are held or pushed, each a linear regime; the drive in all of them."""

from __future__ import annotations

from vibeam.flight.kernels import layout
from vibeam.flight.kernels.compiler import joined, kernel
from vibeam.flight.kernels.contacts import layout as row
from vibeam.flight.kernels.contacts.course import LOADED
from vibeam.flight.kernels.contacts.layout import ContactEngine
from vibeam.flight.kernels.drive import carried_rate, coarsest_level, exact_period, steady_response
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.kernels.roots.pair import tabulate_drive


@joined
def regime_of(engine: ContactEngine, slot: int) -> Regime:
    """The regime of a set."""
    return Regime(
        engine.pairs[slot], engine.table[slot], engine.levels[slot], engine.signal, engine.attached,
        engine.blocks[slot], engine.into[slot], engine.outof[slot], engine.held[slot], engine.signals[slot],
        engine.terms,
    )  # fmt: skip


@kernel
def key_of(engine: ContactEngine, held: float, pushed: float) -> float:
    """Key of the set of contacts held and pushed."""
    return float(held + (1 << engine.rows.shape[0]) * pushed)


@kernel
def slot_of(engine: ContactEngine, key: float) -> int:
    """Slot of the set with that key; NONE where it was not made yet."""
    for slot in range(engine.sets.shape[0]):
        if engine.sets[slot] == key:
            return slot
    return row.NONE


@kernel
def set_drive(engine: ContactEngine, omega: float, amplitude: float) -> None:
    """Put the engine under b = amplitude · sin(omega t); under a load of its own that says nothing."""
    drive = engine.drive
    drive[layout.W], drive[layout.STRENGTH], drive[layout.AMPLITUDE] = omega, omega * omega * amplitude, amplitude
    drive[layout.PERIOD], drive[layout.PERIOD_REST] = exact_period(omega)
    if engine.course.numbers[LOADED] > 0.0:
        return
    for slot in range(engine.sets.shape[0]):
        if engine.sets[slot] >= 0.0:
            regime = regime_of(engine, slot)
            tabulate_drive(omega, regime.levels)
            steady_response(regime, drive)
            rate = max(omega, carried_rate(regime.pairs, regime.blocks))
            engine.coarsest[slot] = coarsest_level(regime.pairs, regime.levels, rate)
