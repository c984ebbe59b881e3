"""The page that flies, in Chromium and Firefox from a file: numbers of Python, sliders, address, case, no engine.

pip install 'vibeam[browser]', Debian's chromium and firefox-esr;
python -m pytest -m slow tests/vibeam/extensions/explore
"""

import re
import shutil
from math import tau
from pathlib import Path

import numpy as np
import pytest
from browsers import Opened

import vibeam
from vibeam.extensions.explore.sliders import case_sliders
from vibeam.solvers import solver

pytestmark = pytest.mark.slow

CASES = Path(__file__).parents[4] / "cases"
PERIODS = 40
PLACES = [  # of motions that repeat
    ("dtu_neutral", "sdof", {"frequency": 15.0}),
    ("dtu_neutral", "sdof", {"frequency": 15.6, "gap": 2e-5, "restitution": 0.6, "damping": 1.3}),
    ("dtu_neutral", "two_modes", {"frequency": 14.4, "drive": 0.4}),
    ("sdof_nominal", "sdof", {}),
    ("rigs/elastic_stop", "sdof", {}),
    ("rigs/elastic_stop", "beam", {}),
    ("rigs/elastic_stop", "three_modes", {"gap": 8e-5, "damping": 2.0}),
    ("experiment/fig28", "two_way", {"restitution": 0.75, "damping": 2.0}),
    ("experiment/table1", "neutral", {"restitution": 0.55}),
]
FLY = """async ({fidelity, periods, ...place}) => {
  const {impactTimes, impactVelocities, ...others} = await vibeam.fly({fidelity, periods, ...place});
  return {impactTimes: [...impactTimes], impactVelocities: [...impactVelocities], ...others};
}"""
UNTIL = "while (!(%s)) await new Promise((done) => setTimeout(done, 20));"  # the page's policy refuses texts as code
READY, SETTLED = UNTIL % "window.vibeam", UNTIL % "document.querySelector('#state').textContent.startsWith('Settled')"
NUMBERS = "document.querySelector('#readings tbody').innerText"
FIDELITIES = "#readings thead th:not(:first-child)"
CURVES = UNTIL % f"!{NUMBERS}.includes('…')"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Pages of cases, written once, by the stem of the case's file."""
    folder, made = tmp_path_factory.mktemp("explore"), {}

    def page_of(stem):
        if stem not in made:
            made[stem] = vibeam.explore(CASES / f"{stem}.toml").write(folder / f"{Path(stem).name}.html")
        return made[stem]

    return page_of


def settled(found):
    found.page.evaluate(f"async () => {{ {SETTLED} {CURVES} }}")
    return found.page


@pytest.fixture
def opened(browser, pages):
    """The page of one case, settled."""
    found = Opened(browser, pages("dtu_neutral"))
    settled(found)
    yield found
    assert found.said == []
    assert found.foreign == []
    found.page.close()


def truth(stem, fidelity, place):
    """Impacts (times, velocities) and steady point by Python, the case read anew with the sliders' keys."""
    file = CASES / f"{stem}.toml"
    sliders = case_sliders(vibeam.load(file)).sliders
    keys = [sliders[name].settings(value) for name, value in place.items() if name != "frequency"]
    case = vibeam.load(file, set={"units": "SI"} | {key: value for each in keys for key, value in each.items()})
    omega = tau * place.get("frequency", sliders["frequency"].value)
    system, amplitude = case.system(fidelity), float(case.amplitude_of(fidelity, omega))
    path = vibeam.simulate(system, vibeam.Drive(omega, amplitude), PERIODS * tau / omega)
    flight = solver("flight", system, omega)
    point, _ = flight.steady([omega], amplitude, None, case.sweep.settle, PERIODS, case.sweep.output)
    return path, point


def is_same(found, stem, fidelity, place):
    """Motions that repeat forget round-off: to 1e-12 of the time and of the largest value; periods to the number."""
    path, point = truth(stem, fidelity, place)
    assert len(path.impact_times) > PERIODS / 4
    assert point.period[0] > 0
    assert np.allclose(found["impactTimes"], path.impact_times, rtol=1e-12, atol=0)
    size = np.abs(path.impact_velocities).max()
    assert np.allclose(found["impactVelocities"], path.impact_velocities, rtol=0, atol=1e-12 * size)
    assert found["period"] == point.period[0]
    extremes = np.array([point.maximum[0], point.minimum[0]])
    assert np.allclose([found["maximum"], found["minimum"]], extremes, rtol=0, atol=1e-12 * np.abs(extremes).max())


@pytest.mark.parametrize(("stem", "fidelity", "place"), PLACES)
def test_a_flight_in_chromium_is_that_of_python(browser, pages, stem, fidelity, place):
    found = Opened(browser, pages(stem))
    found.page.evaluate(f"async () => {{ {READY} }}")
    is_same(found.page.evaluate(FLY, {"fidelity": fidelity, "periods": PERIODS, **place}), stem, fidelity, place)
    assert found.said == []
    assert found.foreign == []
    found.page.close()


@pytest.mark.parametrize(("stem", "fidelity", "place"), PLACES[:3])
def test_a_flight_in_firefox_is_that_of_python(firefox, pages, stem, fidelity, place):
    firefox.open(pages(stem).as_uri())
    firefox.run(READY)
    found = firefox.run(f"return ({FLY})(given[0]);", {"fidelity": fidelity, "periods": PERIODS, **place})
    is_same(found, stem, fidelity, place)
    assert firefox.heard() == []


@pytest.mark.parametrize("stem", ["dtu_tight", "rigs/tube", "rigs/mems_switch"])
def test_steady_points_at_random_places_are_those_of_python(browser, pages, stem):
    """Extremes to 1e-12 of the largest where the motion repeats; where not, that it does not."""
    found, rng = Opened(browser, pages(stem)), np.random.default_rng(7)
    sliders = case_sliders(vibeam.load(CASES / f"{stem}.toml")).sliders
    fidelity, *_ = vibeam.load(CASES / f"{stem}.toml").fidelities
    found.page.evaluate(f"async () => {{ {READY} }}")
    repeated = 0
    for _ in range(8):
        moved = ("frequency", "drive", "gap", "restitution")
        place = {each: rng.uniform(sliders[each].low, sliders[each].high) for each in moved if each in sliders}
        _, point = truth(stem, fidelity, place)
        flown = found.page.evaluate(FLY, {"fidelity": fidelity, "periods": PERIODS, **place})
        assert (flown["period"] > 0) == (point.period[0] > 0)
        if point.period[0] > 0:
            extremes = np.array([point.maximum[0], point.minimum[0]])
            off = 1e-12 * np.abs(extremes).max()
            assert np.allclose([flown["maximum"], flown["minimum"]], extremes, rtol=0, atol=off)
            repeated += 1
    assert repeated >= 2
    assert found.said == []
    found.page.close()


def test_sliders_and_pictures_follow_keys_in_firefox(firefox, pages):
    firefox.open(pages("dtu_neutral").as_uri())
    firefox.run(f"{SETTLED} {CURVES}")
    before = firefox.run(f"return {NUMBERS};")
    firefox.press("#slide-restitution", "\ue012" * 30)  # left arrow
    firefox.run(f"await new Promise((done) => setTimeout(done, 300)); {SETTLED} {CURVES}")
    assert firefox.run(f"return {NUMBERS};") != before
    assert "R=" in firefox.run("return location.hash;")
    assert firefox.run("return document.querySelectorAll('#live-spectrum canvas').length;") == 3
    assert firefox.heard() == []


def test_a_refusal_is_a_sentence(opened):
    for wrong, said in [
        ({"fidelity": "none"}, "No fidelity none: there are sdof, two_modes, beam"),
        ({"fidelity": "sdof", "restitution": 1.5}, "restitution"),
        ({"fidelity": "sdof", "frequency": 0}, "frequency"),
        ({"fidelity": "sdof", "gapp": 1e-5}, "No slider is called gapp"),
        ({"fidelity": "sdof", "gap": "1e-5"}, 'gap must be a number, not "1e-5"'),
        ({"fidelity": "sdof", "periods": 2.5}, "periods must be a whole number"),
        ({"fidelity": "sdof", "settle": -1}, "settle must be a whole number"),
    ]:
        answer = opened.page.evaluate(
            "(asked) => { try { vibeam.fly(asked); return ''; } catch (fault) { return fault.message; } }",
            {"periods": 2, **wrong},
        )
        assert said in answer


def test_arrow_keys_move_every_slider_and_the_numbers_follow(opened):
    page = opened.page
    for slider in page.locator("#sliders input[type=range]").all():
        before, text = page.evaluate(NUMBERS), slider.get_attribute("aria-valuetext")
        slider.focus()
        for _ in range(40):
            page.keyboard.press("ArrowRight")
        if slider.get_attribute("aria-valuetext") == text:  # it stood at its upper end
            for _ in range(40):
                page.keyboard.press("ArrowLeft")
        assert slider.get_attribute("aria-valuetext") != text
        page.wait_for_timeout(50)
        settled(opened)
        assert page.evaluate(NUMBERS) != before


def test_the_address_reproduces_the_place_to_the_digit(browser, pages, opened):
    page = opened.page
    page.locator("#slide-gap-number").fill("30")
    page.locator("#slide-frequency-number").fill("15.4")
    page.locator("#flown input").last.uncheck()
    page.wait_for_timeout(400)
    settled(opened)
    numbers = page.evaluate(NUMBERS)
    again = Opened(browser, pages("dtu_neutral"), fragment="#" + page.url.partition("#")[2])
    settled(again)
    assert again.page.evaluate(NUMBERS) == numbers
    assert again.page.locator("#slide-gap-number").input_value() == "30"
    assert again.page.locator(FIDELITIES).count() == 2
    assert again.said == []
    again.page.close()


def test_a_number_that_the_case_would_refuse_moves_nothing_and_is_told(opened):
    page, before = opened.page, opened.page.evaluate(NUMBERS)
    field = page.locator("#slide-restitution-number")
    for wrong in ("1.4", "-1", ""):
        field.fill(wrong)
        assert re.search("a number from 0", page.locator("#slider-fault").inner_text())
        assert field.get_attribute("aria-invalid") == "true"
    page.wait_for_timeout(400)
    assert page.evaluate(NUMBERS) == before


def test_the_case_at_these_sliders_runs_and_gives_the_same_numbers(opened, tmp_path):
    page = opened.page
    page.locator("#slide-gap-number").fill("20")
    page.locator("#slide-restitution-number").fill("0.6")
    page.locator("#slide-frequency-number").fill("15.2")
    page.wait_for_timeout(400)
    settled(opened)
    shutil.copytree(CASES / "references", tmp_path / "references")  # which the case names
    file = tmp_path / "written.toml"
    file.write_bytes(opened.saved("Write the case at these sliders"))
    case = vibeam.load(file)
    assert (case.keys.value("stop.gap"), case.keys.value("stop.restitution")) == (2e-5, 0.6)
    found = page.evaluate(FLY, {"fidelity": "sdof", "periods": 50, "frequency": 15.2, "gap": 2e-5, "restitution": 0.6})
    result = vibeam.run(vibeam.load(file, set={"sweep.frequency": [15.2], "sweep.direction": "up"}))
    _, response = next(iter(result["sdof"].items()))
    assert np.allclose([response.maximum[0], response.minimum[0]], [found["maximum"], found["minimum"]], rtol=1e-12)


@pytest.mark.parametrize("link", ["#f=x&gap=nan&R=9&drive=&without=all,none", "#%E0%A4%A", "#gap=1e999"])
def test_a_broken_link_opens_the_page_at_the_case(browser, pages, link):
    found = Opened(browser, pages("dtu_neutral"), fragment=link)
    assert settled(found).locator(FIDELITIES).count() == 3
    assert found.said == []
    found.page.close()


def test_without_webassembly_the_page_says_so_and_shows_the_rest(browser, pages):
    found = Opened(browser, pages("dtu_neutral"), before="delete globalThis.WebAssembly;")
    assert "no WebAssembly" in found.page.locator("#explore-waits").inner_text()
    assert not found.page.locator("#explore-body").is_visible()
    assert found.page.locator("#scene svg").first.is_visible()
    assert found.said == []
    found.page.close()


def test_without_workers_the_page_answers_itself(browser, pages):
    found = Opened(browser, pages("dtu_neutral"), before="globalThis.Worker = class { constructor() { throw 1; } };")
    here = settled(found).evaluate(NUMBERS)
    assert found.said == []
    found.page.close()
    found = Opened(browser, pages("dtu_neutral"))
    assert settled(found).evaluate(NUMBERS) == here
    found.page.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nothing_is_found_by_axe(browser, pages, theme):
    pytest.importorskip("axe_playwright_python")
    found = Opened(browser, pages("dtu_neutral"), color_scheme=theme)
    settled(found)
    assert found.violations() == []
    assert found.said == []
    found.page.close()


def test_a_telephone_needs_no_scrolling_aside(browser, pages):
    found = Opened(browser, pages("dtu_neutral"), viewport={"width": 360, "height": 740})
    assert settled(found).evaluate("document.documentElement.scrollWidth") <= 360
    found.page.close()


def test_a_notebook_shows_it_in_a_frame_without_rights(browser, pages, tmp_path):
    """Sandboxed: no request, no storage, no address of its own; sliders move all the same."""
    notebook = tmp_path / "notebook.html"
    shown = vibeam.explore(CASES / "dtu_neutral.toml")._repr_html_()
    notebook.write_text(f"<!DOCTYPE html><title>n</title><h1>n</h1>{shown}", encoding="utf-8")
    found = Opened(browser, notebook)
    frame = found.page.frames[1]
    frame.evaluate(f"async () => {{ {SETTLED} {CURVES} }}")
    before = frame.evaluate(NUMBERS)
    frame.locator("#slide-frequency-number").fill("15.1")
    found.page.wait_for_timeout(400)
    frame.evaluate(f"async () => {{ {SETTLED} {CURVES} }}")
    assert frame.evaluate(NUMBERS) != before
    assert found.said == []
    assert found.foreign == ["about:srcdoc"] or found.foreign == []
    found.page.close()
