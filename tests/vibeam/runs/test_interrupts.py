"""Long work ends where it is told to: settling for ever is left soon, from any thread, and what was whole is kept."""

from __future__ import annotations

import time
from threading import Event
from typing import Any

import numpy as np
import pytest
from apart import run_apart

import vibeam
from vibeam.flight.engine import threads as pause
from vibeam.runs import parallel
from vibeam.runs.parallel import heartbeat
from vibeam.runs.sweep import march
from vibeam.solvers.integration import stepper
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

FOREVER = """
import os, signal, threading
import numpy as np
import vibeam
from vibeam.flight.engine import threads as pause
from vibeam.runs.parallel import run_parallel
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

system = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72, law={law}
)
real, paused, by_signal = pause.pause, threading.Event(), True

def heard():
    if not paused.is_set():
        paused.set()
        if by_signal:
            os.kill(os.getpid(), signal.SIGINT)
    real()

pause.pause = heard

def settle_for_ever(item=None, stop=None):
    vibeam.sweep(system, omega=[95.0], amplitude=1e-4, settle=10**9, hold=1)

def fail_soon(item, stop):
    if item == 0 and not by_signal:
        paused.wait()
        raise ZeroDivisionError
    settle_for_ever()

for by_signal, in_threads in ((True, False), (True, True), (False, True)):
    paused.clear()
    try:
        run_parallel(fail_soon, range(3), workers=3) if in_threads else settle_for_ever()
    except (KeyboardInterrupt, ZeroDivisionError) as error:
        print(type(error).__name__, flush=True)
"""
LAWS = ["None", "LinearStop(1e6, 1.0)", "HuntCrossley(1e8, 0.5)"]


@pytest.mark.parametrize("law", LAWS)
def test_settling_for_ever_is_left(law: str) -> None:
    """By Ctrl-C in the main thread, by Ctrl-C while threads work, and where another thread fails."""
    printed = run_apart(FOREVER.format(law=law))
    assert printed.split() == ["KeyboardInterrupt", "KeyboardInterrupt", "ZeroDivisionError"]


@pytest.mark.parametrize(
    ("law", "settle"), [(None, 400_000), (LinearStop(1e6, 1.0), 40_000), (HuntCrossley(1e8, 0.5), 4000)]
)
def test_a_pause_leaves_no_trace_in_the_next_point(monkeypatch: pytest.MonkeyPatch, law: Any, settle: int) -> None:
    """A point after one that paused is to the bit what it is from the same state, and so is one point made twice."""
    pauses = []
    monkeypatch.setattr(pause, "pause", lambda: pauses.append(1))
    system = vibeam.ImpactSystem.from_modes([47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], restitution=0.72, law=law)
    both = list(march(system, [95.0, 97.0], 1e-4, settle=settle, hold=4))
    assert pauses
    again = list(march(system, [97.0], 1e-4, settle=settle, hold=4, state=both[0][1], slowest=95.0))
    np.testing.assert_array_equal(again[0][1].displacement, both[1][1].displacement)
    np.testing.assert_array_equal(again[0][0].maximum, both[1][0].maximum)
    assert again[0][0].impacts == both[1][0].impacts


@pytest.mark.parametrize("solver", ["direct", "moreau"])
def test_solvers_that_step_hear_it_too(monkeypatch: pytest.MonkeyPatch, solver: str) -> None:
    heard = 0

    def stop() -> None:
        nonlocal heard
        heard += 1
        if heard == 50:
            raise pause.Stopped

    monkeypatch.setattr(stepper, "pause", stop)
    system = vibeam.ImpactSystem.from_modes([1.0], 0.1, 1.0, 1.0, restitution=0.7)
    with pytest.raises(pause.Stopped):
        vibeam.sweep(system, omega=[2.0], amplitude=1.0, settle=10**6, hold=1, solver=solver)


class _Late(Event):
    """Set after so many looks at it."""

    left = 100

    def is_set(self) -> bool:
        self.left -= 1
        return self.left < 0


def test_exponents_are_left_between_two_segments_of_a_motion() -> None:
    """A motion with chatter has hundreds of segments in a few periods, each with a matrix exponential."""
    system = vibeam.ImpactSystem.from_modes([47.7, 190.8], 0.01, [2.0, 1.0], [0.5, 0.2], restitution=0.3, gap=-1e-5)
    with pause.stopping_at(_Late()), pytest.raises(pause.Stopped):
        vibeam.lyapunov(system, vibeam.Drive(95.0, 2e-4), settle=0, periods=20)


def test_a_line_comes_every_few_seconds_while_one_piece_lasts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parallel, "EVERY", 0.01)
    told: list[str] = []
    with heartbeat(told.append, lambda: "beam: 8 of 61 rows"):
        while len(told) < 3:
            time.sleep(0.001)
    count = len(told)
    time.sleep(0.05)
    assert len(told) == count
    assert told[0].startswith("beam: 8 of 61 rows, 0 s of CPU time")
