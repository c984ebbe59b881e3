"""The page of a results file: what it says, what it asks of nobody, and how it takes hostile texts."""

import base64
import csv
import json
import os
import re
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure
from stand_in import curve as made
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.figures.units import DisplayUnits
from vibeam.maps.run import run_map
from vibeam.report.output import StudySheet
from vibeam.report.page import charts
from vibeam.report.page.charts import packed
from vibeam.report.page.drawing import LEFT, REACH, drawing, mode_shapes
from vibeam.report.page.page import VIEWS, page, study_page
from vibeam.report.page.parts import EXPORT, IMPORT, as_json, text_of
from vibeam.report.tables import blank
from vibeam.store.errors import StoreError
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
elements = 12
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "0.1 mm"
restitution = 0.7
[sensor]
position = "100 mm"
[drive]
amplitude = "0.02 mm"
[sweep]
frequency = { from = "30 Hz", to = "60 Hz", points = 7 }
direction = "up"
settle = 400
hold = 20
[fidelity.sdof]
reduction = "static_mode"
[fidelity.beam]
reduction = "modal"
modes = 4
label = "four </b> modes"
"""


LAB = """
[reference.lab]
file = "lab.csv"
fidelity = "beam"
quantity = "amplitude"
tolerance = "1 %"
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    file = folder / "case.toml"
    file.write_text(CASE.replace("TITLE", HOSTILE), encoding="utf-8")
    vibeam.run(vibeam.load(file), out=folder / "case.h5", compare=True)
    return folder / "case.h5"


@pytest.fixture(scope="module")
def text(results):
    return page(stored(results))


@pytest.fixture(scope="module")
def data(text):
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.DOTALL)
    return json.loads(found[1])


def decoded(packed_values):
    whole = np.frombuffer(base64.b64decode(packed_values["data"]), dtype="<u2")
    return packed_values["low"] + packed_values["step"] * whole


class Elements(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found = []
        self.words = []

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.words.append(data)


def elements(text):
    parser = Elements()
    parser.feed(text)
    return parser


def test_a_result_is_read_from_its_file_to_the_bit_and_the_file_stays(results):
    before = results.read_bytes()
    found = vibeam.read(results)
    again = vibeam.run(found.case)
    assert found.case.title == HOSTILE
    for name in again:
        for field in ("amplitude", "impact_velocity", "period", "mode_energy"):
            np.testing.assert_array_equal(getattr(found[name].up, field), getattr(again[name].up, field))
    assert results.read_bytes() == before
    assert found.comparisons
    assert found.restitutions("beam")[0] == 0.7


def test_the_page_says_all_that_the_terminal_says(results, text, monkeypatch):
    """Every cell and every sentence of ``vibeam run``, the errors of each fidelity among them."""
    monkeypatch.setenv("COLUMNS", "240")
    done = CliRunner().invoke(app, ["run", str(results.with_name("case.toml")), "--out", str(results)])
    assert done.exit_code == 0, done.output
    assert "amplitudes" in done.stdout
    shown = " ".join(" ".join(elements(text).words).split())
    lines = [line for line in done.stdout.splitlines() if line and not line.startswith(("─", "more: -v", "wrote "))]
    missing = [part for line in lines for part in re.split(r"\s{2,}", line.strip()) if part not in shown]
    assert missing == []


def test_the_page_has_the_rig_and_its_sweep_in_a_sentence(results, text):
    overview = str(stored(results).result.overview)
    assert "mode 1 at" in overview
    assert f"<p>{overview}.</p>" in text


def test_hostile_texts_are_shown_as_texts(text):
    parsed = elements(text)
    assert not [1 for tag, attributes in parsed.found if any(key.startswith("on") for key in attributes)]
    assert [attributes["alt"] for tag, attributes in parsed.found if tag == "img"]
    assert all(
        attributes["src"].startswith(("data:image/png;", "data:image/svg+xml;"))
        for tag, attributes in parsed.found
        if tag == "img"
    )
    assert HOSTILE in "".join(parsed.words)
    assert "49" not in re.search(r"<h1>(.*?)</h1>", text)[1]


def test_the_page_asks_nothing_of_any_network_and_is_small(text):
    parsed = elements(text)
    asked = [attributes for tag, attributes in parsed.found for key in ("src", "href", "action") if key in attributes]
    assert all(attributes.get("src", "data:").startswith("data:") for attributes in asked)
    assert all(attributes.get("href", "#").startswith("#") for attributes in asked)
    policy = next(each["content"] for _, each in parsed.found if each.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'")
    assert "connect-src" not in policy
    assert {"base-uri 'none'", "form-action 'none'"} <= set(policy.split("; "))  # no part of default-src
    assert len(text.encode()) < 1.6e6


def test_curves_on_the_page_are_those_of_the_file(results, data):
    result = vibeam.read(results)
    assert [each["label"] for each in data["fidelities"]] == ["sdof", "four </b> modes"]
    for curve in data["curves"]:
        response = result[curve["fidelity"]].up
        np.testing.assert_allclose(curve["frequency"], response.frequency, rtol=1e-5)
        unit = next(each for each in data["quantities"] if each["name"] == "amplitude")
        factor = {"mm": 1e3, "µm": 1e6}[unit["unit"]]
        np.testing.assert_allclose(curve["values"]["amplitude"], factor * response.amplitude, rtol=1e-5)
        np.testing.assert_allclose(np.sum(curve["shares"], axis=0), 1, atol=1e-3)


def test_a_curve_on_the_page_is_cut_where_its_figure_cuts_it(results, data):
    """Two pieces around a jump; motions without contact by themselves; in the style of the figures."""
    grid = np.linspace(14.0, 17.0, 61)
    jumped = np.where(grid < 15.8, 1.0, 0.2) / (1 + 8 * (grid - 15.2) ** 2)
    steps = np.where(grid < 14.6, 1.0, 2.0)
    found = charts.chart_pieces(
        made(grid, jumped), {"amplitude": jumped, "maximum": jumped, "impacts_per_period": steps}
    )
    assert found == {
        "amplitude": [[0, 0, 36], [0, 36, 61]],
        "impacts_per_period": [[0, 0, 12], [0, 12, 36], [0, 36, 61]],
    }
    names = [each["name"] for each in data["kinds"]]
    assert (data["kinds"][names.index("not periodic")]["width"], data["kinds"][0]["marker"]) == (0, "")
    for each in data["curves"]:
        period, kinds = np.array(each["values"]["period"]), np.full(len(each["frequency"]), -1)
        for kind, begin, end in each["pieces"]["amplitude"]:
            kinds[begin:end] = kind
        np.testing.assert_array_equal(kinds == names.index("no contact"), period == -1)
        assert (kinds >= 0).all()
        assert {-1, 1} <= set(period)


def test_no_label_of_the_drawing_covers_another():
    """Mass, sensor, outputs and both stops at one place."""
    outputs = "".join(f'[output.{name}]\nposition = "132 mm"\n' for name in ("second", "laser"))
    text = CASE.replace('"100 mm"', '"132 mm"').replace("restitution", 'second_gap = "0.2 mm"\nrestitution', 1)
    further = '[[further_stop]]\nposition = "131 mm"\ngap = "0.3 mm"\nrestitution = 0.5\nside = "below"\n'
    found = drawing(parse(text.replace('second_gap = "0.2 mm"', "") + outputs + further).scene)
    assert "further stop, gap 0.3 mm" in found
    assert found.count('class="stop"') == 2
    found = drawing(parse(text + outputs).scene)
    assert found.count('class="stop"') == 2
    texts = re.findall(r'<text x="([\d.]+)" y="([\d.]+)">([^<]+)</text>', found)
    boxes = [(float(x), float(y), 3.3 * len(words)) for x, y, words in texts]
    assert len(boxes) >= 7
    for at, (x, y, half) in enumerate(boxes):
        assert 0 <= x - half < x + half <= 960
        assert all(abs(x - other) >= half + wide or abs(y - low) >= 12 for other, low, wide in boxes[:at])


def test_print_has_no_section_that_needs_a_script(text):
    printed = re.search(r"@media print \{(.*?)\n\}", text, re.DOTALL)[1]
    assert "#participation { display: none; }" in printed


def brightness(colour):
    """Relative luminance, WCAG 2.2."""
    digits = colour.lstrip("#")
    digits = "".join(2 * each for each in digits) if len(digits) == 3 else digits
    parts = (int(digits[at : at + 2], 16) / 255 for at in (0, 2, 4))
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return np.dot((0.2126, 0.7152, 0.0722), linear)


def contrast(one, other):
    low, high = sorted(map(brightness, (one, other)))
    return (high + 0.05) / (low + 0.05)


def test_texts_and_lines_stand_out_on_the_light_and_on_the_dark_ground(text, data):
    """4.5 for texts, 3 for lines and marks: WCAG 2.2, 1.4.3 and 1.4.11; the system's dark is the reader's."""
    roots = [dict(re.findall(r"--(\w+): (#\w+)", each)) for each in re.findall(r":root[^{]*\{([^}]*)\}", text)]
    light, dark, system = roots[:3]
    assert dark == system
    assert light.keys() == dark.keys()
    for colours, kind in ((light, "colour"), (dark, "dark")):
        for name in ("ink", "pale", "link", "stop"):
            assert contrast(colours[name], colours["ground"]) >= 4.5
        assert min(contrast(colours[name], colours["tint"]) for name in ("ink", "link")) >= 4.5
        assert min(contrast(each[kind], colours["ground"]) for each in data["palette"] + data["fidelities"]) >= 3


def test_headings_controls_and_pictures_have_an_order_and_names(text):
    parsed = elements(text)
    levels = [int(tag[1]) for tag, _ in parsed.found if re.fullmatch(r"h\d", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(deeper - level <= 1 for level, deeper in pairwise(levels))
    names = [at["aria-label"] for _, at in parsed.found if at.get("role") in ("region", "img")]
    assert all(names)
    sections = re.findall(r"<h2[^>]*>([^<]+)</h2>", text)
    regions = [at["aria-label"] for _, at in parsed.found if at.get("role") == "region"] + sections
    assert len(regions) == len(set(regions))
    for control in re.findall(r"<(?:select|input)\b[^>]*>", text.partition('<script id="data"')[0]):
        before = text[: text.index(control)]
        assert before.rindex("<label") > before.rindex("</label>") if "</label>" in before else "<label" in before
    links = [at["href"][1:] for tag, at in parsed.found if tag == "a"]
    assert set(links) <= {at.get("id") for _, at in parsed.found}


def test_scripts_take_from_one_another_what_these_have_and_what_they_use():
    before = {}
    for name in ("state", "saving", *VIEWS, "start"):
        source = text_of(f"{name}.js")
        for taken, home in IMPORT.findall(source):
            for each in taken.strip("{} ").split(", "):
                assert each in before[home], f"{name}.js: {home}.js has no {each}"
                assert len(re.findall(rf"\b{each}\b", source)) > 1, f"{name}.js does not use {each}"
        before[name] = [each[1] for each in EXPORT.findall(source)]


def test_a_page_without_an_engine_may_not_compile(results):
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page(stored(results)))[1]
    assert "wasm" not in policy
    assert "worker" not in policy


def test_mode_shapes_are_those_of_the_structure_over_their_places(results, text):
    """From three to eight modes, here of a fidelity with four: the dot is the shape at the stop."""
    case = vibeam.read(results).case
    shown = mode_shapes(case.scene, 4)
    assert [shown.data.count(f"mode {number}<") for number in (1, 4, 5)] == [1, 1, 0]
    assert mode_shapes(case.scene, 1).data.count("<polyline") == 3
    assert mode_shapes(case.scene, 40).data.count("<polyline") == 8
    assert shown.data in text
    table = vibeam.modes(case, 2)
    points = re.findall(r'<polyline class="shape" points="([^"]+)"', shown.data)[1].split()
    x, y = np.array([each.split(",") for each in points], dtype=float).T
    rest = float(re.findall(r'class="axis" d="M[\d.]+ ([\d.]+)H', shown.data)[1])
    np.testing.assert_allclose((x - LEFT) / (x[-1] - LEFT), table.positions / 0.18, atol=1e-4)
    shape = table.shapes[:, 1] / table.shapes[np.argmax(abs(table.shapes[:, 1])), 1]
    np.testing.assert_allclose((rest - y) / REACH, shape, atol=5e-3)
    dot = float(re.findall(r'class="touch" cx="[\d.]+" cy="([\d.]+)"', shown.data)[1])
    assert (rest - dot) / REACH == pytest.approx(np.interp(0.132, table.positions, shape), abs=5e-3)
    rows = list(csv.reader(shown.numbers.splitlines()))
    assert float(rows[-1][2]) == pytest.approx(table.shapes[-1, 1], rel=1e-5)


MEASURED = """
[measured.top]
fidelity = "beam"
quantity = "peak"
value = "0.2 mm"
uncertainty = "5 %"
source = "lab"
[measured.where]
fidelity = "beam"
quantity = "peak_frequency"
value = "50 Hz"
source = "lab"
[measured.one]
fidelity = "sdof"
quantity = "impact_velocity"
frequency = "40 Hz"
value = "3 mm/s"
source = "lab"
[map.plane]
axes = [
  { key = "stop.gap", from = "0.05 mm", to = "0.1 mm", points = 2 },
  { key = "sweep.frequency", from = "30 Hz", to = "60 Hz", points = 3 },
]
[show.ends]
kind = "curve"
quantity = "reach"
"""


def test_what_was_measured_and_the_figures_and_maps_of_the_case_are_on_the_page(tmp_path):
    (tmp_path / "lab.csv").write_text("frequency,amplitude,direction\n30,1e-5,up\n", encoding="utf-8")
    (tmp_path / "case.toml").write_text(CASE.replace("TITLE", "Prüfstand") + LAB + MEASURED, encoding="utf-8")
    case = vibeam.load(tmp_path / "case.toml")
    vibeam.run(case, out=tmp_path / "case.h5")
    found = stored(tmp_path / "case.h5")
    marks = {each["name"]: each for each in charts.chart_data(found)["references"]}
    assert (marks["lab"]["frequency"], marks["lab"]["value"], marks["lab"]["single"]) == ([30.0], [1e-5], False)
    assert (marks["top"]["frequency"], marks["top"]["value"], marks["top"]["bar"]) == ([50.0], [2e-4], [1e-5])
    assert [marks["one"][each] for each in ("quantity", "frequency", "value")] == ["impact_velocity", [40.0], [3e-3]]
    assert "where" not in marks
    before = page(found)
    assert "Not shown: Map plane, which vibeam map draws beside" in before
    assert 'alt="Map plane' not in before
    run_map(case, "plane", tmp_path / "case_plane.h5")
    after = page(found)
    assert 'alt="Map plane, without its exact lines"' in after
    curve = re.search(r'data-name="ends" data-csv="([^"]+)"', after)[1].splitlines()
    assert curve[0] == "panel,curve,x,y"
    assert len(curve) > 10
    drawn = tmp_path / "case_plane.svg"
    drawn.write_text("<svg xmlns='http://www.w3.org/2000/svg'/>", encoding="utf-8")
    assert base64.b64encode(drawn.read_bytes()).decode() in page(found)
    os.utime(drawn, (0, 0))
    assert base64.b64encode(drawn.read_bytes()).decode() not in page(found)
    run_map(
        vibeam.load(tmp_path / "case.toml", {"drive.amplitude": "0.03 mm"}),
        "plane",
        tmp_path / "case_plane.h5",
        fresh=True,
    )
    assert 'alt="Map plane' not in page(found)


def test_the_drawing_has_one_scale(results):
    found = drawing(vibeam.read(results).case.scene)
    points = [tuple(map(float, each.split(","))) for each in re.search(r'points="([^"]+)"', found)[1].split()]
    x, y = zip(*points, strict=True)
    assert (max(y) - min(y)) / (max(x) - min(x)) == pytest.approx(3 / 180, rel=1e-2)
    stop = float(re.search(r'class="stop" d="M([\d.]+)', found)[1])
    assert (stop - LEFT) / (max(x) - min(x)) == pytest.approx(132 / 180, rel=1e-3)


def test_points_that_were_not_run_and_references_that_are_not_there_are_said(tmp_path):
    case = CASE.replace("TITLE", "partial") + LAB
    (tmp_path / "lab.csv").write_text("frequency,amplitude,direction\n30,1e-5,up\n", encoding="utf-8")
    (tmp_path / "case.toml").write_text(case, encoding="utf-8")
    loaded = vibeam.load(tmp_path / "case.toml")

    class Enough(Exception):
        pass

    def stop(done, total):
        if done >= 1:
            raise Enough

    with pytest.raises(Enough):
        vibeam.run(loaded, out=tmp_path / "case.h5", progress=stop)
    (tmp_path / "lab.csv").unlink()
    found = stored(tmp_path / "case.h5")
    assert 0 < found.missing < found.result.total
    text = page(found)
    assert f"{found.missing} of 14 points were not run yet" in text
    assert "lab: no such file beside the results" in text


def test_what_is_no_result_is_refused_in_one_line(tmp_path, results):
    (tmp_path / "other.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    with pytest.raises(StoreError, match="is no results file: name one that vibeam run has written"):
        vibeam.read(tmp_path / "other.h5")
    with pytest.raises(StoreError, match=r"cannot be opened .*: name one that vibeam run has written"):
        vibeam.read(tmp_path / "none.h5")
    other = tmp_path / "other.toml"
    other.write_text(CASE.replace("0.2 kg", "0.3 kg"), encoding="utf-8")
    with pytest.raises(StoreError, match=r"is not of .*other\.toml"):
        stored(results, vibeam.load(other))


def test_numbers_come_back_within_half_a_step():
    values = np.random.default_rng(3).standard_normal(500)
    np.testing.assert_allclose(decoded(packed(values)), values, atol=0.51 * np.ptp(values) / 65535)
    assert decoded(packed(np.full(3, 2.5))) == pytest.approx(2.5)
    assert json.loads(as_json({"a": "</script><!--\u2028&"})) == {"a": "</script><!--\u2028&"}
    assert "<" not in as_json({"a": "</script><!--"})


def test_another_title_is_the_file_s_from_the_next_run_on_without_a_word(tmp_path):
    file = tmp_path / "case.toml"
    for title in ("one", "another"):
        file.write_text(CASE.replace("TITLE", title), encoding="utf-8")
        found = vibeam.run(vibeam.load(file), out=tmp_path / "case.h5")
        assert vibeam.read(tmp_path / "case.h5").case.title == title
    assert found.found == found.total


def sheet_drawn():
    figure = Figure(figsize=(3, 2))
    figure.subplots().plot([1, 2], [3, 4], label="line")
    return figure


def sheets():
    """Sheets of two studies, with hostile texts."""
    table, more = blank("Narrow", "model", "off|"), blank("Wide", "model", "by|")
    table.add_row("sdof", "3 %")
    more.add_row(HOSTILE, "4 %")
    said = ["Two modes suffice.", [table], ["Not known: fly it."], ["A detail."], [more]]
    return [("Modes & more", StudySheet(*said, draw=sheet_drawn)), ("Effects", StudySheet(HOSTILE))]


SHEETS = sheets()


def test_a_page_of_studies_has_a_section_for_each_sheet_with_all_that_it_holds():
    """Answer, tables, notes, figure; folded: details and further tables; hostile texts as texts."""
    text = study_page(HOSTILE, "One beam, one stop.", SHEETS)
    parsed = elements(text)
    words = " ".join(" ".join(parsed.words).split())
    said = ("One beam, one stop.", "Modes & more", "Two modes suffice.", "Narrow", "3 %", "Not known: fly it.")
    assert [each for each in (*said, "A detail.", "Wide", "4 %") if each not in words] == []
    assert words.count(HOSTILE) == 4  # title twice, a cell, an answer
    folded = re.search(r"<details>(.*?)</details>", text, re.DOTALL)[1]
    assert "A detail." in folded
    assert "Narrow" not in folded
    assert [at["alt"] for tag, at in parsed.found if tag == "img"] == ["Figure: Modes & more"]
    assert all(at["src"].startswith("data:image/svg+xml;") for tag, at in parsed.found if tag == "img")
    assert len([tag for tag, _ in parsed.found if tag == "section"]) == 2
    drawn = next(at["data-csv"] for tag, at in parsed.found if tag == "figure")
    assert drawn.splitlines() == ["panel,curve,x,y", ",line,1,3", ",line,2,4"]


def test_words_of_the_terminal_and_lines_of_a_case_are_those_of_a_page():
    """A hint at ``-v`` names the part of the page, in a note, a caption or a detail; lines of a case stand as such."""
    table = blank("Wide", "name", "size|")
    table.caption = "*: -v says why"
    table.add_row("a", "1")
    cure = 'In place of [stop] as it is:\n[stop]\ngap = "1 mm"  # <yours>\nlaw = "hertz"'
    notes = ["rigs: no fuller model is known, -v says why", cure, "Nothing [of a case] here."]
    text = study_page("Title", "Answer.", [("One", StudySheet("", [table], notes, [cure, "one -v says why"]))])
    assert "-v" not in re.sub(r"<(script|style).*?</\1>", "", text, flags=re.DOTALL)
    assert text.count("“Further numbers and notes” says why") == 3
    lines = re.findall(r"<pre>(.*?)</pre>", text, re.DOTALL)
    assert lines == ["[stop]\ngap = &#34;1 mm&#34;  # &lt;yours&gt;\nlaw = &#34;hertz&#34;"] * 2
    assert "Nothing [of a case] here." in text


def test_what_is_of_the_contact_has_a_unit_of_its_own():
    """Beside a strain gauge the distance from the stop is a length, the impact's velocity one of the contact."""
    found = {
        each.name: each.unit for each in charts.chart_quantities(DisplayUnits("µε", 1e6, "Hz", 1.0, "", 1, "strain"))
    }
    assert (found["maximum"], found["reach"], found["impact_velocity"]) == ("µε", "mm", "mm/s")
    assert charts.chart_quantities(DisplayUnits("µm", 1e6, "Hz", 1.0))[3].unit == "µm"
