"""Pictures of what was read: every point of the file is drawn, in grey what is cut, in colour what is used."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import SDOF
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app
from vibeam.extensions.identification.signal_kind import identify_stretch
from vibeam.report.fit import identification_sheet
from vibeam.report.measured import case_pictures
from vibeam.studies.measured_panel import MOST, draw_curve

TIME = np.arange(0, 2, 8e-3)
SHAKEN = Path(__file__).parents[3] / "cases" / "code_aster" / "sdnd102_wall.toml"
FORCE = np.loadtxt(SHAKEN.with_name("sdnd102_force.csv"), delimiter=",", skiprows=1, comments="#").T


def decay(since: float, size: float = 1.0) -> Any:
    """Decay of 9 Hz, 2 %, from a time on."""
    t, omega = np.maximum(TIME - since, 0), 2 * np.pi * 9
    return size * np.exp(-0.02 * omega * t) * np.cos(omega * np.sqrt(1 - 0.02**2) * t) * (since <= TIME)


def written(path: Path, heads: str, *columns: Any) -> Path:
    np.savetxt(path, np.transpose(columns), delimiter=",", header=heads, comments="")
    return path


def drawn(draw: Any) -> list[dict[str, Any]]:
    """Points of the lines of each panel, by their looks: what is cut is grey, what is used blue, the fit thin."""
    panels = []
    for axes in draw().axes:
        lines = {line.get_color(): np.transpose(line.get_xydata()) for line in axes.lines}
        named = {"0.75": "all", "#0072B2": "used", "#D55E00": "fit"}
        panels.append({named[colour]: xy for colour, xy in lines.items() if colour in named} | {"axes": axes})
    return panels


def used(panel: dict[str, Any]) -> Any:
    """Abscissae of the points in colour."""
    x, y = panel["used"]
    return x[np.isfinite(y)]


RECORDS = {
    "a pre-trigger": (decay(0.5), 0.5, 2.0),
    "held before": (decay(0.5) + (TIME < 0.5), 0.5, 2.0),
    "a second event": (decay(0.0) + decay(1.2, 0.9), 0.0, 1.2),
}


@pytest.mark.parametrize("name", RECORDS)
def test_of_a_decay_all_is_drawn_in_si_and_what_is_cut_is_grey(name: str, tmp_path: Path) -> None:
    value, first, last = RECORDS[name]
    file = written(tmp_path / "decay.csv", "t [ms],x [mm]", 1e3 * TIME, 2.5 * value)
    found = identify_stretch(file, None, None)
    (panel,) = drawn(identification_sheet(found).draw)
    np.testing.assert_allclose(panel["all"], [TIME, 2.5e-3 * value], atol=1e-15)
    assert found.stretch == pytest.approx((used(panel)[0], used(panel)[-1]))
    assert used(panel)[[0, -1]] == pytest.approx([first, last], abs=0.03)
    assert len(used(panel)) == found.points
    at, model = panel["fit"]
    inside = (at > first + 0.02) & (at < last - 0.02)
    np.testing.assert_allclose(model[inside], 2.5e-3 * value[np.searchsorted(TIME, at[inside] - 1e-9)], atol=1e-6)
    axes = panel["axes"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time in s", "x in m")
    cut = len(TIME) - found.points
    assert axes.get_title(loc="left") == f"decay.csv: {cut} of {len(TIME)} points are cut"


def test_what_is_clipped_is_grey_and_the_fit_goes_over_it(tmp_path: Path) -> None:
    clipped = np.clip(decay(0.0), -0.7, 0.7)
    found = identify_stretch(written(tmp_path / "a.csv", "t [s],x [m]", TIME, clipped), None, None)
    (panel,) = drawn(identification_sheet(found).draw)
    assert len(used(panel)) == found.points < len(TIME)
    assert np.abs(panel["all"][1]).max() == 0.7 < np.abs(panel["fit"][1]).max()


def test_a_whole_decay_has_nothing_in_grey(tmp_path: Path) -> None:
    found = identify_stretch(written(tmp_path / "a.csv", "t [s],acc [g]", TIME, decay(0.0)), None, None)
    (panel,) = drawn(identification_sheet(found).draw)
    assert "all" not in panel
    np.testing.assert_allclose(panel["used"][1], 9.80665 * decay(0.0))
    assert (panel["axes"].get_title(loc="left"), panel["axes"].get_ylabel()) == ("a.csv", "acc in m/s²")


def receptance(f: Any, *modes: float) -> Any:
    s = 2j * np.pi * f
    return sum(1 / (s**2 + 0.04 * np.pi * each * s + (2 * np.pi * each) ** 2) for each in modes)


def test_of_a_response_what_from_and_to_leave_out_is_grey(tmp_path: Path) -> None:
    f = np.arange(2, 60, 0.25)
    h = receptance(f, 9.0, 22.0, 41.0)
    file = written(tmp_path / "a.csv", "f [Hz],Re [um/N],Im [um/N]", f, 1e6 * h.real, 1e6 * h.imag)
    panel, modes = drawn(identification_sheet(identify_stretch(file, "15 Hz", "50")).draw)
    np.testing.assert_allclose(panel["all"], [f, np.abs(h)], rtol=1e-12)
    np.testing.assert_allclose(used(panel), f[(f >= 15) & (f <= 50)])
    np.testing.assert_allclose(panel["fit"][1], np.abs(h[(f >= 15) & (f <= 50)]), rtol=0.1)
    assert panel["axes"].get_ylabel() == "modulus of Re and Im in m/N"
    assert modes["axes"].get_ylabel() == "modes in the fit"


def test_of_a_power_spectrum_the_root_is_drawn_and_the_band_that_is_fitted(tmp_path: Path) -> None:
    f = np.arange(2, 60, 0.1)
    size = 1e3 * np.abs(receptance(f, 20.0))
    found = identify_stretch(written(tmp_path / "a.csv", "f [Hz],PSD [g^2/Hz]", f, size**2), None, None)
    (panel,) = drawn(identification_sheet(found).draw)
    np.testing.assert_allclose(panel["all"], [f, 9.80665 * size], rtol=1e-12)
    np.testing.assert_allclose(used(panel), f[size >= 0.15 * size.max()])
    assert panel["axes"].get_ylabel() == "root of PSD in √((m/s²)²/Hz)"


@pytest.mark.parametrize(
    ("head", "size", "label"),
    [
        ("T [g/g]", 1.0, "T"), ("H [mm/V]", 1e-3, "H in m/V"), ("H [counts]", 1.0, "H in counts"),
        ("FFT [mm/Hz]", 1e-3, "FFT in m/Hz"), ("power", 1.0, "root of power"), ("a $1_2$ [V]", 1.0, r"a \$1_2\$ in V"),
    ],
)  # fmt: skip
def test_an_axis_has_head_and_unit(head: str, size: float, label: str, tmp_path: Path) -> None:
    f = np.arange(10, 30, 0.25)
    value = 1e3 * np.abs(receptance(f, 20.0))
    file = written(tmp_path / "a.csv", f"f [Hz],{head}", f, value ** (2 if head == "power" else 1))
    (panel, *_) = drawn(identification_sheet(identify_stretch(file, None, None, of="spectrum")).draw)
    np.testing.assert_allclose(panel["all"], [f, size * value], rtol=1e-12)
    assert panel["axes"].get_ylabel() == label


def run(*words: str | Path, code: int = 0) -> str:
    done = CliRunner().invoke(app, list(map(str, words)))
    assert done.exit_code == code, done.output
    return done.output


def with_reference(folder: Path, more: str) -> Path:
    """Case with a measured curve of another program's form."""
    written(folder / "laser.csv", "Frequenz [Hz],Weg", np.arange(1.0, 21.0), np.arange(20.0) + 1)
    told = '[reference.laser]\nfile = "laser.csv"\nmeasured = true\nfidelity = "sdof"\nquantity = "amplitude"\n'
    columns = 'columns = { frequency = "Frequenz", amplitude = "Weg" }\n'
    case = folder / "rig.toml"
    case.write_text(SDOF + told + columns + more, encoding="utf-8")
    return case


def test_of_a_reference_what_its_window_leaves_out_is_grey(tmp_path: Path) -> None:
    case = vibeam.load(with_reference(tmp_path, 'window = ["5 Hz", "9 Hz"]\n'))
    (panel,) = drawn(case_pictures(case)[0].draw)
    np.testing.assert_allclose(panel["all"], [np.arange(1.0, 21.0), np.arange(20.0) + 1])
    np.testing.assert_allclose(used(panel), np.arange(5.0, 10.0))
    assert panel["axes"].get_title(loc="left") == "laser, laser.csv: 15 of 20 points are cut"
    assert panel["axes"].get_ylabel() == "Weg"


@pytest.mark.parametrize(
    ("keys", "first", "last"),
    [
        ({"drive.from": "0.1 s", "drive.to": "0.8 s"}, 0.1, 0.8),
        ({"drive.start": "0.2 s", "record.duration": "0.5 s"}, 0.2, 0.7),
        ({"record.duration": "0.5 s"}, 0.0, 0.5),
        ({}, 0.0, 1.0),
    ],
    ids=["from and to", "start and duration", "duration", "all"],
)
def test_of_a_drive_what_the_run_does_not_take_is_grey(keys: dict[str, Any], first: float, last: float) -> None:
    (panel,) = drawn(case_pictures(vibeam.load(SHAKEN, keys))[0].draw)
    np.testing.assert_allclose(panel.get("all", panel["used"]), FORCE, rtol=1e-12, atol=1e-12)
    assert used(panel)[[0, -1]] == pytest.approx([first, last])
    assert panel["axes"].get_ylabel() == "force in N"


def test_of_many_points_no_extreme_is_lost() -> None:
    from matplotlib.figure import Figure

    value = np.sin(np.arange(10.0 * MOST))
    value[12345] = 7.0
    curve = vibeam_curve(value)
    axes = Figure().add_subplot()
    draw_curve(axes, curve, ["b", "r"])
    shown = np.asarray(axes.lines[0].get_ydata())
    assert len(shown) <= MOST
    assert (shown.max(), shown.min()) == (7.0, value.min())


def vibeam_curve(value: Any) -> Any:
    from vibeam.studies.measured_panel import MeasuredCurve

    return MeasuredCurve(np.arange(len(value)), value, np.ones(len(value), dtype=bool), timed=True)


def test_check_draws_what_it_read_beside_the_model(tmp_path: Path) -> None:
    case = with_reference(tmp_path, 'window = ["5 Hz", "9 Hz"]\n')
    said = run("check", case, "--plot", tmp_path / "a.svg")
    assert f"wrote {tmp_path / 'a.svg'}, {tmp_path / 'a_measured.svg'}" in said
    assert "15 of 20 points are cut" in (tmp_path / "a_measured.svg").read_text(encoding="utf-8")


def test_check_draws_the_drive_of_a_record(tmp_path: Path) -> None:
    said = run("check", SHAKEN, "--set", "drive.to='0.8 s'", "--plot", tmp_path / "new/", code=1)
    assert f"wrote {tmp_path / 'new' / 'sdnd102_wall_check.png'}" in said


def test_derive_draws_what_a_case_measures_where_a_file_is_asked_for(tmp_path: Path) -> None:
    case = SHAKEN.parents[1] / "synthetic" / "fit.toml"
    assert "taken:" not in run("derive", case)
    said = run("derive", case, "-o", tmp_path / "a.csv")
    assert "laser.csv: taken: response curve" in said
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.csv", "a_measured.png", "a_measured.svg"]


def test_a_picture_is_whole_or_not_there(tmp_path: Path) -> None:
    file = written(tmp_path / "decay.csv", "t [ms],x [mm]", 1e3 * TIME, decay(0.0))
    assert "this is a file or lies below one" in run("fit", file, "-o", file / "a.csv", code=2)
    assert [each.name for each in tmp_path.iterdir()] == ["decay.csv"]
    run("fit", file, "-o", tmp_path / "new" / "a.csv")
    assert sorted(each.name for each in (tmp_path / "new").iterdir()) == ["a.csv", "a.png", "a.svg"]
    run("fit", file, "-o", tmp_path / "page.html")
    assert 'alt="Figure: a decaying cosine fitted' in (tmp_path / "page.html").read_text(encoding="utf-8")
