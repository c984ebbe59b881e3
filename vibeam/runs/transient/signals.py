"""Signals of a record's case: its outputs, the velocities and accelerations of displacements, the contact force."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import quantity_of, units_of_output
from vibeam.flight.equilibrium import Contacts
from vibeam.system.rows import TimeDerivative
from vibeam_models.arrays import Array, Flags, Index
from vibeam_models.outputs import DISPLACEMENT

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.observe.motion import Path
    from vibeam.system.impact_system import ImpactSystem

FORCE = "contact_force"
RATES = ("", "velocity", "acceleration")


@dataclass(frozen=True)
class TransientSignal:
    """TransientSignal over time: the ``order``-th time derivative of an ``output``; ``unit`` as results files have it.

    The contact force, whose output is "contact" and whose ``order`` is −1, is the largest of all contacts.
    """

    name: str
    output: str
    order: int
    unit: str

    @property
    def long_name(self) -> str:
        """Meaning in words."""
        if self.order < 0:
            return "largest contact force"
        return f"{RATES[self.order]} of {self.output}".removeprefix(" of ")


def signals_of(case: Case, system: ImpactSystem, outputs: Sequence[str]) -> Iterator[TransientSignal]:
    """Signals of ``outputs`` in one fidelity; KeyError for an output that its system does not have."""
    for name in outputs:
        system.derivative(name)
        units = units_of_output(case, name)
        yield TransientSignal(name, name, 0, units.output)
        if quantity_of(case, name) is DISPLACEMENT:
            for order in (1, 2):
                per = units.rate if order == 1 else ("s-2" if units.length == "1" else "m s-2")
                yield TransientSignal(f"{name}_{RATES[order]}", name, order, per)
    if any(law.yields for law in Contacts.of(system).laws):
        yield TransientSignal(FORCE, "contact", -1, "N" if case.scene.natural_unit is None else "1")


def with_signals(system: ImpactSystem, signals: Sequence[TransientSignal]) -> ImpactSystem:
    """The system with its velocities and accelerations among the signals as outputs of their own."""
    made = {s.name: TimeDerivative(system.output(s.output), s.order) for s in signals if s.order > 0}
    return replace(system, derivatives={**system.derivatives, **made})


def values_at(path: Path, record: Any, signals: Sequence[TransientSignal], times: Array, poses: Array) -> Array:
    """Values (m, o) of the signals at ``times`` (m,) of a motion under ``record``, its modes at ``poses`` (m, 2, n)."""
    system, made = path.system, []
    derivatives = {each.name: each for each in signals if each.name in system.derivatives}
    second = any(system.derivatives[name].order > 1 for name in derivatives)
    motions = [poses[:, 0], poses[:, 1], accelerations(path, record, times, poses) if second else poses[:, 1]]
    for each in signals:
        if each.order < 0:
            made.append(contact_forces(Contacts.of(system), poses)[0].max(axis=1))
        elif each.name not in derivatives:
            made.append(motions[0] @ system.output(each.output))
        else:
            read = system.derivatives[each.name]
            base = read.base * record.at(times) if read.base else 0.0
            made.append(motions[read.order] @ read.row + base)
    return np.stack(made, axis=1)


def accelerations(path: Path, record: Any, times: Array, poses: Array) -> Array:
    """Modal accelerations (m, n) by the equations of motion, the forces of contacts that push or hold among them."""
    system, contacts = path.system, Contacts.of(path.system)
    found = np.outer(record.load_at(times), system.load) + system.static
    found -= damping_force(system, poses[:, 1]) + system.omega**2 * poses[:, 0]
    if any(law.yields for law in contacts.laws):
        found -= contact_forces(contacts, poses)[0] @ contacts.rows
    for number, row in enumerate(contacts.rows):
        held = within(path.rests if system.further is None else path.holds(number), times)  # type: ignore[attr-defined]
        if held.any() and not (system.further is None and number):
            found[held] -= np.outer(found[held] @ row / (row @ row), row)
    return np.asarray(found)


def damping_force(system: ImpactSystem, rates: Array) -> Array:
    """Modal damping forces (m, n) at modal velocities (m, n)."""
    if system.coupling is not None:
        return np.asarray(rates @ system.coupling)
    return np.asarray(2 * system.zeta * system.omega * rates)


def within(intervals: Array, times: Array) -> Flags:
    """Times that lie within one of the intervals (m, 2), in ascending order."""
    if not len(intervals):
        return np.zeros(len(times), dtype=bool)
    last = np.searchsorted(intervals[:, 0], times, side="right") - 1
    return np.asarray((last >= 0) & (times < intervals[np.maximum(last, 0), 1]))


def share_in_contact(path: Path) -> float:
    """Share of a motion's time in which a rigid stop holds, or a yielding one is pushed."""
    spans = np.concatenate([path.rests, pushes_of(path)])
    begin, end = spans[np.argsort(spans[:, 0])].T
    before = np.concatenate([[path.t_start], np.maximum.accumulate(end)])[:-1]  # spans of several stops overlap
    return float(np.sum(np.maximum(end - np.maximum(begin, before), 0.0))) / (path.t_end - path.t_start)


def pushes_of(path: Path) -> Array:
    """Begins and ends (k, 2), s, of a motion's contacts with stops that yield."""
    return np.cumsum(np.reshape(getattr(path, "contacts", ()), (-1, 3))[:, :2], axis=1)


def contacts_struck(path: Path) -> Index:
    """Numbers of the contacts that the impacts of a motion strike, 0: the first stop."""
    known = getattr(path, "impact_contacts", None)
    return np.zeros(len(path.impact_times), dtype=np.int64) if known is None else np.asarray(known)


def contact_forces(contacts: Contacts, poses: Array) -> tuple[Array, Array]:
    """Forces (m, k), N, of contacts that yield, which only push, and the rates of their penetrations, m/s."""
    depth, rate = poses[:, 0] @ contacts.rows.T - contacts.gaps, poses[:, 1] @ contacts.rows.T
    force = np.zeros_like(depth)
    for number, law in enumerate(contacts.laws):
        inside = depth[:, number] > 0
        if law.yields and inside.any():
            force[inside, number] = np.maximum(law.force(depth[inside, number], rate[inside, number]), 0.0)
    return force, rate
