"""The page of a record case in Chromium and Firefox: window of time by pointer, touch, keyboard, link; what is saved.

pip install 'vibeam[browser]' and Debian's chromium and firefox-esr; python -m pytest -m slow tests/vibeam/report
"""

import csv
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from browsers import Opened

import vibeam
from tests.vibeam.report.test_record_page import CASE, HOSTILE
from vibeam.report.page.page import page
from vibeam.studies.stored import stored

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    (folder / "case.toml").write_text(CASE.replace("TITLE", HOSTILE), encoding="utf-8")
    vibeam.run(vibeam.load(folder / "case.toml"), out=folder / "case.h5")
    return stored(folder / "case.h5")


@pytest.fixture(scope="module")
def file(results):
    made = results.result.path.with_suffix(".html")
    made.write_text(page(results), encoding="utf-8")
    return made


@pytest.fixture
def opened(browser, file):
    found = Opened(browser, file)
    found.page.locator("#timeline canvas").first.wait_for()
    yield found
    assert found.said == []
    assert found.foreign == []
    found.page.close()


def window(opened):
    """Begin and end of the window, s, as the page says them."""
    told = opened.page.locator("#in-window").inner_text()
    return tuple(map(float, re.match(r"([\d.e-]+) to ([\d.e-]+) s", told).groups()))


def test_keys_buttons_and_a_link_move_the_window_and_keep_it_within_the_record(browser, file, opened):
    assert window(opened) == (0, 0.3)
    rows = opened.page.locator("#timeline")
    rows.focus()
    for key, span in (("+", (0.075, 0.225)), ("ArrowRight", (0.1125, 0.2625)), ("-", (0, 0.3)), ("+", (0.075, 0.225)),
                      *[("ArrowRight", None)] * 2, ("ArrowRight", (0.15, 0.3)), ("Home", (0, 0.3))):  # fmt: skip
        rows.press(key)
        assert span is None or window(opened) == pytest.approx(span)
    opened.page.get_by_role("button", name="look at first impact").click()
    begin, end = window(opened)
    assert 0 <= begin < end < 0.3
    again = Opened(browser, file, fragment="#" + opened.page.url.partition("#")[2])
    again.page.locator("#timeline canvas").first.wait_for()
    assert window(again) == pytest.approx((begin, end), abs=1e-9)
    again.page.close()


def test_a_part_that_is_dragged_over_is_enlarged_in_all_rows_and_a_double_click_shows_all(opened):
    over = opened.page.locator("#timeline .u-over").nth(1)
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    opened.page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 40)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 50, steps=4)
    opened.page.mouse.up()
    assert window(opened) == pytest.approx((0.06, 0.15), abs=1e-3)
    read = opened.page.locator("#reading").inner_text()
    assert re.match(r"0\.1\d+ s: base acceleration -?[\d.]+( … -?[\d.]+)? m/s²; sensor sdof ", read)
    over.dblclick()
    assert window(opened) == (0, 0.3)


def test_fingers_move_and_scale_the_window(opened):
    over = opened.page.locator("#timeline .u-over").first
    over.scroll_into_view_if_needed()
    opened.page.locator("#timeline").focus()
    opened.page.locator("#timeline").press("+")
    moved = """(host, moves) => {
        const { left, width } = host.getBoundingClientRect();
        for (const [type, pointerId, share] of moves) {
            const keys = { pointerId, pointerType: "touch", clientX: left + share * width, bubbles: true };
            host.dispatchEvent(new PointerEvent(type, keys));
        }
    }"""
    over.evaluate(moved, [["pointerdown", 1, 0.5], ["pointermove", 1, 0.3], ["pointerup", 1, 0.3]])
    assert window(opened) == pytest.approx((0.105, 0.255), abs=1e-4)
    pinch = [
        ["pointerdown", 1, 0.25],
        ["pointerdown", 2, 0.5],
        ["pointermove", 2, 0.75],
        ["pointerup", 1, 0],
        ["pointerup", 2, 0],
    ]
    over.evaluate(moved, pinch)
    begin, end = window(opened)
    assert end - begin == pytest.approx(0.075, rel=1e-3)
    assert begin + 0.25 * (end - begin) == pytest.approx(0.105 + 0.25 * 0.15, abs=1e-4)  # the finger that rests


def test_what_is_saved_are_the_numbers_of_the_window(results, opened):
    opened.page.locator("#timeline").focus()
    opened.page.locator("#timeline").press("+")
    rows = list(csv.DictReader(opened.saved("CSV of histories").decode("utf-8-sig").splitlines()))
    sensor = [each for each in rows if each["signal"] == "sensor" and each["fidelity"] == "sdof"]
    own = results.result["sdof"].history["sensor"].within(0.075, 0.225, most=10**6)
    assert max(float(each["greatest"]) for each in sensor) == pytest.approx(1e3 * own.greatest.max(), rel=1e-4)
    assert min(float(each["least"]) for each in sensor) == pytest.approx(1e3 * own.least.min(), rel=1e-4)
    hits = list(csv.DictReader(opened.saved("CSV of impacts in the window").decode("utf-8-sig").splitlines()))
    times = results.result["sdof"].impact_times[1][0]
    mine = [float(each["time (s)"]) for each in hits if each["fidelity"] == "sdof"]
    np.testing.assert_allclose(mine, times[(times >= 0.075) & (times <= 0.225)], atol=1e-9)
    drawing = opened.saved("SVG of histories").decode()
    looks = [each["colour"] for each in json.loads(opened.page.locator("#data").text_content())["fidelities"]]
    widths = [
        {float(each) for each in re.findall(f'stroke="{look}" stroke-width="([^"]+)"', drawing)} for look in looks
    ]
    assert min(widths[0]) > max(widths[1])  # what lies in front covers no outline behind it …
    assert not re.search(r'fill="#[0-9A-Fa-f]{6}(?!26)[0-9A-Fa-f]{2}"', drawing)  # … and no area does
    assert "velocity before impact (mm/s)" in "".join(ElementTree.fromstring(drawing).itertext())
    assert opened.saved("PNG of histories").startswith(b"\x89PNG")
    for name in ("velocities", "factor", "spectra"):
        assert b"fidelity" in opened.saved(f"CSV of {name}")
        assert opened.saved(f"SVG of {name}").startswith(b"<svg")


def test_rows_and_fidelities_are_taken_away_and_come_back(opened):
    rows = opened.page.locator("#timeline .chart")
    assert rows.count() == 3
    opened.page.get_by_role("checkbox", name="velocity of sensor").check()
    assert rows.count() == 4
    before = rows.nth(1).screenshot()
    opened.page.locator("#shown input").first.uncheck()
    assert rows.nth(1).screenshot() != before
    assert "sdof" not in opened.page.locator("#in-window").inner_text()


@pytest.mark.parametrize("link", ["#x=9,1&hide=99&rows=none&theme=pink&velocities=none", "#%E0%A4%A", "#x=0.29,9"])
def test_a_broken_link_opens_the_page_as_it_is(browser, file, link):
    found = Opened(browser, file, fragment=link)
    found.page.locator("#timeline canvas").first.wait_for()
    begin, end = window(found)
    assert 0 <= begin < end <= 0.3
    assert found.said == []
    found.page.close()


def test_a_telephone_needs_no_scrolling_aside_and_print_has_the_static_picture(browser, file):
    found = Opened(browser, file, viewport={"width": 360, "height": 740})
    found.page.locator("#timeline canvas").first.wait_for()
    assert found.page.evaluate("document.documentElement.scrollWidth") <= 360
    found.page.emulate_media(media="print")
    assert found.page.locator("#history .still").is_visible()
    assert not found.page.locator("#timeline").is_visible()
    found.page.close()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nothing_is_found_by_axe(browser, file, theme):
    pytest.importorskip("axe_playwright_python")
    found = Opened(browser, file, color_scheme=theme)
    found.page.locator("#timeline canvas").first.wait_for()
    for folded in found.page.locator("details").all():
        folded.evaluate("each => { each.open = true; }")
    assert found.violations() == []
    assert found.said == []
    found.page.close()


def test_firefox_shows_the_same_page(firefox, file):
    firefox.open(file.as_uri())
    assert firefox.run("return document.querySelector('h1').textContent;") == HOSTILE
    firefox.run("await new Promise((done) => setTimeout(done, 500));")
    assert firefox.run("return document.querySelectorAll('#timeline canvas').length;") == 3
    assert firefox.heard() == []
