"""The overview of rig and sweep: numbers by hand, what is said before a sweep, what of it is kept."""

from __future__ import annotations

import json
from math import isnan, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from sealed import edited
from stand_in import SDOF, one_mode
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.runs.summary import remarks
from vibeam.runs.systems import closed_frequency, gap_at_rest, open_frequencies, overview_of, properties_of
from vibeam.studies.stored import stored

CASES = Path(__file__).parents[3] / "cases"
SHORT = {"sweep.frequency.points": 2, "sweep.settle": 1, "sweep.hold": 1, "fidelity.beam": None, "reference": None}

SHORT_FRAME = {key: value for key, value in SHORT.items() if key.startswith("sweep")}

#: a steel strip whose length lacks its prefix: 0.18 m is meant
FORGOTTEN = {"units": "SI", "beam.length": 180, "stop.position": 132, "mass": None, "sensor.position": 100}


def said_of(case: vibeam.Case) -> tuple[str, list[str]]:
    models = {name: properties_of(case, name, case.system(name)) for name in case.fidelities}
    found = overview_of(case, models)
    return str(found), list(found.warnings())


def test_a_storey_that_is_held_leaves_the_other_alone() -> None:
    """M = diag(2, 1.5), K = [[9000, −4000], [−4000, 4000]]; the upper storey at the stop: ω² = 9000/2."""
    system = vibeam.load(CASES / "matrices" / "frame.toml").system("whole")
    assert closed_frequency(system) == pytest.approx(sqrt(9000 / 2) / (2 * pi), rel=1e-12)
    roots = np.sqrt(np.sort(np.roots([3.0, -(9000 * 1.5 + 4000 * 2), 9000 * 4000 - 4000**2])))
    assert open_frequencies(system)[:2] == pytest.approx(roots / (2 * pi), rel=1e-12)
    assert isnan(closed_frequency(vibeam.load(CASES / "matrices" / "frame.toml").system("one")))


def test_weight_takes_from_the_gap() -> None:
    """q = static / ω², w q of the gap."""
    system = vibeam.ImpactSystem.from_modes(
        [2.0, 5.0], 0.1, [1.0, 0.5], 1.0, gap=0.3, restitution=0.5, static=[0.4, 1.0]
    )
    assert gap_at_rest(system) == pytest.approx(0.3 - (1.0 * 0.4 / 4 + 0.5 * 1.0 / 25), rel=1e-14)


def test_the_rig_in_a_sentence() -> None:
    """7850 kg/m³ · 180 · 20 · 1.034 mm³ = 29.22 g, and 200 g on it; f₁ = 7.597 Hz by the page on cases."""
    text, warnings = said_of(vibeam.load(CASES / "dtu_loose.toml", set=SHORT))
    assert text.startswith(
        "beam 180 mm × 20 mm × 1.034 mm, 29.22 g; moving mass 229.2 g; mode 1 at 7.597 Hz (ζ 1.7 %), "
    )
    assert text.endswith("; sweep 8 Hz … 17 Hz = 1.05 … 2.24 × mode 1; static gap 0.1553 mm at the contact")
    assert warnings == []
    text, warnings = said_of(parse(SDOF))
    assert text.startswith("mode 1 at 0.1592 Hz (ζ 1.5 %); sweep 0.2387 Hz … 0.3979 Hz = 1.5 … 2.5 × mode 1; ")
    assert text.endswith("; static gap 0 at the contact")
    assert warnings == []


def test_a_free_ball_has_no_first_frequency(tmp_path: Path) -> None:
    """M = 1 kg, K = 0: a motion that nothing holds."""
    np.save(tmp_path / "M.npy", np.eye(1))
    np.save(tmp_path / "K.npy", np.zeros((1, 1)))
    (tmp_path / "ball.toml").write_text(BALL, "utf-8")
    text, _ = said_of(vibeam.load(tmp_path / "ball.toml"))
    assert "a free body, 1 rigid-body mode at 0 Hz; sweep 1 Hz … 2 Hz; " in text


def test_results_away_from_the_matrices_say_what_they_lack(tmp_path: Path) -> None:
    frame = CASES / "matrices" / "frame.toml"
    vibeam.run(vibeam.load(frame, SHORT_FRAME), tmp_path / "frame.h5")
    cure = (
        r"the files of matrices\.mass and matrices\.stiffness are not beside it: copy them into the folder of frame\.h5"
    )
    with pytest.raises(vibeam.StoreError, match=cure):
        vibeam.read(tmp_path / "frame.h5")
    for name in "MK":
        (tmp_path / f"frame_{name}.mtx").write_bytes((frame.parent / f"frame_{name}.mtx").read_bytes())
    assert vibeam.read(tmp_path / "frame.h5")["one"].up is not None


BALL = """
[matrices]
mass = "M.npy"
stiffness = "K.npy"
units = "SI"
damping_ratio = 0
contact = 1
sensor = 1
force = 1
[stop]
gap = "1 mm"
restitution = 0.7
[drive]
force = "1 N"
[sweep]
frequency = { from = "1 Hz", to = "2 Hz", points = 3 }
settle = 10
hold = 10
[fidelity.one]
reduction = "full"
"""


def test_what_is_implausible_is_told() -> None:
    (warning,) = said_of(vibeam.load(CASES / "dtu_loose.toml", set=SHORT | FORGOTTEN | {"drive": {"amplitude": 1e-3}}))[
        1
    ]
    assert "is far from the sweep, 8 Hz … 17 Hz: look at the units of the rig, or move the sweep" in warning
    (warning,) = said_of(parse(SDOF, set={"sdof.damping_ratio": 2.7}))[1]
    assert warning == "a damping ratio of 2.7 leaves mode 1 no resonance (1 % is 0.01)"


def test_it_is_told_before_a_sweep_and_kept_with_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(SDOF.replace("gap = 0.0", "gap = 1.0"), "utf-8")
    first = CliRunner().invoke(app, ["run", "a.toml", "--json"], env={"COLUMNS": "80"})
    assert first.exit_code == 0, first.output
    assert "sweep 0.2387 Hz … 0.3979 Hz" in " ".join(first.stderr.split())
    assert first.stderr.startswith("mode 1 at 0.1592 Hz")
    assert first.stderr.splitlines()[0].endswith("at the contact")  # in a pipe a sentence is a line
    assert json.loads(first.stdout)["remarks"] == [
        "sdof: no impact at any frequency: sweep over mode 1, at 0.1592 Hz, narrow the gap, or drive harder"
    ]
    again = CliRunner().invoke(app, ["run", "a.toml"], env={"COLUMNS": "80"})
    assert "static gap" not in again.output
    kept = stored("a.h5")
    assert str(kept.result.overview) == str(vibeam.run(vibeam.load("a.toml")).overview)


def test_a_file_without_models_has_them_made_anew(tmp_path: Path) -> None:
    case = parse(SDOF)
    vibeam.run(case, tmp_path / "a.h5")
    with edited(tmp_path / "a.h5") as file:
        del file["models"]
    assert stored(tmp_path / "a.h5").result.overview is None
    assert vibeam.run(case, tmp_path / "a.h5").overview is not None
    assert stored(tmp_path / "a.h5").result.overview is not None


def test_inside_the_sweep_mode_1_is_no_cure() -> None:
    text = one_mode('["0.5 rad/s", "1 rad/s", "1.5 rad/s"]', 5, 2, "[fidelity.sdof]", gap=1.0)
    assert remarks(vibeam.run(parse(text))) == ["sdof: no impact at any frequency: narrow the gap, or drive harder"]
