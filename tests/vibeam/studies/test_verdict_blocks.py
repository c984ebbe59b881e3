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
from vibeam.maps.job import write_block
from vibeam.studies.verdict import planes

CASES = Path(__file__).parents[3] / "cases"
QUICK = {"sweep.settle": 100, "sweep.hold": 20, "beam.elements": 8, "fidelity.beam.modes": 3}
CHAOTIC = {"low": "-0.14 mm", "high": "-0.12 mm", "points": 4, "frequencies": 2, "verify": 0}
TWO = ["sdof", "two_modes"]


@pytest.fixture
def case() -> vibeam.Case:
    return vibeam.load(CASES / "dtu_neutral.toml", QUICK)


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Blocks of two rows, and a list of those that were computed."""
    computed: list[Any] = []
    whole = planes.evaluate_block

    def counted(block: Any, threads: int | None = None) -> Any:
        computed.append((block.grid.fidelity, block.first))
        return whole(block, threads)

    monkeypatch.setattr(planes, "ROWS", 2)
    monkeypatch.setattr(planes, "evaluate_block", counted)
    return computed


def assert_same(one: vibeam.Verdict, other: vibeam.Verdict) -> None:
    """Equal to the bit, times aside."""
    np.testing.assert_array_equal(one.label, other.label)
    for mine, theirs in zip(one.models, other.models, strict=True):
        for name in ("value", "error", "kind", "exponent", "count", "state", "resting"):
            np.testing.assert_array_equal(getattr(mine, name), getattr(theirs, name), err_msg=name)
    for mine_, theirs_ in zip(one.boundaries, other.boundaries, strict=True):
        np.testing.assert_array_equal(mine_.frequency, theirs_.frequency)


def test_a_run_that_ended_goes_on_and_computes_nothing_twice(
    case: vibeam.Case, rows: list[Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted(Exception):
        pass

    def ending(path: Path, folder: Path, *given: Any) -> None:
        if len(list(folder.glob("*.npz"))) == 2:
            raise Interrupted
        write_block(path, folder, *given)

    undisturbed = vibeam.verdict(case, fidelities=TWO, **CHAOTIC)
    assert len(rows) == 4
    assert any((model.kind == -2).any() for model in undisturbed.models)  # with chaos, whose bits say most
    with monkeypatch.context() as patch:
        patch.setattr(planes, "write_block", ending)
        with pytest.raises(Interrupted):
            vibeam.verdict(case, fidelities=TWO, **CHAOTIC, folder=tmp_path)
    rows.clear()
    told: list[str] = []
    assert_same(vibeam.verdict(case, fidelities=TWO, **CHAOTIC, folder=tmp_path, tell=told.append), undisturbed)
    assert len(rows) == 2
    assert len(told) == 4
    assert "two_modes: 4 of 4 rows" in told
    rows.clear()
    assert_same(vibeam.verdict(case, fidelities=TWO, **CHAOTIC, folder=tmp_path), undisturbed)
    assert rows == []


def test_a_damaged_block_is_computed_anew_and_another_map_is_refused(
    case: vibeam.Case, rows: list[Any], tmp_path: Path
) -> None:
    asked = CHAOTIC | {"points": 2, "fidelities": TWO}
    whole = vibeam.verdict(case, **asked, folder=tmp_path)
    file = next(tmp_path.glob("sdof*.npz"))
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(bytes(content))
    rows.clear()
    assert_same(vibeam.verdict(case, **asked, folder=tmp_path), whole)
    assert rows == [("sdof", 0)]
    for other in ({"quantity": "reach"}, {"frequencies": 3}, {"low": "-0.13 mm"}):
        with pytest.raises(vibeam.StoreError, match="another map"):
            vibeam.verdict(case, **(asked | other), folder=tmp_path)
    assert vibeam.verdict(case, **(asked | {"accuracy": "3 %"}), folder=tmp_path).accuracy == 0.03  # flies nothing


def test_the_folder_beside_is_deleted_at_the_end_alone(tmp_path: Path) -> None:
    path, folder = tmp_path / "rig_verdict.csv", tmp_path / "rig_verdict.csv.parts"
    folder.mkdir()
    (folder / "manifest").write_text("{}")
    with pytest.raises(KeyboardInterrupt), planes.kept_beside(path):
        raise KeyboardInterrupt
    assert folder.is_dir()
    with planes.kept_beside(path, fresh=True) as again:
        assert not again.exists()
        with pytest.raises(vibeam.StoreError, match="writing it"), planes.kept_beside(path):
            pass
    assert list(tmp_path.iterdir()) == []


COMMAND = (
    "dtu_neutral.toml --points 24 --frequencies 5 --from=-0.2mm --to=0mm --verify 0 --fidelity sdof"
    " --fidelity two_modes --set sweep.settle=200 --set sweep.hold=30 --set beam.elements=8 --out"
)  # fmt: skip


def begun(out: Path) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "vibeam", "verdict", *COMMAND.split(), str(out)]
    return subprocess.Popen(words, cwd=CASES, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_killed_at_any_instant_it_goes_on_to_the_same_bits(tmp_path: Path, seed: int) -> None:
    undisturbed, killed = tmp_path / "undisturbed.csv", tmp_path / "killed.csv"
    started = time.monotonic()
    assert begun(undisturbed).wait() == 0
    duration = time.monotonic() - started
    rng, parts = np.random.default_rng(seed), tmp_path / "killed.csv.parts"
    stored: dict[str, bytes] = {}
    for _ in range(2):
        process = begun(killed)
        time.sleep(float(rng.uniform(0.2, 0.8)) * duration)
        process.send_signal(signal.SIGKILL)
        if process.wait() == 0:  # it was quicker, and all is done
            break
        found = {path.name: path.read_bytes() for path in parts.glob("[!.]*.npz")}
        assert stored.items() <= found.items()  # what was there is there, and the same
        stored = found
    assert begun(killed).wait() == 0
    assert killed.read_bytes() == undisturbed.read_bytes()
    assert not parts.exists()
