"""Acceleration of an output of a motion, as the base of equipment mounted there: cubics with jumps of velocity.

Between its events a motion is smooth; there its acceleration is interpolated at the four Chebyshev nodes of pieces,
which are halved until the cubic meets the acceleration at the ends and middles of its panels to ``WITHIN`` of its
largest value. Impacts make the velocity jump: the jump is what the integral of the cubics lacks to the exact change of
velocity.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from vibeam.flight.trajectory import Trajectory
from vibeam.observe.motion import smooth_stretches
from vibeam.observe.oscillators import Pieces
from vibeam.system.record import Record
from vibeam.system.rows import TimeDerivative
from vibeam_models.arrays import Array

WITHIN = 1e-6  # share of the largest acceleration by which the cubics may be off
TURN = 2.0  # angle through which the fastest mode turns in a piece at first
HALVINGS = 12
NODES = np.cos(np.pi * (2 * np.arange(4) + 1) / 8)[::-1] / 2 + 0.5  # of a piece as [0, 1]
TESTED = np.array([0.005, 0.3, 0.5, 0.7, 0.995])
FITTED = np.linalg.inv(np.vander(NODES, 4, increasing=True))
CALLED = "acceleration of the carried base"


def pieces_at(path: Trajectory, output: str) -> Pieces:
    """Absolute acceleration of an ``output`` along the whole motion; KeyError for an unknown one."""
    wanted = _acceleration(path, output)
    system = replace(path.system, derivatives={**path.system.derivatives, CALLED: wanted})
    return _fitted(replace(path, system=system), wanted)


def _acceleration(path: Trajectory, output: str) -> TimeDerivative:
    """Absolute acceleration of an output; an output that is one is taken as it is."""
    given = path.system.derivative(output)
    if given is not None and given.order == 2:
        return given
    row = path.system.output(output) if given is None else given.row
    drive: Any = path.drive
    carried = not isinstance(drive, Record) or drive.quantity == "acceleration"
    return TimeDerivative(row, 2, base=1.0 if carried else 0.0)


def _fitted(path: Trajectory, wanted: TimeDerivative) -> Pieces:
    events = _stretches(path)
    begin, width = _first_pieces(path, events)
    accepted: list[tuple[Array, Array, Array]] = []
    largest = 0.0
    for halving in range(HALVINGS + 1):
        values = path.at(begin[:, None] + width[:, None] * NODES, CALLED)
        tested = path.at(begin[:, None] + width[:, None] * TESTED, CALLED)
        largest = max(largest, float(np.abs(values).max(initial=0.0)))
        scaled = values @ FITTED.T
        off = np.abs(scaled @ np.vander(TESTED, 4, increasing=True).T - tested).max(axis=1)
        good = (off <= WITHIN * largest) | (halving == HALVINGS)
        accepted.append((begin[good], width[good], scaled[good]))
        begin, width = np.tile(begin[~good], 2), np.tile(width[~good] / 2, 2)
        begin[len(begin) // 2 :] += width[len(width) // 2 :]
        if not len(begin):
            break
    starts, widths, rows = (np.concatenate(parts) for parts in zip(*accepted, strict=True))
    order = np.argsort(starts)
    coefficients = rows[order] / widths[order, None] ** np.arange(4)
    times = np.append(starts[order], path.t_end)
    return Pieces(times, coefficients, _jumps(path, wanted, times, coefficients, events))


def _stretches(path: Trajectory) -> Array:
    """Intervals (m, 2) in which the acceleration is smooth: between events of the stops and knots of a record."""
    knots = path.drive.times if isinstance(path.drive, Record) else np.empty(0)
    ends = path.contacts[:, 0] + path.contacts[:, 1]
    events = np.concatenate(
        [smooth_stretches(path, path.t_start, path.t_end).ravel(), path.contacts[:, 0], ends, knots]
    )
    marks = np.unique(np.clip(events, path.t_start, path.t_end))
    return np.stack([marks[:-1], marks[1:]], axis=1)


def _first_pieces(path: Trajectory, events: Array) -> tuple[Array, Array]:
    """Begins and lengths of equal pieces of each smooth stretch."""
    fastest = max(float(path.system.omega.max()), 1 / (path.t_end - path.t_start))
    counts = np.maximum(1, np.ceil((events[:, 1] - events[:, 0]) * fastest / TURN)).astype(int)
    widths = np.repeat((events[:, 1] - events[:, 0]) / counts, counts)
    within = np.arange(len(widths)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.repeat(events[:, 0], counts) + within * widths, widths


def _jumps(path: Trajectory, wanted: TimeDerivative, times: Array, coefficients: Array, events: Array) -> Array:
    """Jumps (K,) of the output's velocity at the ends of pieces: exact changes less the integrals of the cubics."""
    lengths = np.diff(times)
    gained = np.cumsum((coefficients * lengths[:, None] ** np.arange(1, 5) / np.arange(1, 5)).sum(axis=1))
    ends = np.searchsorted(times, events[1:, 0])  # knots at events within
    knots = np.concatenate([[0], ends])
    speeds = path.modes_at(times[knots])[:, 1] @ wanted.row + wanted.base * _base_velocity(path.drive, times[knots])
    jumps = np.zeros(len(lengths))
    jumps[ends - 1] = np.diff(speeds) - np.diff(np.concatenate([[0.0], gained[ends - 1]]))
    return jumps


def _base_velocity(drive: Any, times: Array) -> Array:
    """Velocity of the base but for a constant, m/s."""
    if isinstance(drive, Record):
        return np.asarray(drive.velocity_at(times)) if drive.quantity == "acceleration" else np.zeros(len(times))
    return np.asarray(drive.amplitude * drive.omega * np.cos(drive.omega * times))
