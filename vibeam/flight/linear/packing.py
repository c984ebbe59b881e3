"""From an ImpactSystem to the arrays that the kernels run on, and back; the free modes also by blocks for the lanes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import floor, inf, log2

import numpy as np

from vibeam.flight.engine.threads import PerThread
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.lanes import layout as block_layout
from vibeam.flight.kernels.layout import ELASTIC, FORGOTTEN, LINGERING, PANEL, REDUCED, RESOLVED, SILENT, Engine, Regime
from vibeam.flight.linear.block_regime import SignalRow, held_regime, rates, regime, with_signals
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.arrays import Array

SLOW = 1e-6  # turns within a motion below which a mode is slow, and the motion itself says how long a panel is
KEPT = 16  # packed systems
SPARE = 4  # levels of panels shorter than the fastest rate needs
FASTEST = 1e36  # bounds take eighth powers of the rates


def lay_out(pairs: Array, table: Array, levels: Array, modes: Array, drive: Array, lanes: int) -> tuple[Array, Array]:
    """``cells`` and ``rungs`` of a packed system; empty where a mode takes no part in the contact.

    Or where one far beyond critical damping lingers, which the lanes bound by its fast decay; or where damped impacts
    may go on without end: the lanes know the end of a flight to round-off of the displacement, not of the flight.
    """
    n = pairs.shape[1]
    lingering = (pairs[layout.SLOW] > 0) & (pairs[layout.SLOW] * levels[layout.STEP, 0] < LINGERING)
    unending = 1.0 - drive[layout.RESTITUTION] < ELASTIC and np.any(pairs[layout.SIGMA] > 0)
    if np.min(np.abs(modes[layout.CONTACT])) < SILENT or np.any(lingering) or unending:
        return np.zeros(0), np.zeros(0)
    blocks = -(-n // lanes)
    cells = np.zeros((block_layout.CELL_ROWS, blocks * lanes))
    rungs = np.zeros((layout.LEVELS, block_layout.RUNG_ROWS, blocks * lanes))
    turn = np.sqrt(np.maximum(-pairs[layout.DISC], 0.0))
    contact, kappa = modes[layout.CONTACT], pairs[layout.KAPPA]
    cells[block_layout.RATE, :n], cells[block_layout.TURN, :n] = pairs[layout.SIGMA], turn
    cells[block_layout.TURN_INVERSE, :n] = 1.0 / np.where(turn > 0, turn, np.inf)
    cells[block_layout.DAMP, :n], cells[block_layout.SPRING, :n] = 2 * pairs[layout.SIGMA], pairs[layout.OMEGA] ** 2
    cells[block_layout.NORM, :n] = pairs[layout.INVERSE]
    cells[block_layout.KICK, :n] = contact**2 / drive[layout.MOBILITY]
    cells[block_layout.PUT, :n] = contact * modes[layout.YIELD]
    for row, power in ((block_layout.K1, 1), (block_layout.K2, 2), (block_layout.K4, 4), (block_layout.K5, 5)):
        cells[row, :n] = kappa**power
    decay = np.full(blocks * lanes, np.inf)
    decay[:n] = pairs[layout.DECAY]
    mixed = np.zeros(blocks * lanes)
    mixed[:n] = pairs[layout.DISC] >= 0
    cells[block_layout.SLOWEST] = np.repeat(decay.reshape(blocks, lanes).min(axis=1), lanes)
    cells[block_layout.MIXED] = np.repeat(mixed.reshape(blocks, lanes).max(axis=1), lanes)
    rungs[:, :8, :n] = np.moveaxis(table[:8], 0, 1)
    low = (np.arange(n)[None, :] < levels[layout.COUNT][:, None]).astype(float)
    h4 = levels[layout.STEP][:, None] ** 4
    rungs[:, block_layout.LOW, :n] = low
    rungs[:, block_layout.MISSED, :n] = low * kappa**4 * h4 / 384 + (1 - low)
    rungs[:, block_layout.MISSED_FIRST, :n] = low * kappa**5 * h4 / (384 * 5) + (1 - low) * kappa
    cells = np.moveaxis(cells.reshape(block_layout.CELL_ROWS, blocks, lanes), 1, 0)
    rungs = np.moveaxis(rungs.reshape(layout.LEVELS, block_layout.RUNG_ROWS, blocks, lanes), 2, 1)
    return np.ascontiguousarray(cells).ravel(), np.ascontiguousarray(rungs).ravel()


def longest_flight(pairs: Array) -> float:
    """Time for which a flight's closed form keeps its digits, by the fastest mode that does not decay before."""
    turn = np.sqrt(np.maximum(-pairs[layout.DISC], 0.0))
    ringing = turn[pairs[layout.DECAY] * REDUCED < FORGOTTEN * turn]
    return float(REDUCED / np.max(ringing, initial=1e-300))


class PackedSystem:
    """An ImpactSystem as the kernels see it: modes sorted by rate, and the way back to the user's order."""

    def __init__(self, system: ImpactSystem, top: int) -> None:
        """``top``: level of the longest panels, 2**top s."""
        self.system = system
        self.order = np.argsort(rates(system.omega, system.zeta * system.omega), kind="stable")
        self._in_order = bool(np.array_equal(self.order, np.arange(system.size)))
        self._engines = PerThread(self._engine(top))
        self.still: tuple[Array, Array] | None = None  # pose and status of the equilibrium, once they were asked for

    @property
    def engine(self) -> Engine:
        """The calling thread's arrays."""
        return self._engines.own()

    def engine_for(self, size: float) -> Engine:
        """The same, for a motion with modal displacements of about ``size``; inf where that is not known."""
        engine = self.engine
        engine.drive[layout.MOTION] = size
        return engine

    def _engine(self, top: int) -> Engine:
        own, order = self.system, self.order
        omega, zeta = own.omega[order], own.zeta[order]
        sigma, contact, load, static = zeta * omega, own.contact[order], own.load[order], own.static[order]
        modes, drive = np.zeros((layout.MODE_ROWS, own.size)), np.zeros(layout.DRIVE_ROWS)
        modes[layout.CONTACT], modes[layout.LOAD], modes[layout.STATIC] = contact, load, static
        modes[layout.ZETA], modes[layout.YIELD] = zeta, yields(omega, contact)
        drive[layout.GAP], drive[layout.RESTITUTION] = own.gap, own.restitution
        drive[layout.MOBILITY] = contact @ contact
        pairs, table, levels = regime(omega, sigma, omega**2 * (zeta - 1.0) * (zeta + 1.0), top)
        cells, rungs = lay_out(pairs, table, levels, modes, drive, 1 if own.size == 1 else 8)
        drive[layout.LONGEST] = longest_flight(pairs)
        return Engine(
            pairs, table, levels, np.zeros(layout.SIGNAL_ROWS), np.zeros((layout.ATTACHED_ROWS, own.size)), modes,
            drive, _rest(omega, sigma, contact, load, static, own.gap, top), cells, rungs,
        )  # fmt: skip

    def inward(self, values: Array) -> Array:
        """Values (…, n) of the user's modes in the kernels' order."""
        if self._in_order:
            return np.array(values, dtype=float, order="C")
        return np.ascontiguousarray(np.asarray(values, dtype=float)[..., self.order])

    def outward(self, values: Array) -> Array:
        """Values (…, n) in the kernels' order as the user's modes."""
        if self._in_order:
            return values.copy()
        result = np.empty_like(values)
        result[..., self.order] = values
        return result


def _rest(omega: Array, sigma: Array, contact: Array, load: Array, static: Array, gap: float, top: int) -> Regime:
    """The system held on the stop, with its contact force."""
    linear = LinearSystem(omega**2, np.diag(2 * sigma), contact, inf)
    found, force = held_regime(linear, static, load, gap, top)
    silent = SignalRow(np.zeros(len(contact)), np.zeros(len(contact)))  # the gap, which is none
    return with_signals(found, [silent, silent, force])


def yields(omega: Array, contact: Array) -> Array:
    """Displacements that move the contact by 1 with the least energy: c/ω² over its sum, free modes alone if any."""
    loose = (omega == 0.0) & (contact != 0.0)
    softest = np.min(omega[contact != 0.0])
    weight = (
        np.where(loose, contact, 0.0) if loose.any() else contact * (softest / np.where(omega > 0, omega, 1.0)) ** 2
    )
    return np.asarray(weight / (contact @ weight))


def pack(system: ImpactSystem, omega: float, span: float = 0.0) -> PackedSystem:
    """The system packed for drives of ``omega`` rad/s and more; without, for the slowest mode or a time of ``span``.

    Systems that were packed lately are not packed again. ValueError as ``top_level``.
    """
    key = _Same(system)
    return _packed(key, top_level(slowest_rate(system, omega, span), _fastest_rate(key)))


def top_level(slowest: float, fastest: float) -> int:
    """Level of the longest panels, 2**level s: for the slowest rate, but so that the shortest resolve the fastest.

    ValueError for rates that no double can hold.
    """
    if not (fastest < FASTEST and slowest > 1 / FASTEST):
        raise ValueError(f"rates from {slowest:g} to {fastest:g} rad/s: take another unit of time")
    longest = floor(log2(PANEL / slowest))
    return min(longest, floor(log2(RESOLVED / fastest)) + layout.LEVELS - SPARE) if fastest > 1 / FASTEST else longest


@dataclass(frozen=True, eq=False)
class _Same:
    """A system as a key: the object itself, whose arrays are read-only."""

    system: ImpactSystem

    def __hash__(self) -> int:
        return id(self.system)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.system is other.system


@lru_cache(maxsize=KEPT)
def _fastest_rate(key: _Same) -> float:
    return float(np.max(rates(key.system.omega, key.system.zeta * key.system.omega)))


@lru_cache(maxsize=KEPT)
def _packed(key: _Same, top: int) -> PackedSystem:
    return PackedSystem(key.system, top)


def slowest_rate(system: ImpactSystem, omega: float, span: float) -> float:
    """The lowest rate (rad/s) that panels must serve: of a mode ω, or ω/(ζ + √(ζ² − 1)) beyond critical damping."""
    if omega > 0:
        return omega
    moving, once = system.omega > 0, 1.0 / span if span > 0 else 0.0
    own, zeta = system.omega[moving], np.maximum(system.zeta[moving], 1.0)
    slowest = float(np.min(own / (zeta + np.sqrt((zeta - 1.0) * (zeta + 1.0))), initial=np.inf))
    return slowest if SLOW * once < slowest < np.inf else once or 1.0
