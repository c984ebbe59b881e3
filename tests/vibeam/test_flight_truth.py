"""The flight solver against stored arbitrary-precision truth (``tests/independent/make_truth.py`` remakes it)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam

TRUTH = json.loads((Path(__file__).parent.parent / "independent" / "truth.json").read_text())
NAMES = {kind: [entry["name"] for entry in TRUTH[kind]] for kind in ("systems", "grazing", "chatter")}


def entry(kind: str, name: str) -> dict[str, Any]:
    return next(e for e in TRUTH[kind] if e["name"] == name)


def system_of(e: dict[str, Any]) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        e["omega"],
        e["zeta"],
        e["contact"],
        e["load"],
        gap=e["gap"],
        restitution=e["restitution"],
        static=e["static"],
    )


def start_of(e: dict[str, Any]) -> vibeam.State:
    return vibeam.State(np.array(e["start"]["displacement"]), np.array(e["start"]["velocity"]))


def drive_of(e: dict[str, Any]) -> vibeam.Drive:
    return vibeam.Drive(e["drive"]["omega"], e["drive"]["amplitude"])


def run(e: dict[str, Any], t_end: float) -> Any:
    return vibeam.simulate(system_of(e), drive_of(e), t_end, start_of(e))


@pytest.mark.parametrize("name", NAMES["systems"])
def test_fifty_impacts_of_random_systems(name: str) -> None:
    e = entry("systems", name)
    times, speeds = np.array(e["times"], dtype=float), np.array(e["velocities"], dtype=float)
    path = run(e, times[-1] * (1 + 1e-9))
    assert len(path.impact_times) == len(times)
    bar = 1e-10 * max(1.0, e["amplification"] / 100)
    np.testing.assert_allclose(path.impact_times, times, rtol=bar)
    np.testing.assert_allclose(path.impact_velocities, speeds, rtol=bar, atol=bar * speeds.max())
