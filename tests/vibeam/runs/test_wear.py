"""Wear, the stop's laws for a single degree of freedom, and a damper on a mass without a spring."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import free_mass
import numpy as np
import pytest
from stand_in import one_mode

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.system.response import Branches, FrequencyResponse
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution
from vibeam_models.structure import Structure

SYSTEM = vibeam.ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
GRID = np.array([1.8, 2.0, 2.2])
B = 0.5e-3
PLANS: dict[str, Any] = {"amplitude": B, "settle": 30, "hold": 10}
GRID_TEXT = '["1.8 rad/s", "2 rad/s", "2.2 rad/s"]'
SDOF = one_mode(GRID_TEXT, 30, 10, "[fidelity.one]", "SOLVER", gap=0.0, loss="STOP", direction="both")


def case(stop: str, solver: str = "") -> vibeam.Case:
    return parse(SDOF.replace("STOP", stop).replace("SOLVER", solver), "mine.toml")


def curve(**more: Any) -> FrequencyResponse:
    found = vibeam.sweep(SYSTEM, **(PLANS | {"omega": GRID} | more))
    assert isinstance(found, FrequencyResponse)
    return found


# wear


def by_hand(wear: float) -> list[float]:
    """Reach point by point: every impact flown is counted on the path, and the gap set anew."""
    state, struck, reach = None, 0, []
    for omega in (*GRID, *GRID[::-1]):
        worn = replace(SYSTEM, gap=wear * struck)
        point = vibeam.sweep(worn, omega=[omega], amplitude=B, settle=30, hold=10, state=state)
        assert isinstance(point, FrequencyResponse)
        path = vibeam.simulate(worn, vibeam.Drive(omega, B), 40 * 2 * np.pi / omega, state)
        struck, state = struck + len(path.impact_times), path.state
        reach.append(float(point.reach[0]))
    return reach


def test_each_point_has_the_gap_that_the_impacts_before_it_wore(tmp_path: Path) -> None:
    expected = by_hand(2e-6)
    found = vibeam.sweep(SYSTEM, omega=GRID, direction="both", wear=2e-6, **PLANS)
    assert isinstance(found, Branches)
    assert found.up is not None
    assert found.down is not None
    np.testing.assert_allclose([*found.up.reach, *found.down.reach], expected, rtol=1e-7)
    run = vibeam.run(case("restitution = 0.9\nwear = 2e-6"), out=tmp_path / "worn.h5")["one"]
    assert run.up is not None
    assert run.down is not None
    np.testing.assert_array_equal([*run.up.reach, *run.down.reach], [*found.up.reach, *found.down.reach])
    assert np.abs(found.down.reach[::-1] - found.up.reach).max() > 1e-5, "the bars above fail without wear"


def test_a_run_that_was_stopped_goes_on_with_what_was_worn(tmp_path: Path) -> None:
    worn, left = case("restitution = 0.9\nwear = 2e-6"), 4
    whole = vibeam.run(worn)["one"]

    def stop(done: int, total: int) -> None:
        if done == left:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        vibeam.run(worn, out=tmp_path / "half.h5", progress=stop)
    again = vibeam.run(worn, out=tmp_path / "half.h5")
    assert 0 < again.found < again.total
    for way, response in whole.items():
        np.testing.assert_array_equal(dict(again["one"].items())[way].reach, response.reach)


def test_without_wear_nothing_changes() -> None:
    np.testing.assert_array_equal(curve(wear=0.0).reach, curve(drift=lambda omega: 0 * omega).reach)
    assert "wear" not in case("restitution = 0.9").numbers
    assert np.all(curve(wear=1e-6).reach[1:] != curve().reach[1:])
    assert curve(wear=1e-6).reach[0] == curve().reach[0]


def test_wear_adds_to_drift() -> None:
    both = curve(wear=1e-6, drift=lambda omega: 1e-5 * omega)
    gap = 1e-5 * GRID[1] + 1e-6 * both.impacts[0]
    first = curve(omega=GRID[:1], drift=lambda omega: 1e-5 * omega)
    assert both.reach[0] == first.reach[0]
    alone = vibeam.sweep(replace(SYSTEM, gap=gap), omega=[GRID[1]], **(PLANS | {"settle": 600}))
    settled = curve(omega=GRID[:2], wear=1e-6, drift=lambda omega: 1e-5 * omega, settle=600)
    assert isinstance(alone, FrequencyResponse)
    gap_after = gap + 1e-6 * (settled.impacts[0] - both.impacts[0])
    there = vibeam.sweep(replace(SYSTEM, gap=gap_after), omega=[GRID[1]], **(PLANS | {"settle": 600}))
    assert isinstance(there, FrequencyResponse)
    assert settled.reach[1] == pytest.approx(there.reach[0], rel=1e-10)
    assert alone.reach[0] != pytest.approx(there.reach[0], rel=1e-6)


def test_a_fidelity_may_leave_wear_and_drift_out() -> None:
    stop = 'restitution = 0.9\nwear = 2e-6\ndrift_frequency = ["1.8 rad/s", "2.2 rad/s"]\ndrift = [0.0, 1e-4]'
    leaves = 'without = ["stop.wear", "stop.drift", "stop.drift_frequency"]'
    plain = vibeam.run(case("restitution = 0.9"))["one"].up
    bare = vibeam.run(case(stop, leaves))["one"].up
    drifts = vibeam.run(case(stop, 'without = ["stop.wear"]'))["one"].up
    assert plain is not None
    assert bare is not None
    assert drifts is not None
    np.testing.assert_array_equal(bare.reach, plain.reach)
    assert np.all(drifts.reach[1:] != plain.reach[1:])


def test_wear_that_makes_no_sense_is_refused() -> None:
    for wear in (-1e-6, np.inf):
        with pytest.raises(ValueError, match="wear"):
            curve(wear=wear)
    with pytest.raises(ValueError, match="solver 'orbit' counts no impacts"):
        curve(wear=1e-6, solver="orbit")


# a law for one degree of freedom


def test_every_law_goes_with_a_single_degree_of_freedom() -> None:
    def law(stop: str) -> object:
        return case(stop).system("one").law

    assert law("restitution = 0.8") is None
    assert law('law = "restitution"\nrestitution = 0.8') is None
    assert law('law = "linear"\nstiffness = 1e4\ndamping = 3.0') == LinearStop(1e4, 3.0)
    matched = law('law = "linear"\nstiffness = 1e4\nrestitution = 0.8')
    assert isinstance(matched, LinearStop)
    assert free_mass.restitution(matched, 1.0) == pytest.approx(0.8, rel=1e-12)
    assert law('law = "hertz"\nhertz_stiffness = 1e5') == HuntCrossley(1e5, 0.0, 1.5)
    hunt = law('law = "hunt-crossley"\nhertz_stiffness = 1e5\nrestitution = 0.7\nvelocity = 0.01')
    assert isinstance(hunt, HuntCrossley)
    assert free_mass.given_back(hunt, 0.01) == pytest.approx(0.7, rel=1e-12)
    assert law('law = "velocity restitution"\nrestitution = 0.6\nvelocity = 0.01') == PlasticRestitution(0.6, 0.01)
    table = law('law = "velocity restitution"\nspeeds = [0.001, 0.01]\nrestitutions = [0.8, 0.6]')
    assert table == TableRestitution((0.001, 0.01), (0.8, 0.6))
    assert case("restitution = 0.9\nsecond_gap = 0.02").system("one").second_gap == 0.02


def test_a_very_stiff_stop_is_its_restitution() -> None:
    stiff = vibeam.run(case('law = "linear"\nstiffness = 1e10\nrestitution = 0.8'))["one"].up
    hard = vibeam.run(case("restitution = 0.8"))["one"].up
    assert stiff is not None
    assert hard is not None
    np.testing.assert_allclose(stiff.reach, hard.reach, rtol=1e-3)


@pytest.mark.parametrize(
    ("stop", "solver", "said"),
    [
        ("", "", "stop.restitution: missing (speed after over speed before an impact): write restitution = "),
        ('law = "linear"\nrestitution = 0.7', "", "mass and penetration): write stiffness = 400"),
        ('law = "linear"\nstiffness = 1e4', "", "stop.damping: the loss of the linear stop is not said"),
        ('law = "hertz"\nhertz_stiffness = 1e4\nrestitution = 0.9', "", "stop.restitution: does not go with"),
        ("stiffness = 1e4", "", 'stop.stiffness: does not go with law = "restitution"'),
        ("restitution = 0.9\nsecond_gap = 0.0", "", "stop.second_gap: must be above −gap = 0, or"),
        ("restitution = 0.9\ndrift = [0.0]", "", "stop.drift_frequency: missing"),
        ("restitution = 0.9\nwear = -1", "", "stop.wear: -1 must be ≥ 0"),
        (
            "restitution = 0.9\nwear = 1e-6",
            'solver = "averaging"',
            "fidelity.one.solver: 'averaging' counts no impacts",
        ),
    ],
)
def test_faults_are_said_at_their_key(stop: str, solver: str, said: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(stop, solver)
    assert said in str(caught.value)


# a damper without a spring


def test_a_damper_on_a_mass_without_a_spring_slows_it_down() -> None:
    """m x″ + c x′ = 0: x = x₀ + v₀ (1 − e^{−ct/m}) m/c, and again from the stop with −R v."""
    one, mass, c, r = np.ones(1), 2.0, 0.6, 0.5
    structure = Structure(
        M=mass * np.eye(1), C=c * np.eye(1), K=np.zeros((1, 1)), load=0 * one, static=0 * one, contact=one
    )
    system = vibeam.ImpactSystem.from_structure(structure, gap=0.0, restitution=r)
    start = vibeam.State(np.array([-1.0]) * np.sqrt(mass), np.array([2.0]) * np.sqrt(mass))
    path = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 5.0, start)
    rate = c / mass
    at = -np.log(1 - rate * 1.0 / 2.0) / rate
    before = 2.0 - rate * 1.0
    assert path.impact_times == pytest.approx([at], rel=1e-13)
    assert path.impact_velocities == pytest.approx([before], rel=1e-13)
    there = -r * before * (1 - np.exp(-rate * (5.0 - at))) / rate
    assert path.at(5.0) == pytest.approx(there, rel=1e-12)


def test_a_mass_without_damper_stays_plain() -> None:
    structure = Structure(
        M=np.diag([1.0, 2.0]),
        C=np.diag([0.0, 0.5]),
        K=np.diag([0.0, 8.0]),
        load=np.zeros(2),
        static=np.zeros(2),
        contact=np.ones(2),
    )
    assert vibeam.ImpactSystem.from_structure(structure, gap=0.0).beyond_plain == ()
