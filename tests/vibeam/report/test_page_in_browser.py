"""The page in Chromium: toggles, reading, frequency picker, animation, no error, no request, nothing run, accessible.

pip install 'vibeam[browser]' and Debian's chromium; python -m pytest -m slow tests/vibeam/report
"""

import json
import re
from pathlib import Path

import pytest

import vibeam
from tests.vibeam.report.test_page import CASE, HOSTILE
from vibeam.report.page.page import page
from vibeam.studies.stored import stored

pytestmark = pytest.mark.slow

CHROMIUM = Path("/usr/bin/chromium")

OPTIONS = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
           "--disable-component-update", "--disable-sync"]  # fmt: skip


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api")
    if not CHROMIUM.exists():
        pytest.skip("needs Debian's chromium")
    with playwright.sync_playwright() as started:
        found = started.chromium.launch(executable_path=str(CHROMIUM), args=OPTIONS)
        yield found
        found.close()


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    (folder / "case.toml").write_text(CASE.replace("TITLE", HOSTILE), encoding="utf-8")
    vibeam.run(vibeam.load(folder / "case.toml"), out=folder / "case.h5", compare=True)
    (folder / "case.html").write_text(page(stored(folder / "case.h5")), encoding="utf-8")
    return folder / "case.html"


class Opened:
    """A page with what it has asked for, said and run."""

    def __init__(self, browser, file, **options):
        self.page = browser.new_page(**options)
        self.asked, self.said = [], []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("dialog", lambda dialog: (self.said.append("dialog"), dialog.dismiss()))
        self.page.goto(file.as_uri())

    @property
    def foreign(self):
        return [url for url in self.asked if not url.startswith(("file:", "data:"))]


@pytest.fixture
def opened(browser, file):
    found = Opened(browser, file)
    yield found
    assert found.said == []
    assert found.foreign == []
    found.page.close()


def test_opens_in_less_than_a_second_of_its_own(opened):
    timing = opened.page.evaluate("JSON.stringify(performance.getEntriesByType('navigation')[0])")
    assert json.loads(timing)["domInteractive"] < 1000


def test_hostile_texts_are_shown_and_not_run(opened):
    assert opened.page.locator("h1").inner_text() == HOSTILE
    assert opened.page.locator("img[src='x']").count() == 0
    assert "four </b> modes ↑" in opened.page.locator("#shown").inner_text()


def test_a_curve_is_taken_away_and_comes_back(opened):
    box = opened.page.locator("#shown input").first
    before = opened.page.locator("#response canvas").screenshot()
    box.uncheck()
    without = opened.page.locator("#response canvas").screenshot()
    box.check()
    assert without != before
    assert opened.page.locator("#response canvas").screenshot() == before


def test_the_curve_under_the_pointer_is_read_out(opened):
    place = opened.page.locator("#response .u-over")
    place.scroll_into_view_if_needed()
    place.hover()
    reading = opened.page.locator("#reading").inner_text()
    assert re.search(r"^45 Hz: sdof ↑ \d+(\.\d+)? mm, four </b> modes ↑ \d+(\.\d+)? mm$", reading)


def test_the_reader_picks_a_frequency(opened):
    picker = opened.page.locator("#pick")
    picker.focus()
    picker.evaluate("each => { each.value = 0; each.dispatchEvent(new Event('input')); }")
    assert opened.page.locator("#picked").inner_text() == "30 Hz"
    clear = opened.page.locator("#numbers").inner_text()
    portrait = opened.page.locator("#portrait path").first.get_attribute("d")
    picker.press("End")
    assert opened.page.locator("#picked").inner_text() == "60 Hz"
    assert opened.page.locator("#portrait path").first.get_attribute("d") != portrait
    assert "no contact" in clear


def test_the_beam_moves_when_played_and_stands_still_before(opened):
    line = opened.page.locator("#beam polyline").last
    still = line.get_attribute("points")
    opened.page.wait_for_timeout(300)
    assert line.get_attribute("points") == still
    opened.page.locator("#play").click()
    opened.page.wait_for_timeout(400)
    assert opened.page.locator("#beam polyline").last.get_attribute("points") != still
    assert opened.page.locator("#play").get_attribute("aria-pressed") == "true"


PLOT = "(name) => charts.find((each) => each.host.id === name).plot"

SCALES = f"() => {{ const {{ x, y }} = ({PLOT})('response').scales; return [x.min, x.max, y.min, y.max]; }}"


def test_a_zoom_scales_the_upward_axis_anew_and_leaves_no_mark_beside_it(opened):
    place = opened.page.locator("#response .u-over")
    place.scroll_into_view_if_needed()
    box, whole = place.bounding_box(), opened.page.evaluate(SCALES)
    beside = {"x": box["x"] + box["width"] + 2, "y": box["y"], "width": 16, "height": box["height"] - 10}
    before = opened.page.screenshot(clip=beside)
    opened.page.mouse.move(box["x"] + 0.1 * box["width"], box["y"] + 60)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 0.33 * box["width"], box["y"] + 60, steps=3)
    opened.page.mouse.up()
    low, high, _, top = opened.page.evaluate(SCALES)
    assert whole[0] < low < high < whole[1]
    assert top < 0.9 * whole[3]
    assert opened.page.screenshot(clip=beside) == before


def test_another_quantity_empties_the_readout(opened):
    place = opened.page.locator("#response .u-over")
    place.scroll_into_view_if_needed()
    place.hover()
    assert "mm" in opened.page.locator("#reading").inner_text()
    opened.page.locator("#quantity").select_option("impact_velocity")
    assert "mm," not in opened.page.locator("#reading").inner_text()
    assert opened.page.locator("#kinds").inner_text().count("grazing") == 0


def test_no_tick_of_the_shares_is_zero_and_the_finest_is_named(opened):
    ticks = f"() => {{ const {{ y }} = ({PLOT})('shares').scales; return logTicks(y.min, y.max).map(percent); }}"
    found = opened.page.evaluate(ticks)
    assert len(found) >= 2
    assert "0 %" not in found
    for low, high in ((0.039, 1.6), (0.006, 0.12), (0.9, 1.1), (1e-6, 1.3)):
        assert len(opened.page.evaluate(f"logTicks({low}, {high})")) >= 3
    assert "four </b> modes" in opened.page.locator("#cost p").inner_text()


def test_spectra_have_a_strip_each_and_the_beam_its_stop_and_base(opened):
    assert opened.page.locator("#spectrum canvas").count() == 2
    assert opened.page.locator("#beam path.stop").count() == 2
    assert "base ± 20 µm" in opened.page.locator("#beam").inner_html()


def test_a_telephone_needs_no_scrolling_aside(browser, file):
    found = Opened(browser, file, viewport={"width": 390, "height": 800})
    width = found.page.evaluate("document.documentElement.scrollWidth")
    found.page.close()
    assert width <= 390


def test_without_scripts_the_static_picture_is_there(browser, file):
    found = Opened(browser, file, java_script_enabled=False)
    assert found.page.locator(".still img").first.is_visible()
    assert not found.page.locator("#response").is_visible()
    found.page.close()


def test_printed_it_has_the_static_picture(opened):
    opened.page.emulate_media(media="print")
    assert opened.page.locator(".still img").first.is_visible()
    assert not any(opened.page.locator(each).is_visible() for each in ("#response", "#motion", "#participation"))


def test_nothing_serious_is_found_by_axe(opened):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    found = axe.Axe().run(opened.page).response["violations"]
    serious = [each for each in found if each["impact"] in ("serious", "critical")]
    assert [(each["id"], [node["html"][:120] for node in each["nodes"]]) for each in serious] == []
