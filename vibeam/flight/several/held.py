"""The regime of a set of contacts that are held: a linear system in coordinates that they leave free."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vibeam.flight.engine.entries import regimes_move, regimes_poses_at
from vibeam.flight.engine.threads import unpaused
from vibeam.flight.equilibrium import Contacts, multipliers
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.layout import Regime, watch_of
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.kernels.regimes.layout import RegimeEngine
from vibeam.flight.linear.block_regime import SignalRow, free_regime, with_signals
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam_models.arrays import Array

COUPLES = 1e-13  # share of the damping of two held modes below which what couples them is round-off
FLAT = 1e-14  # share of the fastest held mode below which another has no stiffness
MANY = 10**9
FORCE = 2  # row of the force signal of a regime's first side


@dataclass(frozen=True)
class SignalRoot:
    """The first root of some signals: whose (−1: none within the span), when, the pose and clock then, panels."""

    signal: int
    time: float
    pose: Array
    clock: float
    panels: int


class HeldRegime:
    """A linear system in m ≥ 1 coordinates ξ, η = place + basis ξ, with gaps of all contacts and forces of the held."""

    def __init__(self, contacts: Contacts, held: tuple[int, ...], top: int) -> None:
        system = contacts.system
        self.held, rows = held, contacts.rows[list(held)]
        self.basis, omega, self.place = _coordinates(contacts, rows, contacts.gaps[list(held)])
        damper = _cleaned(self.basis.T @ contacts.damper @ self.basis)
        static = self.basis.T @ (system.static - contacts.spring * self.place)
        linear = LinearSystem(omega**2, damper, np.ones(len(omega)))
        self.regime = free_regime(linear, static, self.basis.T @ system.load, top)
        self.engine = _engine(self.regime, omega, damper, static, self.basis.T @ system.load, top)
        self.signals = np.concatenate(
            [self._filled(each) for each in (*_gaps(contacts, self), *_forces(contacts, self))]
        )
        m = len(self.regime.held)
        self.trace = np.zeros((1, regime_layout.TRACE_COLUMNS))
        self.room = watch_of(np.zeros(m), 0, self.trace, np.zeros((1, 2, m)))
        self.status, self.counts = np.zeros(regime_layout.STATUS_ROWS), np.zeros(layout.COUNT_ROWS, dtype=np.int64)

    def _filled(self, row: SignalRow) -> Array:
        return with_signals(self.regime, [row]).signals[:1]

    def inward(self, poses: Array) -> Array:
        """Poses (…, 2, n) in the coordinates left free (…, 2, m)."""
        moved = np.array(poses, dtype=float)
        moved[..., 0, :] -= self.place
        return np.ascontiguousarray(moved @ self.basis)

    def outward(self, poses: Array) -> Array:
        """And back."""
        full = poses @ self.basis.T
        full[..., 0, :] += self.place
        return np.asarray(full)

    def first(
        self, omega: float, amplitude: float, pose: Array, clock: float, span: float,
        signals: tuple[int, ...], order: float, rise: float,
    ) -> SignalRoot:  # fmt: skip
        """The first root within ``span`` of one or two signals; ``order`` and ``rise`` say how the first one starts."""
        for place, which in enumerate(signals):
            self.regime.signals[layout.GAP_SIGNAL + place] = self.signals[which]
        self.engine.law[regime_layout.SIDES] = len(signals)
        moved, status = pose.copy(), self.status
        status.fill(0.0)
        status[layout.CLOCK], status[layout.ORDER], status[layout.RISE] = clock, order, rise
        outcome = self._move(self.engine, omega, amplitude, moved, span)
        met = self.trace[0, layout.END] != layout.SPAN_END
        if outcome not in (0, layout.FULL):
            raise Unfollowed(outcome)
        time = float(self.trace[0, layout.DURATION])
        panels = int(self.counts[layout.PANELS])
        return SignalRoot(
            signals[int(status[regime_layout.SIDE])] if met else -1, time, moved, float(status[layout.CLOCK]), panels
        )

    def _move(self, engine: RegimeEngine, omega: float, amplitude: float, pose: Array, span: float) -> int:
        self.counts.fill(0)
        self.trace.fill(0.0)
        outcome, _ = unpaused(
            regimes_move, engine, omega, amplitude, pose, self.status, span, 0, 0, MANY, self.room, self.counts, 0
        )
        return int(outcome)

    def poses(self, omega: float, amplitude: float, pose: Array, clock: float, after: Array) -> Array:
        """Poses (k, 2, m) times ``after`` (k,) from one pose."""
        trace, m = np.zeros((1, regime_layout.TRACE_COLUMNS)), len(self.regime.held)
        trace[0, layout.AT_CLOCK] = clock
        out = np.empty((len(after), 2, m))
        regimes_poses_at(
            self.engine, omega, amplitude, trace, pose[None], np.zeros(len(after), dtype=np.int64),
            np.ascontiguousarray(after), np.zeros((2, m)), out,
        )  # fmt: skip
        return out

    @cached_property
    def _pushed(self) -> RegimeEngine:
        """The same with this regime as that of a push, whose largest force the kernels tell."""
        return self.engine._replace(upper=self.regime)

    def highest(
        self, omega: float, amplitude: float, pose: Array, clock: float, span: float, row: Array, above: float
    ) -> float:
        """The largest value over ``span`` of row·η + ``above``, which must be positive throughout."""
        signal = SignalRow(row @ self.basis, np.zeros(len(self.regime.held)), float(row @ self.place) + above)
        self.regime.signals[FORCE] = self._filled(signal)[0]
        self.status.fill(0.0)
        self.status[layout.CLOCK], self.status[layout.KIND] = clock, regime_layout.CONTACT
        outcome = self._move(self._pushed, omega, amplitude, pose.copy(), span)
        if outcome not in (0, layout.FULL) or not self.trace[0, layout.DURATION] >= span:
            raise Unfollowed(outcome)
        return float(self.trace[0, regime_layout.PEAK]) - above


class Unfollowed(Exception):
    """A motion that the kernels could not follow; ``args[0]`` is their outcome."""


def _coordinates(contacts: Contacts, rows: Array, gaps: Array) -> tuple[Array, Array, Array]:
    """Modes (n, m) of the system held at ``rows``, without damping, their frequencies, and a place where it is held.

    At least one coordinate: where none is left free, one that moves nothing.
    """
    omega = contacts.system.omega
    n = len(omega)
    if not len(rows):
        return np.eye(n), np.array(omega), np.zeros(n)
    soft = rows * contacts.yields
    place = soft.T @ (np.linalg.pinv(soft @ rows.T, hermitian=True) @ gaps)
    _, sizes, turned = np.linalg.svd(rows)
    rank = int(np.sum(sizes > 1e-10 * sizes[0]))
    free = turned[rank:].T
    if not free.shape[1]:
        return np.zeros((n, 1)), np.ones(1), place
    _, size, turn = np.linalg.svd(omega[:, None] * free, full_matrices=True)
    size = np.concatenate([size, np.zeros(free.shape[1] - len(size))])
    return free @ turn.T, np.where(size > FLAT * max(size.max(), float(omega.max())), size, 0.0), place


def _cleaned(damper: Array) -> Array:
    """The damping matrix symmetric, and without what couples two modes by round-off."""
    size = np.sqrt(np.abs(np.diag(damper)))
    both = (damper + damper.T) / 2
    return np.where(np.abs(both) > COUPLES * np.outer(size, size), both, 0.0)


def _gaps(contacts: Contacts, held: HeldRegime) -> list[SignalRow]:
    """The gap of every contact."""
    still = np.zeros(held.basis.shape[1])
    return [
        SignalRow(-row @ held.basis, still, float(gap - row @ held.place))
        for row, gap in zip(contacts.rows, contacts.gaps, strict=True)
    ]


def _forces(contacts: Contacts, held: HeldRegime) -> list[SignalRow]:
    """The forces that press the held contacts, λ = G⁻¹ W (f − D η' − Λ η)."""
    if not held.held:
        return []
    each, system = multipliers(contacts.rows[list(held.held)]), contacts.system
    at, rate = -(each * contacts.spring) @ held.basis, -(each @ contacts.damper) @ held.basis
    constant = each @ (system.static - contacts.spring * held.place)
    load = each @ system.load
    return [SignalRow(at[i], rate[i], float(constant[i]), float(load[i])) for i in range(len(held.held))]


def _engine(regime: Regime, omega: Array, damper: Array, static: Array, load: Array, top: int) -> RegimeEngine:
    """The kernels' arrays: signals are watched, and nothing follows at their roots."""
    m, one = len(omega), np.ones(1)
    aside = free_regime(LinearSystem(one, np.zeros((1, 1)), one), np.zeros(1), np.zeros(1), top)
    law = np.zeros(regime_layout.LAW_ROWS)
    law[regime_layout.FAMILY], law[regime_layout.SIDES], law[regime_layout.MOBILITY] = regime_layout.LINEAR, 1.0, np.inf
    nowhere, drive = np.zeros((2, m)), np.zeros(layout.DRIVE_ROWS)
    drive[layout.MOTION] = np.inf
    return RegimeEngine(
        regime, aside, aside, drive, law, np.zeros((3, 0)), nowhere, nowhere.copy(), np.zeros(2), np.array(omega),
        omega**2, np.array(damper), np.array(np.diag(damper)), load, static, np.zeros((14, 12)), np.zeros((2, 13)),
        np.zeros((13, 2 * m)), np.zeros((3, 2 * m)),
    )  # fmt: skip
