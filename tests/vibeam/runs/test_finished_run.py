"""A run with nothing left to do: what it takes from the file in place of systems, and when it does not believe it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from sealed import edited
from stand_in import RIG

from vibeam.case.case import Case
from vibeam.case.fidelity import restitutions
from vibeam.casefile.read import load
from vibeam.runs import keys, systems
from vibeam.runs.result import Result
from vibeam.runs.run import run
from vibeam.runs.store.branches import read_rows, write_rows
from vibeam.solvers import register_solver
from vibeam.solvers.declaration import SolverDeclaration
from vibeam.store.errors import StoreError

SHORT: dict[str, Any] = {
    "sweep.frequency": {"from": "14.9 Hz", "to": "15.7 Hz", "points": 5},
    "sweep.direction": "up",
    "sweep.settle": 30,
    "sweep.hold": 10,
}


@pytest.fixture(scope="module")
def short() -> Case:
    return load(RIG, set=SHORT)


@pytest.fixture(scope="module")
def finished(short: Case, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("finished") / "short.h5"
    run(short, path, compare=True)
    return path


@pytest.fixture
def file(finished: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(finished, tmp_path))


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Cases whose systems were built from now on."""
    cases: list[Case] = []
    build = systems._systems

    def noted(case: Case) -> Any:
        cases.append(case)
        return build(case)

    monkeypatch.setattr(systems, "_systems", noted)
    return cases


def without_time(result: Result) -> list[Any]:
    return list(result.comparisons)


def test_no_system_is_built_and_every_number_is_the_same(short: Case, file: Path, built: list[Case]) -> None:
    before = file.read_bytes()
    result = run(short, file, compare=True)
    assert built == []
    assert file.read_bytes() == before
    anew = run(short, compare=True)
    assert built == [short]
    assert without_time(result) == without_time(anew)
    for name, fidelity in short.fidelities.items():
        assert result.restitutions(name) == restitutions(short.scene_of(name), fidelity)
        assert np.array_equal(result[name].up.amplitude, anew[name].up.amplitude)


def test_a_run_that_was_not_compared_gets_its_comparison(short: Case, tmp_path: Path, built: list[Case]) -> None:
    path = tmp_path / "short.h5"
    run(short, path)
    assert "comparison" not in h5py.File(path)
    assert without_time(run(short, path, compare=True)) == without_time(run(short, compare=True))
    built.clear()
    run(short, path, compare=True)
    assert built == []


@pytest.mark.parametrize(
    "change",
    [
        {"mass.mass": "0.21 kg"},
        {"stop.restitution": 0.7},
        {"drive.voltage": "0.59 V"},
        {"beam.elements": 24},
        {"fidelity.two_modes.modes": 3},
        {"fidelity.beam.set": {"stop.restitution": 0.71}},
        {"sweep.hold": 11},
        {"sweep.frequency.to": "15.8 Hz"},
        {"sweep.frequency.points": 9},
        {"sweep.output": "contact"},
    ],
    ids=lambda change: next(iter(change)),
)
def test_of_a_changed_case_nothing_is_believed(file: Path, built: list[Case], change: dict[str, Any]) -> None:
    changed = load(RIG, set=SHORT | change)
    with edited(file) as stored:  # of the same physics, as far as the file can tell
        for name in ("text", "shared"):
            del stored[f"case/{name}"]
            text = getattr(changed, "numbers" if name == "text" else name).encode()
            stored[f"case/{name}"] = np.array(text, dtype=h5py.string_dtype("utf-8", len(text)))
    result = run(changed, file, compare=True, tell=lambda line: None)
    assert changed in built
    anew = run(changed, compare=True)
    assert without_time(result) == without_time(anew)
    assert [result.restitutions(name) for name in result] == [anew.restitutions(name) for name in anew]


def test_what_other_code_computed_is_not_believed(
    short: Case, file: Path, built: list[Case], monkeypatch: pytest.MonkeyPatch
) -> None:
    with h5py.File(file) as stored:
        key = stored["comparison"].attrs["key"]
    monkeypatch.setattr(keys, "_digest", lambda folders: "other")
    run(short, file, compare=True)
    assert built == [short]
    with h5py.File(file) as stored:
        assert stored["comparison"].attrs["key"] != key
    run(short, file, compare=True)
    assert built == [short]


def test_the_digest_of_the_code_hangs_on_every_source_that_computes(tmp_path: Path) -> None:
    package = Path(systems.__file__).parents[1]
    shutil.copytree(package, tmp_path / "vibeam", ignore=shutil.ignore_patterns("__pycache__", "*.xz"))
    copy = tmp_path / "vibeam"

    def digest() -> str:
        keys._digest.cache_clear()
        return keys._digest((copy,))

    before = digest()
    for file in ("runs/comparison/errors.py", "case/fidelity.py", "flight/kernels/extremes.py"):
        with (copy / file).open("a") as source:
            source.write("# changed\n")
        assert digest() != before, file
        before = digest()
    with (copy / "report" / "tables.py").open("a") as source:
        source.write("# changed\n")
    assert digest() == before
    keys._digest.cache_clear()


def test_what_code_of_others_computes_is_computed_each_time(short: Case, file: Path, built: list[Case]) -> None:
    from vibeam.solvers import SOLVERS

    register_solver(SolverDeclaration("of_others", "somewhere:Solver"))
    try:
        run(short, file, compare=True)
        run(short, file, compare=True)
    finally:
        SOLVERS.remove("of_others")
    assert built == [short, short]


def test_a_comparison_of_other_points_is_not_believed(short: Case, file: Path) -> None:
    before = run(short, file, compare=True).comparisons[0].rows[0].held
    with edited(file) as stored:
        values = dict(read_rows(stored["beam/up"]))
        write_rows(stored["beam/up"], 0, values | {"amplitude": values["amplitude"] * 1.001})
    after = run(short, file, compare=True).comparisons[0].rows[0].held
    assert after == pytest.approx((1 + before) / 1.001 - 1, abs=1e-12)


DAMAGES: tuple[Callable[[Any], None], ...] = (
    lambda stored: stored["models/beam"].attrs.modify("restitution", 0.5),
    lambda stored: stored["models/beam"].attrs.modify("key", stored["models/sdof"].attrs["key"]),
    lambda stored: stored["comparison/sdof"].attrs.modify("peak", 0.1),
    lambda stored: stored["compared/sdof"].attrs.modify("amplitude_error", 0.5),
)


def test_what_is_damaged_is_said(short: Case, finished: Path, tmp_path: Path) -> None:
    for damage in DAMAGES:
        file = Path(shutil.copy(finished, tmp_path))
        with h5py.File(file, "r+") as stored:
            damage(stored)
        with pytest.raises(StoreError, match="its digest does not fit"):
            run(short, file, compare=True)
