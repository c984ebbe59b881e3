"""Contacts in several places: against plain integration, closed forms, and what one contact gives."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bounded import Bound
from contact_loop import Rig

import vibeam
from vibeam.flight.contacts.solver import ContactsSolver
from vibeam.flight.equilibrium import equilibrium_on_contacts
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import ViscousRestitution

PLAIN: dict[str, Any] = {
    "omega": [50.0, 310.0, 900.0], "zeta": 0.02, "contact": [1.0, -0.8, 0.6], "load": [1.0, 0.5, 0.3],
    "gap": 1e-4, "restitution": 0.7,
}  # fmt: skip

DRIVE = vibeam.Drive(60.0, 1e-4)

G = 9.81


def made(further: list[vibeam.Contact] | None = None, **changes: Any) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(**{**PLAIN, **changes}, further=further)


def pair(rng: np.random.Generator, n: int, k: int, restitution: float | None, static: float) -> tuple[Any, Any, Any]:
    """The same rig for vibeam and for the plain integration."""
    omega, zeta = np.sort(rng.uniform(30, 200, n)), rng.uniform(0.005, 0.05, n)
    rows, gaps, load = rng.uniform(-1, 1, (k, n)), rng.uniform(0.5e-4, 3e-4, k), rng.uniform(0.3, 1, n)
    coefficients = rng.uniform(0.3, 0.9, k) if restitution is None else np.full(k, restitution)
    constant = rng.uniform(0, static, n) if static else np.zeros(n)
    drive = vibeam.Drive(rng.uniform(30, 120), 2e-4)
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, rows[0], load, gap=gaps[0], restitution=coefficients[0], static=constant,
        further=[vibeam.Contact(rows[j], gaps[j], coefficients[j]) for j in range(1, k)],
    )  # fmt: skip
    matrices = np.diag(omega**2), np.diag(2 * zeta * omega)
    strength = drive.omega**2 * drive.amplitude
    return system, drive, Rig(*matrices, load, constant, rows, gaps, coefficients, drive.omega, strength)


# Seeds with many impacts, rests on one and on two contacts (restitution 0.2 and 0: accumulations, sticking), releases.
@pytest.mark.parametrize(
    ("seed", "n", "k", "restitution", "static", "end"),
    [
        (0, 2, 2, None, 0.0, 0.5), (5, 2, 2, None, 0.0, 0.5), (1, 3, 3, None, 0.0, 0.3), (3, 3, 3, None, 0.0, 0.4),
        (1, 3, 2, 0.2, 3.0, 0.2), (4, 3, 2, 0.2, 3.0, 0.2), (1, 3, 2, 0.0, 3.0, 0.2), (2, 3, 2, 0.0, 3.0, 0.2),
    ],
)  # fmt: skip
def test_motions_agree_with_plain_integration(
    seed: int, n: int, k: int, restitution: float | None, static: float, end: float
) -> None:
    system, drive, rig = pair(np.random.default_rng(seed), n, k, restitution, static)
    still = vibeam.State(np.zeros(n), np.zeros(n))
    path = vibeam.simulate(system, drive, end, still)
    x, v = rig.run(np.zeros(n), np.zeros(n), end)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(rig.hits) > 2
    # The reference cuts accumulations off at 1e-6 m/s: compared are impacts before the first one, releases, the end.
    first = path.chatters[0, 0] - 1e-3 if len(path.chatters) else end
    early = [hit for hit in rig.hits if hit[0] < first]
    count = len(early)
    assert np.sum(path.impact_times < first) == count
    assert path.impact_times[:count] == pytest.approx([hit[0] for hit in early], abs=1e-10)
    assert path.impact_contacts[:count].tolist() == [hit[1] for hit in early]
    assert path.impact_velocities[:count] == pytest.approx([hit[2] for hit in early], rel=1e-8)
    ends = sorted(stop for j in range(k) for _, stop in path.holds(j) if stop < end)
    for time, contact in rig.releases:
        assert np.min(np.abs(np.array(ends) - time)) < 1e-7, (time, contact)
    assert path.state.displacement == pytest.approx(x, abs=1e-10 * np.abs(x).max() + 1e-13)
    assert path.state.velocity == pytest.approx(v, abs=1e-7 * np.abs(v).max())


def test_held_contacts_are_held_and_no_gap_is_entered() -> None:
    system, drive, _ = pair(np.random.default_rng(1), 3, 2, 0.2, 3.0)
    path = vibeam.simulate(system, drive, 1.0, vibeam.State(np.zeros(3), np.zeros(3)))
    times = np.linspace(0, 1, 20_001)
    gaps = path.gaps(times)
    assert gaps.shape == (20_001, 2)
    assert gaps.min() > -1e-15
    assert len(path.holds(0)) + len(path.holds(1)) > 0
    for j in range(2):
        for begin, end in path.holds(j):
            inside = (times > begin) & (times < end)
            assert np.all(np.abs(gaps[inside, j]) < 1e-15)
    assert len(path.rests) <= len(path.holds(0)) + len(path.holds(1))


def test_no_impact_adds_energy() -> None:
    for seed in range(4):
        system, drive, _ = pair(np.random.default_rng(seed), 3, 3, None, 0.0)
        path = vibeam.simulate(system, drive, 0.5, vibeam.State(np.zeros(3), np.zeros(3)))
        before, after = path.modes_at(path.impact_times - 1e-12), path.segments.poses[1:]
        ends = path.segments.trace[:-1, 0] + path.segments.trace[:-1, 1]
        kinetic = {time: float(pose[1] @ pose[1]) for time, pose in zip(ends, after, strict=True)}
        for time, pose in zip(path.impact_times, before, strict=True):
            last = kinetic[min(kinetic, key=lambda each, time=time: abs(each - time))]  # type: ignore[misc]
            assert last <= float(pose[1] @ pose[1]) * (1 + 1e-6)


def test_a_contact_out_of_reach_changes_nothing() -> None:
    alone, two = made(), made([vibeam.Contact([1.0, 0.3, -0.5], 1.0, 0.5)])
    first, second = vibeam.simulate(alone, DRIVE, 0.5), vibeam.simulate(two, DRIVE, 0.5)
    assert len(first.impact_times) > 5
    assert second.impact_times == pytest.approx(first.impact_times, abs=1e-13)
    assert set(second.impact_contacts.tolist()) == {0}


def test_a_contact_on_the_other_side_is_a_second_stop() -> None:
    other = vibeam.Contact(-np.array(PLAIN["contact"]), 2e-4, 0.7)
    first = vibeam.simulate(made(second_gap=2e-4), DRIVE, 0.5)
    second = vibeam.simulate(made([other]), DRIVE, 0.5)
    assert len(first.impact_times) > 10
    assert second.impact_times == pytest.approx(first.impact_times, abs=1e-12)
    third = vibeam.simulate(made([vibeam.Contact([1.0, 1.0, 1.0], 1.0)], second_gap=2e-4), DRIVE, 0.5)
    assert third.impact_times == pytest.approx(first.impact_times, abs=1e-12)
    assert set(third.impact_contacts.tolist()) == {0, 1}


def test_two_contacts_at_one_place_are_one() -> None:
    still = vibeam.State(np.zeros(3), np.zeros(3))
    soft: dict[str, Any] = {"static": [0.5, 0.0, 0.0], "restitution": 0.3, "gap": 1e-4}  # it comes to rest on the stop
    one = vibeam.simulate(made(**soft), DRIVE, 0.5, still)
    both = vibeam.simulate(made([vibeam.Contact(PLAIN["contact"], 1e-4, 0.3)], **soft), DRIVE, 0.5, still)
    assert len(one.rests) > 0
    assert both.impact_times[:5] == pytest.approx(one.impact_times[:5], abs=1e-12)
    assert both.rests == pytest.approx(one.rests, abs=1e-9)
    assert both.at(0.4321) == pytest.approx(one.at(0.4321), abs=1e-12)


def test_newtons_cradle() -> None:
    """Balls of 1, 2, 3 kg, the last two touching: each pair's elastic collision in turn, v' by momentum and energy."""
    root = 1 / np.sqrt([1.0, 2.0, 3.0])
    rows = [[root[0], -root[1], 0.0], [0.0, root[1], -root[2]]]
    system = vibeam.ImpactSystem.from_modes(
        [0, 0, 0], 0, rows[0], 0, gap=0.1, restitution=1.0, further=[vibeam.Contact(rows[1], 0.0)]
    )
    path = vibeam.simulate(system, vibeam.Drive(0, 0), 1.0, vibeam.State([0, 0, 0], [1 / root[0], 0, 0]))
    assert path.impact_contacts.tolist() == [0, 1]
    assert path.impact_times == pytest.approx([0.1, 0.1], rel=1e-14)
    assert path.state.velocity * root == pytest.approx([-1 / 3, -2 / 15, 8 / 15], rel=1e-13)


def bar(restitution: float, gap: float = 0.1) -> tuple[vibeam.ImpactSystem, float, float]:
    """A bar of 2 kg and length 1 m that falls flat, stops under both ends; modes: fall and turn, mass-normalised."""
    mass, half = 2.0, 0.5
    inertia = mass * half**2 / 3
    ends = [[1 / np.sqrt(mass), side * half / np.sqrt(inertia)] for side in (1, -1)]
    system = vibeam.ImpactSystem.from_modes(
        [0, 0], 0, ends[0], 0, gap=gap, restitution=restitution, static=[G * np.sqrt(mass), 0],
        further=[vibeam.Contact(ends[1], gap, restitution)],
    )  # fmt: skip
    return system, mass, inertia


def test_a_bar_lands_on_two_stops() -> None:
    """Each end has mobility 4/m and −2/m at the other: struck in turn from v, v with R = ½, by hand."""
    system, _, _ = bar(0.5)
    path = vibeam.simulate(system, vibeam.Drive(0, 0), 4.0, vibeam.State([0, 0], [0, 0]))
    v, (first, second) = np.sqrt(2 * G * 0.1), (1.0, 1.0)
    hits = []
    within = Bound()
    while within(max(first, second) > 0):
        if first >= second:
            hits.append((0, first))
            first, second = -first / 2, second + 3 / 4 * first
        else:
            hits.append((1, second))
            first, second = first + 3 / 4 * second, -second / 2
    at_once = path.impact_times < path.impact_times[0] + 1e-9
    assert path.impact_times[0] == pytest.approx(np.sqrt(0.2 / G), rel=1e-14)
    assert path.impact_contacts[at_once].tolist() == [contact for contact, _ in hits]
    assert path.impact_velocities[at_once] == pytest.approx([speed * v for _, speed in hits], rel=1e-12)
    speeds = path.modes_at(path.impact_times[0])[1] @ np.array([system.contact, system.further[0].row]).T
    assert speeds == pytest.approx([first * v, second * v], rel=1e-12)
    assert path.outcome is vibeam.Outcome.SETTLED_ON_STOP
    assert path.gaps(4.0) == pytest.approx([0, 0], abs=1e-16)
    assert path.holds(0)[-1, 1] == path.holds(1)[-1, 1] == 4.0


@pytest.mark.parametrize("restitution", [0.0, 0.2, 0.5, 0.8])
@pytest.mark.parametrize("tilt", [0.0, 0.02, -0.01])
def test_a_bar_comes_to_rest_on_both_stops_and_loses_energy(restitution: float, tilt: float) -> None:
    system, mass, inertia = bar(restitution)
    start = vibeam.State([0, tilt * np.sqrt(inertia)], [0, 0])
    path = vibeam.simulate(system, vibeam.Drive(0, 0), 4.0, start)
    energy = np.array([pose[1] @ pose[1] / 2 - G * np.sqrt(mass) * pose[0, 0] for pose in path.segments.poses])
    assert np.all(np.diff(energy) <= 1e-12)
    assert path.outcome is vibeam.Outcome.SETTLED_ON_STOP
    assert path.state.displacement == pytest.approx([0.1 * np.sqrt(mass), 0], abs=1e-14)


def test_two_contacts_that_accumulate_together_come_to_rest() -> None:
    """Each impact on one stop throws the other contact off its own: both accumulate at once, neither is lost."""
    rng, n = np.random.default_rng(3), 8
    rows = rng.uniform(0.5, 1, n), rng.uniform(0.5, 1, n) * (-1.0) ** np.arange(n)
    system = vibeam.ImpactSystem.from_modes(
        50.0 * np.arange(1, n + 1) ** 2, 0.02, rows[0], 1.0, gap=1e-4, restitution=0.7,
        further=[vibeam.Contact(rows[1], 2e-4, 0.7)],
    )  # fmt: skip
    path = vibeam.simulate(system, DRIVE, 0.25, max_impacts=5000)
    assert path.ended is vibeam.Ended.COMPLETE
    assert len(path.segments.trace) < 2 * path.stats["impacts"]
    assert len(path.chatters) > 5
    assert path.gaps(np.linspace(0, 0.25, 5001)).min() > -1e-16


def test_no_motion_of_random_systems_is_lost_or_goes_through_a_stop() -> None:
    for seed in range(60):
        rng = np.random.default_rng(seed)
        n, k = rng.integers(1, 7), rng.integers(2, 5)
        rows, gaps = rng.uniform(-1, 1, (k, n)), rng.uniform(0.2e-4, 3e-4, k)
        coefficients, static = rng.choice([0, 0.2, 0.5, 0.8], k), rng.uniform(-1, 1, n) * rng.choice([0, 3, 30])
        system = vibeam.ImpactSystem.from_modes(
            np.sort(rng.uniform(20, 2000, n)), 0.02, rows[0], rng.uniform(0.3, 1, n), gap=gaps[0],
            restitution=coefficients[0], static=static,
            further=[vibeam.Contact(rows[j], gaps[j], coefficients[j]) for j in range(1, k)],
        )  # fmt: skip
        path = vibeam.simulate(system, vibeam.Drive(rng.uniform(20, 200), 2e-4), 0.2, max_impacts=3000)
        assert path.ended is vibeam.Ended.COMPLETE, seed
        assert path.gaps(np.linspace(0, 0.2, 400)).min() > -1e-14, seed


def test_an_acceleration_is_the_rate_of_the_velocity_held_or_not() -> None:
    rate = vibeam.TimeDerivative([1.0, 0.5, -0.3], 2)
    system, drive, _ = pair(np.random.default_rng(1), 3, 2, 0.2, 3.0)
    path = vibeam.simulate(replace(system, derivatives={"a": rate}), drive, 0.2, vibeam.State(np.zeros(3), np.zeros(3)))
    trace = path.segments.trace[path.segments.trace[:, 1] > 1e-3]
    times = trace[:, 0] + trace[:, 1] / 2
    assert len(path.holds()) > 0
    step = 1e-6
    slope = (path.modes_at(times + step)[:, 1] - path.modes_at(times - step)[:, 1]) @ rate.row / (2 * step)
    assert path.at(times, "a") == pytest.approx(slope, rel=1e-6, abs=1e-6 * np.abs(slope).max())


def test_equilibrium_leans_on_both_stops() -> None:
    """Two masses on springs of 1 N/m drawn by 3 N and 2 N to stops at 1 m and 0.5 m, each on its own."""
    system = vibeam.ImpactSystem.from_modes(
        [1, 1], 0.1, [1, 0], 0, gap=1.0, static=[3, 2], further=[vibeam.Contact([0, 1], 0.5)]
    )
    path = vibeam.simulate(system, vibeam.Drive(0, 0), 1.0)
    assert path.state.displacement == pytest.approx([1.0, 0.5], rel=1e-14)
    assert path.state.resting
    assert path.holds(0).tolist() == path.holds(1).tolist() == [[0.0, 1.0]]
    narrow = replace(system, further=(vibeam.Contact([-1, 0], -2.0),))
    with pytest.raises(ValueError, match="nothing fits between the stops"):
        vibeam.simulate(narrow, vibeam.Drive(0, 0), 1.0)


def test_a_sweep_is_that_of_one_contact_where_the_others_are_out_of_reach() -> None:
    far = vibeam.Contact([1.0, 0.3, -0.5], 1.0, 0.5)
    omega, settings = [46.0, 95.0], {"amplitude": 1e-4, "settle": 300, "hold": 20}
    one, two = vibeam.sweep(made(), omega=omega, **settings), vibeam.sweep(made([far]), omega=omega, **settings)
    assert isinstance(one, vibeam.FrequencyResponse)
    assert isinstance(two, vibeam.FrequencyResponse)
    assert np.all(one.period > 0)
    for name in ("amplitude", "reach", "maximum", "minimum", "impacts_per_period", "impact_velocity", "period", "rest"):
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-10), name
    assert two.mode_energy == pytest.approx(one.mode_energy, rel=1e-9)


def test_refusals_are_one_clear_message() -> None:
    two = made([vibeam.Contact([1.0, 0.3, -0.5], 2e-4)])
    with pytest.raises(ValueError, match="solver 'direct' cannot take several contacts: the solver 'flight' can"):
        vibeam.sweep(two, omega=[60.0], amplitude=1e-4, solver="direct")
    with pytest.raises(ValueError, match="closed-form orbits cannot take several contacts"):
        vibeam.boundaries(two, DRIVE.amplitude, (0.9 * DRIVE.omega, DRIVE.omega))
    with pytest.raises(ValueError, match="one place of contact"):
        vibeam.simulate(made(), DRIVE, 0.1).holds()
    with pytest.raises(ValueError, match="row of a contact must be 3 finite numbers"):
        made([vibeam.Contact([1.0, 0.3], 2e-4)])
    with pytest.raises(ValueError, match=r"row: must be .*gap: .*restitution: "):
        vibeam.Contact([0.0, 0.0], np.nan, 1.5)


def test_none_is_no_contact() -> None:
    assert made([]).further is None
    assert made([]).beyond_plain == ()
    two = made([vibeam.Contact([1.0, 0.3, -0.5], 2e-4)])
    assert two.moves_as(made([vibeam.Contact([1.0, 0.3, -0.5], 2e-4)]))
    assert not two.moves_as(made([vibeam.Contact([1.0, 0.3, -0.5], 3e-4)]))
    assert "1 further contact" in repr(two)


STORED = json.loads(Path(__file__).with_name("several_contacts.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("stored", STORED, ids=[str(each["seed"]) for each in STORED])
def test_motions_are_those_of_the_loop_in_python_that_was_before(stored: dict[str, Any]) -> None:
    """2 to 8 contacts, accumulations, holds, releases; what is left is round-off of up to 275 impacts."""
    further = [vibeam.Contact(*each) for each in stored["further"]]
    system = vibeam.ImpactSystem.from_modes(**stored["system"], further=further)
    still = vibeam.State(np.zeros(system.size), np.zeros(system.size))
    path = vibeam.simulate(system, vibeam.Drive(stored["omega"], stored["amplitude"]), 0.05, still)
    assert (len(path.impact_times), len(path.holds())) == (stored["impacts"], stored["holds"])
    size = float(np.abs(stored["displacement"]).max())
    assert path.state.displacement == pytest.approx(stored["displacement"], rel=0, abs=1e-12 * size)
    assert path.state.velocity == pytest.approx(stored["velocity"], rel=0, abs=1e-12 * stored["speed"])


def test_sets_are_made_when_first_met_whatever_was_flown_before() -> None:
    system, drive, _ = pair(np.random.default_rng(1), 3, 2, 0.2, 3.0)
    still = vibeam.State(np.zeros(3), np.zeros(3))
    fresh = [vibeam.simulate(system, drive, end, still) for end in (0.2, 0.2)]
    solver = ContactsSolver(system, drive.omega)
    solver.simulate(drive, still, 0.0, 0.3, 1000)
    again = solver.simulate(drive, still, 0.0, 0.2, 1000)
    assert np.array_equal(fresh[0].segments.trace, fresh[1].segments.trace)
    assert np.array_equal(fresh[0].segments.trace[:, :2], again[3].trace[:, :2])


LAWS = [LinearStop(1e5), LinearStop(1e5, 3.0), LinearStop(1e4, 30.0), ViscousRestitution(0.1, 0.2)]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("second", [None, 2e-4])
def test_a_law_is_that_of_one_contact_where_the_others_are_out_of_reach(law: Any, second: float | None) -> None:
    alone = made(law=law, second_gap=second)
    drive, times = vibeam.Drive(60.0, 3e-4), np.linspace(0, 0.3, 50)
    first = vibeam.simulate(alone, drive, 0.3)
    far = vibeam.simulate(replace(alone, further=(vibeam.Contact([1.0, 0.3, -0.5], 1.0, 0.5),)), drive, 0.3)
    assert len(first.impact_times) > 2
    assert far.impact_times == pytest.approx(first.impact_times, abs=1e-13)
    assert far.modes_at(times) == pytest.approx(first.modes_at(times), abs=1e-11 * np.abs(first.modes_at(times)).max())
    assert far.contacts == pytest.approx(first.contacts, rel=1e-9)
    if second is not None:
        other = vibeam.Contact(-np.array(PLAIN["contact"]), second, law=law)
        both = vibeam.simulate(replace(alone, second_gap=None, further=(other,)), drive, 0.3)
        assert both.impact_times == pytest.approx(first.impact_times, abs=1e-13)


def test_a_sweep_among_linear_stops_is_that_of_two_on_one_row() -> None:
    law = LinearStop(1e5, 3.0)
    other = vibeam.Contact(-np.array(PLAIN["contact"]), 2e-4, law=law)
    settings = {"omega": [30.0, 120.0], "amplitude": 2e-4, "settle": 300, "hold": 20}
    one = vibeam.sweep(made(law=law, second_gap=2e-4), **settings)
    two = vibeam.sweep(made(law=law, further=[other]), **settings)
    assert isinstance(one, vibeam.FrequencyResponse)
    assert isinstance(two, vibeam.FrequencyResponse)
    for name in ("amplitude", "reach", "impacts_per_period", "impact_velocity", "period", "rest", "mode_energy"):
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-9), name


def test_a_rigid_stop_beside_a_linear_one_agrees_with_plain_integration() -> None:
    """Two modes: a linear stop with damping, and a rigid one elsewhere, R = 0.6; steps of 1e-6 s, Runge–Kutta."""
    rows, gaps, law = np.array([[1.0, -0.8], [-0.4, 0.9]]), [1e-4, 5e-5], LinearStop(2e5, 10.0)
    omega, zeta, load = np.array([50.0, 310.0]), 0.02, np.array([1.0, 0.5])
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, rows[0], load, gap=gaps[0], law=law, further=[vibeam.Contact(rows[1], gaps[1], 0.6)]
    )
    drive = vibeam.Drive(60.0, 4e-4)
    path = vibeam.simulate(system, drive, 0.0788)
    hits, _ = soft_and_hard(omega, zeta, load, rows, gaps, law, 0.6, drive, 0.0788)
    assert len(hits) > 3
    rigid = path.impact_contacts == 1
    assert np.any(~rigid)
    assert path.impact_times[rigid] == pytest.approx(hits, abs=1e-7)


def soft_and_hard(
    omega: Any, zeta: float, load: Any, rows: Any, gaps: Any, law: Any, restitution: float, drive: Any, end: float
) -> tuple[list[float], Any]:
    """Impacts on the second, rigid stop, and the last state, by Runge–Kutta steps cut at the rigid stop."""

    def rate(t: float, y: Any) -> Any:
        x, v = y
        deep, fast = rows[0] @ x - gaps[0], rows[0] @ v
        push = max(0.0, law.stiffness * deep + law.damping * fast) if deep > 0 else 0.0
        base = drive.omega**2 * drive.amplitude * np.sin(drive.omega * t)
        return np.array([v, load * base - 2 * zeta * omega * v - omega**2 * x - rows[0] * push])

    def step(t: float, y: Any, h: float) -> Any:
        a = rate(t, y)
        b = rate(t + h / 2, y + h / 2 * a)
        c = rate(t + h / 2, y + h / 2 * b)
        d = rate(t + h, y + h * c)
        return y + h / 6 * (a + 2 * b + 2 * c + d)

    hits, t, y, h = list[float](), 0.0, np.zeros((2, 2)), 2e-6
    within = Bound()
    while within(t < end):
        after = step(t, y, h)
        if rows[1] @ after[0] > gaps[1] and rows[1] @ after[1] > 0:
            low, high = 0.0, h
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (middle, high) if rows[1] @ step(t, y, middle)[0] < gaps[1] else (low, middle)
            y = step(t, y, low)
            t += low
            hits.append(t)
            y[1] -= rows[1] * (1 + restitution) * (rows[1] @ y[1]) / (rows[1] @ rows[1])
            continue
        t, y = t + h, after
    return hits, y


def test_an_equilibrium_that_is_not_found_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two of Hertz's stops, pressed: one step of Newton's method is not enough, all of them are."""
    further = [vibeam.Contact([1.0, 0.3, -0.5], 2e-4, law=HuntCrossley(1e8))]
    pressed = replace(made(further), law=HuntCrossley(1e9, 0.1), static=np.array([30.0, -20.0, 10.0]))
    assert np.isfinite(equilibrium_on_contacts(pressed).displacement).all()
    monkeypatch.setattr("vibeam.flight.equilibrium.ROUNDS", 1)
    with pytest.raises(ValueError, match="no static equilibrium among the stops that yield"):
        equilibrium_on_contacts(pressed)


def test_equilibrium_leans_on_a_rigid_and_a_linear_stop() -> None:
    """Springs of 1 N/m drawn by 3 N to a stop at 1 m, by 2 N into one of 3 N/m at 0.5 m: 2 = x + 3 (x − ½)."""
    system = vibeam.ImpactSystem.from_modes(
        [1, 1], 0.1, [1, 0], 0, gap=1.0, static=[3, 2], further=[vibeam.Contact([0, 1], 0.5, law=LinearStop(3.0))]
    )
    path = vibeam.simulate(system, vibeam.Drive(0, 0), 1.0)
    assert path.state.displacement == pytest.approx([1.0, 3.5 / 4], rel=1e-14)
    assert path.holds(0).tolist() == [[0.0, 1.0]]
    soft = replace(system, static=np.array([0.5, 2.0]))
    alone = vibeam.simulate(soft, vibeam.Drive(0, 0), 1.0)
    assert not len(alone.holds())
    assert alone.outcome is vibeam.Outcome.SETTLED_ON_STOP


def test_a_trajectory_is_pickled_and_read_anew() -> None:
    path = vibeam.simulate(made([vibeam.Contact([1.0, 0.3, -0.5], 2e-4)]), DRIVE, 0.3)
    times = np.linspace(0, 0.3, 50)
    assert np.array_equal(pickle.loads(pickle.dumps(path)).at(times), path.at(times))
