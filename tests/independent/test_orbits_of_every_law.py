"""Periodic motions of every law against ``orbits.json``, found by a second program (``shooting.py``)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

TRUTH: dict[str, Any] = json.loads(Path(__file__).with_name("orbits.json").read_text(encoding="utf-8"))
NAMES = pytest.mark.parametrize("name", TRUTH)


def system_of(rig: dict[str, Any]) -> vibeam.ImpactSystem:
    """The rig as vibeam has it."""
    kind, *numbers = rig["law"]
    stop: dict[str, Any] = {"restitution": numbers[0]}
    if kind == "linear":
        stop = {"restitution": 1.0, "law": LinearStop(*numbers)}
    elif kind == "power":
        stop = {"restitution": 1.0, "law": HuntCrossley(numbers[0], numbers[2], numbers[1])}
    rows = {name: np.array(rig[name]) for name in ("omega", "zeta", "contact", "load", "static")}
    return vibeam.ImpactSystem(**rows, gap=rig["gap"], second_gap=rig.get("second_gap"), **stop)


def orbit_of(name: str, off: float) -> vibeam.Orbit:
    """The orbit that shooting finds from a start that is ``off`` by that share."""
    truth = TRUTH[name]
    state = np.array([float(each) for each in truth["state"]])
    n = len(state) // 2
    moved = state * (1 + off * np.cos(np.arange(2 * n)))
    omega, base = truth["rig"]["drive"]
    (found,) = vibeam.orbits(
        system_of(truth["rig"]),
        vibeam.Drive(omega, base),
        1,
        start=vibeam.State(moved[:n], moved[n:]),
        time=truth["rig"]["phase"] * 2 * np.pi / omega,
    )
    return found


@NAMES
def test_impacts_are_those_of_the_second_program(name: str) -> None:
    orbit, truth = orbit_of(name, 1e-3), TRUTH[name]
    span = orbit.span
    expected = np.array([[float(each) for each in row] for row in truth["impacts"]])
    impacts = [np.array(sorted(zip(np.mod(times, span), speeds, strict=True))) for times, speeds in (
        (orbit.times, orbit.velocities), expected.T,
    )]  # fmt: skip
    np.testing.assert_allclose(impacts[0], impacts[1], rtol=1e-10)


@NAMES
def test_multipliers_are_those_of_the_second_program(name: str) -> None:
    orbit, truth = orbit_of(name, 1e-3), TRUTH[name]
    expected = np.array([complex(float(a), float(b)) for a, b in truth["multipliers"]])
    left = list(expected)
    for value in orbit.multipliers:  # a pair may stand in either order
        nearest = int(np.argmin(np.abs(np.array(left) - value)))
        assert abs(left.pop(nearest) - value) < 1e-8 * np.abs(expected).max()
    assert orbit.stable == (np.abs(expected).max() < 1)
