"""A plan moved to another gap is the plan made at that gap: constants in proportion, all else the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vibeam.flight.kernels import layout
from vibeam.flight.linear.over_gap import PlanOverGap
from vibeam.flight.linear.regimes import plan
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

COUPLED = np.array([[0.9, 0.2, 0.0], [0.2, 3.0, 0.4], [0.0, 0.4, 8.0]])
BASE = ImpactSystem.from_modes(
    [40.0, 260.0, 700.0], 0.01, [1.3, -0.4, 0.8], [0.6, 0.2, -0.1], gap=1e-4, restitution=0.7, static=[-0.3, 0.2, 0.1]
)
SYSTEMS = {
    "plain": BASE,
    "coupled": replace(BASE, coupling=COUPLED),
    "two hard stops": replace(BASE, second_gap=3e-4),
    "linear": replace(BASE, law=LinearStop(4e4, 3.0)),
    "two linear stops, coupled": replace(BASE, law=LinearStop(4e4), second_gap=2e-4, coupling=COUPLED),
    "integrated": replace(BASE, law=HuntCrossley(1e7, 0.5)),
}
EPSILON = 2.0**-52


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("more", [0.0, 7e-5, -9e-5, 1e-2])
def test_constants_go_with_the_gap(name: str, more: float) -> None:
    """To a few roundings of the parts: the plan sums them in another order. At the system's own gap to the bit."""
    system = SYSTEMS[name]
    over, there = PlanOverGap.of(system), plan(replace(system, gap=system.gap + more), 30.0)
    pairs = [(over.free, there.free), (over.upper, there.upper)]
    pairs += [] if over.lower is None else [(over.lower, there.lower)]
    assert (over.lower is None) == (system.second_gap is None)
    for own, made in pairs:
        rows = [layout.CONSTANT1, layout.CONSTANT2]
        for known, share, wanted in (
            (own.regime.blocks[rows], own.constants, made.blocks[rows]),
            (own.regime.held, own.held, made.held),
            (own.regime.signals[:, -2], own.signals, made.signals[:, -2]),
        ):
            finite = np.isfinite(known)
            size = np.max(np.abs(known[finite]), initial=0.0) + np.max(np.abs(share), initial=0.0) * (abs(more) + 3e-4)
            assert np.array_equal(np.isfinite(wanted), finite)
            away = np.abs(known[finite] + more * share[finite] - wanted[finite])
            assert np.all(away <= (8 * EPSILON * size if more else 0.0))
        for name in ("into", "outof", "pairs"):
            assert np.array_equal(getattr(own.regime, name), getattr(made, name))
        assert np.array_equal(own.regime.signals[:, :-2], made.signals[:, :-2])
        assert np.array_equal(np.delete(own.regime.blocks, rows, axis=0), np.delete(made.blocks, rows, axis=0))
