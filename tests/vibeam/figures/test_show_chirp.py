"""The swept-sine test as a figure: its numbers against the chirp itself, its faults, its drawing, its results file."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from figures import beam
from scipy.integrate import solve_ivp

import vibeam
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.figures.kinds import chirp
from vibeam.figures.sheet import Sheet
from vibeam.report.figures import figure

CASE = """[sdof]
natural_frequency = "8 Hz"
damping_ratio = 0.02
[stop]
gap = {gap}
restitution = 0.9
{stop}
[drive]
amplitude = 0.5e-3
[sweep]
frequency = {{ from = "7.5 Hz", to = "8.5 Hz", points = 3 }}
settle = 200
hold = 2
[fidelity.it]
{own}
[show.it]
kind = "chirp"
{more}
"""


def case_of(more: str = 'rate = "0.2 Hz/s"', gap: float = 1.0, own: str = "", stop: str = "") -> Any:
    return parse(CASE.format(gap=gap, own=own, more=more, stop=stop), "mine.toml")


def sheets_of(*args: Any, **keys: Any) -> tuple[Sheet, ...]:
    return vibeam.run(case_of(*args, **keys)).shown["it"]


def test_an_oscillator_without_impacts_is_swept_as_the_equation_says():
    """Extremes of each period of q̈ + 2ζω q̇ + ω² q = Ω²B sin φ, Ω = Ω₀ + αt, by DOP853 from the settled motion."""
    (up,) = sheets_of('rate = "0.05 Hz/s"\ndirection = "up"')
    own, first, rate = 2 * np.pi * 8, 2 * np.pi * 7.5, 2 * np.pi * 0.05

    def slope(t: float, y: Any) -> list[float]:
        force = (first + rate * t) ** 2 * 0.5e-3 * np.sin(first * t + rate * t * t / 2)
        return [y[1], force - own**2 * y[0] - 0.04 * own * y[1]]

    settled = first**2 * 0.5e-3 / (own**2 - first**2 + 0.04j * own * first)
    start, end = [settled.imag, (1j * first * settled).imag], up["time"][-1] + 2 * np.pi / first
    path = solve_ivp(slope, (0, end), start, "DOP853", rtol=1e-10, atol=1e-14, dense_output=True).sol
    begins = np.append(up["time"], 2 * up["time"][-1] - up["time"][-2])
    swing = [np.ptp(path(np.linspace(a, b, 400))[0]) / 2 for a, b in pairwise(begins)]
    assert np.abs(up["amplitude"] / swing - 1).max() < 1e-4  # 400 times a period see ptp to (π/400)²/2
    assert up["swept_peak"][0] == up["amplitude"].max()
    assert up["swept_peak_frequency"][0] == up["frequency"][np.argmax(up["amplitude"])]


def test_up_the_peak_comes_late_and_down_from_where_it_came():
    up, down = sheets_of('rate = "0.1 Hz/s"')
    assert down["swept_peak_frequency"] < 8.0 < up["swept_peak_frequency"]
    assert up["frequency"][-1] == pytest.approx(down["frequency"][0], rel=2e-3)
    assert up["amplitude"][-1] == pytest.approx(down["amplitude"][0], rel=0.02)
    assert up["frequency"][0] == pytest.approx(7.5, rel=2e-3)


def test_an_amplitude_over_several_periods_has_their_extremes():
    (one,), (four,) = (sheets_of(f'rate = "0.2 Hz/s"\ndirection = "up"\nperiods = {n}', gap=0.0) for n in (1, 4))
    count = len(one["amplitude"]) // 4
    assert len(four["amplitude"]) == count
    high = one["maximum"][: 4 * count].reshape(count, 4).max(1)
    low = one["minimum"][: 4 * count].reshape(count, 4).min(1)
    np.testing.assert_array_equal(four["amplitude"], (high - low) / 2)
    np.testing.assert_array_equal(four["time"], one["time"][: 4 * count : 4])
    assert four["impacts"].max() > 0


@pytest.mark.parametrize(
    ("own", "within"),
    [
        ('solver = "direct"\noptions = { method = "DOP853", rtol = 1e-9, atol = 1e-13 }', 1e-6),
        ('solver = "moreau"\noptions = { steps = 8000 }', 1e-2),
    ],
)
def test_other_solvers_fly_it_too(own, within):
    """With impacts, from the motion settled over 5 drive periods, so that time stepping is quick."""
    more = 'rate = "2 Hz/s"\ndirection = "up"\nsettle = 5'
    cases = [case_of(more, gap=0.0, own=each) for each in ("", own)]
    (exact,), (other,) = (chirp.sheets(case, "it", case.shows["it"]) for case in cases)
    assert exact["impacts"].max() > 0
    np.testing.assert_allclose(other["maximum"], exact["maximum"], atol=within * exact["amplitude"].max())
    np.testing.assert_allclose(other["minimum"], exact["minimum"], atol=within * exact["amplitude"].max())


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"more": 'rate = "20 Hz/s"'}, "0.4 drive periods, at least 1 makes one: lower the rate"),
        ({"more": 'rate = "1 Hz/s"\nperiods = 100'}, "the chirp lasts 8 drive periods, fewer than the 100"),
        ({"stop": "wear = 1e-8"}, "a chirp has one gap"),
        ({"stop": 'drift_frequency = ["7 Hz", "9 Hz"]\ndrift = [0, 1e-4]'}, "a chirp has one gap"),
    ],
)
def test_no_motion_says_why(keys, message):
    (sheet,) = sheets_of(**keys)
    assert message in sheet.fault


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"own": 'solver = "orbit"'}, 'kind = "chirp" flies a transient, "orbit" of it knows settled motions alone'),
        ({"more": ""}, 'show.it.rate: missing: kind = "chirp" needs it'),
        ({"more": 'rate = "1 Hz"'}, "show.it.rate: '1 Hz' is a frequency, not a sweep rate"),
        ({"more": 'rate = "1 Hz/s"\nfrequency = "8 Hz"'}, 'show.it.frequency: kind = "chirp" has no use for it'),
    ],
)  # fmt: skip
def test_what_a_case_is_told(keys, message):
    with pytest.raises(CaseError) as caught:
        case_of(**keys)
    assert message in str(caught.value)


def test_it_is_drawn_with_the_distance_of_its_peak_from_the_settled_one(tmp_path):
    case = beam("chirp", rate="0.5 Hz/s", sweep__frequency=[15.0, 15.3, 15.6], sweep__settle=100)
    result = vibeam.run(case, out=tmp_path / "a.h5")
    made = figure(result, case.shows["it"])
    labels = [line.get_label() for line in made.axes[0].get_lines()]
    assert sum("swept up: peak" in label for label in labels) == len(case.fidelities)
    assert sum("swept down: peak" in label for label in labels) == len(case.fidelities)
    again = vibeam.run(case, out=tmp_path / "a.h5")
    for old, new in zip(result.shown["it"], again.shown["it"], strict=True):
        np.testing.assert_array_equal(old["amplitude"], new["amplitude"])


def test_a_chirp_of_one_amplitude_is_named_by_its_direction():
    case = case_of('rate = "2 Hz/s"\ndirection = "up"\nperiods = 3')
    made = figure(vibeam.run(case), case.shows["it"])
    labels = [str(line.get_label()) for line in made.axes[0].get_lines()]
    assert [label.split(":")[0] for label in labels if "swept" in label] == ["it, swept up"]
