"""A run under a record: kept motion by motion, continued, adapted, read again; its report and JSON."""

from __future__ import annotations

import json
import os
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sealed import edited

import vibeam
from vibeam.figures.record import kept_place
from vibeam.report.transient import modal_energies, transient_report
from vibeam.report.transient_answer import is_chaotic
from vibeam.runs.parallel import Interrupted
from vibeam.runs.transient import motions, store
from vibeam.runs.transient.result import TransientResult
from vibeam.store.errors import StoreError
from vibeam.store.hdf5 import fixed

TABLES: dict[str, Any] = {
    "title": "two models of a mass on a spring",
    "sdof": {"natural_frequency": "2 Hz", "damping_ratio": 0.03},
    "stop": {"gap": 0.01, "restitution": 0.7},
    "drive": {"density": 0.5, "band": ["0.5 Hz", "5 Hz"], "seed": 4},
    "record": {"duration": "4 s", "realisations": 2, "over": "level", "values": [1.0, 2.0]},
    "fidelity": {"events": {"solver": "direct"}, "steps": {"solver": "moreau"}},
}


def case(**record: Any) -> vibeam.Case:
    return vibeam.Case.of(TABLES | {"record": TABLES["record"] | record})


def run(of: vibeam.Case, path: Path | None = None, **more: Any) -> TransientResult:
    made: Any = vibeam.run(of, path, **more)
    assert isinstance(made, TransientResult)
    return made


@pytest.fixture(scope="module")
def whole() -> TransientResult:
    return run(case())


def test_a_run_has_a_motion_of_each_fidelity_value_and_seed(whole: TransientResult) -> None:
    assert (list(whole), whole.over, whole.factors, whole.seeds) == (["events", "steps"], "level", (1.0, 2.0), (4, 5))
    for each in whole.values():
        assert each.complete.all()
        assert each.peak.shape == (2, 2, 3)
        assert [signal.name for signal in each.signals] == ["sensor", "sensor_velocity", "sensor_acceleration"]
    assert (whole.total, whole.found, whole.missing) == (8, 0, 0)


def test_spectra_have_the_frequencies_of_their_own_motion(tmp_path: Path) -> None:
    """A key that makes modes faster takes more samples, and its lines go further; the file has both."""
    beam = {"length": 1.0, "width": 0.02, "thickness": 0.005, "youngs_modulus": 7e10, "density": 2700.0}
    tables = {name: each for name, each in TABLES.items() if name != "sdof"}
    tables |= {
        "units": "SI",
        "beam": beam | {"damping_ratio": 0.03},
        "fidelity": {"own": {"reduction": "modal", "modes": 6}},
    }
    tables["stop"] = TABLES["stop"] | {"position": 0.3}
    tables["sensor"] = {"position": 0.3}
    tables["record"] = {"duration": "8 s", "over": "beam.length", "values": [1.0, 0.5]}
    found = run(vibeam.Case.of(tables), tmp_path / "run.h5")["own"]
    assert np.nanmax(found.frequency[1, 0]) > 1.5 * np.nanmax(found.frequency[0, 0])
    assert np.array_equal(np.isfinite(found.frequency), np.isfinite(found.spectrum[:, :, 0]))
    stored: Any = vibeam.read(tmp_path / "run.h5")["own"]
    assert np.array_equal(stored.frequency, found.frequency, equal_nan=True)


def test_a_reading_is_that_of_the_motion(whole: TransientResult) -> None:
    """The peak as scanned at 40 000 times of the motion flown again, to the distance of two of them; impacts equal."""
    maker = motions.MotionMaker(case(), "events")
    path = maker.path(1, maker.load(1, 1))[0]
    times = np.linspace(0, 4, 40_001)
    own = whole["events"]
    assert own.greatest[1, 1, 0] == pytest.approx(0.01, rel=1e-9)  # the stop
    assert own.least[1, 1, 0] == pytest.approx(path.at(times, "sensor").min(), rel=1e-5)
    assert np.array_equal(own.impact_times[1][1], path.impact_times)
    assert own.of("impacts")[1, 1] == len(path.impact_times) > 3
    assert own.of("hardest_impact")[1, 1] == path.impact_velocities.max()


def test_histories_hold_the_extremes_and_the_load(whole: TransientResult) -> None:
    own, at = whole["events"], (kept_place(whole), 0)
    assert at == (0, 0)
    for number, signal in enumerate(own.signals):
        assert own.history[signal.name].peak == pytest.approx(own.peak[0, 0, number], rel=1e-3)
    assert whole.input[""].peak == pytest.approx(case().input("events", 4).peak, rel=1e-6)


def test_a_second_run_flies_nothing(tmp_path: Path, whole: TransientResult, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "own.h5"
    first = run(case(), path)
    assert first == whole
    assert first.found == 0
    monkeypatch.setattr(motions.MotionMaker, "path", None)
    again = run(case(), path)
    assert again == whole
    assert again.found == 8
    stored = vibeam.read(path)
    assert stored == whole
    assert isinstance(stored, TransientResult)
    assert stored.comparison == whole.comparison
    assert stored["events"].history == whole["events"].history
    assert stored.input == whole.input


def test_seeds_values_and_fidelities_are_added(tmp_path: Path, whole: TransientResult) -> None:
    path = tmp_path / "own.h5"
    run(case(realisations=1, values=[1.0]), path, fidelities=["events"])
    assert run(case(realisations=1, values=[1.0]), path).found == 1
    more = run(case(), path)
    assert more.found == 2
    assert more == whole


def test_motions_that_would_be_lost_are_kept_aside(tmp_path: Path) -> None:
    path, said = tmp_path / "own.h5", []
    run(case(), path)
    fewer = run(case(realisations=1), path, tell=said.append)
    assert fewer.found == 4
    assert (tmp_path / "own.1.h5").exists()
    assert len(said) == 1
    assert "kept aside as own.1.h5" in said[0]
    assert vibeam.read(tmp_path / "own.1.h5") == run(case())


def test_a_run_that_is_stopped_goes_on(
    tmp_path: Path, whole: TransientResult, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    path = tmp_path / "own.h5"
    monkeypatch.setattr(store, "WRITE_EVERY", 0.0)

    def stop(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match=r"stopped: \d of 8 motions are kept in .*own.h5: the same command goes on"):
        run(case(), path, progress=stop)
    partial: Any = vibeam.read(path)
    assert 0 < partial.missing < 8
    assert np.isnan(partial["steps"].peak).any()
    rest = run(case(), path)
    assert rest.found == 8 - partial.missing
    assert rest == whole


def test_a_part_of_a_run_is_reported_without_the_value_that_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(done: int, total: int) -> None:
        if done == 1:
            raise KeyboardInterrupt

    monkeypatch.setattr(store, "WRITE_EVERY", 0.0)
    with pytest.raises(Interrupted):
        run(case(), tmp_path / "own.h5", progress=stop)
    partial: Any = vibeam.read(tmp_path / "own.h5")
    assert not partial["events"].run[-1].any()
    assert list(modal_energies(partial)) == []
    assert transient_report(partial)


def test_blocks_of_a_killed_run_are_found(
    tmp_path: Path, whole: TransientResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a kill leaves: the file of the first motions and blocks beside it, which nobody gathered."""
    path = tmp_path / "own.h5"
    monkeypatch.setattr(store, "WRITE_EVERY", 0.0)
    with monkeypatch.context() as killed:
        killed.setattr(store.TransientStore, "close", lambda self, changed: None)
        run(case(), path)
    assert len(list((tmp_path / "own.h5.parts").glob("*.npz"))) >= 7
    stored: Any = vibeam.read(path)
    assert stored == whole
    assert stored.missing == 0
    assert run(case(), path).found == 8


def test_files_of_another_kind_and_damaged_ones_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "own.h5"
    run(case(), path)
    content = path.read_bytes()
    path.write_bytes(content[:3000] + b"?" + content[3001:])
    with pytest.raises(StoreError, match="damaged, or was changed"):
        run(case(), path)
    with pytest.raises(StoreError, match="damaged, or was changed"):
        vibeam.read(path)
    path.write_text("no results")
    with pytest.raises(StoreError, match=r"no result of a case with \[record\]"):
        run(case(), path)


@pytest.mark.parametrize("other", ["vibeam transient 10", "vibeam transient 2"])
def test_a_file_of_another_format_is_refused_though_its_seal_fits(tmp_path: Path, other: str) -> None:
    path = tmp_path / "own.h5"
    run(case(), path)
    with edited(path) as file:
        file.attrs["format"] = fixed(other)
    for use in (lambda: run(case(), path), lambda: vibeam.read(path)):
        with pytest.raises(StoreError, match="is no vibeam result of this version: start over with --fresh"):
            use()
    assert run(case(), path, fresh=True).found == 0


def test_a_pipe_is_no_results_file_and_nobody_waits_for_it(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "own.h5")
    assert not store.is_transient(tmp_path / "own.h5")
    with pytest.raises(StoreError, match="is a pipe, not a file"):
        vibeam.read(tmp_path / "own.h5")


def test_every_fidelity_whose_solver_cannot_take_the_law_is_named_at_once(tmp_path: Path) -> None:
    stop = {"gap": 0.01, "law": "linear", "stiffness": 1e4, "restitution": 0.5}
    made = vibeam.Case.of(TABLES | {"stop": stop})
    with pytest.raises(vibeam.CaseError) as told:
        run(made, tmp_path / "own.h5")
    assert [each.key for each in told.value.faults] == ["fidelity.events", "fidelity.steps"]
    assert "solver 'direct' cannot take the contact law \"linear\": the solver 'flight' can" in str(told.value)
    assert list(tmp_path.iterdir()) == []


def test_a_key_of_the_rig_is_varied() -> None:
    """With the stop twice as far away the motion hits it later; without reach of it, never."""
    found = run(case(over="stop.gap", values=[0.01, 0.02, 10.0], realisations=1))["events"]
    first = found.of("first_impact")[:, 0]
    assert first[0] < first[1]
    assert np.isnan(first[2])
    assert found.of("impacts")[2, 0] == 0
    assert found.peak[2, 0, 0] > 0


def test_the_answer_names_what_suffices_and_what_is_missed(whole: TransientResult) -> None:
    sheet = transient_report(whole)
    assert "is within 5 % of events, the finest" in sheet.answer or "steps misses" in sheet.answer
    stricter = copy(whole)
    stricter.case = whole.case.with_keys({"verdict.accuracy": 1e-12})
    tight = transient_report(stricter)
    assert tight.answer.startswith("No other fidelity is known to be within 1e-10 % of events")
    assert "steps misses" in tight.answer
    assert [table.title for table in (*sheet.tables, *sheet.more)] == [
        "Fidelities", "Peaks", "Energies", "Impacts", "Energy by mode, events", "Cost",
    ]  # fmt: skip
    rows = sheet.data["fidelities"][0]["motions"]
    assert len(rows) == 4
    assert rows[3]["seed"] == 5
    assert rows[3]["level"] == 2.0


def test_stepping_is_compared_on_the_same_realisations(whole: TransientResult) -> None:
    """Both solve one system: their peaks are within 2 %, as paired, while the realisations scatter by far more."""
    of = whole.comparison["steps"]
    found = of.difference("peak", "sensor", at=0)
    assert abs(found.mean) < 0.02
    assert found.n == 2
    assert np.std(whole["events"].of("peak")[0]) / whole["events"].of("peak")[0].mean() > 2 * found.error
    assert np.all(of.horizon > 0)
    assert not is_chaotic(of)


def test_the_command_prints_the_answer_first_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from typer.testing import CliRunner

    from vibeam.casefile.toml_writing import to_toml  # noqa: F401
    from vibeam.cli.main import app

    file = tmp_path / "own.toml"
    file.write_text(case().text, encoding="utf-8")
    found = CliRunner().invoke(app, ["run", str(file), "--out", str(tmp_path / "own.h5"), "--json"])
    assert found.exit_code == 0, found.output
    data = json.loads(found.stdout)
    assert data["answer"]
    assert data["over"] == "level"
    assert len(data["fidelities"]) == 2


def test_a_free_decay_has_a_twin_of_its_own() -> None:
    """No load to disturb: the start is, so that the twin's motion is another one, though it agrees to the end."""
    tables = {
        "units": "SI", "sdof": TABLES["sdof"], "stop": TABLES["stop"], "record": {"duration": 4.0},
        "start": {"displacement": -0.03}, "fidelity": {"exact": {}, "steps": {"solver": "moreau"}},
    }  # fmt: skip
    found = run(vibeam.Case.of(tables))
    (twin,) = found.twins["exact"].values()
    own = found["exact"].impact_times[0][0]
    assert 0 < np.max(np.abs(twin["impact_times"] - own)) < 1e-4
    assert found.comparison["steps"].own_horizon.tolist() == [4.0]
    assert found["exact"].start[0, 0, 0] > 10 * found["exact"].left[0, 0, 0] > 0


def test_the_overview_says_the_largest_load() -> None:
    told: list[Any] = []
    run(case(realisations=1), before=told.append)
    largest = max(case().input("events", 4, level=value).peak for value in (1.0, 2.0))
    assert f"base acceleration up to {largest:.4g}, " in str(told[0])


def test_motions_and_impacts_are_tables(tmp_path: Path, whole: TransientResult) -> None:
    import csv

    from vibeam.report.result_tables import write_tables

    motions_file, impacts_file = write_tables(whole, tmp_path / "own_motions.csv")
    rows = list(csv.DictReader(motions_file.read_text(encoding="utf-8").splitlines()))
    assert [(row["fidelity"], row["level"], row["seed"]) for row in rows[:3]] == [
        ("events", "1.0", "4"), ("events", "1.0", "5"), ("events", "2.0", "4"),
    ]  # fmt: skip
    assert float(rows[1]["sensor_velocity_peak (1/s)"]) == whole["events"].peak[0, 1, 1]
    struck = list(csv.DictReader(impacts_file.read_text(encoding="utf-8").splitlines()))
    assert impacts_file.name == "own_impacts.csv"
    assert len(struck) == sum(int(each.impacts.sum()) for each in whole.values())
    assert float(struck[0]["time (s)"]) == whole["events"].impact_times[0][0][0]
