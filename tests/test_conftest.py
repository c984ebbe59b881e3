"""Limits of time, and results of solvers as another processor might have them."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from pathlib import Path

import nudged
import numpy as np
import pytest
from scipy.integrate import solve_ivp

HANGING = """
import ctypes
import pytest

def test_before(): pass

@pytest.mark.timeout(1)
def test_that_hangs(): ctypes.CDLL(None).sleep(600)  # compiled code, which hears no signal

def test_behind(): pass
"""


def test_a_test_that_hangs_is_ended_and_named(tmp_path: Path) -> None:
    (tmp_path / "test_hanging.py").write_text(HANGING)
    command = [sys.executable, "-m", "pytest", "-n", "1", "--timeout-method=thread", "-p", "no:cacheprovider"]
    ran = subprocess.run([*command, str(tmp_path)], cwd=tmp_path, capture_output=True, text=True)
    assert "crashed while running 'test_hanging.py::test_that_hangs'" in ran.stdout
    assert "1 failed, 2 passed" in ran.stdout
    assert ran.returncode == 1


def test_every_test_has_a_limit(request: pytest.FixtureRequest) -> None:
    assert request.config.pluginmanager.hasplugin("timeout")
    assert float(request.config.getini("timeout")) == 120
    assert request.config.getini("timeout_method") == "thread"


def test_a_nudged_result_is_one_unit_in_the_last_place_away() -> None:
    def floor(t: float, y: np.ndarray) -> float:
        return float(y[0])

    floor.terminal = True  # type: ignore[attr-defined]
    found = [solve_ivp(lambda t, y: [y[1], -9.81], (0.0, end), [1.0, 0.0], events=floor) for end in (3.0, 0.1)]
    for each in found:
        before, time, event = each.y.copy(), each.t.copy(), [one.copy() for one in each.t_events]
        after = nudged.nudge(each)
        assert np.all(np.abs(after.y - before) == np.spacing(np.minimum(np.abs(after.y), np.abs(before))))
        assert np.array_equal(after.t[:-1], time[:-1])
        assert (after.t[-1] != time[-1]) == (after.status == 1)
        assert all(np.all(a != b) for a, b in zip(after.t_events, event, strict=True))


def test_no_two_files_of_tests_have_one_name() -> None:
    """Without packages pytest would take the second one for the first."""
    names = [each.name for each in Path(__file__).parent.rglob("test_*.py")]
    assert [name for name, number in Counter(names).items() if number > 1] == []
