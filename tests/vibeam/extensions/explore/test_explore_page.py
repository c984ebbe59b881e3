"""Pages that fly: what they carry, what they may, and what stands in their place where nothing flies."""

import base64
import gzip
import json
import re
from html import unescape
from importlib.resources import files

import numpy as np
import pytest
from browsers import Opened
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app
from vibeam.extensions.explore import command
from vibeam.extensions.explore import page as explore_pages
from vibeam.extensions.explore.drive import motion_without_stop
from vibeam.extensions.explore.exploration import SANDBOX
from vibeam.extensions.explore.page import HOMES, live_part, of_payload
from vibeam.extensions.explore.payload import guessed_units, payload
from vibeam.extensions.explore.sliders import case_sliders
from vibeam.flight.engine.loading import KernelsUnavailable
from vibeam.report.page.page import page
from vibeam.report.page.parts import HOME, IMPORT, bundle, text_of, with_imports
from vibeam.runs.run_plan import restricted
from vibeam.studies.stored import stored

HOSTILE = "</script><img src=x onerror=alert(1)> & {{ 7 * 7 }}"
STOPPED = "no fidelity of this case can be flown in a page; vibeam run sweeps it:\n"


@pytest.fixture(scope="module")
def case():
    return vibeam.load("cases/dtu_neutral.toml", {"title": HOSTILE, "sweep.frequency.points": 3})


@pytest.fixture(scope="module")
def made(case):
    return payload(case)


@pytest.fixture(scope="module")
def html(case):
    return vibeam.explore(case).html


@pytest.fixture
def run(monkeypatch, tmp_path):
    """``vibeam …`` in an empty folder."""
    folder = vibeam.load("cases/dtu_neutral.toml").path.resolve().parent
    (tmp_path / "cases").symlink_to(folder)
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(app, list(words))


def numbers(packed):
    return np.frombuffer(base64.b64decode(packed["f8"]), "<f8").reshape(packed["shape"])


def script(text, name):
    return re.search(rf'<script id="{name}"[^>]*>(.*?)</script>', text, re.DOTALL)[1]


def policy(text):
    return re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]


def test_a_payload_has_what_the_page_reads(case, made):
    assert made.keys() == {
        "version", "level", "digest", "libraries", "slots", "models", "sliders", "fixed", "ended", "sweep", "asked",
        "case",
    }  # fmt: skip
    assert made["asked"] == {"amplitude": 0.05, "frequency": pytest.approx(0.01)}
    assert (made["version"], made["level"], len(made["digest"])) == (vibeam.__version__, "wasm", 16)
    assert made["libraries"].keys() == {"tables", "flight", "points"}
    for text in made["libraries"].values():
        assert gzip.decompress(base64.b64decode(text))[:4] == b"\0asm"
    assert {"tables.tabulate", "flight.move", "points.run"} <= made["slots"]["entries"].keys()
    assert made["sweep"]["frequency"] == [14.0, 15.5, 17.0]
    assert made["case"].keys() == {"title", "name", "file", "template"}
    assert [each["name"] for each in made["sliders"]] == ["frequency", "drive", "gap", "restitution", "damping"]
    for each in made["sliders"]:
        assert each["low"] <= each["value"] <= each["high"]
        assert each["name"] == "frequency" or each["of"].keys() == {"sdof", "two_modes", "beam"}
    json.dumps(made, allow_nan=False)


def test_models_are_the_systems_to_the_bit(case, made):
    for model in made["models"]:
        system = case.system(model["name"])
        assert (model["engine"], model["refusal"], model["finest"]) == ("plain", "", "beam")
        for name in ("omega", "zeta", "contact", "load", "static"):
            assert numbers(model[name]).tolist() == getattr(system, name).tolist()
        assert (model["gap"], model["restitution"]) == (system.gap, system.restitution)
        drive = model["amplitude"]
        assert drive["level"] * drive["factor"] == pytest.approx(case.amplitude_of(model["name"]), rel=1e-15)


def test_a_platform_gives_tables_at_the_places_of_the_slider():
    case = vibeam.load("cases/experiment/fig28.toml", {"sweep.frequency.points": 3})
    made = payload(case)
    frequency = next(each for each in made["sliders"] if each["name"] == "frequency")
    tables = {each["name"]: each["amplitude"] for each in made["models"] if "frequency" in each["amplitude"]}
    assert tables
    for drive in tables.values():
        assert numbers(drive["frequency"]).tolist() == numbers(frequency["places"]).tolist()


def test_damping_moves_a_drive_by_a_platform_only_where_the_page_says_so():
    """A platform that is felt in some fidelities has its damping multiplied too, in those that feel it not as well."""
    shaken = {"mass": "5 kg", "frequency": "3.25 Hz", "damping_ratio": 0.05, "calibrated_at": "15.5 Hz"}
    own = {"fidelity.sdof.set": {"platform.coupling": "one-way"}, "sweep.frequency.points": 5}
    for coupling, damped in {"two-way": False, "one-way": True}.items():
        case = vibeam.load("cases/dtu_neutral.toml", own | {"platform": shaken | {"coupling": coupling}})
        model = next(each for each in payload(case)["models"] if each["name"] == "sdof")
        assert (model["engine"], model["damped"]) == ("plain", damped)
        omega = 2 * np.pi * case.sweep.frequency
        twice = case.with_keys(case_sliders(case).sliders["damping"].settings(2.0))
        same = np.array_equal(case.amplitude_of("sdof", omega), twice.amplitude_of("sdof", omega))
        assert same is damped


def test_a_size_without_a_stop_is_the_resonance_of_one_mode():
    """ω²B/√((ω² − Ω²)² + (2ζωΩ)²) of the textbook, largest over the sweep."""
    case = vibeam.load("cases/sdof_nominal.toml", {"sweep.frequency.points": 5})
    ratio = case.sweep.frequency * 2 * np.pi
    wanted = 0.5e-3 * ratio**2 / np.hypot(1 - ratio**2, 2 * 0.015 * ratio)
    assert motion_without_stop(case, "sdof", "sensor") == pytest.approx(wanted.max(), rel=1e-12)
    still = vibeam.load("cases/sdof_nominal.toml", {"sdof.damping_ratio": 0.0, "sweep.frequency": ["1 rad/s"]})
    assert motion_without_stop(still, "sdof", "sensor") == 0


def test_sizes_of_numbers_suit_the_motion():
    units = {name: guessed_units(vibeam.load(f"cases/{name}.toml")) for name in ("dtu_neutral", "rigs/mems_switch")}
    assert (units["dtu_neutral"].length, units["dtu_neutral"].frequency) == ("mm", "Hz")
    assert units["rigs/mems_switch"].frequency == "kHz"
    assert units["rigs/mems_switch"].length in ("µm", "nm")
    between = vibeam.load("cases/rigs/tube.toml", {"stop.gap": "2 µm", "stop.second_gap": "3 µm"})
    assert guessed_units(between).length == "µm"
    assert guessed_units(vibeam.load("cases/rigs/harvester.toml")).length == "mm"  # one fidelity has a gap of 1 m
    assert guessed_units(vibeam.load("cases/experiment/fig30.toml")).length == "mm"  # 50 mm: out of reach


def test_the_page_asks_nothing_of_any_network_and_may_compile(html):
    wanted = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
    wanted += "script-src 'unsafe-inline' 'wasm-unsafe-eval'; worker-src blob:; base-uri 'none'; form-action 'none'"
    assert policy(html) == wanted
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:|#)""", html)
    assert "<img src=x" not in html
    assert "49" not in re.search(r"<h1>(.*?)</h1>", html)[1]
    assert json.loads(script(html, "engine"))["case"]["title"] == HOSTILE
    assert len(html.encode()) < 900_000


def test_the_engine_stands_on_the_page_once_and_names_no_file(html):
    engine = script(html, "worker")
    assert engine.strip().startswith('"use strict";')
    assert not re.search(r"^(import|export) |^ *//|^ */\*\*", engine, re.MULTILINE)
    defined = re.findall(r"^modules\.(\w+) = ", html, re.MULTILINE)
    assert len(defined) == len(set(defined))
    assert {"slots", "engine", "explore", "start"} <= set(defined)
    assert "document" not in re.sub(r"//.*|/\*.*?\*/", "", "".join(engine.split("modules.worker")[0]), flags=re.DOTALL)


def test_a_page_of_results_has_the_engine_unless_it_is_left_out(tmp_path, case):
    vibeam.run(vibeam.load("cases/sdof_nominal.toml", {"sweep.frequency.points": 3}), out=tmp_path / "a.h5")
    found = stored(tmp_path / "a.h5")
    still, flying = page(found), page(found, engine=True)
    assert "wasm-unsafe-eval" in policy(flying)
    assert "wasm" not in still
    for each in re.findall(r'<section id="(\w+)"', still):
        assert f'<section id="{each}"' in flying
    units = json.loads(script(flying, "engine"))["sweep"]["units"]
    charts = json.loads(script(flying, "data"))
    assert units == {name: charts[name] for name in units}
    said = CliRunner().invoke(app, ["report", str(tmp_path / "a.h5"), "--no-engine", "-o", str(tmp_path / "b.html")])
    assert (said.exit_code, (tmp_path / "b.html").read_text("utf-8")) == (0, still)


def test_a_page_without_its_kernels_says_so(tmp_path, monkeypatch):
    def missing(found):
        raise KernelsUnavailable("a page cannot carry the engine: gone")

    monkeypatch.setattr(explore_pages, "results_section", missing)
    vibeam.run(vibeam.load("cases/sdof_nominal.toml", {"sweep.frequency.points": 3}), out=tmp_path / "a.h5")
    said = CliRunner().invoke(app, ["report", str(tmp_path / "a.h5"), "-o", f"{tmp_path}/"])
    assert said.exit_code == 0
    assert said.stderr == "the page has no engine: a page cannot carry the engine: gone\n"
    assert "wasm" not in (tmp_path / "a.html").read_text("utf-8")


def test_explore_writes_a_page_and_opens_no_browser_in_a_pipe(run, tmp_path, monkeypatch):
    monkeypatch.setattr("webbrowser.open", lambda url: pytest.fail("nobody is there"))
    said = run("explore", "cases/dtu_neutral.toml", "--set", "stop.gap=0.05 mm", "--fidelity", "beam")
    assert (said.exit_code, said.stdout, said.stderr) == (0, "dtu_neutral_explore.html\n", "")
    sliders = json.loads(script((tmp_path / "dtu_neutral_explore.html").read_text("utf-8"), "engine"))["sliders"]
    gap = next(each for each in sliders if each["name"] == "gap")
    assert (gap["value"], list(gap["of"])) == (0.05e-3, ["beam"])
    said = run("explore", "cases/rigs/two_stops.toml", "-o", "pages/a.html")
    assert said.stdout == "pages/a.html\n"
    assert [line.partition(":")[0] for line in said.stderr.splitlines()] == ["sdof", "four_modes"]
    told = json.loads(run("explore", "cases/rigs/two_stops.toml", "--json", "-o", "pages/").stdout)
    assert (told["files"], told["flown"]) == (["pages/two_stops_explore.html"], ["one_stop"])
    assert told["refused"].keys() == {"sdof", "four_modes"}


def test_a_browser_opens_where_somebody_is_there(run, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr(command, "_display", lambda: True)
    run("explore", "cases/sdof_nominal.toml")
    assert [url.rpartition("/")[2] for url in opened] == ["sdof_nominal_explore.html"]
    run("explore", "cases/sdof_nominal.toml", "--no-open")
    run("explore", "cases/sdof_nominal.toml", "--json")
    assert len(opened) == 1


@pytest.mark.parametrize(
    ("variables", "there"),
    [({"DISPLAY": ":0"}, True), ({"WAYLAND_DISPLAY": "w"}, True), ({}, False), ({"DISPLAY": ":0", "CI": "1"}, False)],
)
def test_who_is_there(monkeypatch, variables, there):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "CI"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    assert command._display() is there
    monkeypatch.setattr("sys.stdout.isatty", lambda: False)
    assert command._display() is False


def test_a_case_that_no_page_flies_is_a_message_and_no_file(run, tmp_path):
    said = run("explore", "cases/paper/fig03.toml")
    assert said.exit_code == 2
    assert said.stderr.startswith(f"cases/paper/fig03.toml: {STOPPED}direct: ")
    assert run("explore", "cases/gone.toml").stderr == "cases/gone.toml: no such file\n"
    assert run("explore", "cases/sdof_nominal.toml", "-o", "a.png").exit_code == 2
    assert [each.name for each in tmp_path.iterdir()] == ["cases"]


def test_a_page_of_results_names_what_it_does_not_fly():
    case = restricted(vibeam.load("cases/sdof_methods.toml"), ["mapping", "averaging_paper"])
    live = live_part(case)
    assert (live.payload, len(live.refusals)) == ("", 2)
    assert live.refusals[0].startswith(f"{case.fidelities['mapping'].label or 'mapping'}: ")


def test_a_notebook_shows_the_page_as_a_frame_that_is_shut_off(case, html, tmp_path):
    shown = vibeam.explore(case, height=700)
    frame = shown._repr_html_()
    assert unescape(re.search(r'srcdoc="([^"]*)"', frame)[1]) == shown.html == html
    assert re.search(r'sandbox="([^"]*)"', frame)[1] == SANDBOX
    assert "allow-same-origin" not in SANDBOX
    assert "height: 700px" in frame
    assert frame.count("<") == 2  # the frame and its end: no text of the case is markup
    assert shown.write(tmp_path / "a.html").read_text("utf-8") == html
    assert "html" not in repr(shown)


@pytest.mark.slow
def test_the_frame_of_a_notebook_flies_in_a_browser(browser, tmp_path):
    """Shut off from its notebook, without an address: it flies as Python does, and a slider moves it."""
    case = vibeam.load("cases/dtu_neutral.toml")
    shown = vibeam.explore(case)._repr_html_()
    (tmp_path / "notebook.html").write_text(f"<!DOCTYPE html><meta charset=utf-8>{shown}", encoding="utf-8")
    opened = Opened(browser, tmp_path / "notebook.html")
    opened.page.wait_for_timeout(1000)
    frame = opened.page.frames[1]
    ready = "new Promise((done) => { const look = () => (window.vibeam ? done() : setTimeout(look, 20)); look(); })"
    frame.evaluate(ready)
    found = frame.evaluate("vibeam.fly({fidelity: 'beam', frequency: 15.3, periods: 20})")
    drive = vibeam.Drive(2 * np.pi * 15.3, float(case.amplitude_of("beam")))
    path = vibeam.simulate(case.system("beam"), drive, 20 / 15.3)
    times = found["impactTimes"]
    times = list(times.values()) if isinstance(times, dict) else times
    np.testing.assert_allclose(times, path.impact_times, rtol=0, atol=1e-11 / 15.3)
    gap = frame.locator("#sliders input[type=range]").nth(2)
    before = frame.locator("#differences").inner_text()
    gap.focus()
    gap.press("ArrowRight")
    opened.page.wait_for_timeout(1500)
    assert frame.locator("#differences").inner_text() != before
    assert opened.said == []
    assert opened.foreign == ["about:srcdoc"] or opened.foreign == []
    opened.page.close()


def test_modules_of_other_folders_come_in_the_order_of_what_they_take():
    homes = (HOME, *HOMES)
    found = with_imports(["periodic", "pictures"], known=("multipliers",), homes=homes)
    assert "multipliers" not in found
    for name in found:
        for _, home in IMPORT.findall(text_of(f"{name}.js", homes)):
            assert home == "multipliers" or found.index(home) < found.index(name)
    text = bundle(found, first=False, homes=homes)
    assert not re.search(r"^(import|export) ", text, re.MULTILINE)
    assert "const modules" not in text


def test_no_two_modules_of_pages_have_one_name():
    places = (files(package) / folder for package, _, folder in (home.partition(":") for home in (HOME, *HOMES)))
    names = [file.name for place in places for file in place.glob("*.*") if file.suffix in (".js", ".html", ".css")]
    assert len(names) == len(set(names)) > 20


def test_a_page_whose_models_cannot_be_flown_says_why(tmp_path, monkeypatch):
    monkeypatch.setattr(
        explore_pages, "results_section", lambda found: of_payload("", ("contacts <b> in several places",))
    )
    vibeam.run(vibeam.load("cases/sdof_nominal.toml", {"sweep.frequency.points": 3}), out=tmp_path / "a.h5")
    assert "contacts &lt;b&gt; in several places" in page(stored(tmp_path / "a.h5"), engine=True)
