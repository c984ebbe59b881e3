"""The hard scenes: the flight solver passes every one, and the judge sees what is wrong."""

from __future__ import annotations

import numpy as np
import pytest
from scene_verdict import Found, flown, judged
from scenes import MAKERS, Maker, ball, elastic, full_model, strong_drive, touched

import vibeam

LATE = 1e-10  # of a time, after as many impacts as a scene has


QUICK = [make for make in MAKERS if make not in (full_model, strong_drive)]


@pytest.mark.parametrize("make", QUICK, ids=lambda make: make.__name__)
def test_flight_passes(make: Maker) -> None:
    scene = make()
    verdict = judged(scene, flown(scene)[0])
    assert verdict.fine, str(verdict)
    assert verdict.late < LATE
    assert verdict.timed == len(scene.firm)


def test_flight_passes_a_drive_of_1e12() -> None:
    scene = strong_drive()
    assert judged(scene, flown(scene)[0]).late < LATE
    path = vibeam.simulate(scene.case.system, scene.case.drive, scene.end, scene.case.start)
    error = path.errors.time[0]  # counts no digits of a steady response that is not taken out
    assert abs(path.impact_times[0] - scene.impacts[0, 0]) <= 3 * error <= LATE * scene.impacts[0, 0]


@pytest.mark.slow
def test_flight_passes_the_full_model() -> None:
    scene = full_model()
    assert judged(scene, flown(scene)[0]).fine


def test_the_judge_sees_what_is_wrong() -> None:
    scene = ball()
    right = flown(scene)[0]
    impacts, places = right.impacts, right.places
    assert judged(scene, Found(np.delete(impacts, 5, axis=0), places)).missed == 1
    assert judged(scene, Found(np.insert(impacts, 5, [0.8, 1.0], axis=0), places)).invented == 1
    assert judged(scene, Found(impacts * [1.001, 1.0], places)).late == pytest.approx(1e-3)
    assert not judged(scene, Found(impacts, places + 0.05)).fine
    assert judged(scene, Found(impacts, np.append(places, -0.05))).off > 0.01
    assert judged(touched(), Found(np.empty((0, 2)), np.zeros(1))).missed == 1


def test_the_judge_sees_energy_that_is_made() -> None:
    """A ball that should be at rest is thrown up again; a mode without any loss has lost 3 %."""
    scene = ball()
    right = flown(scene)[0]
    assert judged(scene, right).made == pytest.approx(0.0, abs=1e-12)
    right.state = np.array([[0.0], [-1.0]])
    assert judged(scene, right).made == pytest.approx(0.5 / 9.81)
    assert not judged(scene, right).fine
    scene = elastic()
    right = flown(scene)[0]
    right.state = right.state * np.sqrt(0.97)
    assert judged(scene, right).made == pytest.approx(-0.03 * 0.5 / (0.5 - 0.3**2 / 2))
    assert not judged(scene, right).fine
