"""Loops of tests and scripts: none may run for ever because a processor's last digits never reach its end.

A ``while`` that compares numbers computed in floating point (a time with its end, a speed with a threshold) may be kept
alive by rounding: `solve_ivp` from event to event may find the same instant again and again. Such a loop counts its
rounds: ``while within(t < end)`` of ``support/bounded.py``, or a ``for`` over a range. Numbers of arbitrary precision
are the same on every processor; their programs and scripts are left out.
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from bounded import Bound

ROOT = Path(__file__).parents[1]
FOLDERS = ("tests", "cases", ".ci")
PRECISE = (
    "tests/independent/",
    "tests/hard/scenes.py",
    "tests/hard/test_chatter.py",
    "tests/others/program_contacts.py",
)
KILLED = ("tests/others/scenes/",)  # each run is a process with a limit of time (attempt.py)
FILES = sorted(file for folder in FOLDERS for file in (ROOT / folder).rglob("*.py") if "__pycache__" not in file.parts)
ORDER = ast.Lt | ast.LtE | ast.Gt | ast.GtE
COUNTS = ("len", "sum", "monotonic", "process_time")


def unbounded(text: str) -> list[str]:
    """Conditions of loops that floating point decides alone."""
    return [ast.unparse(each.test) for each in ast.walk(ast.parse(text)) if isinstance(each, ast.While) if _open(each)]


def _open(loop: ast.While) -> bool:
    if isinstance(loop.test, ast.Call):
        return False
    orders = [each for each in ast.walk(loop.test) if isinstance(each, ast.Compare) and isinstance(each.ops[0], ORDER)]
    return bool(orders) and not any(_counts(side) for each in orders for side in (each.left, *each.comparators))


def _counts(side: ast.expr) -> bool:
    if isinstance(side, ast.Constant):
        return isinstance(side.value, int) and side.value > 1
    called = [ast.unparse(each.func) for each in ast.walk(side) if isinstance(each, ast.Call)]
    return any(each.split(".")[-1] in COUNTS for each in called)


def test_no_loop_hangs_on_last_digits() -> None:
    names = {file: file.relative_to(ROOT).as_posix() for file in FILES}
    judged = [file for file, name in names.items() if not name.startswith(PRECISE + KILLED)]
    assert len(judged) > 300
    found = {names[file]: loops for file in judged if (loops := unbounded(file.read_text(encoding="utf-8")))}
    assert found == {}


@pytest.mark.parametrize(
    "condition", ["t < end", "speed > 1e-12", "end - t > 0", "not failed and t < end", "self.t <= x"]
)
def test_a_loop_over_a_time_is_seen(condition: str) -> None:
    assert len(unbounded(f"while {condition}:\n    pass\n")) == 1


@pytest.mark.parametrize("condition", ["within(t < end)", "len(found) < count", "queue", "time.monotonic() < until"])
def test_a_loop_that_counts_is_none(condition: str) -> None:
    assert unbounded(f"while {condition}:\n    pass\n") == []


def test_a_bound_ends_a_loop_that_does_not() -> None:
    within = Bound(3)
    assert [within(True) for _ in range(3)] == [True] * 3
    with pytest.raises(AssertionError, match="not at its end after 3 rounds"):
        within(True)
    assert not Bound()(1 > 2)
