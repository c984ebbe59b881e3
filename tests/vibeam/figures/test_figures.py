"""Figures: limits hold all data, looks stay with their fidelities, labels stay apart, no panel is empty unsaid."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from stand_in import case as stand_in_case
from stand_in import curve, one_mode, plain, system

import vibeam
from vibeam.case.case import Case
from vibeam.case.plans import FigurePlan
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.figures import RINGING, SHARES, page
from vibeam.figures.lettering import crowded_axes, thin_out
from vibeam.figures.panels import decades, from_zero
from vibeam.figures.response_curve import frc, write_frc
from vibeam.figures.sheet import Column, Sheet
from vibeam.figures.style import COLOURS, looks_of
from vibeam.figures.units import units_for, units_of
from vibeam.report.figures import figure, write_shown
from vibeam.runs.result import Result
from vibeam.system.response import Branches, Ended

GRID = np.linspace(14.0, 17.0, 61)
PEAK = 1e-3 / (1 + 8 * (GRID - 15.2) ** 2)
SDOF = one_mode('["1.8 rad/s", "2 rad/s"]', 2, 2, direction="up")
HERTZ = (1.8 / (2 * np.pi), 2 / (2 * np.pi))


def responses(*sizes: float, **changes: Any) -> Result:
    """A result of so many fidelities, f0 first, each with a peak of its size, and how each response differs."""
    own = {key: changes.pop(key) for key in ("ended", "period") if key in changes}
    branches = {f"f{n}": Branches(curve(GRID, size * PEAK, **own), None) for n, size in enumerate(sizes)}
    fidelities = {name: plain(name) for name in branches}
    systems = {name: system(1, gap=changes.pop("gap", 0.0)) for name in branches}
    return Result(stand_in_case(system=systems.__getitem__, fidelities=fidelities, **changes), branches)


def shows(kind: str, *keys: str, fidelities: int = 2, further: str = "") -> Case:
    """A case with a figure ``it`` of a kind at both frequencies of its sweep."""
    names = [f"[fidelity.f{n}]" for n in range(fidelities)]
    return parse("\n".join([SDOF, *names, further, f'[show.it]\nkind = "{kind}"', *keys]) + "\n")


BOTH = 'frequency = ["1.8 rad/s", "2 rad/s"]'


def motion(fidelity: str, frequency: float, turns: float = 1.0, periods: int = 4) -> Sheet:
    """A circle round and round; with ``turns`` no whole number of drive periods it never closes."""
    time = np.linspace(0, periods / frequency, 100 * periods + 1)
    angle = 2 * np.pi * frequency * time * turns
    size = 1e-3 * (1 + 0.3 * np.sin(0.37 * angle) * (turns != 1))
    rows = {"time": time, "displacement": size * np.cos(angle), "velocity": size * np.sin(angle)}
    rows |= {"impact_time": time[[5]], "impact_velocity": size[[5]]}
    return Sheet(fidelity, frequency, {name: Column(values, "q", name) for name, values in rows.items()})


def shown(case: Case, *sheets: Sheet) -> Figure:
    """The figure ``it`` of given numbers."""
    branches = {name: Branches(curve(np.array(HERTZ), 1e-3), None) for name in case.fidelities}
    return page.composed(lambda: figure(Result(case, branches, shown={"it": sheets}), case.shows["it"]))


def outside(axes: Axes) -> list[str]:
    """The lines of which a point with a place in the axes' coordinates lies beyond the limits."""
    low, high = axes.get_ylim()
    lines = [line for line in axes.lines if line.get_transform() == axes.transData]
    data = {str(line.get_label()): np.asarray(line.get_ydata(), dtype=float) for line in lines}
    return [name for name, y in data.items() if np.any(y[np.isfinite(y)] < low) or np.any(y[np.isfinite(y)] > high)]


def labels(made: Figure) -> list[str]:
    """The legend's entries, unbroken."""
    return [text.get_text().replace("\n", " ") for legend in made.legends for text in legend.get_texts()]


def texts(made: Figure) -> list[str]:
    """What is written in the panels."""
    return [text.get_text() for axes in made.axes for text in axes.texts]


@pytest.mark.parametrize("sizes", [(1, 3), (1, 3, 0.2), (1, 2, 0.5, 7, 3)])
def test_a_higher_curve_after_the_first_is_within_the_limits(sizes: tuple[float, ...]) -> None:
    made = frc(responses(*sizes))
    for axes in made.axes:
        assert outside(axes) == []
        assert axes.get_ylim()[0] == 0
    assert made.axes[0].get_ylim()[1] > max(sizes) * 1.0


def test_an_axis_by_the_data_says_that_it_does_not_start_at_zero() -> None:
    """The range is a fifth of the top; with a curve a tenth as high on the same scale the axis starts at 0 again."""
    flat = {"f0": Branches(curve(GRID, 0.8e-3 + 0.2 * PEAK), None)}
    low = flat | {"f1": Branches(curve(GRID, 0.1e-3), None)}
    for branches, bottom in ((flat, 0.75), (low, 0.0)):
        systems = {name: system(1, gap=0.0) for name in branches}
        made = frc(Result(stand_in_case(system=systems.__getitem__), branches))
        assert made.axes[0].get_ylim()[0] >= bottom
        marks = [each for each in made.axes[0].lines if each.get_gid() == "not-from-zero"]
        assert (len(marks) == 2, "does not start at 0" in made.get_supylabel()) == (bottom > 0, bottom > 0)
    assert frc(responses(1)).axes[0].get_ylim()[0] == 0


def test_scattered_motions_of_three_fidelities_get_a_panel_each() -> None:
    chaotic = np.where(GRID > 16, 0, 1)
    assert [len(frc(responses(*sizes, period=chaotic)).axes) for sizes in ((1, 2), (1, 2, 3))] == [1, 3]
    assert len(frc(responses(1, 2, 3)).axes) == 1


def test_a_finest_fidelity_of_which_nothing_is_drawn_is_in_no_legend() -> None:
    """Four fidelities in panels of their own; the finest never repeats."""
    for period, explained in ((0, False), (1, True)):
        finest = Branches(curve(GRID, PEAK, period, modes=3), None)
        branches = {name: Branches(curve(GRID, PEAK), None) for name in ("f0", "f1", "f2")} | {"f3": finest}
        systems = {name: system(1, gap=0.0) for name in branches}
        fidelities = {name: plain(name) for name in branches}
        made = frc(Result(stand_in_case(system=systems.__getitem__, fidelities=fidelities), branches))
        assert any("for comparison" in each for each in labels(made)) is explained


def test_an_isolated_point_of_period_one_is_explained_and_one_without_contact_is_a_dash() -> None:
    alone = np.select([GRID[30] == GRID, GRID[40] == GRID], [1, -1], 0)
    made = frc(responses(1, period=alone))
    assert "period 1, at one frequency alone" in labels(made)
    marks = {each.get_gid(): each.get_marker() for each in made.axes[0].lines if len(each.get_xdata()) == 1}
    assert marks["f0-up-1-period_one"] == "o"
    assert marks["f0-up-3-no_contact"] == "_"
    assert "period 1, at one frequency alone" not in labels(frc(responses(1)))


def test_every_grazing_line_has_the_colour_of_its_fidelity() -> None:
    branches = {name: Branches(curve(GRID, PEAK), None) for name in ("f0", "f1")}
    systems = {"f0": system(1, gap=1e-3), "f1": system(1, gap=1.2e-3)}
    fidelities = {name: plain(name) for name in branches}
    made = frc(Result(stand_in_case(system=systems.__getitem__, fidelities=fidelities), branches))
    lines = {each.get_gid(): each for each in made.axes[0].lines if str(each.get_gid()).endswith("-gap")}
    assert [lines[name].get_color() for name in ("f0-gap", "f1-gap")] == list(COLOURS[:2])
    assert lines["f0-gap"].get_linestyle() == "--"  # matplotlib's name of every dash pattern
    assert lines["f0-gap"]._dash_pattern != lines["f1-gap"]._dash_pattern


def test_an_axis_from_zero_goes_on_to_scale_itself() -> None:
    axes = Figure().subplots()
    axes.plot([0, 1], [1, 2])
    from_zero(axes)
    axes.plot([0, 1], [3, 9])
    assert axes.get_ylim()[0] == 0
    assert axes.get_ylim()[1] > 9


@pytest.mark.parametrize("kind", ["ringing", "boundaries", "participation", "curve"])
def test_higher_curves_are_within_the_limits_of_every_kind(kind: str) -> None:
    keys = {"curve": ['quantity = "maximum"'], "boundaries": ['quantity = "largest_gap"']}.get(kind, [BOTH])
    if kind == "ringing":
        keys = ['near = "6 rad/s"']
    sheets = []
    for size, name in ((1.0, "f0"), (40.0, "f1")):
        for frequency in (float("nan"),) if kind in ("boundaries", "curve") else HERTZ:
            values = size * np.array([1.0, 2.0])
            numbers = {column: Column(values, "1", column) for column in ("value", *RINGING, *SHARES)}
            numbers |= {"mode": Column(np.array([1.0, 2.0]), "1", ""), "frequency": Column(np.array(HERTZ), "Hz", "")}
            sheets.append(Sheet(name, frequency, numbers))
    for axes in shown(shows(kind, *keys), *sheets).axes:
        assert outside(axes) == []
        assert all(patch.get_height() <= axes.get_ylim()[1] for patch in axes.patches)


def test_every_fidelity_keeps_its_look_and_no_two_share_one() -> None:
    names = [f"f{n}" for n in range(20)]
    case = stand_in_case(fidelities={name: plain(name) for name in names})
    whole = {name: (look.colour, look.dash) for name, look in looks_of(case, names).items()}
    assert len(set(whole.values())) == 20
    part = {name: (look.colour, look.dash) for name, look in looks_of(case, ["f13", "f2"]).items()}
    assert part == {name: whole[name] for name in ("f13", "f2")}


def test_a_fidelity_has_its_colour_in_all_figures() -> None:
    found = set()
    for kind, keys in (("history", BOTH), ("portrait", BOTH), ("curve", 'quantity = "reach"')):
        case = shows(kind, keys, 'fidelities = ["f1"]')
        made = shown(case, *(motion("f1", each) for each in HERTZ))
        lines = [line for axes in made.axes for line in axes.lines if line.get_label() == "f1"]
        found |= {(to_hex(line.get_color()).upper(), line.get_linestyle()) for line in lines}
    whole = frc(responses(1, 2))
    found |= {
        (to_hex(line.get_color()).upper(), "-")
        for line in whole.axes[0].lines
        if line.get_gid() == "f1-up-0-period_one"
    }
    assert found == {(COLOURS[1], "-")}


def test_coinciding_curves_are_drawn_ever_narrower() -> None:
    made = shown(shows("history", BOTH, fidelities=4), *(motion(f"f{n}", each) for n in range(4) for each in HERTZ))
    widths = [line.get_linewidth() for line in made.axes[0].lines if str(line.get_label()).startswith("f")]
    assert widths == sorted(widths, reverse=True)
    assert np.all(-np.diff(widths) > 0.2)


def test_tick_labels_do_not_overlap() -> None:
    case = shows("section", BOTH, fidelities=1, further='[figure]\nwidth = "70 mm"')
    points = {"displacement": -0.123456 + 1e-4 * np.arange(9.0), "velocity": np.arange(9.0)}
    columns = {name: Column(values, "q", name) for name, values in points.items()}
    branches = {"f0": Branches(curve(np.array(HERTZ), 1e-3), None)}
    result = Result(case, branches, shown={"it": tuple(Sheet("f0", each, columns) for each in HERTZ)})
    with mpl.rc_context(page.PAGE):
        made = figure(result, case.shows["it"])
        assert crowded_axes(made)
        thin_out(made)
        assert not crowded_axes(made)
    assert all(len(axes.get_xticks()) >= 2 for axes in made.axes)


def test_a_logarithmic_axis_leaves_round_off_out() -> None:
    axes = Figure().subplots()
    decades(axes, [np.array([3.0, 1e-4, 1e-17, 0.0, np.nan])])
    low, high = axes.get_ylim()
    assert low == pytest.approx(0.5e-4)
    assert high == 6
    decades(axes, [np.array([0.0])])
    assert axes.get_ylim() == (low, high)


def test_failed_points_lie_along_the_edge_with_their_reason() -> None:
    code = Ended.NO_ORBIT.code
    made = frc(responses(1, ended=np.where(GRID > 16, code, 0)))
    (marks,) = [line for line in made.axes[0].lines if "failed" in str(line.get_gid())]
    assert marks.get_transform() == made.axes[0].get_xaxis_transform()
    assert 0.9 < np.unique(marks.get_ydata()) < 1
    assert list(marks.get_xdata()) == list(GRID[GRID > 16])
    assert f"failed, along the upper edge: {Ended.NO_ORBIT.value}" in labels(made)


def test_where_nothing_is_drawn_the_figure_says_why() -> None:
    made = frc(responses(1, ended=np.full(61, Ended.NOT_FINITE.code), period=0))
    assert Ended.NOT_FINITE.value in " ".join(labels(made))
    calm = shown(shows("curve", 'quantity = "impact_velocity"', fidelities=1))
    assert texts(calm) == ["no impact at any frequency"]
    assert labels(calm) == ["f0: no impact at any frequency"]
    faults = [Sheet("f0", HERTZ[0], fault="it fell asleep"), motion("f0", HERTZ[1])]
    partly = shown(shows("portrait", BOTH, fidelities=1), *faults)
    assert texts(partly) == ["it fell asleep"]
    assert labels(partly) == ["stop", "f0", "f0 at 1 of 2 frequencies: it fell asleep"]


def test_a_motion_that_does_not_repeat_is_faded() -> None:
    made = shown(shows("portrait", BOTH, fidelities=1), motion("f0", HERTZ[0]), motion("f0", HERTZ[1], 0.7713, 40))
    calm, wild = made.axes
    assert not calm.collections
    (lines,) = [each for each in wild.collections if isinstance(each, LineCollection)]
    assert len(lines.get_segments()) == 40
    assert lines.get_alpha() < 0.3
    ends = [(one[-1], two[0]) for one, two in zip(lines.get_segments(), lines.get_segments()[1:], strict=False)]
    assert all(np.array_equal(last, first) for last, first in ends)


def test_a_section_of_one_place_is_seen_as_one() -> None:
    columns = {name: Column(-2e-3 + 1e-17 * np.arange(50.0), "q", name) for name in ("displacement", "velocity")}
    made = shown(shows("section", BOTH, fidelities=1), *(Sheet("f0", each, columns) for each in HERTZ))
    low, high = made.axes[0].get_xlim()
    assert high - low == pytest.approx(0.4e-3, rel=1e-6)
    assert made.axes[0].lines[0].get_markersize() > 5


def test_a_far_stop_does_not_press_the_curve_flat() -> None:
    made = frc(responses(1, gap=1.0))
    assert made.axes[0].get_ylim()[1] < 2
    assert "grazing: above the figure" in labels(made)


def test_a_far_stop_does_not_press_the_motion_flat() -> None:
    case = parse(shows("portrait", BOTH, fidelities=1).text, set={"stop.gap": 1.0})
    made = shown(case, *(motion("f0", each) for each in HERTZ))
    assert made.axes[0].get_xlim()[1] < 2e-3
    assert labels(made) == ["f0", "stop: beyond the figure"]


def test_titles_and_labels_are_no_formulas(tmp_path: Path) -> None:
    shown = responses(1, title="a $\\frac{1 title\x1b[31m$")
    shown.case.fidelities["f0"].label = "cost: $5 and $x_"
    write_frc(shown, tmp_path / "a.svg", tmp_path / "a.png")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    for words in ("a $\\frac{1 title\\x1b[31m$", "cost: $5 and $x_"):
        assert words in text
    assert "\x1b" not in text


def test_a_title_takes_a_few_lines_however_long_it_is() -> None:
    made = frc(responses(1, title="no end " * 1000))
    title = made.get_suptitle().splitlines()
    assert [line.startswith("no end") for line in title] == [True] * 4 + [False] * (len(title) - 4)
    assert title[3].endswith(" …")


def test_the_figure_table_says_formats_width_and_title(tmp_path: Path) -> None:
    table = '[figure]\nformat = ["pdf", "svg"]\nwidth = "90 mm"\ntitle = false'
    case = shows("curve", 'quantity = "reach"', fidelities=1, further=table)
    assert case.figure == FigurePlan(("pdf", "svg"), 0.09, False)
    result = Result(case, {"f0": Branches(curve(np.array(HERTZ), 1e-3), None)})
    files = write_shown(result, tmp_path / "r.h5")
    assert [file.name for file in files] == ["r_it.pdf", "r_it.svg"]
    assert files[0].read_bytes().startswith(b"%PDF")
    for made in (figure(result, case.shows["it"]), frc(result)):
        assert made.get_figwidth() == pytest.approx(90 / 25.4)
        assert made.get_suptitle() == ""


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ('format = "gif"', "figure.format: 'gif' is not one of"),
        ('width = "3 km"', "figure.width: '3 km' is outside [0.04, 1]"),
        ("titel = false", "figure.titel: unknown key; did you mean 'title'?"),
    ],
)
def test_a_wrong_figure_table_is_told(line: str, fault: str) -> None:
    with pytest.raises(CaseError) as caught:
        shows("curve", 'quantity = "reach"', further=f"[figure]\n{line}")
    assert [str(each).split(": ", 1)[1].startswith(fault) for each in caught.value.faults] == [True]


def test_figures_and_labels_change_no_numbers(tmp_path: Path) -> None:
    text, out = SDOF + "[fidelity.f0]\n", tmp_path / "r.h5"
    vibeam.run(parse(text), out)
    named = parse(text + 'label = "the oscillator"\n[figure]\nformat = "pdf"\n')
    assert named.key == parse(text).key
    result = vibeam.run(named, out)
    assert result.found == result.total
    assert labels(frc(result))[0] == "the oscillator"
    assert parse(named.text).fidelities["f0"].label == "the oscillator"


@pytest.mark.parametrize(
    ("amplitude", "top", "expected"),
    [
        (0.4e-3, 17.0, ("mm", "Hz", "mm/s")),
        (22e-6, 5e5, ("µm", "kHz", "m/s")),
        (2e-9, 3e7, ("nm", "MHz", "mm/s")),
        (2.5, 0.5, ("m", "Hz", "mm/s")),
    ],
)
def test_units_suit_the_size(amplitude: float, top: float, expected: tuple[str, str, str]) -> None:
    case = stand_in_case(sweep=stand_in_case().sweep)
    case.sweep.frequency = np.array([top / 2, top])
    result = Result(case, {"one": Branches(curve(case.sweep.frequency, amplitude), None)})
    found = units_for(result)
    assert (found.length, found.frequency, found.speed) == expected
    assert found.lengths(amplitude) == f"{amplitude * found.length_factor:.4g} {expected[0]}"
    assert units_of(case).length == "mm"


def test_axes_say_whose_motion_they_show_and_figures_what() -> None:
    made = frc(responses(1))
    assert made.get_suptitle() == "a case\nfrequency response"
    rig = vibeam.load(Path(__file__).parents[3] / "cases" / "dtu_neutral.toml", set={
        "show.it.kind": "portrait", "show.it.frequency": "15 Hz", "show.it.output": "contact",
    })  # fmt: skip
    drawn = shown(rig, *(motion(name, 15.0) for name in rig.fidelities))
    assert drawn.axes[0].get_xlabel() == "contact displacement (mm)"
    assert drawn.axes[0].get_ylabel() == "contact velocity (mm/s)"
    assert drawn.get_suptitle().splitlines() == [
        "DTU impacting beam, neutral gap, 0.6 V", "velocity over displacement, R₁ = 0.72 of mode 1",
    ]  # fmt: skip
