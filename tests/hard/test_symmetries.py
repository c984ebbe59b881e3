"""What no motion may notice, over random systems of 1 to 30 modes: all to round-off times the motion's own sensitivity.

Both motions come from the solver; how far they may differ says ``sensitivity.blur``, which knows no closed form.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_systems import Case, random_case
from sensitivity import Blur, Knot, blur, drift

import vibeam
from vibeam.flight.trajectory import Trajectory

SEED, NUMBERS = 11, range(24)
SAFE = 256.0  # last digits in every state
FAINT = 0.02


def motion(case: Case, periods: float = 8.0, begin: float = 0.0) -> Trajectory:
    """Some drive periods, or fewer where there are many impacts."""
    return vibeam.simulate(*case[:2], begin + periods * span(case), case.start, t_start=begin, max_impacts=60)


def span(case: Case) -> float:
    return 2 * np.pi / case.drive.omega


def firm(case: Case, path: Trajectory) -> tuple[np.ndarray, np.ndarray, Blur]:
    """Impacts that are there beyond doubt: up to the first rest, faint touch or loss of all digits."""
    hits, speeds = path.impact_times, path.impact_velocities
    before = path.rests[0, 0] if len(path.rests) else np.inf
    kept = np.cumprod((hits < before) & (speeds > 1e-9 * speeds.max(initial=0.0)) & (speeds > 0)).astype(bool)
    hits, speeds = hits[kept][:-1], speeds[kept][:-1]
    poses = path.modes_at(hits)
    knots = [Knot(t, s, *pose) for t, s, pose in zip(hits, speeds, poses, strict=True)]
    empty = Blur(np.zeros(0), np.zeros(0))
    spread = (
        blur(case.system, case.drive, path.t_start, case.start.displacement, case.start.velocity, knots)
        if knots
        else empty
    )
    pulls = [
        abs(case.system.contact @ drift(case.system, case.drive, k.time, k.displacement, k.velocity)) for k in knots
    ]
    sure = np.cumprod(SAFE * spread.time * np.array(pulls) <= FAINT * speeds).astype(bool)
    return hits[sure], speeds[sure], Blur(spread.time[sure], spread.speed[sure])


def assert_the_same(case: Case, path: Trajectory, times: np.ndarray, speeds: np.ndarray, extra: float = 0.0) -> None:
    """The firm impacts of the one motion are among the other's, as closely as round-off and ``extra`` of it allow."""
    hits, fast, spread = firm(case, path)
    assert len(times) >= len(hits)
    share = 1 + extra / np.finfo(float).eps
    late = np.abs(times[: len(hits)] - hits) / (SAFE * spread.time * share)
    off = np.abs(speeds[: len(hits)] - fast) / (SAFE * spread.speed * share)
    assert late.max(initial=0.0) <= 1
    assert off.max(initial=0.0) <= 1


@pytest.fixture(scope="module")
def cases() -> list[tuple[Case, Trajectory]]:
    made = [random_case(SEED, number) for number in NUMBERS]
    return [(case, motion(case)) for case in made]


Made = list[tuple[Case, Trajectory]]


def test_the_comparison_looks_at_something(cases: Made) -> None:
    counts = [len(firm(*each)[0]) for each in cases]
    assert sum(counts) > 300
    assert sum(count >= 5 for count in counts) > 12


def test_the_comparison_sees_a_billionth_of_the_restitution(cases: Made) -> None:
    seen = 0
    for case, path in cases:
        if 0.01 < case.system.restitution < 0.99 and len(firm(case, path)[0]) > 3:
            other = motion(Case(replace(case.system, restitution=case.system.restitution * (1 - 1e-9)), *case[1:]))
            try:
                assert_the_same(case, path, other.impact_times, other.impact_velocities)
            except AssertionError:
                seen += 1
    assert seen > 3


@pytest.mark.parametrize("periods", [1, 1000])
def test_a_shift_by_whole_periods(cases: Made, periods: int) -> None:
    """The shifted start is a double, a little beside whole periods: the drive is as much out of phase."""
    for case, path in cases:
        begin = periods * span(case)
        other = motion(case, begin=begin)
        late = 4 * np.finfo(float).eps * case.drive.omega * begin
        assert_the_same(case, path, other.impact_times - begin, other.impact_velocities, extra=late)


def test_turned_mode_shapes(cases: Made) -> None:
    """Mirrored: the sign of a mode shape is nobody's business."""
    for number, (case, path) in enumerate(cases):
        sign = np.random.default_rng(number).choice([-1.0, 1.0], case.system.size)
        rows = {name: getattr(case.system, name) * sign for name in ("contact", "load", "static")}
        start = vibeam.State(case.start.displacement * sign, case.start.velocity * sign)
        other = motion(Case(replace(case.system, **rows), case.drive, start))
        assert_the_same(case, path, other.impact_times, other.impact_velocities)


def test_a_drive_turned_by_half_a_period(cases: Made) -> None:
    """Load and drive both with the other sign."""
    for case, path in cases:
        system, drive = (
            replace(case.system, load=-case.system.load),
            replace(case.drive, amplitude=-case.drive.amplitude),
        )
        other = motion(Case(system, drive, case.start))
        assert_the_same(case, path, other.impact_times, other.impact_velocities)


@pytest.mark.parametrize(("length", "time"), [(2.0**-30, 1.0), (2.0**10, 2.0**-20), (1e-9, 1.0), (1e3, 3600.0)])
def test_units(cases: Made, length: float, time: float) -> None:
    exact = np.log2(length) % 1 == np.log2(time) % 1 == 0
    for case, path in cases:
        system = replace(
            case.system, omega=case.system.omega / time, static=case.system.static * (length / time**2),
            gap=case.system.gap * length,
        )  # fmt: skip
        start = vibeam.State(case.start.displacement * length, case.start.velocity * (length / time))
        drive = vibeam.Drive(case.drive.omega / time, case.drive.amplitude * length)
        other = motion(Case(system, drive, start))
        if exact:
            np.testing.assert_array_equal(other.impact_times, path.impact_times * time)
            np.testing.assert_array_equal(other.impact_velocities, path.impact_velocities * (length / time))
        else:
            late = np.finfo(float).eps * 4
            assert_the_same(case, path, other.impact_times / time, other.impact_velocities / (length / time), late)


def test_the_order_of_the_modes(cases: Made) -> None:
    for number, (case, path) in enumerate(cases):
        order = np.random.default_rng(number).permutation(case.system.size)
        rows = {name: getattr(case.system, name)[order] for name in ("omega", "zeta", "contact", "load", "static")}
        start = vibeam.State(case.start.displacement[order], case.start.velocity[order])
        other = motion(Case(replace(case.system, **rows), case.drive, start))
        assert_the_same(case, path, other.impact_times, other.impact_velocities)


def test_splitting_anywhere(cases: Made) -> None:
    for number, (case, path) in enumerate(cases):
        rng = np.random.default_rng(number)
        cuts = np.sort(rng.uniform(0, path.t_end, 3))
        times, speeds, start, begin = [], [], case.start, 0.0
        for cut in [*cuts, path.t_end]:
            part = vibeam.simulate(*case[:2], cut, start, t_start=begin, max_impacts=10_000)
            times.append(part.impact_times)
            speeds.append(part.impact_velocities)
            start, begin = part.state, cut
        assert_the_same(case, path, np.concatenate(times), np.concatenate(speeds), extra=np.finfo(float).eps)


def test_a_mode_that_the_contact_does_not_touch(cases: Made) -> None:
    for number, (case, path) in enumerate(cases):
        rng = np.random.default_rng(number)
        row = {
            "omega": case.drive.omega * rng.uniform(0.1, 9), "zeta": rng.uniform(0, 2), "contact": 0.0,
            "load": rng.normal(), "static": rng.normal(),
        }  # fmt: skip
        place = rng.integers(case.system.size + 1)
        rows = {name: np.insert(getattr(case.system, name), place, value) for name, value in row.items()}
        start = vibeam.State(
            np.insert(case.start.displacement, place, 0.3), np.insert(case.start.velocity, place, -0.1)
        )
        other = motion(Case(replace(case.system, **rows), case.drive, start))
        assert_the_same(case, path, other.impact_times, other.impact_velocities)
