"""Tangent maps of motions with several contacts: against differences of flights, and those of one contact."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.flight.contacts.solver import ContactsSolver
from vibeam.flight.disturbance.maps import maps_of
from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.flight.event_driven import Segments
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.contacts.layout import HELD_AT, PUSHED_AT
from vibeam.flight.readout import struck
from vibeam.flight.solver import exact_solver
from vibeam.system.state import State
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.restitution import TableRestitution

Flown = tuple[Segments, State]
BEGIN, SPAN = 0.15, 0.1


def rig(seed: int, **law: Any) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
    """Two to four modes, two or three contacts; a static force presses the second one, whose law may be given."""
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(2, 5)), int(rng.integers(2, 4))
    omega, zeta = np.sort(rng.uniform(30, 200, n)), rng.uniform(0.005, 0.3, n)
    rows, gaps = rng.uniform(-1, 1, (k, n)), rng.uniform(0, 1e-4, k)
    static, coefficients = rows[1] * rng.uniform(1.0, 6.0), rng.uniform(0, 0.8, k)
    coefficients[0] = 0.6
    share = rng.uniform(-1, 1, (n, n))
    further = [vibeam.Contact(rows[j], gaps[j], coefficients[j]) for j in range(1, k)]
    further[0] = replace(further[0], **law)
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, rows[0], rng.uniform(0.3, 1, n), gap=gaps[0], restitution=0.6, static=static, further=further,
        coupling=share @ share.T if seed % 3 == 0 else None,
    )  # fmt: skip
    return system, vibeam.Drive(rng.uniform(30, 120), 3e-4)


def flown(system: vibeam.ImpactSystem, drive: vibeam.Drive, start: np.ndarray, begin: float, span: float) -> Flown:
    n, solver = system.size, exact_solver(system, drive.omega)
    assert isinstance(solver, ContactsSolver)
    state = State(start[:n], start[n:])
    _, _, last, segments, _ = solver.simulate(drive, state, begin, begin + span, 10_000)
    return segments, last


def values(state: State) -> np.ndarray:
    return np.concatenate([state.displacement, state.velocity])


def judge(system: vibeam.ImpactSystem, drive: vibeam.Drive) -> Segments:
    """Hold the map to differences of flights, Richardson's two of 2e-5 and 4e-5 of the motion's size, to 5e-8."""
    n = system.size
    away = np.concatenate(
        [-1e-3 * np.sum([system.contact, *(c.row for c in system.further or ())], axis=0), 0 * system.omega]
    )
    _, state = flown(system, drive, away, 0.0, BEGIN)
    assert not state.resting
    start, units = values(state), np.concatenate([system.omega, np.ones(n)])
    segments, last = flown(system, drive, start, BEGIN, SPAN)
    found = maps_of(system, drive, segments, last).product() * (units[:, None] / units)
    small, columns = 1e-5 * float(np.max(np.abs(start * units))), []
    for unit in np.eye(2 * n) / units:
        ends = {way: values(flown(system, drive, start + way * small * unit, BEGIN, SPAN)[1]) for way in (-2, -1, 1, 2)}
        columns.append((8 * (ends[1] - ends[-1]) - (ends[2] - ends[-2])) / (12 * small) * units)
    want = np.array(columns).T
    np.testing.assert_allclose(found, want, rtol=0, atol=5e-8 * np.abs(want).max())
    return segments


@pytest.mark.parametrize("seed", [1, 6, 37, 41, 53, 58])
def test_impacts_of_one_contact_while_another_is_held(seed: int) -> None:
    trace = judge(*rig(seed)).trace
    assert np.any((trace[:, HELD_AT] > 0) & struck(trace))


@pytest.mark.parametrize("law", [LinearStop(2e5, 20.0), LinearStop(3e5)])
def test_impacts_of_one_contact_while_a_linear_stop_pushes(law: LinearStop) -> None:
    for seed in (2, 8, 15, 19):
        trace = judge(*rig(seed, law=law)).trace
        assert np.any((trace[:, PUSHED_AT] > 0) & struck(trace))


def test_a_contact_of_another_law() -> None:
    for seed in (41, 58):
        judge(*rig(seed, law=TableRestitution((0.01, 0.05, 0.2), (0.6, 0.5, 0.3))))


@pytest.mark.parametrize(
    "law",
    [
        {"restitution": 0.7},
        {"law": TableRestitution((0.2, 1.0, 3.0), (0.9, 0.7, 0.5))},
        {"law": LinearStop(400.0, 6.0)},
    ],
)
def test_two_stops_at_one_place_are_those_of_one_contact(law: dict[str, Any]) -> None:
    """A second stop, and the same as a further contact: two engines, two sets of tangent maps, to 1e-11."""
    one = vibeam.ImpactSystem.from_modes(
        [1.0, 2.6, 7.1], [0.02, 0.05, 0.3], [1.0, 0.6, -0.4], [1.0, 0.3, 0.1], gap=0.3, second_gap=0.5, **law
    )
    more = replace(one, second_gap=None, further=(vibeam.Contact(-one.contact, 0.5, one.restitution, one.law),))
    drive, start = vibeam.Drive(2.9, 1.0), np.array([0.1, 0.0, 0.0, 0.5, 0.2, 0.0])
    segments, last = flown(more, drive, start, 0.0, 20.0)
    found = maps_of(more, drive, segments, last)
    solver = exact_solver(one, drive.omega)
    assert not isinstance(solver, ContactsSolver)
    _, _, end, own, _ = solver.simulate(drive, State(start[:3], start[3:]), 0.0, 20.0, 10_000)
    want = TangentMaps(one, drive, own, end).product()
    assert struck(own.trace).sum() > 10
    np.testing.assert_allclose(found.product(), want, rtol=0, atol=1e-9 * np.abs(want).max())
    factors = np.eye(6)
    for i in range(len(found)):
        for matrix in found.steps(i, found.fastest, 0.5):
            factors = matrix @ factors
    np.testing.assert_allclose(factors, found.product(), rtol=0, atol=1e-9 * np.abs(found.product()).max())
    assert np.all(found.trace[:, layout.DURATION] >= 0)


def test_a_contact_that_is_held_loses_two_directions() -> None:
    system, drive = rig(41)
    segments = judge(system, drive)
    held = np.flatnonzero(segments.trace[:-1, HELD_AT] > 0)
    maps = maps_of(system, drive, segments, State(*segments.poses[-1]))
    before = int(held[0]) - 1
    assert maps.lost(before) == 2
    assert maps.kept(before).shape == (2 * system.size, 2 * system.size - 2)
    rows = [system.contact, *(each.row for each in system.further or ())]
    row = rows[int(np.log2(segments.trace[held[0], HELD_AT]))]
    moved = maps.over(before) @ np.eye(2 * system.size)
    np.testing.assert_allclose(row @ moved[: system.size], 0.0, atol=1e-9 * np.abs(moved).max())
