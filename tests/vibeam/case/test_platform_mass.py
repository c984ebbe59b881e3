"""Bounds that measured frequencies set to the platform's mass, as cases/experiment says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import vibeam

CASE = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"
ACCELEROMETER = {"added_mass": [{"mass": "2.4 g", "position": "90 mm"}]}
PLATFORM = 2 * np.pi * 3.25


def upper(platform: float, **settings: object) -> float:
    """Upper frequency in Hz of mode 1 on a free platform of a mass in kg whose lower one is 3.25 Hz.

    (ω₁² − ω²)(k − Mω²) = Γ²ω⁴: the spring k from the lower root, then the larger root of the quadratic in ω².
    """
    case = vibeam.load(CASE, set=settings)
    beam = case.system("beam")
    own, effective = float(beam.omega[0]) ** 2, float(beam.load[0]) ** 2
    mass, low = platform + case.scene.moving_mass, PLATFORM**2
    spring = mass * low + effective * low**2 / (own - low)
    roots = np.roots([mass - effective, -(own * mass + spring), own * spring])
    assert roots.min() == pytest.approx(low)
    return float(np.sqrt(roots.max())) / (2 * np.pi)


@pytest.mark.parametrize(
    ("frequency", "mass", "settings"),
    [(8.125, 1.8, ACCELEROMETER), (7.875, 3.4, ACCELEROMETER), (7.875, 3.5, {}), (7.625, 35.4, {}), (7.65, 18.7, {})],
)
def test_a_frequency_bounds_the_platforms_mass(frequency: float, mass: float, settings: dict[str, object]) -> None:
    assert brentq(lambda each: upper(each, **settings) - frequency, 1.0, 100.0, xtol=1e-3) == pytest.approx(
        mass, abs=0.05
    )


def test_the_case_has_the_same_frequencies() -> None:
    case = vibeam.load(CASE.parent / "experiment" / "fig28_mass.toml")
    for name, mass in (("hammer_2", 2.0), ("hammer_5", 5.0), ("hammer_20", 20.0)):
        found = np.sort(case.system(name).omega)[:2] / (2 * np.pi)
        assert found == pytest.approx([3.25, upper(mass, **ACCELEROMETER)], abs=2e-3)
