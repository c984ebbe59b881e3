"""Pictures for a reader who decides: marks stand where the errors are; what is not known is open, or named."""

from __future__ import annotations

import re
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pytest
from made_responses import made
from observed import NEUTRAL
from stand_in import SDOF

import vibeam
from tests.vibeam.runs.test_comparison import FIVE, hardening
from vibeam.case.study_plans import VerdictPlan
from vibeam.casefile.read import parse
from vibeam.periodic.motion_kind import FREE, SteadyKind
from vibeam.report import modes_needed as modes_sheet
from vibeam.report.decision_figures import Decision, ErrorSize, ModelError, responses_figure, shown_in, times_figure
from vibeam.report.run_answer import groups_of
from vibeam.report.run_report import recommended, run_decisions, run_report
from vibeam.report.verdict import pictures, sheet
from vibeam.runs.comparison.errors import AmplitudeError, KindDifference, ResponseComparison
from vibeam.runs.comparison.responses import Response, compared
from vibeam.runs.summary import compare
from vibeam.studies.modes_needed import modes_needed

GRID = np.linspace(100.0, 200.0, 101)
QUICK = {"beam.elements": 8, "sweep.frequency.points": 9, "sweep.direction": "up", "figure.format": ["svg"]}


def known(late: float = 0.0, size: float = 1.0, doubled: float = 0.0) -> Response:
    """Model whose jump down from 180 Hz is so late, whose amplitudes are so many times those of the reference."""
    return made(hardening(180.0 * (1 + late), size, doubled=doubled), GRID)


def drawn(models: dict[str, Response], reference: Response, **more: Any) -> Decision:
    every = {"reference": reference, **models}
    curves = {
        (name, "up"): tuple(np.array([[each.frequency, each.amplitude] for each in one.places["up"]]).T)
        for name, one in every.items()
    }
    shown = {name: compared(one, reference) for name, one in models.items()}
    return Decision(vibeam.load(NEUTRAL), FIVE, "reference", curves, shown, **more)


def swept(case: Any) -> Any:
    return vibeam.run(case, compare=True)


def lines(figure: Any) -> dict[str, Any]:
    """Lines and surfaces of all panels by their names."""
    return {each.get_gid(): each for axes in figure.axes for each in axes.get_children() if each.get_gid()}


def test_brackets_stand_at_the_frequencies_and_amplitudes_of_the_comparison() -> None:
    """Known: one model 4 % too high whose jump is right, one of the same amplitudes whose jump is 6 % late."""
    found = drawn({"near": known(0.0, 1.04), "far": known(0.06)}, known())
    marks = lines(responses_figure(found))
    curve = marks["response-reference-up"]
    scale = float(np.nanmax(curve.get_ydata())) / max(each.amplitude for each in known().places["up"])
    high = found.shown["near"].amplitude
    assert high is not None
    upright = marks["amplitude-error-near"]
    assert upright.get_xdata() == pytest.approx([high.frequency] * 2)
    assert np.array(upright.get_ydata()) / scale == pytest.approx([high.ours, high.reference])
    assert high.ours / high.reference == pytest.approx(1.04)
    level = marks["frequency-error-far"]
    assert level.get_xdata() == pytest.approx([180.0 * 1.06, 180.0], rel=2e-3)
    before, after = (np.interp(each, *found.curves["reference", "up"]) * scale for each in (179.0, 181.0))
    assert after <= level.get_ydata()[0] <= before  # on the jump
    said = [text.get_text() for text in responses_figure(found).axes[0].texts]
    assert {"4 %", "6 %"} <= set(said)


def test_what_is_not_surely_elsewhere_has_open_ends_and_its_range() -> None:
    found = drawn({"near": known(0.0004)}, known())
    [end] = found.shown["near"].ends[:1]
    unsure = replace(found.shown["near"], ends=(replace(end, error=0.002, open=0.02),))
    mark = lines(responses_figure(replace(found, shown={"near": unsure})))["frequency-error-near"]
    assert mark.get_markerfacecolor() == "white"
    at = end.reference.frequency
    assert sorted(mark.get_xdata()) == pytest.approx([0.98 * at, 1.02 * at])


def test_another_motion_is_shaded_over_its_range() -> None:
    found = drawn({"doubled": known(doubled=10.0)}, known())
    shaded = lines(responses_figure(found))["kind-error-doubled"]
    assert (shaded.get_x(), shaded.get_width()) == (pytest.approx(170, abs=0.2), pytest.approx(10, abs=0.3))
    [legend] = responses_figure(found).legends
    assert "shaded: other motion" in " ".join(legend.get_title().get_text().split())


@pytest.mark.parametrize(
    ("found", "amplitude", "frequency"),
    [
        (ResponseComparison(), ErrorSize(), ErrorSize(0.0)),
        (ResponseComparison(AmplitudeError(-0.03, 15, "up", 1, 1)), ErrorSize(0.03), ErrorSize(0.0)),
        (ResponseComparison(AmplitudeError(0.04, 15, "up", 1, 1, 0.01)), ErrorSize(0.06, True), ErrorSize(0.0)),
        (ResponseComparison(AmplitudeError(0.01, 15, "up", 1, 1, inf)), ErrorSize(inf, True), ErrorSize(0.0)),
        (ResponseComparison(unknown=(("up", 15.0, 16.0),)), ErrorSize(), ErrorSize(inf, True)),
        (
            ResponseComparison(kinds=(KindDifference(15, 15.01, 0.0, "up", SteadyKind(1, 1), SteadyKind(FREE), True),)),
            ErrorSize(), ErrorSize(inf),
        ),
    ],
    ids=["no contact", "known", "scatter", "read once", "failed points", "contact in one alone"],
)  # fmt: skip
def test_what_is_not_known_is_open_at_its_bound_and_what_is_not_there_is_no_mark(
    found: ResponseComparison, amplitude: ErrorSize, frequency: ErrorSize
) -> None:
    made_up = ModelError.of("two", found, FIVE, 1e-3)
    for one, other in ((made_up.amplitude, amplitude), (made_up.frequency, frequency)):
        assert one.open is other.open
        assert one.value == pytest.approx(other.value, nan_ok=True)


def test_open_ends_are_drawn_at_their_bound() -> None:
    near = drawn({"near": known(0.006)}, known()).shown["near"]
    wide = replace(near, ends=(replace(near.ends[0], error=0.006, open=0.01),))
    assert ModelError.of("near", near, FIVE, 1.0).frequency.open is False
    assert ModelError.of("near", wide, FIVE, 1.0).frequency == ErrorSize(pytest.approx(0.016), True)


def test_errors_stand_at_their_cpu_times_and_models_without_one_are_named() -> None:
    errors = (
        ModelError("one", 1e-4, ErrorSize(0.2), ErrorSize(0.03), "1"),
        ModelError("two", 4e-4, ErrorSize(0.02, True), ErrorSize(0.0), "2"),
        ModelError("two", 2e-3, ErrorSize(1e-9), solver="orbit"),
        ModelError("lost", 0.0, ErrorSize(0.5)),
    )
    found = drawn({"one": known()}, known(), errors=errors, reference_seconds=5e-3, left_out=("three", "four"))
    figure = times_figure(found)
    marks = lines(figure)
    place = {name: (each.get_xdata()[0], each.get_ydata()[0]) for name, each in marks.items() if "-of-" in name}
    assert place["amplitude-of-one"] == pytest.approx((0.1, 20.0))
    assert place["frequency-of-one"] == pytest.approx((0.1, 3.0))
    assert place["amplitude-of-two-orbit"] == pytest.approx((2.0, 0.01))  # no error is drawn smaller
    assert place["frequency-of-two"] == pytest.approx((0.4, 0.01))
    assert "frequency-of-two-orbit" not in place  # a solver's ends are not known
    assert not any("lost" in name for name in place)
    assert marks["amplitude-of-two"].get_markerfacecolor() == "white"
    assert marks["asked-amplitude"].get_ydata()[0] == pytest.approx(5.0)
    remark = " ".join(figure.legends[0].get_title().get_text().split())
    assert remark == "open marks: not surely known; not compared: three, four"
    assert shown_in(errors) == ["amplitude", "frequency"]
    assert shown_in([ModelError("none", 1e-4, ErrorSize())]) == []


def test_a_run_shows_the_cheapest_that_suffices_and_the_next_cheaper_beside_the_finest() -> None:
    result = swept(vibeam.load(NEUTRAL, set=QUICK))
    [found] = run_decisions(result)
    assert (found.reference, list(found.shown)) == ("beam", ["two_modes", "sdof"])
    assert [each.ending for each in run_report(result).pictures] == ["", "_times"]
    marks = lines(times_figure(found))
    for name, response in result.items():
        if f"amplitude-of-{name}" in marks:
            seconds = float(np.nansum(response.up.cpu_seconds)) / len(response.up)
            assert marks[f"amplitude-of-{name}"].get_xdata()[0] == pytest.approx(1e3 * seconds)
    [group] = groups_of(result, compare(result))
    assert [row.fidelity for row in recommended(group, found.shown, replace(FIVE, amplitude=1e-9))] == [
        "two_modes",
        "sdof",
    ]
    assert [row.fidelity for row in recommended(group, found.shown, replace(FIVE, amplitude=0.5))] == ["sdof"]
    assert recommended(group, {}, FIVE) == []


def test_two_fidelities_have_one_picture_and_one_has_none() -> None:
    two = vibeam.load(NEUTRAL, set=QUICK | {"fidelity.two_modes": None, "reference": None})
    assert [each.ending for each in run_report(swept(two)).pictures] == [""]
    assert list(run_report(swept(parse(SDOF))).pictures) == []


def test_without_contact_curves_have_no_marks() -> None:
    still = vibeam.load(NEUTRAL, set=QUICK | {"stop.gap": "9 mm"})
    [found] = run_decisions(swept(still))
    assert [name for name in lines(responses_figure(found)) if "error" in name] == []
    assert [each.ending for each in found.pictures] == [""]


@pytest.fixture(scope="module")
def verdict() -> vibeam.Verdict:
    """Modes that have an answer, effects that have none; solvers and plane not asked for."""
    case = vibeam.load(NEUTRAL, set=QUICK)
    stage = vibeam.studies.Stage
    stages = (stage("modes", modes_needed(case), 0.1), stage("effects", None, 0.0, "no effect is named"))
    return vibeam.Verdict(case, VerdictPlan(only=("modes", "effects")), stages)


def test_the_page_of_a_verdict_has_the_sentence_two_pictures_and_the_rest_folded(verdict: vibeam.Verdict) -> None:
    made_page = sheet(verdict).page
    assert made_page is not None
    text = made_page()
    heads = re.findall(r"<h2[^>]*>([^<]*)</h2>", text)
    assert heads == ["Models over each other", "What accuracy costs in time", "Notes", "Numbers of each stage"]
    assert text.index(modes_sheet.answer(verdict["modes"])) < text.index("<h2")
    first = text.index("<details>")
    assert text.rindex("<img") < first < text.index("<table>")
    assert re.findall(r"<summary>([^<]*)</summary>", text) == ["How many modes?"]
    assert "Not answered: effects (no effect is named)." in text[:first]
    assert "Not asked for: solvers, map; without --only all stages are computed." in text[:first]


def test_a_stage_without_an_answer_has_no_picture(verdict: vibeam.Verdict) -> None:
    alone = replace(verdict, stages=tuple(replace(each, why="too dear") for each in verdict.stages))
    assert list(pictures(alone)) == []
    solid = vibeam.Verdict(verdict.case, verdict.plan, (vibeam.studies.Stage("solid", None, 0.0),))
    assert list(pictures(solid)) == []


def test_the_pictures_of_a_record_are_its_own(verdict: vibeam.Verdict) -> None:
    """A study under a record has no response over frequency."""
    case = vibeam.load("cases/inputs/half_sine.toml")
    assert list(pictures(replace(verdict, case=case))) == []


def test_the_error_that_is_allowed_is_in_sight_of_errors_far_from_it() -> None:
    errors = (ModelError("one", 2e-4, ErrorSize(1e-4), ErrorSize(0.4)),)
    figure = times_figure(Decision(vibeam.load(NEUTRAL), FIVE, "ten", errors=errors))
    for axes, allowed in zip(figure.axes, (5.0, 1.0), strict=True):
        low, high = axes.get_ylim()
        assert low < allowed < high


def test_responses_at_one_frequency_are_marks() -> None:
    one = np.array([15.3]), np.array([4e-4])
    found = Decision(vibeam.load(NEUTRAL), FIVE, "ten", {("ten", "up"): one, ("one", "up"): one})
    assert [line.get_marker() for line in responses_figure(found).axes[0].lines] == ["o", "o"]
