"""The regime of a set of contacts that are held, or pushed by linear stops: a linear system in what they leave free.

It is made in m ≥ 1 coordinates ξ, η = place + basis ξ, and given to the kernels in modes, with blocks that move nothing
in the place of those that are held: so all sets of a system have arrays of the same shapes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from vibeam.flight.equilibrium import Contacts, multipliers
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts import layout as contact_layout
from vibeam.flight.kernels.contacts.course import no_course, with_sets
from vibeam.flight.kernels.contacts.layout import ContactEngine, room_for
from vibeam.flight.kernels.layout import Regime
from vibeam.flight.linear.block_regime import SignalRow, derivative_signal, free_regime, lone_modes
from vibeam.flight.linear.eigenpairs import LinearSystem
from vibeam.flight.linear.regimes import runge_kutta
from vibeam_models.arrays import Array

COUPLES = 1e-13  # share of the damping of two held modes below which what couples them is round-off
FLAT = 1e-14  # share of the fastest held mode below which another has no stiffness
FIRST = 4  # sets for which there is room at first


@dataclass(frozen=True)
class ContactSet:
    """Contacts held, and contacts that push by linear laws: their numbers, in order."""

    held: tuple[int, ...]
    pushed: tuple[int, ...]

    @classmethod
    def of(cls, key: int, contacts: int) -> ContactSet:
        """The set with that key, see ``ContactEngine.sets``."""
        held, pushed = key % (1 << contacts), key >> contacts
        return cls(*(tuple(j for j in range(contacts) if bits >> j & 1) for bits in (held, pushed)))


class ConstrainedSystem:
    """The system of a set: η'' = static + load Ω²B sin φ − damper η' − stiffness η with its contacts held."""

    def __init__(self, contacts: Contacts, which: ContactSet) -> None:
        system, springs = contacts.system, contacts.springs
        self.contacts, self.held = contacts, which.held
        pushing = {j: spring for j in which.pushed if (spring := springs[j]) is not None}
        rows, gaps = contacts.rows[list(pushing)], contacts.gaps[list(pushing)]
        stiff = np.array([spring.stiffness for spring in pushing.values()])
        self.roots = np.concatenate([np.diag(system.omega), np.sqrt(stiff)[:, None] * rows])  # rootsᵀ roots: stiffness
        self.stiffness = np.diag(contacts.spring) + (rows.T * stiff) @ rows
        self.damper = contacts.damper + (rows.T * [spring.damping for spring in pushing.values()]) @ rows
        self.static = system.static + (stiff * gaps) @ rows
        self.basis, self.omega, self.place = self._coordinates()

    def _coordinates(self) -> tuple[Array, Array, Array]:
        """Modes (n, m) of the system held, without damping, their frequencies, and a place where it is held.

        At least one coordinate: where none is left free, one that moves nothing.
        """
        omega, n = self.contacts.system.omega, self.contacts.system.size
        rows, free, place = self.contacts.rows[list(self.held)], np.eye(n), np.zeros(n)
        if not len(rows) and len(self.roots) == n:
            return free, np.array(omega), place
        if len(rows):
            soft = rows * self.contacts.yields
            place = soft.T @ (np.linalg.pinv(soft @ rows.T, hermitian=True) @ self.contacts.gaps[list(self.held)])
            _, sizes, turned = np.linalg.svd(rows)
            free = turned[int(np.sum(sizes > 1e-10 * sizes[0])) :].T
        if not free.shape[1]:
            return np.zeros((n, 1)), np.ones(1), place
        _, size, turn = np.linalg.svd(self.roots @ free, full_matrices=True)
        size = np.concatenate([size, np.zeros(free.shape[1] - len(size))])
        return free @ turn.T, np.where(size > FLAT * max(size.max(), float(omega.max())), size, 0.0), place

    @cached_property
    def forces(self) -> list[SignalRow]:
        """Rows, on (η, η'), of the forces that press the held contacts, λ = G⁻¹ W (f − D η' − Λ η), in their order."""
        if not self.held:
            return []
        each, load = multipliers(self.contacts.rows[list(self.held)]), self.contacts.system.load
        return [
            SignalRow(-row @ self.stiffness, -row @ self.damper, float(row @ self.static), float(row @ load))
            for row in each
        ]

    def regime(self, top: int) -> Regime:
        """The regime in modes, of n blocks; its signals are still to be set."""
        basis, n = self.basis, self.contacts.system.size
        damper, static = _cleaned(basis.T @ self.damper @ basis), basis.T @ (self.static - self.stiffness @ self.place)
        linear = LinearSystem(self.omega**2, damper, np.ones(len(self.omega)))
        found = free_regime(linear, static, basis.T @ self.contacts.system.load, top)
        both, lacking = np.kron(np.eye(2), basis), n - basis.shape[1]
        into, outof = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n))
        into[2 * lacking :], outof[:, 2 * lacking :] = found.into @ both.T, both @ found.outof
        blocks = _padded(found.blocks, lacking)
        blocks[[layout.CONSTANT1, layout.CONSTANT2, layout.LOAD1, layout.LOAD2], :lacking] = 0.0
        blocks[layout.MODE] = lone_modes(outof)
        levels = found.levels.copy()
        pairs = _padded(found.pairs, lacking)
        levels[layout.COUNT] += lacking * (found.levels[layout.COUNT] > 0)
        return found._replace(
            pairs=pairs, table=_padded(found.table, lacking), levels=levels, blocks=blocks, into=into, outof=outof,
            held=self.place,
        )  # fmt: skip


def _padded(values: Array, lacking: int) -> Array:
    """Copies of the first, slowest block in front of the blocks (…, m)."""
    return np.ascontiguousarray(np.concatenate([np.repeat(values[..., :1], lacking, axis=-1), values], axis=-1))


def _cleaned(damper: Array) -> Array:
    """The damping matrix symmetric, and without what couples two modes by round-off."""
    size = np.sqrt(np.abs(np.diag(damper)))
    both = (damper + damper.T) / 2
    return np.where(np.abs(both) > COUPLES * np.outer(size, size), both, 0.0)


class ContactSets:
    """The kernels' arrays of one system in one thread, with the sets made so far."""

    def __init__(self, contacts: Contacts, slowest: float, top: int) -> None:
        self.contacts, self.top, self._made = contacts, top, dict[int, int]()
        self._output: tuple[Any, ...] | None = None
        self.engine = _empty(contacts, slowest)
        self.make(0)

    def __len__(self) -> int:
        return len(self._made)

    def make(self, key: int) -> None:
        """Make the set with that key, unless it is there."""
        if key in self._made:
            return
        slot = len(self._made)
        if slot == len(self.engine.sets):
            self._grow()
        which = ContactSet.of(key, len(self.contacts.gaps))
        system = ConstrainedSystem(self.contacts, which)
        found, engine = system.regime(self.top), self.engine
        for name in SLOTTED:
            getattr(engine, name)[slot] = getattr(found, name)
        engine.signals[slot] = 0.0
        for place, row in self._signals(system).items():
            engine.signals[slot, place] = _filled(engine, slot, row)
        engine.sets[slot], self._made[key] = key, slot
        if self._output is not None:
            engine.signals[slot, -1] = self.derivative(slot, *self._output)

    def _signals(self, system: ConstrainedSystem) -> dict[int, SignalRow]:
        """Gap of every contact, force of those that hold or that yield linearly."""
        contacts, count = self.contacts, len(self.contacts.gaps)
        still = np.zeros(contacts.system.size)
        found = {
            j: SignalRow(-row, still, float(gap))
            for j, (row, gap) in enumerate(zip(contacts.rows, contacts.gaps, strict=True))
        }
        for j, spring in enumerate(contacts.springs):
            if spring is not None:
                row, pressed = contacts.rows[j], -spring.stiffness * float(contacts.gaps[j])
                found[count + j] = SignalRow(spring.stiffness * row, spring.damping * row, pressed)
        return found | {count + j: row for j, row in zip(system.held, system.forces, strict=True)}

    def watch(self, row: Array, order: int = 0, base: float = 0.0) -> None:
        """Make row·η, row·η' or row·η'' + base·b̈ the output of every set, those to come too."""
        self._output = row, order, base
        for slot in self._made.values():
            self.engine.signals[slot, -1] = self.derivative(slot, *self._output)

    def derivative(self, slot: int, row: Array, order: int, base: float) -> Array:
        """The output that ``watch`` sets, as a signal: weights (2n,), constant, share of Ω²B sin φ."""
        engine = self.engine
        if order == 0:
            return _filled(engine, slot, SignalRow(row, np.zeros(len(row))))
        return derivative_signal(engine.blocks[slot], engine.outof[slot], row, order, base)

    def _grow(self) -> None:
        room = len(self.engine.sets)
        more = {}
        for name in ("sets", "coarsest", *SLOTTED, "signals"):
            old = getattr(self.engine, name)
            more[name] = np.concatenate([old, np.full_like(old, -1.0 if name == "sets" else 0.0)])
        self.engine = self.engine._replace(**more, course=with_sets(self.engine.course, 2 * room))
        assert len(self.engine.sets) == 2 * room


SLOTTED = ("pairs", "table", "levels", "blocks", "into", "outof", "held")  # of a regime, one for each set


def _filled(engine: ContactEngine, slot: int, row: SignalRow) -> Array:
    """A row on (η, η') as a signal of the set's blocks."""
    held, n = engine.held[slot], len(engine.omega)
    weights = row.at @ engine.outof[slot, :n] + row.rate @ engine.outof[slot, n:]
    return np.concatenate([weights, [row.constant + float(row.at @ held), row.load]])


def _empty(contacts: Contacts, slowest: float) -> ContactEngine:
    """The arrays with room for ``FIRST`` sets, and none."""
    system, rows = contacts.system, contacts.rows
    k, n = rows.shape
    numbers = np.zeros(contact_layout.NUMBERS)
    numbers[contact_layout.COUPLED], numbers[contact_layout.SLOWEST] = float(system.coupling is not None), slowest
    drive = np.zeros(layout.DRIVE_ROWS)
    drive[layout.MOTION] = inf
    laws, curves = contacts.kernel_laws()
    nodes, weights = runge_kutta(any(law.integrated for law in contacts.laws))
    soft = rows * contacts.yields
    return ContactEngine(
        sets=np.full(FIRST, -1.0), pairs=np.zeros((FIRST, layout.PAIR_ROWS, n)),
        table=np.zeros((FIRST, layout.TABLE_ROWS, layout.LEVELS, n)),
        levels=np.zeros((FIRST, layout.LEVEL_ROWS, layout.LEVELS)), blocks=np.zeros((FIRST, layout.BLOCK_ROWS, n)),
        into=np.zeros((FIRST, 2 * n, 2 * n)), outof=np.zeros((FIRST, 2 * n, 2 * n)), held=np.zeros((FIRST, n)),
        signals=np.zeros((FIRST, 2 * k + 1, 2 * n + 2)), coarsest=np.zeros(FIRST),
        signal=np.zeros(layout.SIGNAL_ROWS), attached=np.zeros((layout.ATTACHED_ROWS, n)),
        terms=np.zeros((2, 2 * n + 2, 2 + n)), drive=drive, rows=np.array(rows), gaps=np.array(contacts.gaps),
        laws=laws, curves=curves, gram=rows @ rows.T, soft=soft @ rows.T, yields=np.array(contacts.yields),
        omega=np.array(system.omega), spring=np.array(contacts.spring), damper=np.array(contacts.damper),
        damping=np.array(np.diag(contacts.damper)), load=np.array(system.load), static=np.array(system.static),
        numbers=numbers, nodes=nodes, weights=weights, course=no_course(), **room_for(k, n),
    )  # fmt: skip
