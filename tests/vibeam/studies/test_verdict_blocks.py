"""Blocks of a fidelity map on disk: a run that is killed goes on, computes nothing twice, and ends in the same bits."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.maps import evaluate, run
from vibeam.store.steps import StepFile

CASES = Path(__file__).parents[3] / "cases"
QUICK = {"sweep.settle": 100, "sweep.hold": 20, "beam.elements": 8, "fidelity.beam.modes": 3}
CHAOTIC = {"low": "-0.14 mm", "high": "-0.12 mm", "points": 4, "frequencies": 2}
TWO = ["sdof", "two_modes"]


@pytest.fixture
def case() -> vibeam.Case:
    return vibeam.load(CASES / "dtu_neutral.toml", QUICK)


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Blocks of two rows, and a list of those that were computed."""
    computed: list[Any] = []
    whole = run.evaluate_here

    def counted(block: Any) -> Any:
        computed.append((block.grid.fidelity, block.first))
        return whole(block)

    monkeypatch.setattr(evaluate, "TOGETHER", 2)
    monkeypatch.setattr(run, "evaluate_here", counted)
    return computed


def assert_same(one: vibeam.FidelityMap, other: vibeam.FidelityMap) -> None:
    """Equal to the bit, times aside."""
    np.testing.assert_array_equal(one.label, other.label)
    for mine, theirs in zip(one.models, other.models, strict=True):
        for name in ("value", "error", "kind", "count"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(theirs, name), err_msg=name)
    for mine_, theirs_ in zip(one.boundaries, other.boundaries, strict=True):
        np.testing.assert_array_equal(mine_.frequency, theirs_.frequency)


def test_a_run_that_ended_goes_on_and_computes_nothing_twice(
    case: vibeam.Case, rows: list[Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted(Exception):
        pass

    stored, append = list[int](), StepFile.append

    def ending(file: StepFile, said: Path, number: int, values: Any, sync: bool = True) -> None:
        if len(stored) == 2:
            raise Interrupted
        stored.append(number)
        append(file, said, number, values, sync)

    out = tmp_path / "m.h5"
    undisturbed = vibeam.fidelity_map(case, fidelities=TWO, **CHAOTIC)
    assert len(rows) == 4
    assert any((model.kind == 0).any() for model in undisturbed.models)  # no repeat: their bits say most
    with monkeypatch.context() as patch:
        patch.setattr(StepFile, "append", ending)
        with pytest.raises(Interrupted):
            vibeam.fidelity_map(case, fidelities=TWO, **CHAOTIC, out=out)
    rows.clear()
    told: list[Any] = []
    found = vibeam.fidelity_map(case, fidelities=TWO, **CHAOTIC, out=out, progress=lambda *at: told.append(at))
    assert_same(found, undisturbed)
    assert len(rows) == 2
    assert told[0] == (16, 32)
    assert max(told) == (32, 32)
    rows.clear()
    assert_same(vibeam.fidelity_map(case, fidelities=TWO, **CHAOTIC, out=out), undisturbed)
    assert rows == []
    assert vibeam.fidelity_map(case, fidelities=TWO, **CHAOTIC, accuracy="3 %", out=out).plan.accuracy == 0.03
    assert rows == []  # nothing is flown for another accuracy
    before = out.read_bytes()
    with pytest.warns(UserWarning, match="holds the map of the case as it was; its results are kept aside as"):
        vibeam.fidelity_map(case, fidelities=TWO, **(CHAOTIC | {"frequencies": 3}), out=out)
    assert out.with_name(f"{out.stem}.1.h5").read_bytes() == before


COMMAND = (
    "dtu_neutral.toml --picture verdict --points 24,5 --from=-0.2mm --to=0mm --fidelity sdof"
    " --fidelity two_modes --set sweep.settle=200 --set sweep.hold=30 --set beam.elements=8 --out"
)  # fmt: skip


def begun(out: Path) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "vibeam", "map", *COMMAND.split(), str(out)]
    return subprocess.Popen(words, cwd=CASES, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_killed_at_any_instant_it_goes_on_to_the_same_bits(tmp_path: Path, seed: int) -> None:
    undisturbed, killed = tmp_path / "undisturbed.h5", tmp_path / "killed.h5"
    started = time.monotonic()
    assert begun(undisturbed).wait() == 0
    duration = time.monotonic() - started
    rng, parts = np.random.default_rng(seed), tmp_path / "killed.h5.parts"
    stored: dict[str, bytes] = {}
    for _ in range(2):
        process = begun(killed)
        time.sleep(float(rng.uniform(0.2, 0.8)) * duration)
        process.send_signal(signal.SIGKILL)
        if process.wait() == 0:  # it was quicker, and all is done
            break
        found = {path.name: path.read_bytes() for path in parts.glob("[!.]*.steps")}
        assert all(found[name].startswith(each) for name, each in stored.items())  # what was there is there
        stored = found
    assert begun(killed).wait() == 0
    assert killed.with_suffix(".csv").read_bytes() == undisturbed.with_suffix(".csv").read_bytes()
    assert not parts.exists()
