"""A run: each point once, whatever stops it, and the same numbers as without a stop."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import SDOF, Solver, case, same, system

from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError, Fault
from vibeam.flight.engine.threads import Stopped
from vibeam.runs import fidelity_sweep
from vibeam.runs.parallel import Interrupted, run_parallel
from vibeam.runs.result import Result
from vibeam.runs.run import run
from vibeam.runs.sweep import SweepPoints, SweepSettings

POINTS = 2 * 2 * 8  # fidelities, directions, frequencies


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> Solver:
    return use(monkeypatch, Solver())


def use(monkeypatch: pytest.MonkeyPatch, solver: Solver) -> Solver:
    monkeypatch.setattr(fidelity_sweep, "march_blocks", solver)
    monkeypatch.setattr(fidelity_sweep, "WRITE_EVERY", 0.0)
    return solver


def alike(one: Result, other: Result, but: tuple[str, ...] = ()) -> bool:
    pairs = [(one[name], other[name]) for name in one]
    return all(same(a.up, b.up, but) and same(a.down, b.down, but) for a, b in pairs if a.up and b.up)


def test_sweeps_up_then_down_with_the_state_carried(solver: Solver) -> None:
    result = run(case())
    assert list(result) == ["one", "three"]
    up, down = result["one"].up, result["one"].down
    assert up is not None
    assert down is not None
    assert np.array_equal(up.frequency, np.linspace(14.0, 17.0, 8))
    assert np.array_equal(down.frequency, up.frequency[::-1])
    omega = [each for modes, each in solver.calls if modes == 1]
    assert np.array_equal(omega, 2 * np.pi * np.concatenate((up.frequency, down.frequency)))
    straight = [block.amplitude[0] for block, _ in Solver()(system(1), SweepPoints.of(omega, 1e-3), SweepSettings())]
    assert np.array_equal(np.concatenate((up.amplitude, down.amplitude)), straight)


@pytest.mark.parametrize("direction", ["up", "down"])
def test_one_direction_alone(solver: Solver, direction: str) -> None:
    branches = run(case(direction=direction))["one"]
    assert [way for way, _ in branches.items()] == [direction]
    assert (branches.up is None) == (direction == "down")


def test_a_run_that_is_there_is_not_computed_again(solver: Solver, tmp_path: Path) -> None:
    first = run(case(), tmp_path / "a.h5")
    assert (len(solver.calls), first.found, first.total, first.path) == (POINTS, 0, POINTS, tmp_path / "a.h5")
    again = run(case(), tmp_path / "a.h5")
    assert (len(solver.calls), again.found) == (POINTS, POINTS)
    assert alike(first, again)


@pytest.mark.parametrize("stop", [1, 7, 8, 9, 20, 31])
@pytest.mark.parametrize("failure", [ZeroDivisionError(), KeyboardInterrupt()])
def test_a_stopped_run_goes_on_to_the_same_bits(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, stop: int, failure: BaseException
) -> None:
    stopped = use(monkeypatch, Solver(fail_at=stop, failure=failure))
    with pytest.raises((ZeroDivisionError, KeyboardInterrupt)):
        run(case(), tmp_path / "a.h5")
    rest = use(monkeypatch, Solver())
    continued = run(case(), tmp_path / "a.h5")
    assert continued.found == len(stopped.calls)
    assert len(stopped.calls) + len(rest.calls) == POINTS
    assert alike(continued, run(case()))


def test_changing_less_than_a_bit_of_the_state_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The comparison above can fail: the stand-in's map tells states apart that differ in the last bit."""
    use(monkeypatch, Solver())
    first = run(case())
    monkeypatch.setattr(Solver, "_next", staticmethod(_off_by_a_bit(Solver._next)))
    assert not alike(first, run(case()))


def _off_by_a_bit(step: Any) -> Any:
    def off(state: Any, omega: float) -> Any:
        state = step(state, omega)
        return type(state)(np.nextafter(state.displacement, 2.0), state.velocity, state.resting)

    return off


KILLED = """
import sys
sys.path[:0] = {path!r}
from stand_in import Solver, case
from vibeam.runs import fidelity_sweep
from vibeam.runs.run import run
fidelity_sweep.march_blocks, fidelity_sweep.WRITE_EVERY = Solver(fail_at=20), {every}
run(case(), {file!r})
"""


@pytest.mark.parametrize("every", [0.0, 3600.0])
def test_a_killed_run_goes_on_to_the_same_bits(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, every: float) -> None:
    file = tmp_path / "a.h5"
    script = KILLED.format(path=[str(Path(__file__).parents[2] / "support"), *sys.path], every=every, file=str(file))
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -9
    rest = use(monkeypatch, Solver())
    continued = run(case(), file)
    assert continued.found == POINTS - len(rest.calls)
    assert continued.found in ((19, 20) if every == 0.0 else (0, 8, 16))
    assert alike(continued, run(case()))


def test_a_fidelity_that_cannot_be_built_stops_before_any_file(tmp_path: Path) -> None:
    def none(name: str) -> None:
        raise ValueError(f"{name} cannot be")

    def fault(*path: str, message: str) -> Fault:
        return Fault("a.toml", 7, ".".join(path), message)

    with pytest.raises(CaseError) as caught:
        run(case(system=none, fault=fault), tmp_path / "a.h5")
    wanted = [f"a.toml:7: fidelity.{name}: {name} cannot be" for name in ("one", "three")]
    assert [str(each) for each in caught.value.faults] == wanted
    assert not list(tmp_path.iterdir())


def test_a_failure_at_the_first_point_leaves_no_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use(monkeypatch, Solver(fail_at=0, failure=ZeroDivisionError()))
    with pytest.raises(ZeroDivisionError):
        run(case(), tmp_path / "a.h5")
    assert not list(tmp_path.iterdir())


def test_says_how_to_go_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use(monkeypatch, Solver(fail_at=9, failure=KeyboardInterrupt()))
    with pytest.raises(Interrupted, match=r"stopped: (9|10) of 32 points are kept in .*a\.h5: the same command"):
        run(case(), tmp_path / "a.h5")
    with pytest.raises(Interrupted, match="nothing is kept"):
        run(case())


def test_tells_every_point_and_what_was_there(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use(monkeypatch, Solver(fail_at=5, failure=ZeroDivisionError()))
    with pytest.raises(ZeroDivisionError):
        run(case(), tmp_path / "a.h5")
    use(monkeypatch, Solver())
    told: list[tuple[int, int]] = []
    run(case(), tmp_path / "a.h5", progress=lambda done, total: told.append((done, total)))
    assert told == [(done, POINTS) for done in range(told[0][0], POINTS + 1)]
    assert told[0][0] in (5, 6)


@pytest.mark.parametrize("stop", [1, 2, 3, 5])
def test_the_real_flight_goes_on_to_the_same_bits(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, stop: int) -> None:
    """On a pressed stop, where motions are chaotic, and over more than an octave."""
    settings = {"stop.gap": -0.5e-3, "sweep.frequency.from": "0.6 rad/s", "sweep.frequency.points": 9}
    real, nominal = fidelity_sweep.march_blocks, parse(SDOF, set=settings)
    blocks: list[int] = []

    def interrupted(*given: Any, **options: Any) -> Any:
        for block in real(*given, **options):
            if len(blocks) == stop:
                raise ZeroDivisionError
            blocks.append(len(block[0]))
            yield block

    monkeypatch.setattr(fidelity_sweep, "march_blocks", interrupted)
    with pytest.raises(ZeroDivisionError):
        run(nominal, tmp_path / "a.h5")
    monkeypatch.setattr(fidelity_sweep, "march_blocks", real)
    continued = run(nominal, tmp_path / "a.h5")
    assert continued.found == sum(blocks)
    assert alike(continued, run(nominal), but=("cpu_seconds",))


def test_spread_keeps_the_order_and_raises_the_failure() -> None:
    assert run_parallel(lambda item, stop: item**2, range(20)) == [item**2 for item in range(20)]

    def task(item: int, stop: threading.Event) -> int:
        if item == 3:
            raise ZeroDivisionError("three")
        if not stop.wait(20):
            raise TimeoutError
        raise Stopped

    with pytest.raises(ZeroDivisionError, match="three"):
        run_parallel(task, range(5), workers=4)
