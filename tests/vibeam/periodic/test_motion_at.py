"""One motion by each way that leads to it: closed form, shot, followed, simulated; what leads to none is said once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import vibeam
from vibeam.periodic.motion_at import Way, motion_at, touching
from vibeam.periodic.shooting import Reason
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam_models.laws.compliant import LinearStop

PLAIN = vibeam.ImpactSystem.from_modes([1.0, 5.3], [0.05, 0.02], [1.0, 0.6], [1.0, 0.4], gap=0.02, restitution=0.5)
DRIVE = vibeam.Drive(2.0, 0.1)
FAR = replace(PLAIN, second_gap=50.0)  # a second stop that nothing reaches: no closed form knows it
SOFT = replace(PLAIN, law=LinearStop(stiffness=40.0, damping=0.5))


def section(system: vibeam.ImpactSystem, drive: vibeam.Drive = DRIVE) -> StroboscopicMap:
    return StroboscopicMap(system, drive)


def harder(system: vibeam.ImpactSystem, drive: vibeam.Drive) -> vibeam.Orbit:
    """The motion with the harder impact, which is the stable one here, in closed form."""
    [found] = [each for each in vibeam.orbits(system, drive) if each.stable and each.admissible]
    return found


def like(found: vibeam.Orbit, exact: vibeam.Orbit) -> None:
    """Phase and velocity of the impact, amplitude and multipliers to 1e-9."""
    assert (found.velocity, found.phase) == pytest.approx((exact.velocity, exact.phase), rel=1e-9)
    assert found.amplitude() == pytest.approx(exact.amplitude(), rel=1e-9)
    assert np.abs(found.multipliers) == pytest.approx(np.abs(exact.multipliers), rel=1e-9)
    assert found.admissible
    assert found.residual < 1e-12


@pytest.mark.parametrize("omega", [1.9, 2.0, 2.2])
@pytest.mark.parametrize("system", [PLAIN, FAR], ids=["plain", "no closed form"])
@pytest.mark.parametrize("way", Way)
def test_each_way_leads_to_the_motion_of_the_closed_form(way: Way, system: vibeam.ImpactSystem, omega: float) -> None:
    drive = vibeam.Drive(omega, 0.1)
    start = motion_at(section(system, vibeam.Drive(2.05, 0.101)), harder(PLAIN, DRIVE), ways=(Way.SHOT,))
    if way is Way.CLOSED_FORM and system is FAR:
        with pytest.raises(vibeam.NoOrbit):
            motion_at(section(system, drive), start, ways=(way,))
        return
    like(motion_at(section(system, drive), start, ways=(way,)), harder(PLAIN, drive))


def test_the_cheapest_way_is_taken() -> None:
    """No step of Newton's method where there is a closed form; few flights where there is none."""
    start = harder(PLAIN, DRIVE)
    drive = vibeam.Drive(2.1, 0.1)
    assert motion_at(section(PLAIN, drive), start).corrections == ()
    assert 0 < len(motion_at(section(FAR, drive), start).corrections) < 10


def test_a_drive_that_is_far_is_come_to_in_steps() -> None:
    """From 1.9 to 2.9 Newton's method leads elsewhere at once, and to the motion in steps; the gap goes on too."""
    start = motion_at(section(FAR, vibeam.Drive(1.9, 0.1)), harder(PLAIN, DRIVE), ways=(Way.SHOT,))
    goal, drive = replace(FAR, gap=0.03), vibeam.Drive(2.9, 0.1)
    with pytest.raises(vibeam.NoOrbit):
        motion_at(section(goal, drive), start, ways=(Way.SHOT,), steps=8)
    found = motion_at(section(goal, drive), start, ways=(Way.SHOT, Way.FOLLOWED), alike=touching, steps=8)
    like(found, vibeam.orbits(replace(PLAIN, gap=0.03), drive)[0])


def test_without_a_start_it_is_what_a_motion_from_rest_settles_on() -> None:
    like(motion_at(section(FAR)), harder(PLAIN, DRIVE))


def test_an_orbit_of_other_modes_is_lifted() -> None:
    other = replace(PLAIN, omega=np.array([1.0, 5.0]), second_gap=50.0)
    found = motion_at(section(other), harder(PLAIN, DRIVE), ways=(Way.SHOT,))
    like(found, harder(replace(other, second_gap=None), DRIVE))


@pytest.mark.parametrize("way", [Way.SHOT, Way.FOLLOWED, Way.SIMULATED])
def test_a_linear_stop(way: Way) -> None:
    """Each way from a motion at another drive to the one that a long simulation is on."""
    start = motion_at(section(SOFT, vibeam.Drive(2.1, 0.1)), harder(PLAIN, DRIVE))
    found = motion_at(section(SOFT), start, ways=(way,))
    flown = vibeam.sweep(SOFT, omega=[2.0], amplitude=0.1, settle=600, hold=1)
    assert found.velocity == pytest.approx(flown.impact_velocity[0], rel=1e-9)
    assert found.amplitude() == pytest.approx(flown.amplitude[0], rel=1e-9)


def test_a_rest_on_the_stop() -> None:
    """R = 0 and a static force onto the stop: the motion rests in every period, and is come to from its neighbour."""
    rests = vibeam.ImpactSystem.from_modes(1.0, 0.05, 1.0, 1.0, gap=-0.3, restitution=0.0)
    start = motion_at(section(rests, vibeam.Drive(0.9, 0.5)))
    assert start.rests == 1
    for omega in (0.88, 0.85):
        drive = vibeam.Drive(omega, 0.5)
        found = motion_at(section(rests, drive), start, ways=(Way.SHOT,))
        flown = vibeam.sweep(rests, omega=[omega], amplitude=0.5, settle=100, hold=1)
        assert found.rests == 1
        assert found.amplitude() == pytest.approx(flown.amplitude[0], rel=1e-9)


def test_a_start_that_leads_to_no_motion_is_one_refusal() -> None:
    """No impact motion at a drive that never reaches the stop; the reason is the last way's."""
    small = vibeam.Drive(2.0, 1e-4)
    for system in (PLAIN, FAR):
        with pytest.raises(vibeam.NoOrbit, match="no periodic motion") as refused:
            motion_at(section(system, small), harder(PLAIN, DRIVE), ways=(Way.CLOSED_FORM, Way.SHOT, Way.FOLLOWED))
        assert refused.value.reason in (Reason.FOLD, Reason.DIVERGED, Reason.LEFT, Reason.ENDED)
    with pytest.raises(vibeam.NoOrbit):
        motion_at(section(PLAIN), None, ways=(Way.SHOT,))
