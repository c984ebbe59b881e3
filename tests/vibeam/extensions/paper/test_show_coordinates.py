"""Motions in Zhuravlev's and Ivanov's coordinates: their equations of motion and their jumps (paper eq. 3–15)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.figures.sheet import Sheet
from vibeam.report.figures import figure

BETA, DRIVE, OMEGA, R = 0.015, 0.5e-3, 1.9, 0.8
CASE = """[sdof]
damping_ratio = 0.015
[stop]
gap = {gap}
restitution = 0.8
[drive]
amplitude = 0.5e-3
[sweep]
frequency = ["1.9 rad/s"]
settle = 60
hold = 4
[fidelity.it]
{own}
[show.it]
kind = "coordinates"
frequency = "1.9 rad/s"
"""


def case_of(own: str, gap: float = 0.3e-3) -> Case:
    return parse(CASE.format(own=own, gap=gap))


def sheet_of(own: str, gap: float = 0.3e-3) -> Sheet:
    (sheet,) = vibeam.run(case_of(own, gap)).shown["it"]
    return sheet


def rates(sheet: Sheet) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
    """Where neighbouring samples lie in one flight, and the rates of z and of its velocity between them."""
    step = np.diff(sheet["time"])
    near = np.minimum.reduce([np.abs(sheet["time"][:-1] - at) for at in sheet["impact_time"]])
    inside = (step > 0) & (near > 2 * step.max()) & (np.sign(sheet["velocity"][1:]) == np.sign(sheet["velocity"][:-1]))
    with np.errstate(all="ignore"):
        return inside, np.diff(sheet["unfolded"]) / step, np.diff(sheet["unfolded_velocity"]) / step


@pytest.mark.parametrize(
    ("own", "jump", "near"),
    [("", 1 - R, 1e-9), ('solver = "direct"', 1 - R, 1e-9), ('solver = "zhuravlev"', 1 - R, 1e-9),
     ('solver = "ivanov"', 0.0, 1e-9), ('solver = "moreau"', 1 - R, 0.02)],
)  # fmt: skip
def test_the_jumps_are_those_of_eq_3_9_and_13(own: str, jump: float, near: float) -> None:
    sheet = sheet_of(own)
    assert len(sheet["unfolded_jump"]) == 3
    assert sheet["physical_jump"] == pytest.approx(1 + R, abs=near)
    assert sheet["unfolded_jump"] == pytest.approx(jump, abs=near)


@pytest.mark.parametrize("gap", [-0.3e-3, 0.0, 0.3e-3])
def test_zhuravlev_s_coordinates_solve_eq_7(gap: float) -> None:
    sheet = sheet_of("", gap)
    inside, z_rate, rate = rates(sheet)
    z, slope, time = (
        (sheet[name][1:] + sheet[name][:-1]) / 2 for name in ("unfolded", "unfolded_velocity", "time")
    )  # fmt: skip
    assert set(np.sign(z[inside])) == {-1.0, 1.0}
    assert np.allclose(z_rate[inside], slope[inside], atol=1e-4 * np.abs(slope).max())
    left = rate + 2 * BETA * slope + z
    right = np.sign(z) * (gap - OMEGA**2 * DRIVE * np.sin(OMEGA * time))
    assert np.allclose(left[inside], right[inside], atol=1e-4 * np.abs(z).max())
    assert not np.allclose(left[inside], -right[inside], atol=0.01 * np.abs(z).max())
    assert np.allclose(gap - np.abs(sheet["unfolded"]), sheet["displacement"], atol=1e-15)


def test_ivanov_s_coordinates_solve_eq_14_and_15() -> None:
    gap = 0.3e-3
    sheet = sheet_of('solver = "ivanov"\noptions = { method = "DOP853", rtol = 1e-9, atol = 1e-12 }', gap)
    inside, z_rate, rate = rates(sheet)
    z, s, time = ((sheet[name][1:] + sheet[name][:-1]) / 2 for name in ("unfolded", "unfolded_velocity", "time"))
    factor = 1 - (1 - R) / (1 + R) * np.sign(z * s)
    scale = np.abs(s).max()
    assert np.quantile(np.abs(z_rate - factor * s)[inside], 0.9) < 2e-3 * scale
    right = -2 * BETA * s + ((gap - OMEGA**2 * DRIVE * np.sin(OMEGA * time)) * np.sign(z) - z) / factor
    assert np.quantile(np.abs(rate - right)[inside], 0.9) < 5e-3 * scale


def test_drawn_with_physical_and_transformed_curves() -> None:
    result = vibeam.run(case_of('solver = "ivanov"'))
    made = figure(result, result.case.shows["it"])
    assert len(made.axes) == 3
    labels = made.axes[0].get_legend_handles_labels()[1]
    assert labels == ["it, physical", "it, transformed", "stop"]


def test_what_has_no_such_coordinates_says_why() -> None:
    assert "second stop" in sheet_of("set = { 'stop.second_gap' = 0.1 }").fault
