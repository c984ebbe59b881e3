"""Batches of points: shapes, starts, refusals, and the same numbers as sweeps of one frequency."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from refusals import other_answers

import vibeam
from vibeam.batches.response import READ
from vibeam.runs.parallel import run_parallel
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import ViscousRestitution

OWN = vibeam.ImpactSystem.from_modes(
    [1.0], 0.015, contact=[1.0], load=[1.0], gap=0.1, restitution=0.8, outputs={"twice": [2.0]}
)
BEAM = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0, 1790.0], 0.017, contact=[2.1, -0.6, 0.4], load=[0.46, 0.2, 0.1], gap=1e-4, restitution=0.72,
    outputs={"sensor": [1.5, 0.4, -0.2]}, derivatives={"speed": vibeam.TimeDerivative([1.5, 0.4, -0.2], 1)},
)  # fmt: skip
RATES = np.array([40.0, 60.0, 95.0, 130.0])


def assert_same(found: vibeam.BatchResponse, other: Any, at: Any = ()) -> None:
    for name in READ:
        if name != "cpu_seconds":
            assert np.array_equal(getattr(found, name)[at], getattr(other, name)[0], equal_nan=True), name


def test_points_are_those_of_sweeps_of_one_frequency() -> None:
    omega, gap = np.array([0.7, 1.2, 1.9]), np.array([[0.0], [0.1]])
    found = vibeam.batch(
        OWN, omega, 0.05, gap=gap, restitution=0.7, damping=2.0, settle=60, hold=20, output="twice", lanes=False
    )
    assert found.shape == (2, 3)
    assert found.state.shape == (2, 3, 2)
    assert found.mode_energy.shape == (2, 3, 1)
    for i, j in np.ndindex(2, 3):
        system = replace(OWN, gap=float(gap[i, 0]), restitution=0.7, zeta=2 * OWN.zeta)
        assert_same(
            found, vibeam.sweep(system, omega=omega[j], amplitude=0.05, settle=60, hold=20, output="twice"), (i, j)
        )
    assert len({*found.impact_velocity.flat}) == 6


def test_systems_may_be_an_array() -> None:
    systems = [BEAM, replace(BEAM, gap=0.0), BEAM]
    found = vibeam.batch(systems, RATES[:, None], 1e-4, settle=20, hold=10, output="sensor", lanes=False)
    assert found.shape == (4, 3)
    assert np.array_equal(found.amplitude[:, 0], found.amplitude[:, 2])
    for i, j in np.ndindex(4, 2):
        alone = vibeam.sweep(systems[j], omega=RATES[i], amplitude=1e-4, settle=20, hold=10, output="sensor")
        assert_same(found, alone, (i, j))


@pytest.mark.parametrize(
    ("system", "output"),
    [
        (replace(BEAM, law=HuntCrossley(1e6)), "contact"),
        (replace(BEAM, law=LinearStop(1e5, 3.0)), "sensor"),
        (replace(BEAM, law=ViscousRestitution(0.3)), "contact"),
        (replace(BEAM, second_gap=2e-4), "contact"),
        (replace(BEAM, coupling=np.diag(2 * BEAM.zeta * BEAM.omega) + 0.1), "contact"),
        (replace(BEAM, further=(vibeam.Contact([1.0, 1.0, 1.0], 1e-4, 0.5),)), "contact"),
        (replace(BEAM, gap=-2e-4), "contact"),
        (replace(BEAM, restitution=0.0), "sensor"),
        (BEAM, "speed"),
    ],
    ids=["Hunt-Crossley", "linear", "R(v)", "two stops", "coupled", "several", "pressed", "plastic", "derivative"],
)
def test_unusual_points_are_those_of_sweeps(system: vibeam.ImpactSystem, output: str) -> None:
    omega = np.array([50.0, 95.0])
    found = vibeam.batch(system, omega, 2e-4, settle=3, hold=4, output=output, strobes=2, lanes=False)
    for i in range(2):
        assert_same(found, vibeam.sweep(system, omega=omega[i], amplitude=2e-4, settle=3, hold=4, output=output), i)
    row, n = system.row(output), system.size
    last = found.state[:, n:] if output == "speed" else found.state[:, :n]
    assert np.allclose(found.strobes[:, -1], last @ row, rtol=1e-12, atol=0)


def test_what_is_too_small_to_share_is_not_shared(monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads from 10⁵ drive periods on, where two begin to be sooner, however these are dealt out among points."""
    shared: list[list[int]] = []

    def kept(task: Any, items: Any, workers: int | None) -> None:
        shared.append([len(which) for _, which in items])
        run_parallel(task, items, workers)

    monkeypatch.setattr("vibeam.batches.batch.run_parallel", kept)
    octaves = np.linspace(0.7, 1.6, 24)  # in tasks of their own
    vibeam.batch(OWN, octaves, 0.05, settle=200, hold=50, threads=2)
    assert shared == []
    vibeam.batch(OWN, np.full(24, 1.6), 0.05, settle=4000, hold=200, threads=2)
    (few,) = shared
    assert sum(few) == 24
    assert len(few) > 1
    vibeam.batch(OWN, np.full(24, 1.6), 0.05, settle=4000, hold=200, threads=1)
    assert len(shared) == 1


@pytest.mark.parametrize("threads", [2, 8])
def test_any_number_of_threads_gives_the_same_bits(threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vibeam.batches.batch.SHARED", 1)  # in tasks of eight points
    omega = np.linspace(0.5, 2.5, 200)
    found = [vibeam.batch(OWN, omega, 0.05, settle=30, hold=10, strobes=4, threads=each) for each in (1, threads)]
    for name in (*READ, "state", "resting", "strobes"):
        if name != "cpu_seconds":
            assert np.array_equal(getattr(found[0], name), getattr(found[1], name), equal_nan=True), name


def test_orbits_in_closed_form_are_where_points_settle() -> None:
    omega = np.linspace(1.1, 1.6, 6)
    found = vibeam.batch(OWN, omega, 0.05, settle=600, hold=4)
    assert (found.period == 1).all()
    assert (found.impacts_per_period == 1).all()
    for i, rate in enumerate(omega):
        [orbit] = [each for each in vibeam.orbits(OWN, vibeam.Drive(rate, 0.05)) if each.stable and each.admissible]
        assert found.impact_velocity[i] == pytest.approx(orbit.velocity, rel=1e-10)


def test_states_are_carried_from_batch_to_batch() -> None:
    omega = np.array([0.8, 1.3, 2.1])
    first = vibeam.batch(OWN, omega, 0.05, settle=20, hold=5)
    whole = vibeam.batch(OWN, omega, 0.05, settle=25, hold=5)
    for state in (first, first.state):
        assert np.allclose(vibeam.batch(OWN, omega, 0.05, state=state, settle=0, hold=5).state, whole.state, atol=1e-11)
    one = vibeam.batch(OWN, omega, 0.05, state=first.state[0], settle=0, hold=5)
    assert np.array_equal(one.state[0], vibeam.batch(OWN, 0.8, 0.05, state=first.state[0], settle=0, hold=5).state)


def test_failed_points_are_nan_with_their_reason_among_others() -> None:
    start = np.array([[0.0, 0.0], [0.5, 0.0], [0.05, 0.0]])
    found = vibeam.batch(OWN, 1.2, 0.05, state=start, settle=5, hold=5, strobes=1)
    assert [vibeam.Ended.of_code(code).name for code in found.ended] == ["COMPLETE", "PENETRATED", "COMPLETE"]
    assert np.isnan(found.amplitude[1])
    assert np.isnan(found.strobes[1, 0])
    assert not np.isnan(found.amplitude[[0, 2]]).any()
    assert np.array_equal(found.state[1], [0.0, 0.0])
    assert "3 points (3,), 1 mode, 1 not complete" in repr(found)


def test_what_makes_no_sense_is_refused() -> None:
    wrong: dict[str, dict[str, Any]] = {
        "systems: must be ImpactSystem or an array of them, not 'x'": {"systems": [OWN, "x"]},
        "systems: must be ImpactSystem or an array of them, not none": {"systems": []},
        "systems: must have the same number of modes, not 1, 3": {"systems": [OWN, BEAM]},
        "omega: must be positive frequencies in rad/s, not 0": {"omega": [1.0, 0.0]},
        "omega: .* not 'fast'; batch: amplitude: must be finite .*, not nan": {"omega": "fast", "amplitude": np.nan},
        "gap: must be finite numbers, not inf": {"gap": np.inf},
        r"restitution: must be in \[0, 1\], not 1.5": {"restitution": [0.5, 1.5]},
        "contact law .* says all": {"systems": replace(OWN, law=HuntCrossley(1e6)), "restitution": 0.5},
        "damping: must be factors ≥ 0, not -1": {"damping": -1.0},
        r"do not broadcast to one: omega \(2,\), gap \(3,\)": {"omega": [1.0, 2.0], "gap": [0.1, 0.2, 0.3]},
        r"there is no point in shape \(0,\)": {"omega": np.zeros((0,)) + 1.0},
        r"state: must be finite numbers \(…, 2\): displacements of 1 mode": {"state": [0.0, 0.0, 0.0]},
        r"broadcast to one: omega \(2,\), state \(3,\)": {"state": np.zeros((3, 2)), "omega": [1.0, 2.0]},
        "settle: .*; batch: hold: 0 must be a whole number": {"hold": 0, "settle": -1},
        "strobes: 60 must be a whole number from 0 to 50": {"strobes": 60},
        "threads: 0 must be a whole number ≥ 1": {"threads": 0},
        "hold: 0 .*; batch: threads: 1.5 must": {"hold": 0, "threads": 1.5},
    }
    usual = {"systems": OWN, "omega": 1.0, "amplitude": 0.05}
    assert other_answers(lambda changes: vibeam.batch(**usual | changes), wrong) == []
    with pytest.raises(KeyError, match="no output 'speed2'"):
        vibeam.batch(BEAM, 1.0, 0.05, output="speed2", strobes=1)


def test_strobes_of_an_acceleration_are_refused() -> None:
    system = replace(BEAM, derivatives={"shake": vibeam.TimeDerivative([1.0, 0.0, 0.0], 2)})
    with pytest.raises(ValueError, match="strobes: an acceleration is not read"):
        vibeam.batch(system, 95.0, 1e-4, output="shake", strobes=1)
