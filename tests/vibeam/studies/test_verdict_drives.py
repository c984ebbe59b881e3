"""Fidelity map under any drive: axis in its unit, exact boundaries whose drive changes with the frequency, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from stand_in import RIG, one_mode

import vibeam
from vibeam.case.case import Case
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError
from vibeam.studies.verdict.axes import exact_boundaries, second_axis
from vibeam.studies.verdict.planes import plane_of

GRID = '{ from = "1.9 rad/s", to = "2.9 rad/s", points = 5 }'
RANGES = {"stop.restitution": (0.85, 0.95), "stop.gap": (0.1e-3, 0.3e-3)}
TEXT = one_mode(GRID, 20, 5, "[fidelity.one]", "[fidelity.other]", gap=0.2e-3)


def driven(**drive: Any) -> Case:
    return parse(TEXT, "mine.toml", set={"drive": drive})


@pytest.mark.parametrize("key", ["stop.restitution", "drive.acceleration", "stop.gap"])
def test_boundaries_under_an_acceleration_are_those_of_its_amplitude_at_each_frequency(key: str) -> None:
    """B = A/Ω²: at each place of a curve one over the amplitude, the frequency held, has that amplitude."""
    case, ends = driven(acceleration=2e-3), RANGES.get(key, (None, None))
    axis = second_axis(case, key, *ends, 3, case.system("one"))
    hertz = np.linspace(case.sweep.frequency.min(), case.sweep.frequency.max(), 31)
    points = plane_of(case, "one", axis, hertz, "amplitude").points
    curves = [each for each in exact_boundaries(case, "one", points, axis, hertz) if each.boundary == "period doubling"]
    places = [place for each in curves for place in zip(each.frequency, each.value, strict=True)]
    assert len(places) >= 3
    for frequency, value in places:
        omega, own = 2 * np.pi * frequency, parse(TEXT, set={"drive": {"acceleration": 2e-3}} | {key: float(value)})
        level = value if key == "drive.acceleration" else 2e-3
        held = vibeam.boundaries(own.system("one"), (2e-5, 3e-3), omega, kinds=(vibeam.Kind.DOUBLING,))
        assert min(abs(each.amplitude * omega**2 / level - 1) for each in held) < 1e-7


def test_a_drive_s_range_is_written_in_its_unit() -> None:
    beam = vibeam.load(RIG, set={"drive": {"acceleration": "0.05 g"}})
    axis = second_axis(beam, "drive.acceleration", "0.01 g", "1 m/s^2", 3, beam.system("sdof"))
    assert (axis.name, axis.unit) == ("base acceleration", "m/s^2")
    np.testing.assert_allclose(axis.values[[0, -1]], [0.0980665, 1.0])


@pytest.mark.parametrize(
    ("drive", "told"),
    [
        ({"amplitude": 1e-3, "harmonic": [2], "harmonic_share": [0.1]},
         "--set drive.harmonic: a fidelity map knows a drive of one harmonic: take drive.harmonic away"),
        ({"amplitude": [1e-3, 2e-3], "frequency": ["1.9 rad/s", "2.9 rad/s"]},
         "--set drive.amplitude: is a list over frequency, which has no one level to vary: write one number, "
         "or vibeam stability"),
    ],
)  # fmt: skip
def test_what_no_map_knows_is_told_at_its_key(drive: dict[str, Any], told: str) -> None:
    case = parse(TEXT, set={"drive": drive, "fidelity.other.set": {"stop.restitution": 0.8}})
    with pytest.raises(CaseError) as caught:
        vibeam.verdict(case, "frequency,drive", fidelities=("one", "other"), points=2, frequencies=2)
    assert str(caught.value) == told
