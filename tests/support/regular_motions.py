"""Motions that repeat or come to rest, of every law and regime that a page flies, and points of a curve."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import vibeam
from vibeam.flight.points.points import PlainPoints, PointSettings, compute
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution

DRIVE = vibeam.Drive(95.0, 2e-4)
TWO = vibeam.ImpactSystem.from_modes(
    [47.7, 635.0], 0.017, contact=[2.12, 0.31], load=[0.46, 0.09], gap=0.0, restitution=0.72
)
EIGHT = vibeam.ImpactSystem.from_modes(
    47.7 * np.arange(1, 9) ** 2, 0.01, contact=2.0 / np.arange(1, 9), load=0.5 / np.arange(1, 9), restitution=0.2
)
REGULAR = {
    "two modes": TWO,
    "eight modes": EIGHT,
    "chatter": replace(TWO, restitution=0.3, gap=-1e-5),
    "Hertz": replace(TWO, law=HuntCrossley(1e8)),
    "linear stop": replace(TWO, law=LinearStop(1e5, 3.0)),
    "two stops": replace(TWO, restitution=0.6, second_gap=1e-4),
    "coupled damping": replace(TWO, restitution=0.7, coupling=np.array([[1.6, -0.5], [-0.5, 21.6]])),
    "plastic": replace(TWO, law=PlasticRestitution(0.8, 0.01)),
}


def motion(system: vibeam.ImpactSystem) -> vibeam.Trajectory:
    return vibeam.simulate(replace(system), DRIVE, 0.6)


POINTS = PointSettings(settle=60, hold=20, output="contact", strobes=0, elastic=False, most_modes=2)


def points(system: vibeam.ImpactSystem, omega: np.ndarray) -> Any:
    one = np.ones(len(omega))
    given = PlainPoints([system], np.zeros(len(omega), int), omega, 2e-4 * one, 0.0 * one, 0.4 * one)
    [(_, found)] = compute(given, POINTS)
    return found.response


def fly_all() -> None:
    """Call every entry point that a page has."""
    for system in REGULAR.values():
        motion(system).modes_at([0.1, 0.3])
    points(TWO, np.linspace(70.0, 110.0, 5))
