"""Tangent maps of every law against differences of flights in 24 digits, determinants, and Hamilton's equations."""

from __future__ import annotations

from dataclasses import replace

import events
import mpmath
import numpy as np
import pytest
from yielding import Yielding, flown, tangent

import vibeam
from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.flight.event_driven import EventDrivenSolver, Segments
from vibeam.flight.solver import exact_solver
from vibeam.system.state import State
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

TWO = vibeam.ImpactSystem.from_modes([1.0, 2.6], [0.02, 0.05], [1.0, 0.6], [1.0, 0.3], gap=0.3)
COUPLED = np.array([[0.05, 0.02], [0.02, 0.3]])
DRIVE = vibeam.Drive(2.9, 1.0)
START, SPAN = [0.1, -0.05, 0.8, 0.3], 4.0
START_BELOW = [-0.1, -0.05, 0.8, 0.3]
SYSTEMS = {
    "linear": replace(TWO, law=LinearStop(400.0)),
    "linear, damped": replace(TWO, law=LinearStop(400.0, 6.0)),
    "linear, damped, two stops, coupled": replace(
        TWO, law=LinearStop(300.0, 2.0), second_gap=0.5, coupling=COUPLED, static=np.array([0.3, -0.1])
    ),
    "Hertz": replace(TWO, law=Hertz(400.0)),
    "Hunt-Crossley": replace(TWO, law=HuntCrossley(300.0, 0.2)),
    "Hunt-Crossley, two stops, coupled": replace(
        TWO, law=HuntCrossley(300.0, 0.4, 1.3), second_gap=0.5, coupling=COUPLED
    ),
}


def independent(system: vibeam.ImpactSystem) -> Yielding:
    damper = np.diag(2 * system.zeta * system.omega) if system.coupling is None else system.coupling
    gaps = [system.gap] if system.second_gap is None else [system.gap, system.second_gap]
    rows = [each.tolist() for each in (system.omega, damper, system.contact, system.load, system.static)]
    law = system.law
    if isinstance(law, LinearStop):
        return Yielding(*rows, gaps, law.stiffness, damping=law.damping)
    assert isinstance(law, HuntCrossley)
    return Yielding(*rows, gaps, law.stiffness, law.exponent, law.damping)


def motion(system: vibeam.ImpactSystem, drive: vibeam.Drive, start: list[float], span: float) -> tuple[Segments, State]:
    n, solver = system.size, exact_solver(system, drive.omega)
    assert isinstance(solver, EventDrivenSolver)
    _, _, last, segments, _ = solver.simulate(drive, State(np.array(start[:n]), np.array(start[n:])), 0.0, span, 1000)
    return segments, last


def mapped(system: vibeam.ImpactSystem, drive: vibeam.Drive, start: list[float], span: float) -> np.ndarray:
    segments, last = motion(system, drive, start, span)
    return TangentMaps(system, drive, segments, last).product()


@pytest.mark.parametrize("name", SYSTEMS)
def test_maps_are_the_differences_of_flights_in_24_digits(name: str) -> None:
    """Contact is integrated to 1e-12 a step, which leaves the map 4e-11 at most."""
    system, drive = SYSTEMS[name], (DRIVE.omega, DRIVE.amplitude)
    end, touches = flown(independent(system), drive, START, 0.0, SPAN, 24)
    segments, last = motion(system, DRIVE, START, SPAN)
    assert touches >= (4 if system.second_gap is not None else 1)
    reached = np.concatenate([last.displacement, last.velocity])
    np.testing.assert_allclose([float(each) for each in end], reached, rtol=0, atol=1e-10)
    want = tangent(independent(system), drive, START, 0.0, SPAN, 24)
    found = TangentMaps(system, DRIVE, segments, last).product()
    np.testing.assert_allclose(found, want, rtol=0, atol=4e-11 * np.abs(want).max())


@pytest.mark.parametrize("law", [LinearStop(400.0), Hertz(400.0), Hertz(90.0, 2.2)])
@pytest.mark.parametrize("coupling", [None, COUPLED])
def test_without_loss_in_contact_the_determinant_is_liouville_s(law: object, coupling: np.ndarray | None) -> None:
    system = replace(TWO, law=law, coupling=coupling, second_gap=0.6)
    trace = float(np.trace(COUPLED)) if coupling is not None else float(np.sum(2 * TWO.zeta * TWO.omega))
    found = mapped(system, DRIVE, START, 9.0)
    wanted = np.exp(-9.0 * trace)  # a difference of products that are 10³ times as large
    assert np.linalg.det(found) == pytest.approx(wanted, rel=1e-9)


def test_without_any_damping_a_hertzian_stop_makes_a_symplectic_map() -> None:
    """MᵀJM = J: every plane's area is kept, not the volume alone."""
    for system in (replace(TWO, law=Hertz(400.0)), replace(TWO, law=Hertz(50.0), second_gap=0.2)):
        found = mapped(replace(system, zeta=np.zeros(2)), DRIVE, START, 8.0)
        turn = np.kron([[0.0, 1.0], [-1.0, 0.0]], np.eye(2))
        np.testing.assert_allclose(found.T @ turn @ found, turn, rtol=0, atol=1e-10 * np.abs(found).max() ** 2)


def test_factors_of_a_long_contact_are_its_map() -> None:
    """A soft stop that is pressed all the time: one contact in many parts."""
    system = replace(TWO, law=Hertz(3.0), static=np.array([9.0, 0.0]))
    segments, last = motion(system, DRIVE, [2.5, 0.0, 0.0, 0.0], 30.0)
    maps = TangentMaps(system, DRIVE, segments, last)
    whole = maps.product()
    found, count = np.eye(4), 0
    for i in range(len(maps)):
        for matrix in maps.steps(i, maps.fastest, 0.01):
            found, count = matrix @ found, count + 1
    assert count > 2 * len(maps)
    np.testing.assert_allclose(found, whole, rtol=0, atol=1e-10 * np.abs(whole).max())


PRESSED = replace(TWO, gap=0.0, restitution=0.3, static=np.array([1.5, 0.0]))


PLASTIC = replace(PRESSED, restitution=0.0, zeta=np.array([0.05, 0.3]))


@pytest.mark.parametrize(
    "system", [replace(TWO, restitution=0.7), PRESSED, PLASTIC], ids=["impacts", "chatter and rests", "plastic"]
)
def test_maps_of_a_hard_stop_are_differences_of_flights_in_35_digits(system: vibeam.ImpactSystem) -> None:
    """Through rests the map leaves out the second order of the last velocity of an accumulation."""
    modes = events.Modes(*(each.tolist() for each in (system.omega, system.zeta, system.contact, system.load)),
                         system.gap, system.restitution, system.static.tolist())  # fmt: skip
    columns, small, span = [], mpmath.mpf(10) ** -12, 7.0
    with mpmath.workdps(40):
        for k in range(4):
            ends = []
            for way in (1, -1):
                start = [mpmath.mpf(x) + (way * small if i == k else 0) for i, x in enumerate(START_BELOW)]
                under_way = events.Motion(modes, events.Drive(1.3, 2.0), events.State(start[:2], start[2:]), digits=35)
                under_way.run(t_end=span)
                ends.append([*under_way.state().displacement, *under_way.state().velocity])
            columns.append([float((a - b) / (2 * small)) for a, b in zip(*ends, strict=True)])
    want = np.array(columns).T
    found = mapped(system, vibeam.Drive(1.3, 2.0), START_BELOW, span)
    np.testing.assert_allclose(found, want, rtol=0, atol=1e-10 * np.abs(want).max())
