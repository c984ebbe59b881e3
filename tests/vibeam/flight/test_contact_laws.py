"""Several contacts of any law: against one contact, the certificate, tangent maps, round-off."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.flight.disturbance.contacts import ContactMaps
from vibeam.flight.disturbance.maps import tangent_fault
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

ROW = np.array([1.0, -0.8, 0.6])
PLAIN: dict[str, Any] = {
    "omega": [50.0, 310.0, 900.0], "zeta": 0.02, "contact": ROW, "load": [1.0, 0.5, 0.3], "gap": 1e-4,
}  # fmt: skip
DRIVE = vibeam.Drive(60.0, 3e-4)
FAR = vibeam.Contact([1.0, 0.3, -0.5], 1.0, 0.5)
RIGID = vibeam.Contact([-0.4, 0.9, 0.2], 5e-5, 0.6)


def made(law: Any = None, further: Any = None, **changes: Any) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(**{**PLAIN, **changes}, law=law, further=further)


MIXED = made(LinearStop(1e5, 3.0), [vibeam.Contact(-ROW, 2e-4, law=LinearStop(1e5)), RIGID])
ALL = made(HuntCrossley(1e8, 0.4), [RIGID, vibeam.Contact([-1.0, 0.5, 0.3], 6e-5, law=LinearStop(2e5, 10.0))])


@pytest.mark.parametrize("law", [HuntCrossley(1e8), HuntCrossley(1e8, 0.4)])
@pytest.mark.parametrize("second", [None, 2e-4])
def test_an_integrated_law_is_that_of_one_contact_where_the_others_are_out_of_reach(law: Any, second: Any) -> None:
    alone, times = made(law, second_gap=second), np.linspace(0, 0.2, 60)
    first = vibeam.simulate(alone, DRIVE, 0.2)
    far = vibeam.simulate(replace(alone, further=(FAR,)), DRIVE, 0.2)
    assert len(first.impact_times) > 3
    assert far.impact_times == pytest.approx(first.impact_times, abs=1e-12)
    assert far.modes_at(times) == pytest.approx(first.modes_at(times), abs=1e-10 * np.abs(first.modes_at(times)).max())
    assert far.contacts == pytest.approx(first.contacts, rel=1e-8)
    settings = {"omega": [DRIVE.omega], "amplitude": DRIVE.amplitude, "settle": 1, "hold": 1}
    one, two = vibeam.sweep(alone, **settings), vibeam.sweep(far.system, **settings)
    assert isinstance(one, vibeam.FrequencyResponse)
    assert isinstance(two, vibeam.FrequencyResponse)
    for name in ("amplitude", "reach", "impacts_per_period", "impact_velocity", "rest", "mode_energy"):
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-9), name


def test_two_integrated_contacts_at_one_place_share_the_force() -> None:
    """Two stops of half the stiffness at one place are one; the instant of both is one row of the trace."""
    one = vibeam.simulate(made(HuntCrossley(1e8), [FAR]), DRIVE, 0.1)
    both = vibeam.simulate(made(HuntCrossley(5e7), [vibeam.Contact(ROW, 1e-4, law=HuntCrossley(5e7))]), DRIVE, 0.1)
    assert both.impact_times == pytest.approx(one.impact_times, abs=1e-12)
    assert both.at(0.0991) == pytest.approx(one.at(0.0991), rel=1e-9)


def test_an_integrated_contact_beside_held_and_linear_ones_balances_energy() -> None:
    """Undamped modes, elastic laws, no drive: kinetic, elastic and contact energy stay, to 1e-12 a step."""
    law, spring = HuntCrossley(1e8), LinearStop(1e5)
    system = made(
        law, [vibeam.Contact([-1.0, 0.5, 0.3], 6e-5, law=spring), vibeam.Contact([-0.4, 0.9, 0.2], 5e-5, 1.0)], zeta=0.0
    )
    start = vibeam.State([0, 0, 0], [0.02, 0.05, -0.03])
    path = vibeam.simulate(system, vibeam.Drive(1.0, 0.0), 0.2, start)
    poses, gaps = path.modes_at(times := np.linspace(0, 0.2, 400)), np.maximum(-path.gaps(np.linspace(0, 0.2, 400)), 0)
    energy = np.sum(poses[:, 1] ** 2 + (system.omega * poses[:, 0]) ** 2, axis=1) / 2
    energy += 1e8 * gaps[:, 0] ** 2.5 / 2.5 + 1e5 * gaps[:, 1] ** 2 / 2
    assert set(path.impact_contacts.tolist()) == {0, 1, 2}
    assert len(times) == 400
    assert energy == pytest.approx(np.full(400, energy[0]), rel=1e-9)
    assert path.gaps(times)[:, 2].min() > -1e-15


def test_motions_of_all_laws_at_once_keep_out_of_rigid_stops() -> None:
    rng = np.random.default_rng(4)
    for _ in range(20):
        n = int(rng.integers(2, 7))
        rows, gaps = rng.uniform(-1, 1, (4, n)), rng.uniform(0.3e-4, 3e-4, 4)
        laws = [
            LinearStop(rng.uniform(1e4, 1e6), rng.choice([0.0, 5.0, 50.0])),
            HuntCrossley(1e8, rng.choice([0, 0.5])),
        ]
        further = [vibeam.Contact(rows[j], gaps[j], rng.uniform(0, 1), [None, *laws][j - 1]) for j in (1, 2, 3)]
        system = vibeam.ImpactSystem.from_modes(
            np.sort(rng.uniform(20, 2000, n)), 0.02, rows[0], rng.uniform(0.3, 1, n), gap=gaps[0], restitution=0.5,
            static=rng.uniform(-3, 3, n), further=further,
        )  # fmt: skip
        path = vibeam.simulate(system, vibeam.Drive(rng.uniform(20, 200), 2e-4), 0.1, max_impacts=3000)
        assert path.ended is vibeam.Ended.COMPLETE
        assert path.gaps(np.linspace(0, 0.1, 300))[:, :2].min() > -1e-14


def test_a_certificate_covers_every_signal_of_every_segment() -> None:
    path = vibeam.simulate(MIXED, DRIVE, 0.0788, certify=True)
    found = path.certificate
    assert found is not None
    assert found.complete
    trace, count = path.segments.trace, 3
    for i in np.flatnonzero(found.durations > 0):
        mine = found.pieces[found.pieces[:, 0] == i]
        signals = set(mine[:, 4].astype(int).tolist())
        held, pushed = int(found.held[i]), int(found.pushed[i])  # type: ignore[attr-defined]
        for j in range(count):
            busy = (held | pushed) >> j & 1
            assert (count + j in signals) if busy else ({j} & signals or {2 * count + j, 3 * count + j} <= signals)
        for signal in signals:
            own = mine[mine[:, 4] == signal]
            assert own[0, 1] == 0
            assert own[1:, 1] == pytest.approx(own[:-1, 1] + own[:-1, 2], rel=1e-12)
            assert own[-1, 1] + own[-1, 2] >= found.durations[i] * (1 - 1e-12)
        closing = mine[mine[:, 3] == 1]
        assert len(closing) == (trace[i, 4] != 0)
    for begin, length, (segment, signal) in zip(
        found.pieces[:, 1], found.pieces[:, 2], found.pieces[:, [0, 4]], strict=True
    ):
        if signal < count:
            at = found.times[int(segment)] + begin + length * np.array([0.3, 0.7])
            assert (
                path.gaps(np.minimum(at, found.times[int(segment)] + found.durations[int(segment)]))[
                    :, int(signal)
                ].min()
                > -1e-15
            )


def test_what_a_certificate_does_not_prove_is_named() -> None:
    path = vibeam.simulate(MIXED, DRIVE, 0.1, certify=True)
    assert len(path.chatters) == 1
    assert [each.reason for each in path.certificate.unproved] == [  # type: ignore[union-attr]
        "what is left of the accumulation of impacts has no bound"
    ]
    curved = vibeam.simulate(ALL, DRIVE, 0.06, certify=True).certificate
    assert curved is not None
    assert {each.reason.split(" is ")[0] for each in curved.unproved} == {'contact by the law "hunt-crossley"'}


# Impacts in turn, a linear entry with damping and a rigid stop, a completed accumulation, a hold beside a push.
@pytest.mark.parametrize("end", [0.025, 0.075, 0.0795, 0.0809, 0.1])
def test_tangent_maps_are_those_of_flown_neighbours(end: float) -> None:
    """Central differences of 1e-6 of the motion's size: right to about 1e-9."""
    n, still = 3, vibeam.State(np.zeros(3), np.zeros(3))
    path = vibeam.simulate(MIXED, DRIVE, end, still)
    maps = ContactMaps(MIXED, DRIVE, path.segments, path.state)
    size, speed = (float(np.abs(path.segments.poses[:, k]).max()) for k in (0, 1))
    units, found = np.repeat([size, speed], n), np.empty((2 * n, 2 * n))
    shifts = []
    for k in range(2 * n):
        sides, times = [], []
        for sign in (1, -1):
            start = np.zeros(2 * n)
            start[k] = sign * 1e-6 * units[k]
            near = vibeam.simulate(MIXED, DRIVE, end, vibeam.State(start[:n], start[n:]))
            assert near.impact_contacts.tolist() == path.impact_contacts.tolist()
            sides.append(np.concatenate([near.state.displacement, near.state.velocity]))
            times.append(near.impact_times)
        found[:, k] = (sides[0] - sides[1]) / 2e-6 / units
        shifts.append((times[0] - times[1]) / 2e-6)
    product = maps.product() * units / units[:, None]
    assert product == pytest.approx(found, abs=2e-8 * np.abs(found).max())
    whole, readings = np.eye(2 * n), []
    for i in range(len(maps)):
        if path.segments.trace[i, 4] in (1, 3, 4) and len(readings) < 5:
            readings.append(maps.readings(i)[0] @ maps.flow(i) @ whole * units)
        whole = maps.over(i) @ whole
    assert np.array(readings) == pytest.approx(np.array(shifts).T[: len(readings)], rel=1e-5, abs=1e-9)


def test_round_off_grows_along_the_motion() -> None:
    path = vibeam.simulate(MIXED, DRIVE, 0.0788)
    errors = path.errors
    assert errors.meaningful == len(path.impact_times) == len(errors.time)
    assert np.all(errors.velocity > 1e-18)
    assert np.all(errors.velocity < 1e-9 * path.impact_velocities.max())
    with pytest.raises(ValueError, match="hunt-crossley"):
        _ = vibeam.simulate(ALL, DRIVE, 0.06).errors
    assert tangent_fault(MIXED) == ""


def test_orbits_and_exponents_are_those_of_one_contact_where_the_others_are_out_of_reach() -> None:
    one, drive = made(restitution=0.7), vibeam.Drive(95.0, 1e-4)
    two = replace(one, further=(FAR,))
    (first,), (second,) = vibeam.orbits(one, drive), vibeam.orbits(two, drive)
    assert np.poly(second.multipliers) == pytest.approx(np.poly(first.multipliers), abs=1e-10)
    spectra = [vibeam.lyapunov(each, drive, settle=200, periods=60).exponents for each in (one, two)]
    assert spectra[1] == pytest.approx(spectra[0], rel=1e-8)
