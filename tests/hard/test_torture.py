"""The torture: a short part of it, and that its checks can fail."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torture
from energy_balance import balance
from progress import Idleness
from rig_checks import penetration
from rigs import random_rig
from verdict import Verdict
from workers import Lost, Stage, answers

import vibeam
from vibeam.casefile.read import parse
from vibeam.flight.event_driven import Segments

SEED, FEW = 2, (0, 1, 3, 4)

SYSTEM = vibeam.ImpactSystem.from_modes(
    [1.0, 6.1], 0.02, [1.0, 0.4], [1.0, 0.2], gap=0.1, restitution=0.7, static=[0.05, 0.0]
)
DRIVE = vibeam.Drive(1.7, 0.2)


@pytest.fixture(scope="module")
def path() -> vibeam.Trajectory:
    return vibeam.simulate(SYSTEM, DRIVE, 60.0)


def test_a_few_rigs_hold() -> None:
    judged = torture.judged(torture.PARTS["rigs"], SEED, FEW)
    found = {number: verdict.findings for number, verdict, _ in judged}
    assert found == {number: [] for number in FEW}


@pytest.mark.parametrize("number", [1493, 4962])
def test_rigs_that_once_had_findings(number: int) -> None:
    """A tiny start beside a strong drive; the end of an accumulation whose velocities are round-off of the response."""
    ((_, verdict, _),) = torture.judged(torture.PARTS["rigs"], 1, [number])
    assert verdict.findings == []


def test_rigs_are_cases_known_by_seed_and_number() -> None:
    assert random_rig(1, 3) == random_rig(1, 3) != random_rig(1, 4)
    assert parse(random_rig(1, 3)).fidelities.keys() == {"flown"}


def test_the_balance_closes(path: vibeam.Trajectory) -> None:
    found = balance(path, np.random.default_rng(1), 1e7)
    assert found.segments == len(path.segments.trace) > 15
    assert max(found.flow, found.impact) < 1e-13
    assert found.gained <= 0


@pytest.mark.parametrize(
    ("name", "change", "least"),
    [
        ("impact", {"restitution": 0.7 * (1 + 1e-8)}, 1e-9),
        ("flow", {"zeta": np.array([0.02, 0.02 * (1 + 1e-6)])}, 1e-11),
        ("flow", {"load": np.array([1.0 + 1e-9, 0.2])}, 1e-11),
    ],
)
def test_the_balance_sees_another_system(path: vibeam.Trajectory, name: str, change: dict, least: float) -> None:
    other = replace(path, system=replace(SYSTEM, **change))
    assert getattr(balance(other, np.random.default_rng(1), 1e7), name) > least


def test_penetration_is_seen(path: vibeam.Trajectory) -> None:
    assert penetration(path) < 1e-14
    assert penetration(replace(path, system=replace(SYSTEM, gap=0.1 - 1e-9))) > 1e-10
    moved = Segments(path.segments.trace, path.segments.poses + 1e-9, path.segments.size)
    assert penetration(replace(path, segments=moved)) > 1e-10


def _task(number: int, stage: Stage) -> Verdict:
    stage("work")
    if number == 1:
        raise ValueError("one")
    while number == 2:
        pass
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return Verdict(counts={"numbers": 1}, worst={"largest": number})


def test_what_hangs_or_crashes_is_lost_and_the_rest_goes_on() -> None:
    found = {number: answer for number, answer, _ in answers(_task, range(5), 0.3)}
    assert found[0] == Verdict({"numbers": 1}, {"largest": 0})
    assert isinstance(found[1], ValueError)
    assert isinstance(found[2], Lost)
    assert str(found[2]) == "no answer within 0.3 s of CPU time, in work"
    assert str(found[3]) == "the process ended with SIGKILL, in work"
    assert found[4].counts == {"numbers": 1}


@pytest.mark.parametrize(("command", "waits"), [("sleep 60", True), ("(while :; do :; done) & wait", False)])
def test_only_what_neither_works_nor_could_waits(command: str, waits: bool) -> None:
    """A process whose child is busy, or is queued for a processor, does not, however long it takes."""
    process = subprocess.Popen(["sh", "-c", command], start_new_session=True)
    try:
        idleness, asked = Idleness(process.pid, 0.2), 0
        while not (lasts := idleness.lasts()) and (waits or asked < 10):
            time.sleep(0.05)
            asked += 1
        assert lasts == waits
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def test_the_time_of_commands_counts_too() -> None:
    def wait(number: int, stage: Stage) -> Verdict:
        subprocess.run([sys.executable, "-c", "x = sum(range(10_000_000))"], check=True)
        return Verdict()

    ((_, _, seconds),) = answers(wait, [0], 60.0)
    assert seconds > 0.05


def test_a_run_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "report.json"
    monkeypatch.setitem(torture.PARTS, "rigs", torture.Part("test_torture", 0.3, judge="_judge"))
    monkeypatch.setattr(torture.report, "commit", lambda: "abc")
    assert torture.go_on("rigs", 5, torture.report.left("rigs", 5, range(2), file), file) == 1
    assert torture.go_on("rigs", 5, torture.report.left("rigs", 5, range(5), file), file) == 2
    (span,) = torture.report.spans("rigs", file)
    assert (span.first, span.count, span.counts, span.worst) == (0, 5, {"numbers": 2}, {"largest": 4})
    assert sorted(span.findings) == ["1", "2", "3"]
    assert torture.again("rigs", file) == 3


def _judge(seed: int, number: int, stage: Stage) -> Verdict:
    assert seed == 5
    return _task(number, stage)
