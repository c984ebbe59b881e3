"""Periodic motions of random systems of every kind: flown, each comes back; multipliers and stability agree."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.periodic.stroboscopic import StroboscopicMap
from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop

KINDS = ("hard", "linear", "hertz", "hunt-crossley", "two stops", "several contacts", "coupled")


def system(kind: str, seed: int) -> tuple[vibeam.ImpactSystem, vibeam.Drive]:
    """A system of 1 to 5 modes, its scales of time and length random over five decades, some with static forces."""
    rng = np.random.default_rng(seed)
    n, rate, base = int(rng.integers(1, 6)), 10 ** rng.uniform(-1, 4), 10 ** rng.uniform(-6, 0)
    omega = np.concatenate([[1.0], 1 + np.cumsum(rng.uniform(0.5, 4, n - 1))]) * rate
    contact = rng.choice([-1, 1], n) * rng.uniform(0.3, 1, n)
    stiff, more = rate**2 / (contact @ contact) * 10 ** rng.uniform(1, 4), dict[str, Any]()
    laws = {
        "linear": LinearStop(stiff, 0.3 * rate / (contact @ contact)), "hertz": Hertz(stiff / np.sqrt(base)),
        "hunt-crossley": HuntCrossley(stiff / np.sqrt(base), 0.2 / (rate * base)),
    }  # fmt: skip
    gap, damping = base * rng.uniform(0, 3), rng.uniform(0.005, 0.1, n)
    if kind == "two stops":
        more = {"second_gap": base * rng.uniform(0.5, 3)}
    elif kind == "several contacts":
        more = {"further": [vibeam.Contact(rng.normal(size=n), base * rng.uniform(0.2, 3), 0.6)]}
    elif kind == "coupled":
        more = {"coupling": np.diag(2 * damping * omega) + 0.01 * rate}
    made = vibeam.ImpactSystem.from_modes(
        omega, damping, contact, rng.normal(size=n), gap=gap, restitution=rng.uniform(0.2, 0.8),
        law=laws.get(kind), static=rng.normal(size=n) * base * rate**2 * 0.2, **more,
    )  # fmt: skip
    return made, vibeam.Drive(rate * rng.uniform(0.5, 3), base)


@pytest.mark.parametrize("kind", KINDS)
def test_motions_come_back(kind: str) -> None:
    """To 1e-9 of the motion's size, an integrated contact's error grown by multipliers among it."""
    seen = 0
    for seed in range(6):
        own, drive = system(kind, seed)
        starts = {"start": vibeam.State(np.zeros(own.size), np.zeros(own.size))} if not own.beyond_plain else {}
        try:
            found = vibeam.orbits(own, drive, **starts)
        except vibeam.NoOrbit:
            continue
        for orbit in found:
            section, after = StroboscopicMap(own, drive, orbit.time), orbit.path()
            size = section.size(section.flown(orbit.state, 1))
            assert orbit.residual < 1e-9
            assert np.linalg.norm(section.vector(after.state) - section.vector(orbit.state)) < 1e-9 * size
            assert len(after.impact_times) == len(orbit.times)
            assert orbit.stable == (np.abs(orbit.multipliers[0]) < 1)
            assert np.isfinite([orbit.amplitude(), orbit.reach]).all()
            seen += 1
    assert seen >= 3
