"""A cost is what the user would pay again: first calls are made unmeasured, and what compiles is named."""

from __future__ import annotations

import logging
import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba import njit
from stand_in import RIG, SDOF, same

import vibeam
from vibeam.casefile.read import parse
from vibeam.flight import solver as warm_up_motion
from vibeam.flight.engine import compilation
from vibeam.flight.engine.compilation import KERNELS, announce
from vibeam.flight.solver import FlightSolver
from vibeam.solvers import steady as warm_up
from vibeam.studies.cost.study import cost
from vibeam.studies.effects import influence

ROOT = Path(vibeam.__file__).parent
FIRST = 100.0  # seconds that the stub clock adds for the first call of a kernel


class SlowFirst:
    """A clock, and kernels whose first call takes ``FIRST`` seconds on it, as one that is loaded or compiled does."""

    def __init__(self) -> None:
        self.now, self.calls = 0.0, Counter[str]()

    def __call__(self) -> float:
        self.now += 1e-6
        return self.now

    def behind(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def called(*words: Any) -> Any:
            self.now += 0.0 if self.calls[name] else FIRST
            self.calls[name] += 1
            return function(*words)

        return called


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SlowFirst:
    """Every ``thread_time`` looks at it, and the flight kernels are slow once."""
    clock = SlowFirst()
    monkeypatch.setattr("time.thread_time", clock)
    monkeypatch.setattr(FlightSolver, "_move", staticmethod(clock.behind("move", FlightSolver._move)))
    monkeypatch.setattr(warm_up, "_READY", set())
    monkeypatch.setattr(warm_up_motion, "_READY", set())
    return clock


def test_no_fidelity_of_a_run_pays_for_the_first_call(clock: SlowFirst, tmp_path: Path) -> None:
    result = vibeam.run(parse(SDOF + "[fidelity.again]\n"), out=tmp_path / "a.h5")
    kept = vibeam.run(parse(SDOF + "[fidelity.again]\n"), out=tmp_path / "a.h5")
    assert clock.calls["move"] > 20
    for found in (result, kept):
        assert max(np.max(each.cpu_seconds) for name in found for _, each in found[name].items()) < 1


def test_what_is_there_already_is_not_warmed_up_again(clock: SlowFirst, tmp_path: Path) -> None:
    vibeam.run(parse(SDOF), out=tmp_path / "a.h5")
    before = clock.calls["move"]
    vibeam.run(parse(SDOF), out=tmp_path / "a.h5")
    assert clock.calls["move"] == before


def test_a_sweep_and_a_motion_from_python_do_not_pay_either(clock: SlowFirst) -> None:
    system = parse(SDOF).system("sdof")
    swept = vibeam.sweep(system, omega=[1.9, 2.0], amplitude=5e-4, settle=2, hold=2)
    assert np.max(swept.cpu_seconds) < 1
    clock.calls.clear()
    assert vibeam.simulate(system, vibeam.Drive(2.0, 5e-4), 10.0).stats["cpu_seconds"] < 1
    undriven = vibeam.simulate(system, vibeam.Drive(0.0, 0.0), 10.0)
    assert undriven.ended is vibeam.Ended.COMPLETE


def test_the_clock_would_tell(clock: SlowFirst) -> None:
    """The check can fail: without the warm-up the first point has it all."""
    made = FlightSolver(parse(SDOF).system("sdof"), 1.5)
    first, _ = made.steady([2.0, 2.0], 5e-4, None, 1, 2, "contact")
    assert first.cpu_seconds[0] > FIRST > 1 > first.cpu_seconds[1]


def test_studies_are_warm(clock: SlowFirst) -> None:
    asked = '[cost]\nsettle = 5\nhold = 2\nfrequency = ["2 rad/s"]\nsolvers = ["flight"]\nbudget = "3000 s"\n'
    study = cost(parse(SDOF + asked), clock=clock)
    assert [row.used < 1 for row in study.rows] == [True]


def test_an_influence_is_warm(clock: SlowFirst) -> None:
    settings = {"influence.points": 3, "influence.settle": 2, "influence.hold": 2}
    settings |= {"beam.elements": 6, "mass.rigid_half_width": None, "influence.fidelity": "sdof"}
    found = influence(parse(RIG.read_text(encoding="utf-8").split("[reference")[0], set=settings))
    assert max(found.whole.seconds.max(), found.rows[0].without.seconds) < 1


def test_warming_up_changes_no_bit() -> None:
    system = parse(SDOF).system("sdof")
    plain, _ = FlightSolver(system, 1.9).steady([1.9, 2.0], 5e-4, None, 20, 5, "contact")
    swept = vibeam.sweep(system, omega=[1.9, 2.0], amplitude=5e-4, settle=20, hold=5)
    assert same(plain, swept, but=("cpu_seconds",))


def test_every_entry_point_has_a_name_to_be_announced_by() -> None:
    found = set()
    for path in ROOT.rglob("*.py"):
        module = ".".join(("vibeam", *path.relative_to(ROOT).with_suffix("").parts))
        names = re.findall(r"\n@entry\ndef (\w+)", path.read_text(encoding="utf-8"))
        found |= {f"{module}.{name}" for name in names}
    assert found == set(KERNELS)


def test_a_compilation_is_told_once_and_a_kernel_that_is_there_is_not(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    announce()
    inner = njit(lambda x: x + 1)
    outer = njit(lambda x: inner(x) * 2)
    monkeypatch.setitem(
        compilation.KERNELS, f"{__name__}.{inner.py_func.__qualname__}", ("a kernel of this test", "no time")
    )
    with caplog.at_level(logging.WARNING, logger="vibeam"):
        assert outer(1) == 4
        assert outer(2) == 6
        assert outer(1.5) == 5.0
    assert [each.getMessage() for each in caplog.records] == [
        "compiling a kernel of this test (first use only, no time)"
    ]
