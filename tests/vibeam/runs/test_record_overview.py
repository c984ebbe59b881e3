"""Sentences on a load before a run under it: a record too coarse for the highest mode."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.runs.transient.motions import MotionMaker
from vibeam.runs.transient.overview import overview_of_record

CASE = """[sdof]
natural_frequency = "100 Hz"
damping_ratio = 0.03
[stop]
gap = 0.01
restitution = 0.7
[drive]
file = "a.csv"
rate = "{rate} Hz"
interpolation = "{interpolation}"
[record]
duration = "0.05 s"
[fidelity.it]
"""


@pytest.mark.parametrize(
    ("rate", "interpolation", "said"),
    [
        (500.0, "linear", ["500 samples a second, the highest mode, 100 Hz, needs 702 to be off by 10% at most"]),
        (800.0, "linear", []),
        (500.0, "cubic", []),
        (200.0, "cubic", ["200 samples a second, the highest mode, 100 Hz, needs 252 to be off by 10% at most"]),
    ],
)
def test_a_load_too_coarse_for_the_highest_mode_says_what_it_needs(
    tmp_path: Path, rate: float, interpolation: str, said: list[str]
) -> None:
    """702 = 2π · 100/√0.8 and 252 = 2π · 100/38.4^¼: (ωh)²/8 and (ωh)⁴/384 are 0.1."""
    (tmp_path / "a.csv").write_text("".join(f"{value:.6g}\n" for value in np.sin(np.arange(11.0))))
    (tmp_path / "a.toml").write_text(CASE.format(rate=rate, interpolation=interpolation))
    case = vibeam.load(tmp_path / "a.toml", {"drive.column": 1})
    found = list(overview_of_record({"it": MotionMaker(case, "it")}, 1).warnings())
    assert [each.partition(":")[0] for each in found if "samples" in each] == [f"the input has {each}" for each in said]
