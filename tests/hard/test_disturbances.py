"""A short part of mutants, kills, races, damage and environments; that they can find something."""

from __future__ import annotations

import os
import signal
import time
from functools import partial
from pathlib import Path

import commands
import damage
import environment
import kills
import limited
import mutant_runs
import mutants
import numpy as np
import pytest
import races
import scarce
from commands import BEAM, FORMULA, difference, fault_of_completion, fault_of_message, undisturbed, vibeam, write_case
from limited import GIB, Limits, run_limited

from vibeam.exchange.faults import CaseError, Fault

SEED = 2


def nothing(stage: str) -> None:
    """Nobody listens."""


@pytest.fixture(autouse=True)
def one_case(monkeypatch: pytest.MonkeyPatch) -> None:
    """The part of the gate disturbs one short case."""
    short = {"curves": BEAM.replace("points = 61", "points = 21") + FORMULA}
    for module in (commands, kills, races, scarce, damage, environment):
        monkeypatch.setattr(module, "DISTURBED", short)


def test_mutants_are_cases_or_case_errors() -> None:
    verdicts = [mutants.judge(SEED, number, nothing) for number in range(40)]
    assert [each.findings for each in verdicts if each.findings] == []
    assert sum("CaseError" in each.counts for each in verdicts) > 20
    assert sum("Case" in each.counts for each in verdicts) > 3


def test_mutants_are_known_by_seed_and_number() -> None:
    assert mutants.mutant(1, 3) == mutants.mutant(1, 3) != mutants.mutant(1, 4)


def test_a_message_without_a_place_or_with_what_steers_a_terminal_is_a_fault() -> None:
    faults = [
        Fault("a.toml", 9, "a", "beyond the end"),
        Fault("a.toml", 1, "a", "x" * 5000),
        Fault("--set", 1, "a", ""),
    ]
    assert all(mutants.fault_of_message(CaseError([fault]), b"one\ntwo") for fault in faults)
    assert mutants.fault_of_message(CaseError([Fault("a.toml", 2, "a", "wrong")]), b"one\ntwo") == ""


def test_a_mutant_that_loads_runs() -> None:
    assert mutant_runs.judge(SEED, 1, nothing).findings == []


def _spin() -> None:
    while True:
        pass


def _grow() -> None:
    np.ones(GIB // 8 // 8)


@pytest.mark.parametrize(
    ("work", "said", "cpu"),
    [(_spin, "no end in 1 s", 1), (_grow, "GiB", 60), (lambda: os.kill(os.getpid(), signal.SIGSEGV), "SIGSEGV", 60),
     (lambda: [][1], "IndexError", 60), (lambda: os._exit(2), "without a message", 60)],
)  # fmt: skip
def test_what_no_command_may_do_is_seen(work: object, said: str, cpu: int, tmp_path: Path) -> None:
    status = Path("/proc/self/status").read_text(encoding="ascii")
    begins = 1024 * int(status.partition("RssAnon:")[2].split()[0])  # a fork has no pages of files yet
    limits = Limits(cpu=cpu, memory=begins + GIB // 16)
    assert said in run_limited(work, tmp_path, limits).fault(limits)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_a_command_that_ends_well_has_no_fault(tmp_path: Path) -> None:
    ended = run_limited(lambda: print("x"), tmp_path, limited.Limits())
    assert (ended.code, ended.out, ended.fault(Limits())) == (0, "x\n", "")


@pytest.mark.parametrize(("module", "number"), [(kills, 4), (races, 0)], ids=["kills", "races"])
def test_a_run_that_is_disturbed_ends_as_if_it_were_not(module: object, number: int) -> None:
    """Killed once; ``torture.py kills`` kills up to three times."""
    verdict = module.judge(SEED, number, nothing)  # type: ignore[attr-defined]
    assert verdict.findings == []
    assert verdict.counts


def test_a_run_that_lacks_something_says_so_and_goes_on() -> None:
    assert scarce.judge(SEED, 3, nothing).findings == []


@pytest.mark.parametrize("number", range(len(damage.KINDS)))
def test_a_damaged_file_is_refused_or_run_anew(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damage, "half_done", lambda name: {f"{name}.h5": undisturbed(name).content})
    assert damage.judge(SEED, number, nothing).findings == []


def test_another_result_and_a_traceback_are_seen(tmp_path: Path) -> None:
    file = tmp_path / "curves.h5"
    write_case("curves", tmp_path)
    file.write_bytes(undisturbed("curves").content)
    assert difference(file, "curves") == ""
    with commands.h5py.File(file, "r+") as opened:
        opened["sdof/up/amplitude"][3] *= 1 + 1e-15
    assert "sdof/up/amplitude" in difference(file, "curves")
    assert "damaged" in fault_of_completion("curves", tmp_path)
    assert "exit 0" in fault_of_message(commands.Run(0, "", "Traceback (most recent call last):", 1.0), [0])
    assert "exit -9" in fault_of_message(commands.Run(-9, "", "", 1.0), [0, 2])


def test_a_kill_comes_when_it_should(tmp_path: Path) -> None:
    write_case("curves", tmp_path)
    begun = time.monotonic()
    assert vibeam(["run", "curves.toml"], tmp_path, kill=(0.1, signal.SIGKILL)).code == -signal.SIGKILL
    assert time.monotonic() - begun > 0.1


def test_odd_folders_where_warnings_are_errors_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(environment, "vibeam", partial(vibeam, interpreter=("-W", "error")))
    assert environment.fault_in("odd folders", "curves") == ""
