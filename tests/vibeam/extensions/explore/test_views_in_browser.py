"""The section Explore in Chromium: sliders, what moves with them, numbers, files, links; by keyboard, on a telephone.

python -m pytest -m slow tests/vibeam/extensions/explore
"""

import csv
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from browsers import Opened

import vibeam
from tests.vibeam.report.test_page import CASE, HOSTILE
from vibeam.periodic.motion_kind import kinds_of
from vibeam.report.page.page import page
from vibeam.runs.comparison.errors import asked_of
from vibeam.runs.comparison.responses import Response, compared
from vibeam.studies.stored import stored

pytestmark = pytest.mark.slow

SETTLED = """() => document.getElementById("state").textContent.startsWith("Settled")
  && !document.getElementById("state").textContent.includes("follow")
  && !document.getElementById("readings").textContent.includes("…")"""
WATCHED = """() => {
  const rows = () => [...document.querySelectorAll("#readings tr")];
  const row = () => rows().find((each) => each.textContent.startsWith("suffices"));
  window.seen = [];
  new MutationObserver(() => {
    const now = row() && [...row().querySelectorAll("td")].map((each) => each.textContent);
    if (now && JSON.stringify(now) !== JSON.stringify(window.seen.at(-1))) window.seen.push(now);
  }).observe(document.getElementById("readings"), { childList: true });
}"""
VIEWS = ("response at the sliders' place", "beam", "displacement over time", "phase portrait", "spectrum")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("explore")
    (made / "case.toml").write_text(CASE.replace("TITLE", HOSTILE), encoding="utf-8")
    vibeam.run(vibeam.load(made / "case.toml"), out=made / "case.h5")
    found = stored(made / "case.h5")
    (made / "results.html").write_text(page(found, engine=True), encoding="utf-8")
    (made / "still.html").write_text(page(found), encoding="utf-8")
    vibeam.explore(made / "case.toml").write(made / "case.html")
    return made


class Explored(Opened):
    """A page whose engine has settled at the place of the link."""

    def __init__(self, browser, file, fragment="#explore", **options):
        super().__init__(browser, file, fragment, **options)
        self.settle()

    def settle(self):
        self.page.wait_for_function(SETTLED, timeout=20000)

    def set(self, name, value):
        """Type a value into a slider's field, and wait until the motions there are settled."""
        self.page.locator(f"#slide-{name}-number").fill(str(value))
        self.page.wait_for_function('() => document.getElementById("state").textContent.startsWith("Settling")')
        self.settle()

    def reading(self, row):
        """Cells of a row of the numbers."""
        found = self.page.locator("#readings tr", has=self.page.locator(f'th:text-is("{row}")'))
        return found.locator("td").all_inner_texts()


@pytest.fixture
def explored(browser, folder):
    found = Explored(browser, folder / "case.html", "#explore&f=40")
    yield found
    assert found.said == []
    assert found.foreign == []
    found.page.close()


def runs(folder, keys, frequency):
    """Responses of both fidelities at one point from equilibrium."""
    case = vibeam.load(folder / "case.toml", {**keys, "sweep.frequency": [f"{frequency} Hz"]})
    return [response.up for response in vibeam.run(case).values()]


def amplitudes(folder, keys, frequency):
    """Amplitudes (mm) of both fidelities, with four digits, as the page has."""
    return [float(f"{1e3 * each.amplitude[0]:.4g}") for each in runs(folder, keys, frequency)]


def words(response):
    """Period and contact of a point, in the page's words."""
    period, rest = int(response.period[0]), float(response.rest[0])
    if period == -1:
        return "1, no contact"
    resting = f"; chatters, rests on the stop {100 * rest:.3g} % of the time" if rest > 0 else ""
    return f"{period or 'does not repeat'}{resting}"


def test_numbers_are_those_of_a_run_at_the_sliders_place(folder, explored):
    """With four digits, here and after three sliders have moved; the sentence says the verdict and both motions."""
    assert [float(each) for each in explored.reading("amplitude (mm)")] == amplitudes(folder, {}, 40.0)
    explored.set("gap", 0.05)
    explored.set("restitution", 0.5)
    explored.set("drive", 24)
    keys = {"stop.gap": "0.05 mm", "stop.restitution": 0.5, "drive.amplitude": "24 um"}
    sdof, beam = found = amplitudes(folder, keys, 40.0)
    assert [float(each) for each in explored.reading("amplitude (mm)")] == found
    said = explored.page.locator("#differences").inner_text()
    ours, theirs = (kinds_of(each)[0] for each in runs(folder, keys, 40.0))
    same = "as" if ours == theirs else "another motion than"
    assert said.endswith(f"sdof {sdof:g} mm ({ours}, {same} four </b> modes); four </b> modes {beam:g} mm ({theirs}).")


def test_the_verdict_is_that_of_a_run_at_the_sliders_place(folder, explored):
    """Where the curves are whole; both errors in the numbers, and in words what the sentence of a run says too."""
    for gap in (0.1, 0.02):
        if gap != 0.1:
            explored.set("gap", gap)
        case = vibeam.load(folder / "case.toml", {"stop.gap": f"{gap} mm"})
        result, asked = vibeam.run(case, compare=True), asked_of(case)
        python = compared(*(Response.of(result[name]) for name in ("sdof", "beam")), asked.frequency)
        state = {True: "suffices", None: "may suffice", False: "does not suffice"}[python.suffices(asked)]
        said = explored.page.locator("#verdict").inner_text()
        assert said.startswith(f"Beside four </b> modes, for 5 %: sdof {state}: ")
        verdict = {True: "yes", None: "open", False: "no"}[python.suffices(asked)]
        assert explored.reading("suffices for 5 %") == [verdict, "reference"]
        if python.amplitude is not None:
            size = explored.reading("amplitude error")[0].split()[0]
            np.testing.assert_allclose(float(size), 100 * python.amplitude_error, atol=0.051)


@pytest.mark.parametrize(
    ("changes", "reference"),
    [
        ({}, "beam"),
        ({"stop.gap": "9 mm"}, "beam"),  # nothing strikes: its highest point
        ({"stop.gap": "-0.05 mm"}, "beam"),
        ({"sweep.direction": "down"}, "beam"),
        ({"fidelity.beam.solver": "orbit"}, "sdof"),  # the page does not fly the reference
        ({"sweep.frequency": ["37 Hz"]}, "beam"),
    ],
    ids=["strikes", "far", "pressed on", "downwards", "not flown", "one frequency"],
)
def test_a_page_without_results_opens_where_the_reference_strikes(browser, folder, tmp_path, changes, reference):
    """At its highest motion with impacts, of those from equilibrium at the case's frequencies; a link is not needed."""
    quick = {"sweep.settle": 60, "sweep.hold": 10, "sweep.direction": "up"}
    case = vibeam.load(folder / "case.toml", changes)
    points = []
    for frequency in case.sweep.frequency:
        own = {**changes, **quick, "sweep.frequency": [f"{float(frequency)!r} Hz"], "fidelity.beam.solver": "flight"}
        points.append(vibeam.run(vibeam.load(folder / "case.toml", own))[reference].up)
    struck = [each for each in points if each.impacts_per_period[0] > 0] or points
    vibeam.explore(case).write(tmp_path / "case.html")
    found = Explored(browser, tmp_path / "case.html")
    place = float(found.page.locator("#slide-frequency-number").input_value())
    assert place == pytest.approx(max(struck, key=lambda each: each.amplitude[0]).frequency[0], rel=1e-5)
    assert found.page.locator("#start").input_value() == "equilibrium"
    assert "f=" not in found.page.url
    assert found.said == []
    found.page.close()


MANY = "".join(
    f'[fidelity.modes_{number}]\nreduction = "modal"\nmodes = {number}\n' for number in (2, 3, 5, 6)
)  # six in all, the last one the reference


def test_many_fidelities_are_told_apart_and_no_column_is_cut(browser, folder, tmp_path):
    """The reference alone has its colour in the curves; its numbers stand within the page, on the right."""
    (tmp_path / "case.toml").write_text((folder / "case.toml").read_text(encoding="utf-8") + MANY, encoding="utf-8")
    vibeam.explore(tmp_path / "case.toml").write(tmp_path / "case.html")
    found = Explored(browser, tmp_path / "case.html", viewport={"width": 1280, "height": 900})
    head = found.page.locator("#readings thead th").last
    assert head.inner_text() == "modes_6"
    box, host = head.bounding_box(), found.page.locator(".scroll:has(#readings)").bounding_box()
    assert box["x"] + box["width"] <= host["x"] + host["width"] + 1
    svg = found.saved(f"SVG of {VIEWS[0]}").decode()
    looks = [each["look"]["colour"] for each in json.loads(found.page.locator("#engine").text_content())["models"]]
    drawn = [svg.count(f'fill="{each}"') for each in looks]
    assert drawn[-1] > 0
    assert drawn[:-1] == [0] * 5
    assert found.page.locator("#many-flown").is_visible()
    for box in found.page.locator("#flown input").all()[:2]:
        box.uncheck()
    found.settle()
    svg = found.saved(f"SVG of {VIEWS[0]}").decode()
    assert [svg.count(f'fill="{each}"') > 0 for each in looks] == [False] * 2 + [True] * 4
    assert not found.page.locator("#many-flown").is_visible()
    found.page.close()


def test_another_motion_is_told_from_one_of_the_same_kind(folder, explored):
    """Where one fidelity strikes the stop and the other does not; where both do they are of one kind."""
    assert [each.period[0] == -1 for each in runs(folder, {}, 44)] == [False, True]
    explored.set("frequency", 44)
    said = explored.page.locator("#differences").inner_text()
    assert "(period 1 with 1 impact, another motion than four </b> modes)" in said
    assert said.endswith("(no contact).")
    explored.set("frequency", 40)
    assert "another motion" not in explored.page.locator("#differences").inner_text()


def test_nothing_suffices_before_the_curves_are_whole(explored):
    """While the curves are computed anew the verdict is open."""
    explored.page.evaluate(WATCHED)
    explored.set("gap", 0.03)
    *before, (last, reference) = explored.page.evaluate("window.seen")
    assert [first for first, _ in before] == ["…"] * len(before) != []
    assert last in {"yes", "no", "open"}
    assert reference == "reference"


def test_motions_are_called_what_they_are(folder, explored):
    """Without contact, of period 3, without a period, and resting on the stop: by the words of a run."""
    heard = set()
    for gap, restitution, frequency in ((0.1, 0.7, 30), (0.05, 0.9, 30), (-0.05, 0.5, 40)):
        for name, value in (("gap", gap), ("restitution", restitution), ("frequency", frequency)):
            if explored.page.locator(f"#slide-{name}-number").input_value() != str(value):
                explored.set(name, value)
        found = runs(folder, {"stop.gap": f"{gap} mm", "stop.restitution": restitution}, frequency)
        said = explored.reading("repeats after (periods)")
        assert said == [words(each) for each in found]
        assert explored.reading("impacts a period") == [f"{each.impacts_per_period[0]:.4g}" for each in found]
        heard |= set(said)
    assert {"1, no contact", "3", "does not repeat"} <= heard
    assert any("rests on the stop" in each for each in heard)


def test_the_motion_is_in_motion_while_a_slider_moves_and_settles_at_rest(explored):
    slider = explored.page.locator("#slide-gap")
    before = explored.page.locator("#live-history canvas").screenshot()
    slider.focus()
    slider.press("ArrowLeft")
    explored.page.wait_for_function('() => document.getElementById("state").textContent.startsWith("Settling")')
    assert explored.page.locator("#differences").get_attribute("aria-live") == "polite"
    explored.settle()
    for _ in range(3):
        slider.press("PageUp")
    explored.settle()
    assert explored.page.locator("#live-history canvas").screenshot() != before
    assert slider.get_attribute("aria-valuetext") == f"{explored.page.locator('#slide-gap-number').input_value()} mm"


def test_a_link_reproduces_the_place(browser, folder, explored):
    explored.set("gap", 0.07)
    explored.set("damping", 2)
    explored.page.locator("#flown input").last.uncheck()
    explored.settle()
    numbers = explored.page.locator("#readings").inner_text()
    explored.page.wait_for_url(re.compile("damping=2"))
    again = Explored(browser, folder / "case.html", "#" + explored.page.url.partition("#")[2])
    assert again.page.locator("#readings").inner_text() == numbers
    assert again.page.locator("#slide-gap-number").input_value() == "0.07"
    assert not again.page.locator("#flown input").last.is_checked()
    again.page.close()


@pytest.mark.parametrize("link", ["#f=x&gap=99&R=&damping=-1&without=none&start=never", "#f=1e9"])
def test_a_broken_link_opens_the_place_of_the_case(browser, folder, link):
    found = Explored(browser, folder / "case.html", link)
    assert found.page.locator("#slide-gap-number").input_value() == "0.1"
    assert (
        "the link's is not from 30 to 60 Hz; that of the case is shown."
        in found.page.locator("#slider-fault").inner_text()
    )
    assert ", all else as in the case: sdof " in found.page.locator("#differences").inner_text()
    assert found.said == []
    found.page.close()


def test_a_number_out_of_range_is_refused_in_words_and_moves_nothing(explored):
    before, field = explored.page.locator("#readings").inner_text(), explored.page.locator("#slide-restitution-number")
    for text in ("1.2", ""):
        field.fill(text)
        assert explored.page.locator("#slider-fault").inner_text() == "R at the contact: a number from 0 to 1."
        assert field.get_attribute("aria-invalid") == "true"
    explored.page.wait_for_timeout(400)
    assert explored.page.locator("#readings").inner_text() == before
    explored.page.get_by_role("button", name="All as in the case").click()
    assert explored.page.locator("#slider-fault").inner_text() == ""
    assert (field.input_value(), field.get_attribute("aria-invalid")) == ("0.7", "false")


def test_without_any_fidelity_the_pictures_are_empty_and_come_back(explored):
    boxes = explored.page.locator("#flown input").all()
    for each in boxes:
        each.uncheck()
    explored.settle()
    assert explored.page.locator("#live-spectrum canvas").count() == 0
    assert explored.page.locator("#verdict").inner_text() == ""
    assert explored.page.locator("#differences").inner_text().endswith("all else as in the case.")
    boxes[1].check()
    explored.settle()
    assert explored.page.locator("#live-spectrum canvas").count() == 1
    assert explored.page.locator("#readings thead th").all_inner_texts() == ["four </b> modes"]


def test_all_goes_back_to_the_case(explored):
    before = explored.page.locator("#readings").inner_text()
    explored.set("gap", 0.03)
    assert explored.page.locator("#readings").inner_text() != before
    explored.page.get_by_role("button", name="All as in the case").click()
    explored.page.wait_for_function('() => document.getElementById("state").textContent.startsWith("Settling")')
    explored.set("frequency", 40)
    assert explored.page.locator("#readings").inner_text() == before
    explored.page.wait_for_function('() => !location.hash.includes("gap")')


def test_the_case_is_written_at_the_sliders(folder, explored, tmp_path):
    explored.set("gap", 0.06)
    explored.set("damping", 1.5)
    (tmp_path / "written.toml").write_bytes(explored.saved("Write the case at these sliders"))
    written, case = vibeam.load(tmp_path / "written.toml"), vibeam.load(folder / "case.toml")
    assert written.keys.value("stop.gap") == pytest.approx(6e-5, rel=1e-12)
    assert written.keys.value("beam.damping_ratio") == pytest.approx(0.03, rel=1e-12)
    assert written.keys.value("stop.restitution") == case.keys.value("stop.restitution")


def test_a_click_on_the_curves_picks_the_frequency(explored):
    place = explored.page.locator("#live-response .u-over")
    place.scroll_into_view_if_needed()
    box = place.bounding_box()
    explored.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 60)
    assert float(explored.page.locator("#slide-frequency-number").input_value()) == pytest.approx(45, abs=0.1)


def test_every_view_is_saved_whole(explored):
    for view in VIEWS:
        drawing = ElementTree.fromstring(explored.saved(f"SVG of {view}"))
        assert len(drawing.findall(".//{*}path")) + len(drawing.findall(".//{*}polyline")) > 2
        assert "NaN" not in ElementTree.tostring(drawing, encoding="unicode")
    history = explored.saved("SVG of displacement over time").decode()
    assert len(re.findall(r'd="M([\d.]+) [\d.]+L\1 [\d.]+"', history)) == 2  # one impact of each in the one period
    rows = list(csv.reader(explored.saved(f"CSV of {VIEWS[0]}").decode("utf-8-sig").splitlines()))
    assert [float(row[1]) for row in rows[1:8]] == list(range(30, 61, 5))
    assert {row[0] for row in rows[1:]} == {"sdof", "four </b> modes"}


def test_the_beam_plays_and_pauses(explored):
    line, button = explored.page.locator("#live-beam polyline"), explored.page.locator("#live-play")
    still = line.last.get_attribute("points")
    button.click()
    explored.page.wait_for_timeout(300)
    assert line.last.get_attribute("points") != still
    assert button.get_attribute("aria-pressed") == "true"
    button.click()
    still = line.last.get_attribute("points")
    explored.page.wait_for_timeout(200)
    assert line.last.get_attribute("points") == still


@pytest.mark.parametrize("direction", ["both", "down"])
def test_curves_at_rest_follow_the_branches_of_the_case_s_sweep(browser, tmp_path, direction):
    """Where one frequency has two motions: up in impacts, down without contact, as ``vibeam.run`` finds them."""
    text = CASE.partition("[fidelity.beam]")[0].replace('"up"', f'"{direction}"').replace("400", "200")
    text = text.replace("= 0.7", "= 0.9").replace("30 Hz", "40 Hz").replace("60 Hz", "70 Hz").replace("= 7", "= 31")
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    vibeam.explore(tmp_path / "case.toml").write(tmp_path / "case.html")
    found = Explored(browser, tmp_path / "case.html", "#start=sweep")
    said = "downwards" if direction == "down" else "upwards"
    assert found.page.locator("#start option").all_inner_texts() == ["from equilibrium", f"as a sweep {said}"]
    swept = vibeam.run(vibeam.load(tmp_path / "case.toml"))["sdof"]
    legs = [(way, one) for way, one in (("up", swept.up), ("down", swept.down)) if one is not None]
    assert [way for way, _ in legs] == (["up", "down"] if direction == "both" else ["down"])
    if direction == "both":
        assert np.sum(swept.up.amplitude > 1.05 * swept.down.amplitude[::-1]) > 10
    rows: list[list[str]] = []
    while len(rows) < sum(len(one.frequency) for _, one in legs):  # the way down comes after the numbers
        rows = list(csv.reader(found.saved(f"CSV of {VIEWS[0]}").decode("utf-8-sig").splitlines()))[1:]
    assert [row[-1] for row in rows] == [way for way, one in legs for _ in one.frequency]
    np.testing.assert_allclose(
        [[float(cell) for cell in row[1:3]] for row in rows],
        np.concatenate([np.column_stack([one.frequency, 1e3 * one.amplitude]) for _, one in legs]),
        rtol=1e-9,  # periodic motions: round-off of the two engines does not grow
    )
    found.page.close()


def test_a_page_of_results_starts_on_its_sweep(browser, folder):
    """The curves flown upwards are the stored ones; a click on these picks the frequency."""
    found, result = Explored(browser, folder / "results.html"), vibeam.read(folder / "case.h5")
    assert found.page.locator("#start").input_value() == "sweep"
    rows = list(csv.reader(found.saved(f"CSV of {VIEWS[0]}").decode("utf-8-sig").splitlines()))[1:]
    stored_ones = np.concatenate([1e3 * each.up.amplitude for each in result.values()])
    np.testing.assert_allclose([float(row[2]) for row in rows], stored_ones, rtol=1e-9)  # periodic: no digit is lost
    at = int(np.argmax(result["beam"].up.amplitude))  # of the reference
    assert found.reading("amplitude (mm)") == [f"{1e3 * each.up.amplitude[at]:.4g}" for each in result.values()]
    place = found.page.locator("#response .u-over")
    place.scroll_into_view_if_needed()
    box = place.bounding_box()
    found.page.mouse.click(box["x"] + 0.02 * box["width"], box["y"] + 60)
    assert found.page.locator("#slide-frequency-number").input_value() == "30"
    found.page.close()
    still = Opened(browser, folder / "still.html")
    assert still.page.locator("#explore").count() == 0
    still.page.close()


def test_a_browser_without_webassembly_is_told(browser, folder):
    found = Opened(browser, folder / "results.html", before="delete globalThis.WebAssembly;")
    assert "no WebAssembly" in found.page.locator("#explore").inner_text()
    assert found.page.locator("#response canvas").is_visible()
    assert found.said == []
    found.page.close()


def test_tab_goes_through_all_controls_and_shows_where(explored):
    acting = "a, button, select, input, summary, [tabindex='0']"
    visible = [each for each in explored.page.locator(acting).all() if each.is_visible()]
    passed = []
    for _ in visible:
        explored.page.keyboard.press("Tab")
        passed.append(
            explored.page.evaluate("[document.activeElement.id, getComputedStyle(document.activeElement).outlineStyle]")
        )
    assert {"slide-gap", "slide-gap-number", "live-play", "start", "as-case", "write-case"} <= {
        name for name, _ in passed
    }
    assert {outline for _, outline in passed} == {"solid"}


def test_a_telephone_needs_no_scrolling_aside(browser, folder):
    found = Explored(browser, folder / "case.html", viewport={"width": 360, "height": 740})
    assert found.page.evaluate("document.documentElement.scrollWidth") <= 360
    found.page.close()


def test_printed_it_stands_still_with_its_pictures(explored):
    explored.page.emulate_media(media="print")
    assert explored.page.locator("#live-history canvas").is_visible()
    assert not explored.page.locator("#live-play").is_visible()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_nothing_is_found_by_axe(browser, folder, theme):
    found = Explored(browser, folder / "results.html", color_scheme=theme)
    for folded in found.page.locator("details").all():
        folded.evaluate("each => { each.open = true; }")
    assert found.violations() == []
    assert found.said == []
    found.page.close()
