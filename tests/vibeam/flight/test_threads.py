"""What a user holds may be read from several threads at once: every answer is the one that a single thread gets."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from threading import Barrier, get_ident
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.flight.engine.threads import OutOfTime, ending_at, pause
from vibeam.flight.linear.packing import pack
from vibeam.flight.solver import FlightSolver, RegimeSolver
from vibeam.solvers import solver
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

DRIVE = vibeam.Drive(95.0, 1e-4)
THREADS = 4
LAWS = {"restitution": None, "linear": LinearStop(1e6, 1.0), "hunt_crossley": HuntCrossley(1e8, 0.5)}
TIMES = np.linspace(0.0, 0.5, 2000)


def system(law: object = None) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72, law=law, outputs={"sensor": [1.0, 2.0]}
    )


def at_once(*tasks: Callable[[], Any]) -> list[Any]:
    """What the tasks return, each in a thread of its own, all begun at one barrier."""
    barrier = Barrier(len(tasks))

    def run(task: Callable[[], Any]) -> Any:
        barrier.wait()
        return task()

    with ThreadPoolExecutor(len(tasks)) as pool:
        return list(pool.map(run, tasks))


def repeated(task: Callable[[], Any], times: int = 20) -> Callable[[], list[Any]]:
    return lambda: [task() for _ in range(times)]


def points(response: vibeam.FrequencyResponse) -> np.ndarray:
    return np.stack([response.amplitude, response.reach, response.impact_velocity, response.mode_energy[:, 0]])


@pytest.mark.parametrize("law", LAWS)
def test_a_trajectory_is_read_by_several_threads(law: str) -> None:
    path = vibeam.simulate(system(LAWS[law]), DRIVE, 0.5)
    expected = path.at(TIMES), path.velocity_at(TIMES, "sensor")
    readings = [repeated(lambda: path.at(TIMES)), repeated(lambda: path.velocity_at(TIMES, "sensor"))] * (THREADS // 2)
    for index, answers in enumerate(at_once(*readings)):
        for answer in answers:
            np.testing.assert_array_equal(answer, expected[index % 2])


@pytest.mark.parametrize("law", ["restitution", "linear"])
def test_a_solver_sweeps_and_simulates_in_several_threads(law: str) -> None:
    shared = solver("flight", system(LAWS[law]), 80.0)

    def steady(omega: float) -> np.ndarray:
        return points(shared.steady([omega, omega + 1.0], 1e-4, None, 10, 5, "sensor")[0])

    def simulated() -> np.ndarray:
        return shared.simulate(DRIVE, None, 0.0, 0.5, 10**6)[3].trace

    tasks = [lambda: steady(90.0), lambda: steady(95.0), lambda: steady(100.0), simulated]
    expected = [task() for task in tasks]
    for answers, right in zip(at_once(*map(repeated, tasks)), expected, strict=True):
        for answer in answers:
            np.testing.assert_array_equal(answer, right)


@pytest.mark.parametrize("name", ["orbit", "mapping", "averaging"])
def test_a_solver_of_steady_motions_is_shared(name: str) -> None:
    one = vibeam.ImpactSystem.from_modes(50.0, 0.017, 2.0, 0.5, restitution=0.72, gap=1e-5)
    shared = solver(name, one, 80.0)
    tasks = [lambda omega=omega: points(shared.steady([omega], 1e-4, None, 0, 4, "contact")[0]) for omega in (95, 100)]
    expected = [task() for task in tasks]
    assert np.all(np.isfinite(expected[0][0]))
    for answers, right in zip(at_once(*map(repeated, tasks)), expected, strict=True):
        for answer in answers:
            np.testing.assert_array_equal(answer, right)


@pytest.mark.parametrize("method", ["RK45", "LSODA"])
def test_direct_integration_is_shared(method: str) -> None:
    shared = solver("direct", system(), 80.0, method=method)
    tasks = [lambda omega=omega: points(shared.steady([omega], 1e-4, None, 1, 2, "contact")[0]) for omega in (95, 100)]
    expected = [task() for task in tasks]
    for answers, right in zip(at_once(*(repeated(task, 3) for task in tasks)), expected, strict=True):
        for answer in answers:
            np.testing.assert_array_equal(answer, right)


def test_certificates_are_made_in_several_threads() -> None:
    def pieces() -> np.ndarray:
        certificate = vibeam.simulate(system(), DRIVE, 0.5, certify=True).certificate
        assert certificate is not None
        return certificate.pieces

    expected = pieces()
    for answer in at_once(*[pieces] * THREADS):
        np.testing.assert_array_equal(answer, expected)


@pytest.mark.parametrize("made", [FlightSolver, RegimeSolver])
def test_every_thread_has_working_arrays_of_its_own(made: Callable[..., Any]) -> None:
    shared = made(system(), 80.0)

    def arrays() -> tuple[int, list[int]]:
        work = shared.packed.engine.rest if made is FlightSolver else shared.plan.free
        return get_ident(), [array.ctypes.data for array in work]

    seen = dict(at_once(*[arrays] * THREADS))
    assert len(seen) == THREADS
    every = [place for places in seen.values() for place in places]
    assert len(set(every)) == len(every)


@pytest.mark.parametrize("law", ["restitution", "linear"])
def test_a_sweep_does_not_depend_on_what_its_solver_did_before(law: str) -> None:
    far = vibeam.ImpactSystem.from_modes(
        [6.0, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72, law=LAWS[law], static=[-10.0, 0.0]
    )
    used, fresh = (solver("flight", far, 80.0) for _ in range(2))
    used.simulate(DRIVE, vibeam.State(np.array([-1e-6, 0.0]), np.zeros(2)), 0.0, 0.1, 10**5)
    again, first = (one.steady([95.0], 1e-4, None, 2, 2, "contact")[0] for one in (used, fresh))
    np.testing.assert_array_equal(points(again), points(first))


@pytest.mark.parametrize("law", LAWS)
def test_a_trajectory_can_be_pickled(law: str) -> None:
    path = vibeam.simulate(system(LAWS[law]), DRIVE, 0.5)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(path)).at(TIMES), path.at(TIMES))


def test_a_system_is_packed_once_for_drives_of_one_octave_and_another_anew() -> None:
    one = system()
    first = pack(one, 2.0)
    assert pack(one, 2.0) is first
    assert pack(one, 200.0) is not first
    assert pack(replace(one), 2.0) is not first


def test_motions_by_one_packed_system_do_not_disturb_each_other() -> None:
    one, other = system(), vibeam.Drive(105.0, 2e-4)
    alone, shared = vibeam.simulate(replace(one), DRIVE, 0.5), vibeam.simulate(one, DRIVE, 0.5)
    vibeam.simulate(one, other, 0.5)
    vibeam.sweep(one, omega=[100.0], amplitude=1e-4, settle=10, hold=5)
    np.testing.assert_array_equal(alone.modes_at(TIMES), shared.modes_at(TIMES))


def test_a_time_within_another_does_not_lengthen_it() -> None:
    now = 0.0
    with ending_at(lambda: now, 1.0), ending_at(lambda: now, 5.0):
        pause()
        now = 2.0
        with pytest.raises(OutOfTime):
            pause()
    with ending_at(lambda: now, 5.0), ending_at(lambda: now, 1.0), pytest.raises(OutOfTime):
        pause()
    pause()
