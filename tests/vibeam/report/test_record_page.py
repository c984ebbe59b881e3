"""The page and the figures of a record case: the numbers of its results, in what a page may be."""

import json
import re

import numpy as np
import pytest

import vibeam
from vibeam.report.figures import figure
from vibeam.report.page.page import page
from vibeam.report.page.record_charts import record_data
from vibeam.report.record_figure import record_figure
from vibeam.studies.stored import stored

HOSTILE = "</script><img src=x onerror=alert(1)> & {{ 7 * 7 }}"
CASE = """
title = 'TITLE'
[beam]
length = "180 mm"
width = "20 mm"
thickness = "3 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.02
elements = 8
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "0.1 mm"
restitution = 0.7
[sensor]
position = "100 mm"
[drive]
density = "0.05 g^2/Hz"
band = ["5 Hz", "200 Hz"]
seed = 3
[record]
duration = "0.3 s"
realisations = 2
values = [0.5, 1.0]
[fidelity.sdof]
reduction = "static_mode"
[fidelity.beam]
reduction = "modal"
modes = 2
label = "two </b> modes"
[show.hits]
kind = "impact_velocities"
[show.close]
kind = "history"
output = "sensor"
window = ["0.1 s", "0.15 s"]
[show.over_time]
kind = "spectrogram"
fidelities = ["beam"]
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("record")
    (folder / "case.toml").write_text(CASE.replace("TITLE", HOSTILE), encoding="utf-8")
    vibeam.run(vibeam.load(folder / "case.toml"), out=folder / "case.h5")
    return stored(folder / "case.h5")


@pytest.fixture(scope="module")
def text(results):
    return page(results)


@pytest.fixture(scope="module")
def data(results):
    return json.loads(json.dumps(record_data(results.result), allow_nan=False))


def test_the_page_asks_nothing_of_any_network_is_small_and_shows_hostile_texts(text):
    assert len(text.encode()) < 1_600_000
    asked = re.findall(r"<[^>]* (?:src|href|action)=([^ >]+)", text)
    assert [each for each in asked if not re.match(r"[\"'](#|data:)", each)] == []
    assert HOSTILE not in text
    assert "two </b> modes" not in re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)
    for section in (
        "verdict",
        "scene",
        "history",
        "energies",
        "velocities-part",
        "factor-part",
        "spectra-part",
        "checks",
    ):
        assert f'id="{section}"' in text
    for name in ("hits", "close", "over_time"):
        assert f"Figure {name}" in text


def test_histories_on_the_page_reach_the_peaks_of_the_results(results, data):
    result = results.result
    for each in data["histories"]:
        if each["signal"] == "input":
            assert each["fidelity"] == ""
            continue
        own = result[each["fidelity"]]
        at, history = own.signal(each["signal"]), own.history[each["signal"]]
        top = each["low"] + 65535 * each["step"]
        assert each["low"] <= history.least.min()
        assert top >= history.greatest.max() - 1e-9 * each["step"]
        assert max(-each["low"], top) == pytest.approx(history.peak, rel=1e-6)  # in single precision
        assert history.peak == pytest.approx(own.peak[1, 0, at], rel=1e-4)
        assert each["width"] * each["bins"] == pytest.approx(0.3)


def test_impacts_and_marks_of_the_motion_that_is_drawn(results, data, node):
    load = "const { unpacked } = await load('report/page/numbers.js');"
    script = f"{load} return [unpacked(given.time), unpacked(given.velocity)];"
    for each in data["impacts"]:
        own = results.result[each["fidelity"]]
        times, speeds = node(script, each)
        np.testing.assert_allclose(times, own.impact_times[1][0], atol=0.3 / 2**32, rtol=0)
        np.testing.assert_allclose(speeds, own.impact_velocities[1][0], atol=np.ptp(speeds) / 65535)
    labels = [each["label"] for each in data["marks"]]
    assert labels == ["first impact", "peak of sdof", "peak of two </b> modes"]
    assert all(0 <= each["begin"] < each["end"] <= 0.3 for each in data["marks"])


def test_curves_over_the_factor_and_the_velocity_are_means_over_the_seeds(results, data):
    result = results.result
    peak = next(each for each in data["families"]["factor"] if each["label"] == "Peak of sensor")
    for curve in peak["curves"]:
        values = 1e3 * result[curve["fidelity"]].of("peak", "sensor")
        assert curve["y"] == pytest.approx(values.mean(axis=1), rel=1e-4)
        error = np.abs(np.diff(values, axis=1))[:, 0] / 2  # of two: |a − b|/√2/√2
        assert np.subtract(curve["high"], curve["y"]) == pytest.approx(2 * error, rel=1e-2, abs=1e-4)
    hits = data["families"]["velocities"][0]
    assert hits["label"] == "at level 1"
    for curve in hits["curves"]:
        total = sum(len(each) for each in result[curve["fidelity"]].impact_velocities[1])
        assert curve["y"][0] == pytest.approx(total / 2 / 0.3, rel=1e-4)


def test_figures_show_the_whole_record_and_the_window_that_is_asked_for(results):
    result = results.result
    whole = record_figure(result)
    assert whole.axes[-2].get_xlim() == pytest.approx((0, 0.3))
    titles = [axes.get_title(loc="left") for axes in whole.axes[::2]]
    assert titles == [
        "base acceleration (m/s²)",
        "sensor (mm)",
        "velocity of sensor (mm/s)",
        "velocity before impact (mm/s)",
    ]
    close = figure(result, result.case.shows["close"])
    assert close.axes[-1].get_xlim() == pytest.approx((0.1, 0.15))
    drawn = [axes.collections for axes in whole.axes[2:4]]
    lowest = min(path.vertices[:, 1].min() for each in drawn[0] for path in each.get_paths())
    assert lowest == pytest.approx(1e3 * min(result[name].history["sensor"].least.min() for name in result))
    assert vibeam.plot(result).axes[2].get_title(loc="left") == "sensor (mm)"


def test_a_spectrogram_has_the_lines_of_its_modes(results):
    (sheet,) = results.result.shown["over_time"]
    assert sheet.fault == ""
    density = sheet["density"].reshape(len(sheet["frequency"]), -1)
    assert density.shape[1] == len(sheet["time"])
    case = results.result.case
    path = vibeam.simulate(case.system("beam"), case.input("beam", 3), 0.3, case.start("beam"))
    step = np.diff(sheet["frequency"]).mean()
    power = float(density.mean(axis=1).sum() * step)  # of the sensor, one-sided: its variance
    assert power == pytest.approx(path.at(np.linspace(0, 0.3, 60_001), "sensor").var(), rel=0.35)


def test_keys_of_figures_of_sweeps_are_refused_beside_a_record(tmp_path):
    with pytest.raises(vibeam.CaseError, match="periods"):
        vibeam.load(parsed(tmp_path, '[show.more]\nkind = "history"\nperiods = 4\n'))
    with pytest.raises(vibeam.CaseError, match="write two"):
        vibeam.load(parsed(tmp_path, '[show.more]\nkind = "history"\nwindow = ["0.1 s"]\n'))
    with pytest.raises(vibeam.CaseError, match="window"):
        vibeam.load(
            "cases/dtu_neutral.toml", {"show.h.kind": "history", "show.h.frequency": 15.3, "show.h.window": [0.1, 0.2]}
        )


def parsed(folder, more):
    (folder / "more.toml").write_text(CASE + more, encoding="utf-8")
    return folder / "more.toml"


def test_what_cannot_take_a_record_case_says_so_in_one_sentence(tmp_path):
    case = vibeam.load(parsed(tmp_path, ""))
    with pytest.raises(vibeam.CaseError, match=r"record: takes the place of \[sweep\]") as fault:
        vibeam.explore(case)
    assert len(str(fault.value).splitlines()) == 1


def test_around_the_marks_histories_have_their_own_bins(results, monkeypatch):
    """Where the page has room for few bins in all, the parts around the marks keep those of the results."""
    from vibeam.report.page import record_charts

    monkeypatch.setattr(record_charts, "HISTORIES_BYTES", 20_000)
    made = record_data(results.result)
    own = [each for each in made["histories"] if (each["signal"], each["fidelity"]) == ("sensor", "beam")]
    whole, *close = own
    assert whole["bins"] == 1024
    assert [each["width"] < whole["width"] / 2 for each in close] == [True] * len(made["marks"])
    for each, mark in zip(close, made["marks"], strict=True):
        assert each["begin"] <= mark["begin"] < mark["end"] <= each["begin"] + each["width"] * each["bins"] + 1e-12


def test_the_page_of_a_run_that_was_stopped_says_what_is_missing(tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    told = []

    def stop(*counts):
        told.append(counts)
        if len(told) > 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        vibeam.run(vibeam.load(tmp_path / "case.toml"), out=tmp_path / "case.h5", progress=stop)
    found = stored(tmp_path / "case.h5")
    assert 0 < found.missing < 8
    assert f"{found.missing} of 8 motions were not run yet" in page(found)
