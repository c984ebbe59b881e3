"""Work that would have no end, or none worth waiting for, is bounded, and the outcome says what it was."""

from __future__ import annotations

import numpy as np
import pytest

import vibeam
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

THROWN = vibeam.State(np.array([-1.0, 0.0]), np.array([0.0, 0.0]))


def bouncing(law: object, restitution: float = 1.0) -> vibeam.Trajectory:
    """Thrown off a hard stop against which it is pressed, undriven."""
    system = vibeam.ImpactSystem.from_modes(
        [1.0, 6.3], 0.02, [1.0, 0.5], [1.0, 0.2], gap=-0.3, restitution=restitution, law=law
    )
    return vibeam.simulate(system, vibeam.Drive(2.0, 0.0), 400.0, THROWN, max_impacts=50_000)


@pytest.mark.parametrize(
    "law",
    [
        None,
        ViscousRestitution(0.5, 1.0),
        ViscousRestitution(0.5, 2.0),
        PlasticRestitution(0.7, 1.0),
        TableRestitution((0.0, 1.0), (1.0, 0.5)),
        TableRestitution((0.1, 1.0), (1.0, 0.5)),
    ],
    ids=repr,
)
def test_a_chatter_without_end_is_called_one(law: object) -> None:
    path = bouncing(law)
    assert path.ended is vibeam.Ended.EVENT_LIMIT
    assert path.outcome is vibeam.Outcome.ENDLESS_CHATTER


def test_a_chatter_with_an_end_is_completed() -> None:
    """R = 1 − c v^b with b < 1: infinitely many impacts in a finite time."""
    path = bouncing(ViscousRestitution(0.5, 0.2))
    assert path.outcome is vibeam.Outcome.SETTLED_ON_STOP
    assert len(path.chatters) >= 1


def test_a_limit_met_by_ordinary_impacts_is_only_a_limit() -> None:
    system = vibeam.ImpactSystem.from_modes([1.0], 0.02, 1.0, 1.0, restitution=0.7)
    path = vibeam.simulate(system, vibeam.Drive(2.0, 1.0), 1e4, max_impacts=500)
    assert path.outcome is vibeam.Outcome.EVENT_LIMIT


def thirty(top: float, stiffness: float) -> vibeam.ImpactSystem:
    """Thirty modes with coupled damping between two Hunt–Crossley stops."""
    rng = np.random.default_rng(3)
    omega = np.geomspace(50.0, top, 30)
    own = 2 * 0.02 * omega
    drawn = rng.normal(size=(30, 30))
    coupling = np.diag(own) + 1e-3 * np.sqrt(np.outer(own, own)) * (drawn + drawn.T)
    coupling += np.eye(30) * max(0.0, -float(np.linalg.eigvalsh(coupling).min()))
    return vibeam.ImpactSystem.from_modes(
        omega, 0.0, rng.normal(size=30), rng.normal(size=30), gap=1e-5, second_gap=2e-5,
        law=HuntCrossley(stiffness, 0.5), coupling=coupling,
    )  # fmt: skip


@pytest.mark.parametrize(("top", "stiffness"), [(1e3, 1e7), (1e5, 1e9), (1e8, 1e12)])
def test_thirty_modes_between_two_stops(top: float, stiffness: float) -> None:
    path = vibeam.simulate(thirty(top, stiffness), vibeam.Drive(60.0, 1e-3), 0.2)
    assert path.ended in (vibeam.Ended.COMPLETE, vibeam.Ended.UNRESOLVED)
    assert path.ended is vibeam.Ended.COMPLETE or top == 1e8
    assert np.all(np.isfinite(path.segments.poses))


def test_a_long_pressed_contact_costs_no_more_than_a_short_one() -> None:
    """The largest force of a contact that lasts a billion drive periods, where nothing moves after the first few."""
    system = vibeam.ImpactSystem.from_modes([1.0, 6.3], 0.05, [1.0, 0.5], [1.0, 0.2], gap=-0.3, law=LinearStop(50.0))
    path = vibeam.simulate(system, vibeam.Drive(2.0, 1e-3), 1e9)
    assert path.ended is vibeam.Ended.COMPLETE
    assert path.stats["evaluations"] < 1000
    assert len(path.contacts) == 1


def stiff(static: np.ndarray | float, gap: float) -> vibeam.ImpactSystem:
    """Modes from 5 to 120 000 Hz, the stiff ones far overdamped, and a stop that lets nothing bounce."""
    omega = np.geomspace(30.0, 7.6e5, 12)
    return vibeam.ImpactSystem.from_modes(
        omega, np.minimum(6e-5 * omega, 50.0), SIGNS, np.geomspace(1.0, 0.1, 12), gap=gap, restitution=0.0,
        static=static,
    )  # fmt: skip


SIGNS = np.where(np.arange(12) % 2, -1.0, 1.0)


def test_a_start_that_is_nothing_against_the_drive_costs_no_more_than_none() -> None:
    """Stiff modes answer the drive at once: none is carried along for the sake of the start's digits."""
    system, drive = stiff(0.0, 9e-7), vibeam.Drive(27.0, 3.4e-6)
    tiny = vibeam.simulate(system, drive, 0.4, vibeam.State(np.zeros(12), -1e-14 * SIGNS))
    none = vibeam.simulate(system, drive, 0.4, vibeam.State(np.zeros(12), np.zeros(12)))
    assert tiny.ended is none.ended is vibeam.Ended.COMPLETE
    np.testing.assert_allclose(tiny.impact_times, none.impact_times, rtol=1e-6)
    assert tiny.stats["evaluations"] < 20 * none.stats["evaluations"]
    assert tiny.segments.size < 1e-14  # flown once, with the start's digits


@pytest.mark.parametrize("resting", [pytest.param(True, marks=pytest.mark.slow), False])
def test_a_load_set_on_at_rest_is_flown_to_the_end(resting: bool) -> None:
    """From nothing all static displacements are far, and carrying stiff modes there would take 10⁷ panels."""
    static = np.where(np.arange(12) % 3 == 0, 9.81, np.where(np.arange(12) % 3 == 1, -4.0, 0.0))
    system, drive = stiff(static, 0.0), vibeam.Drive(27.0, 0.0)
    path = vibeam.simulate(system, drive, 0.4, vibeam.State(np.zeros(12), np.zeros(12), resting))
    assert path.ended is vibeam.Ended.COMPLETE
    assert np.all(path.at(np.linspace(0, 0.4, 4000)) <= 1e-14)
