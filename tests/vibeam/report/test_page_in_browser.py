"""The page in Chromium and Firefox: toggles, reading, no error, no request, accessible.

pip install 'vibeam[browser]' and Debian's chromium and firefox-esr; python -m pytest -m slow tests/vibeam/report
"""

import csv
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from browsers import Opened
from matplotlib.figure import Figure

import vibeam
from tests.vibeam.report.test_page import CASE, HOSTILE, SHEETS
from vibeam.report.output import SheetPicture, StudySheet
from vibeam.report.page.page import page, study_page
from vibeam.report.tables import blank
from vibeam.studies.stored import stored

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    (folder / "case.toml").write_text(CASE.replace("TITLE", HOSTILE), encoding="utf-8")
    vibeam.run(vibeam.load(folder / "case.toml"), out=folder / "case.h5", compare=True)
    (folder / "case.html").write_text(page(stored(folder / "case.h5")), encoding="utf-8")
    return folder / "case.html"


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


def labels(opened, name="SVG of frequency response"):
    """Tick labels of a chart, across and up, read off its SVG."""
    texts = ElementTree.fromstring(opened.saved(name)).findall(".//{*}text")
    across, up = ([each.text for each in texts if each.get("text-anchor") == way] for way in ("middle", "end"))
    return [float(each) for each in across if re.fullmatch(r"[\d.]+", each)], [float(each) for each in up]


def test_a_zoom_scales_the_upward_axis_anew_and_leaves_no_mark_beside_it(opened):
    place = opened.page.locator("#response .u-over")
    place.scroll_into_view_if_needed()
    box, (across, up) = place.bounding_box(), labels(opened)
    beside = {"x": box["x"] + box["width"] + 2, "y": box["y"], "width": 16, "height": box["height"] - 10}
    before = opened.page.screenshot(clip=beside)
    opened.page.mouse.move(box["x"] + 0.1 * box["width"], box["y"] + 60)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + 0.33 * box["width"], box["y"] + 60, steps=3)
    opened.page.mouse.up()
    assert opened.page.screenshot(clip=beside) == before
    low, high = map(float, re.search(r"x=([\d.]+),([\d.]+)", opened.page.url).groups())
    assert 30 < low < high < 60
    enlarged, lower = labels(opened)
    assert low <= min(enlarged) < max(enlarged) <= high < max(across)
    assert max(lower) < 0.9 * max(up)


def test_a_link_reproduces_curves_quantity_zoom_and_theme(browser, file, opened):
    page = opened.page
    page.locator("#shown input").first.uncheck()
    page.locator("#quantity").select_option("maximum")
    page.locator("#theme").select_option("dark")
    page.get_by_role("link", name="Participation").click()
    page.wait_for_url(re.compile("#participation&.*theme"))
    again = Opened(browser, file, fragment="#" + page.url.partition("#")[2] + "&x=35,50")
    found = again.page
    assert not found.locator("#shown input").first.is_checked()
    assert found.locator("#quantity").input_value() == "maximum"
    assert found.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(20, 25, 31)"
    assert found.evaluate("scrollY") > 500
    across, _ = labels(again)
    assert 35 <= min(across) < max(across) <= 50
    assert "x=35,50" in found.url
    assert again.said == []
    found.close()


@pytest.mark.parametrize("link", ["#f=x&hide=99&x=9,1&q=none&theme=pink&modal=-1&way=left", "#%E0%A4%A", "#<script>"])
def test_a_broken_link_opens_the_page_as_it_is(browser, file, link):
    found = Opened(browser, file, fragment=link)
    assert found.page.locator("#response canvas").is_visible()
    assert found.said == []
    found.page.close()


def test_every_view_is_saved_as_numbers_and_pictures_on_white_paper(browser, file):
    """Whatever the theme; the page is afterwards as it was."""
    found = Opened(browser, file, color_scheme="dark")
    before = found.page.locator("#response canvas").screenshot()
    for view in ("frequency response", "participation", "Mode shapes"):
        drawing = ElementTree.fromstring(found.saved(f"SVG of {view}"))
        assert len(drawing.findall(".//{*}path")) + len(drawing.findall(".//{*}polyline")) > 2
        assert "NaN" not in ElementTree.tostring(drawing, encoding="unicode")
    assert found.page.locator("#response canvas").screenshot() == before
    assert found.saved("PNG of frequency response").startswith(b"\x89PNG")
    rows = list(csv.reader(found.saved("CSV of frequency response").decode("utf-8-sig").splitlines()))
    assert rows[0][:3] == ["fidelity", "sweep", "frequency (Hz)"]
    assert [float(row[2]) for row in rows[1:8]] == list(range(30, 61, 5))
    assert found.saved("CSV of Fidelities").decode("utf-8-sig").startswith("fidelity,modes,")
    assert found.said == []
    assert found.foreign == []
    found.page.close()


def test_nothing_of_the_page_is_global(opened):
    known = opened.page.evaluate("[typeof uPlot, typeof modules, typeof fidelity, typeof charts]")
    assert known == ["undefined"] * 4


def test_another_quantity_empties_the_readout(opened):
    place = opened.page.locator("#response .u-over")
    place.scroll_into_view_if_needed()
    place.hover()
    assert "mm" in opened.page.locator("#reading").inner_text()
    opened.page.locator("#quantity").select_option("impact_velocity")
    assert "mm," not in opened.page.locator("#reading").inner_text()
    assert opened.page.locator("#kinds").inner_text().count("grazing") == 0


def test_no_tick_of_the_shares_is_zero(opened):
    texts = ElementTree.fromstring(opened.saved("SVG of participation")).findall(".//{*}text[@text-anchor='end']")
    assert [each.text for each in texts][:2] == ["100 %", "10 %"]
    assert "0 %" not in [each.text for each in texts]


def test_a_telephone_needs_no_scrolling_aside(browser, file):
    found = Opened(browser, file, viewport={"width": 390, "height": 800})
    width = found.page.evaluate("document.documentElement.scrollWidth")
    found.page.close()
    assert width <= 390


def wide_study():
    """Sheet whose table is wider than any page: numbers of many columns, one without a name, and a long sentence."""
    table = blank("Wide", "", *(f"number {column}|" for column in range(12)), "")
    table.add_row("a row", *["-0.123 %"] * 12, "needed")
    told = blank("Answers", "question", "answer")
    told.add_row("Which?", "With R held the scene needs all of its effects: without one of them it is too low. " * 3)
    return StudySheet("Answer.", [table, told], draw=lambda: Figure(figsize=(9, 3)))


@pytest.mark.parametrize("width", [390, 768, 1280])
def test_wide_tables_of_a_study_scroll_by_themselves(browser, file, width):
    """The page fits its window; sentences in a table are broken into lines, and seen."""
    studies = file.with_name("wide.html")
    studies.write_text(study_page("Wide", "One beam.", [("One", wide_study())]), encoding="utf-8")
    found = Opened(browser, studies, viewport={"width": width, "height": 800})
    assert found.page.evaluate("document.documentElement.scrollWidth") <= width
    said = found.page.locator("table", has_text="Which?")
    assert width < 768 or said.evaluate("each => each.offsetWidth <= each.parentElement.clientWidth")
    found.page.close()


def test_a_wide_table_fits_a_printed_page(browser, file):
    studies = file.with_name("printed.html")
    studies.write_text(study_page("Wide", "One beam.", [("One", wide_study())]), encoding="utf-8")
    found = Opened(browser, studies, viewport={"width": 718, "height": 1000})
    found.page.emulate_media(media="print")
    assert found.page.evaluate("document.documentElement.scrollWidth") <= 718
    found.page.close()


@pytest.fixture(scope="module")
def decisive(file):
    """Page of a verdict: two pictures, a note, two stages of which one has a wide table."""
    figures = [SheetPicture(name, "Words", lambda: Figure(figsize=(5, 4))) for name in ("Models", "Costs")]
    stages = [("How many modes?", wide_study()), ("Which <effects>?", StudySheet("None."))]
    text = study_page("Verdict", "Two modes suffice.", stages, figures, ["Not answered: solvers (too dear)."])
    file.with_name("verdict.html").write_text(text, encoding="utf-8")
    return file.with_name("verdict.html")


@pytest.mark.parametrize("width", [390, 1280])
@pytest.mark.parametrize("folded", [True, False])
def test_a_verdict_fits_its_window_folded_and_not(browser, decisive, width, folded):
    """Tables scroll in a box of their own; pictures are as wide as there is room."""
    found = Opened(browser, decisive, viewport={"width": width, "height": 800})
    found.page.evaluate(
        f"document.querySelectorAll('details').forEach((each) => {{ each.open = {str(not folded).lower()}; }})"
    )
    assert found.page.evaluate("document.documentElement.scrollWidth") <= width
    assert found.page.locator("table").first.is_visible() is not folded
    wide = [each.bounding_box()["width"] for each in found.page.locator("figure img").all()[:2]]
    assert all(min(width, 736) - 40 <= each <= width for each in wide)
    found.page.close()


def test_a_printed_verdict_has_what_decides_and_the_parts_that_a_reader_has_opened(browser, decisive):
    found = Opened(browser, decisive)
    found.page.emulate_media(media="print")
    seen = ("h1", ".headline >> nth=0", "#picture-1 img", "#picture-2 img", "#notes li")
    assert [each for each in seen if not found.page.locator(each).is_visible()] == []
    assert not found.page.locator("#numbers").is_visible()
    found.page.locator("details").first.evaluate("each => { each.open = true; }")
    assert found.page.locator("#numbers h2").is_visible()
    assert [each.is_visible() for each in found.page.locator("details").all()] == [True, False]
    found.page.close()


def test_of_many_fidelities_the_reference_and_the_pointed_one_have_their_colours(browser, file, tmp_path):
    """The others are grey until so few are left that each can be told."""
    more = (f'[fidelity.modes_{number}]\nreduction = "modal"\nmodes = {number}\n' for number in (2, 3, 5))
    case = (file.with_name("case.toml")).read_text(encoding="utf-8") + "".join(more)
    (tmp_path / "case.toml").write_text(case, encoding="utf-8")
    vibeam.run(vibeam.load(tmp_path / "case.toml"), out=tmp_path / "case.h5")
    (tmp_path / "case.html").write_text(page(stored(tmp_path / "case.h5")), encoding="utf-8")
    found = Opened(browser, tmp_path / "case.html")
    looks = [each["colour"] for each in json.loads(found.page.locator("#data").text_content())["fidelities"]]

    def drawn():
        """Whether each fidelity's colour is in solid lines of the curves: lines of grazing are dotted."""
        with found.page.expect_download() as started:  # without the pointer, which stays where it is
            found.page.get_by_label("SVG of frequency response").evaluate("each => each.click()")
        text = Path(started.value.path()).read_text(encoding="utf-8")
        curves = text.partition("<clipPath")[2].partition("</g>")[0]
        lines = [each for each in re.findall("<path[^>]*>", curves) if 'stroke-dasharray=""' in each]
        return [any(look in each for each in lines) for look in looks]

    before = drawn()
    assert before[-1]
    assert not any(before[:-1])
    assert found.page.locator("#many").is_visible()
    found.page.locator("#response .u-legend tr").nth(1).hover()
    assert drawn()[0]
    for box in found.page.locator("#shown input").all()[:1]:
        box.uncheck()
    assert drawn() == [False, True, True, True, True]
    assert not found.page.locator("#many").is_visible()
    found.page.close()


def test_without_scripts_the_static_picture_is_there(browser, file):
    found = Opened(browser, file, java_script_enabled=False)
    assert found.page.locator(".still img").first.is_visible()
    assert not found.page.locator("#response").is_visible()
    found.page.close()


def test_printed_it_has_the_static_picture(opened):
    opened.page.emulate_media(media="print")
    assert opened.page.locator(".still img").first.is_visible()
    assert not any(opened.page.locator(each).is_visible() for each in ("#response", "#participation"))


FOCUSED = """() => {
  const all = [...document.querySelectorAll("*")], own = document.activeElement;
  return [all.indexOf(own), own.localName, getComputedStyle(own).outlineStyle, own.id];
}"""


def test_tab_goes_through_all_that_acts_in_the_order_of_the_page_and_shows_where(opened):
    acting = "a, button, select, input, summary, [tabindex='0']"
    visible = [each for each in opened.page.locator(acting).all() if each.is_visible()]
    passed = []
    for _ in visible:
        opened.page.keyboard.press("Tab")
        passed.append(opened.page.evaluate(FOCUSED))
    assert [place for place, *_ in passed] == sorted({place for place, *_ in passed})
    assert {outline for _, _, outline, _ in passed} == {"solid"}
    assert {"theme", "quantity", "modal"} <= {name for *_, name in passed}


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nothing_is_found_by_axe(browser, file, decisive, theme):
    """Of a result, of studies and of a verdict; nothing minor either."""
    pytest.importorskip("axe_playwright_python")
    studies = file.with_name("studies.html")
    studies.write_text(study_page("Two <modes>", "One beam.", list(SHEETS)), encoding="utf-8")
    for each in (file, studies, decisive):
        found = Opened(browser, each, color_scheme=theme)
        for folded in found.page.locator("details").all():
            folded.evaluate("each => { each.open = true; }")
        assert found.violations() == []
        assert found.said == []
        found.page.close()


def test_firefox_shows_the_same_page(firefox, file):
    firefox.open(file.as_uri())
    assert firefox.run("return document.querySelector('h1').textContent;") == HOSTILE
    assert firefox.run("return document.querySelectorAll('#response canvas').length;") == 1
    assert firefox.heard() == []


def test_firefox_hears_faults(firefox, tmp_path):
    page = tmp_path / "faulty.html"
    page.write_text("<!DOCTYPE html><title>t</title><script>setTimeout(() => { throw new Error('bang'); });</script>")
    firefox.open(page.as_uri())
    assert firefox.run("await new Promise((done) => setTimeout(done, 100)); return 0.1 + 0.2;") == 0.1 + 0.2
    assert firefox.heard() == ["Error: bang"]
    with pytest.raises(RuntimeError, match="no such thing"):
        firefox.run("throw new Error('no such thing');")
