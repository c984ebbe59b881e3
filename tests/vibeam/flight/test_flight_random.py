"""Random systems: against the arbitrary-precision motion over a few impacts, and what must hold for every motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from exact_motion import impacts_and_bar
from hypothesis import HealthCheck, assume, event, given, reject, settings
from hypothesis import strategies as st

import vibeam

EPSILON = np.finfo(float).eps
FEW = settings(max_examples=40, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
MANY = settings(FEW, max_examples=80)
ALL = settings(FEW, max_examples=1000)


class Case(NamedTuple):
    system: vibeam.ImpactSystem
    drive: vibeam.Drive
    start: vibeam.State


def numbers(least: float, most: float) -> st.SearchStrategy[float]:
    """Decimals of nine places: no number so small that it is none."""
    return st.floats(least, most, allow_nan=False).map(lambda x: round(x, 9))


DAMPING = st.one_of(numbers(0, 0.3), st.sampled_from([0.0, 1.0, 1 - 1e-12, 1 + 1e-12, 1 + 1e-6]), numbers(0.3, 8.0))
RESTITUTION = st.one_of(st.sampled_from([0.0, 1.0]), numbers(0.0, 1.0))
GAP = st.one_of(st.just(0.0), numbers(-0.5, 1.0))


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """1 to 6 modes within two decades, any damping, R and sign of the gap; driven, and now and then not.

    Frequencies differ: those that do not can leave a contact without any motion of its own (``test_rest``).
    """
    n = draw(st.integers(1, 6))
    row = st.lists(numbers(-1, 1), min_size=n, max_size=n).map(np.array)
    base = 10 ** draw(numbers(-2, 3))
    omega = base * 10 ** np.cumsum([0.0, *draw(st.lists(numbers(0.02, 0.34), min_size=n - 1, max_size=n - 1))])
    if draw(st.integers(0, 9)) == 0:
        omega[-1] = 0.0
    zeta = np.array([draw(DAMPING) for _ in range(n)])
    contact, load = draw(row), draw(row)
    contact[-1] += np.copysign(0.1, contact[-1])  # a free mode that the stop does not feel: ``test_rest``
    contact[0] = draw(numbers(0.3, 1.0)) * draw(st.sampled_from([1, -1]))
    load[0] = draw(numbers(0.2, 1.0))
    ratio = draw(st.one_of(numbers(0.3, 4.0), st.just(1.0)))
    amplitude = draw(st.one_of(numbers(0.01, 1.0), st.just(0.0))) / ratio**2
    static = draw(row) * base**2 * 0.3 if draw(st.booleans()) else np.zeros(n)
    system = vibeam.ImpactSystem.from_modes(
        omega, zeta, contact, load, gap=draw(GAP), restitution=draw(RESTITUTION), static=static
    )
    x, v = draw(row), draw(row) * base
    beyond = contact @ x - system.gap + 0.01
    x -= contact * max(0.0, beyond) / (contact @ contact)
    return Case(system, vibeam.Drive(base * ratio, amplitude), vibeam.State(x, v))


def period(case: Case) -> float:
    return 2 * np.pi / case.drive.omega


# ------------------------------------------------------------------------------------------------ against the truth


@FEW
@given(cases())
def test_the_first_impacts_are_those_of_the_exact_motion(case: Case) -> None:
    """Up to eight impacts or three periods, or where an impact is too weak to be told from a miss."""
    stiff = 60.0 / max((case.system.omega * (1 + 2 * case.system.zeta)).max(), case.drive.omega)
    end = min(3 * period(case), stiff)
    try:
        expected, bar = impacts_and_bar(*case, count=8, t_end=end)
    except ArithmeticError:  # the truth lies on the stop to all its digits: no force tells rest from flight
        reject()
    firm = np.cumprod((bar < 1e-6) & (expected[:, 1] > 1e-6 * expected[:, 1].max(initial=0.0))).astype(bool)
    expected, bar = expected[firm], bar[firm]
    event(f"{len(expected)} impacts")
    path = vibeam.simulate(*case[:2], end, case.start)
    assert path.ended is vibeam.Ended.COMPLETE
    hits, speeds = path.impact_times, path.impact_velocities
    assert len(hits) >= len(expected)
    if np.all(firm) and len(firm) < 8:
        assert len(hits) == len(expected)
    hits, speeds = hits[: len(expected)], speeds[: len(expected)]
    assert np.all(np.abs(hits - expected[:, 0]) <= bar * expected[:, 0])
    assert np.all(np.abs(speeds - expected[:, 1]) <= bar * expected[:, 1].max(initial=0.0))


# ------------------------------------------------------------------------------------------------ for every motion


def sizes(case: Case, poses: np.ndarray) -> tuple[float, float]:
    """Largest displacement and velocity of the contact's parts."""
    parts = np.abs(poses * case.system.contact).sum(axis=-1)
    return max(float(parts[:, 0].max()), abs(case.system.gap)), float(parts[:, 1].max())


@MANY
@given(cases())
def test_what_every_motion_keeps(case: Case) -> None:
    end = 6 * period(case)
    path = vibeam.simulate(*case[:2], end, case.start, max_impacts=20_000)
    assert path.ended in (vibeam.Ended.COMPLETE, vibeam.Ended.EVENT_LIMIT)
    assert (path.t_end == end) == (path.ended is vibeam.Ended.COMPLETE)
    hits, speeds = path.impact_times, path.impact_velocities
    times = np.unique(np.concatenate([np.linspace(0, path.t_end, 1500), hits[hits <= path.t_end][:2000]]))
    poses = path.modes_at(times)
    size, fast = sizes(case, poses)
    assert np.all(np.isfinite(poses))
    assert np.all(np.isfinite(path.chatters[:, 0]))
    assert np.all(np.isfinite(path.chatters[:, 1])) or case.system.restitution == 1  # held, though it has no end
    assert np.all(np.diff(hits) >= 0)
    assert np.all(speeds >= 0)
    assert (poses[:, 0] @ case.system.contact).max() <= case.system.gap + 1e-12 * size
    at_impacts = path.at(hits[hits <= path.t_end][:2000])
    assert np.all(np.abs(at_impacts - case.system.gap) <= 1e-12 * size + 1e-13 * fast * path.t_end)
    for begin, over in path.rests[:50]:
        inside = np.linspace(begin, min(over, path.t_end), 5)[1:-1]
        assert np.all(np.abs(path.at(inside) - case.system.gap) <= 1e-12 * size)
        assert np.all(np.abs(path.velocity_at(inside)) <= 1e-10 * fast)
    event(f"rests: {len(path.rests) > 0}, impacts: {min(len(hits), 3)}")


@MANY
@given(cases())
def test_energy_never_grows_without_a_drive(case: Case) -> None:
    drive = replace(case.drive, amplitude=0.0)
    system = replace(case.system, static=np.zeros(case.system.size))
    path = vibeam.simulate(system, drive, 6 * period(case), case.start, max_impacts=20_000)
    poses = path.modes_at(np.linspace(0, path.t_end, 800))
    energy = np.sum(poses[:, 1] ** 2 + (system.omega * poses[:, 0]) ** 2, axis=1) / 2
    assert np.diff(energy).max() <= 1e-12 * energy[0]


@MANY
@given(cases(), numbers(0.05, 0.95))
def test_the_first_part_does_not_know_where_the_motion_is_cut(case: Case, share: float) -> None:
    whole = vibeam.simulate(*case[:2], 3 * period(case), case.start, max_impacts=20_000)
    if whole.ended is not vibeam.Ended.COMPLETE:
        return
    cut = share * 3 * period(case)
    first = vibeam.simulate(*case[:2], cut, case.start, max_impacts=20_000)
    early = whole.impact_times < cut
    np.testing.assert_array_equal(first.impact_times, whole.impact_times[early])
    times = np.linspace(0, cut, 50)
    size, _ = sizes(case, whole.modes_at(times))
    np.testing.assert_allclose(first.at(times), whole.at(times), atol=1e-12 * size)


@MANY
@given(cases())
def test_motions_before_the_first_impact_do_not_know_of_the_stop(case: Case) -> None:
    """The same system with its stop far away."""
    end = 3 * period(case)
    path = vibeam.simulate(*case[:2], end, case.start, max_impacts=20_000)
    far = replace(case.system, gap=1e6)
    alone = vibeam.simulate(far, case.drive, end, case.start)
    if len(alone.impact_times) or (path.state.resting and not len(path.impact_times)):
        return
    first = min([end, *path.impact_times[:1]])
    times = np.linspace(0, first, 200)[:-1]
    free = alone.at(times)
    size, _ = sizes(case, alone.modes_at(times))
    np.testing.assert_allclose(path.at(times), free, atol=1e-11 * size)
    # and no earlier contact was passed over
    assert free.max() <= case.system.gap + 1e-9 * size


@MANY
@given(cases())
def test_sweeps_of_any_system_say_how_they_ended(case: Case) -> None:
    """Any but those with modes that have no steady response, which ``test_sweep`` runs apart."""
    assume(case.system.omega.min() > 0 and case.system.zeta.min() > 1e-3)
    omega = case.drive.omega * np.array([0.9, 1.0, 1.1])
    found = vibeam.sweep(
        case.system, omega=omega, amplitude=case.drive.amplitude, settle=5, hold=4, state=case.start,
        options={"limit": 500},
    )  # fmt: skip
    for i in range(3):
        ended = vibeam.Ended.of_code(found.ended[i])
        values = [found.amplitude[i], found.reach[i], found.maximum[i], found.minimum[i], found.rest[i]]
        assert ended in (vibeam.Ended.COMPLETE, vibeam.Ended.EVENT_LIMIT)
        assert np.all(np.isfinite(values)) == (ended is vibeam.Ended.COMPLETE)
        if ended is vibeam.Ended.COMPLETE:
            parts = abs(case.system.gap) + found.reach[i] + np.abs(case.system.static / case.system.omega**2).max()
            parts += np.abs(case.start.displacement).max()  # what is left of it has decayed, its round-off has not
            assert found.maximum[i] <= case.system.gap + 1e-9 * parts
            assert 0 <= found.rest[i] <= 1 + 1e-12
            assert np.all(found.mode_energy[i] >= 0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "test",
    [
        test_the_first_impacts_are_those_of_the_exact_motion,
        test_what_every_motion_keeps,
        test_energy_never_grows_without_a_drive,
        test_motions_before_the_first_impact_do_not_know_of_the_stop,
        test_sweeps_of_any_system_say_how_they_ended,
    ],
)
def test_of_many_systems(test: Any) -> None:
    ALL(given(cases())(test.hypothesis.inner_test))()


def test_the_limit_holds_while_a_point_is_read_off() -> None:
    """R = 1 and overdamped: impacts that grow weaker without end, more of them in a period than are traced at once."""
    system = vibeam.ImpactSystem.from_modes([1.0], [6.9373], [0.3], [0.2], gap=0.0, restitution=1.0)
    start = vibeam.State(np.array([-0.96902646]), np.array([0.21025158]))
    found = vibeam.sweep(
        system, omega=np.array([0.27]), amplitude=1 / 9, settle=0, hold=6, state=start, options={"limit": 2000}
    )
    assert vibeam.Ended.of_code(found.ended[0]) is vibeam.Ended.EVENT_LIMIT
    assert 2000 <= found.impacts[0] <= 6 * 2000
