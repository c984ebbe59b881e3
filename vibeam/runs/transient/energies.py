"""Energy of a motion under a record: work of the load, lost by damping and to the stop, left at the end, by mode.

Energies are of the motion relative to the base: ½η'² + ½ω²(η − η₀)² of each mode, η₀ its static deflection. Damping and
work are integrated by Gauss' rule between all events and knots of the record; what impacts take follows from their
velocities, ½(1 − R²)v²/S. What the modes lose to the stop follows from the other terms, mode by mode: that its sum is
what the impacts took is the check.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.flight.equilibrium import Contacts
from vibeam.flight.kernels.layout import START
from vibeam.observe.motion import poles_of
from vibeam.runs.transient.signals import contact_forces, contacts_struck, damping_force, pushes_of, within
from vibeam.system.record_pieces import blocks
from vibeam_models.arrays import Array, Index

if TYPE_CHECKING:
    from vibeam.observe.motion import Path
    from vibeam.system.impact_system import ImpactSystem

NODES, FINE = (2, 4, 6), (5, 8, 12)  # Gauss nodes of an interval; of a motion that has few intervals
MANY = 20_000  # intervals from which on nodes are spared
#: angle that the fastest live exponential of an interval may turn there; damping is then known to 1e-5, finely to 1e-8
TURNS = np.array([1.0, 2.5, 6.0])
DEAD = 10.0  # decay after which an exponential counts no more: 2e-9 of the energy that it was born with
LIGHT = 1e-3  # share of the hardest impact below which one excites no mode that counts
KNOTS = 1 << 16  # of the record at once


@dataclass(frozen=True, eq=False)
class EnergyBalance:
    """Energies (n,) of the modes, J: at the begin and the end, ``work`` of the load, lost by ``damping``.

    ``lost``: to the stop, which also hands energy from mode to mode: an entry may be negative, their sum not.
    ``residual``: what the sum of ``lost`` differs by from the loss at each impact, as a share of the largest term.
    """

    start: Array
    work: Array
    damping: Array
    lost: Array
    left: Array
    residual: float


def energy_balance(path: Path, record: Any) -> EnergyBalance:
    """Energy balance of a motion under ``record``."""
    system, contacts = path.system, Contacts.of(path.system)
    yields = any(law.yields for law in contacts.laws)
    work, damping, to_stop = np.zeros(system.size), np.zeros(system.size), _at_impacts(path, contacts)
    for times, weights in _nodes(path, record):
        poses = path.modes_at(times)
        rates = poses[:, 1]
        work += (weights * record.load_at(times)) @ rates
        damping += weights @ (rates * damping_force(system, rates))
        if yields:
            to_stop += float(weights @ np.sum(np.prod(contact_forces(contacts, poses), axis=0), axis=1))
    work *= system.load
    start, left = (_energy(system, path.modes_at(t)) for t in (path.t_start, path.t_end))
    lost = start + work - damping - left
    scale = max(float(np.sum(start)), abs(float(np.sum(work))), float(np.sum(damping)), float(np.sum(left)), to_stop)
    residual = abs(float(np.sum(lost)) - to_stop) / scale if scale > 0 else 0.0
    if not (len(path.impact_times) or len(path.rests) or len(pushes_of(path))):  # the stop is never touched
        lost = np.zeros_like(lost)  # it is round-off, which the residual says
    return EnergyBalance(start, work, damping, lost, left, residual)


def _energy(system: ImpactSystem, pose: Array) -> Array:
    stiff = system.omega > 0
    rest = np.divide(system.static, system.omega**2, out=np.zeros(system.size), where=stiff)
    held = np.where(stiff, (system.omega * (pose[0] - rest)) ** 2 / 2, -system.static * pose[0])
    return np.asarray(pose[1] ** 2 / 2 + held)


def _at_impacts(path: Path, contacts: Contacts) -> float:
    """Energy that all impacts on rigid stops take, J."""
    speeds, struck, total = path.impact_velocities, contacts_struck(path), 0.0
    for number, (row, law) in enumerate(zip(contacts.rows, contacts.laws, strict=True)):
        own = speeds[struck == number]
        if not law.yields and len(own):
            total += float(np.sum(own**2 - law.rebound(own) ** 2)) / (2 * float(row @ row))
    return total


def _nodes(path: Path, record: Any) -> Iterator[tuple[Array, Array]]:
    """Nodes and weights in order, in blocks: of the intervals between events and knots, split where modes turn fast."""
    first, last = np.searchsorted(record.times, [path.t_start, path.t_end])
    borders = [path.t_start, *record.times[first + KNOTS : last : KNOTS].tolist(), path.t_end]
    marks, events = _marks(path)
    for ends in pairwise(borders):
        knots = [each[slice(*np.searchsorted(each, ends))] for each in (marks, record.times)]
        edges = np.unique(np.concatenate([*knots, ends]))
        times, weights = _nodes_between(path, edges, events, few=len(borders) == 2)
        yield from ((times[part], weights[part]) for part in blocks(len(times)))


def _nodes_between(path: Path, edges: Array, events: Array, few: bool) -> tuple[Array, Array]:
    """Nodes and weights of the intervals between ``edges``; ``few``: those are all that there are."""
    width = np.diff(edges)
    since = edges[:-1] - events[np.searchsorted(events, edges[:-1], side="right") - 1]
    pushed = within(pushes_of(path), (edges[1:] + edges[:-1]) / 2)
    turn = np.where(pushed, TURNS[-1], width * _live_rate(path.system, since))
    parts = np.maximum(1, np.ceil(turn / TURNS[-1])).astype(int)
    kinds = np.minimum(np.searchsorted(TURNS, turn), len(TURNS) - 1)
    rules = FINE if few and parts.sum() < MANY else NODES
    found = [
        _rule(nodes, edges[:-1][kinds == at], width[kinds == at], parts[kinds == at]) for at, nodes in enumerate(rules)
    ]
    times, weights = (np.concatenate(each) for each in zip(*found, strict=True))
    order = np.argsort(times)
    return np.clip(times[order], path.t_start, path.t_end), weights[order]


def _rule(nodes: int, low: Array, width: Array, parts: Index) -> tuple[Array, Array]:
    """Gauss' nodes and weights of intervals from ``low`` on, each in so many ``parts``."""
    x, w = np.polynomial.legendre.leggauss(nodes)
    first = np.cumsum(parts) - parts
    low, half, first = (np.repeat(each, parts) for each in (low, width / (2 * parts), first))
    middle = low + (2 * (np.arange(len(low)) - first) + 1) * half
    return (middle[:, None] + half[:, None] * x).ravel(), (half[:, None] * w).ravel()


def _marks(path: Path) -> tuple[Array, Array]:
    """Marks between which a motion is smooth but for its load; and the events alone after which all modes are live."""
    segments = getattr(path, "segments", None)
    speeds = path.impact_velocities
    hard = path.impact_times[speeds > LIGHT * np.max(speeds, initial=0.0)]
    events = np.concatenate([[path.t_start], hard, path.rests.ravel(), pushes_of(path)[:, 1]])
    further = np.empty(0) if segments is None else segments.trace[:, START]
    found = (events, np.concatenate([events, path.impact_times, further]))
    events, marks = (np.unique(np.clip(each, path.t_start, path.t_end)) for each in found)
    return marks, events


def _live_rate(system: ImpactSystem, since: Array) -> Array:
    """Rate (rad/s) of the fastest exponential that has not died out so long after an event."""
    poles = poles_of(system)
    poles = poles[np.isfinite(poles)]
    death = np.divide(DEAD, -poles.real, out=np.full(len(poles), np.inf), where=poles.real < 0)
    order = np.argsort(-death)
    fastest = np.maximum.accumulate(np.abs(poles[order]))
    live = np.searchsorted(-death[order], -since, side="left")
    return np.asarray(np.concatenate([[0.0], fastest])[live])
