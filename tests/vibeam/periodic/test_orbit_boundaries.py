"""Where branches of periodic motions end: closed forms, and the flight solver on both sides."""

from __future__ import annotations

import json
from dataclasses import replace
from math import cos, exp, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.periodic.bifurcation_functions import Kind
from vibeam.periodic.boundaries import Boundary, boundaries, on_nodes
from vibeam.periodic.orbit_search import orbits
from vibeam.system.impact_system import Drive, ImpactSystem

COCO = ImpactSystem.from_modes([1.0], 0.05, 1.0, 1.0, gap=1.0, restitution=0.8)
NOMINAL = ImpactSystem.from_modes([1.0], 0.015, 1.0, 1.0, restitution=0.9)
THREE = ImpactSystem.from_modes(
    [1.0, 5.3, 13.0], 0.02, [1.0, 1.5 / 5.3, -1.1 / 13], [1.0, 1 / 5.3, 1 / 13], gap=0.5, restitution=0.7
)
B = 0.5e-3


def only(found: tuple[Boundary, ...], kind: Kind, which: int = 0) -> Boundary:
    return [b for b in found if b.kind is kind and b.clear][which]


def test_kinds_of_boundaries_of_coco() -> None:
    assert {b.kind for b in boundaries(COCO, (0.01, 3.0), 1.0)} == {Kind.GRAZING, Kind.FOLD}


def test_a_fold_in_closed_form() -> None:
    """|H|² = Δ²κ²/(Ω²G₀² + κ²), by hand for one mode."""
    (fold,) = boundaries(COCO, (0.01, 3.0), 1.0, kinds=(Kind.FOLD,))
    beta, span, r = 0.05, 2 * pi, 0.8
    own = sqrt(1 - beta**2)
    e, c, s = exp(-beta * span), cos(own * span), sin(own * span) / own
    bottom = 1 - 2 * e * c + e * e
    g0, g1 = e * s / bottom, (1 - e * (c + beta * s)) / bottom
    kappa = r / (1 + r) - g1
    assert fold.amplitude / (2 * beta) == pytest.approx(abs(kappa) / sqrt(g0**2 + kappa**2), rel=1e-10)
    assert fold.multipliers[0] == pytest.approx(1.0, abs=1e-6)
    assert len(orbits(COCO, Drive(1.0, fold.amplitude * (1 + 1e-9)))) == 2
    assert len(orbits(COCO, Drive(1.0, fold.amplitude * (1 - 1e-9)))) == 0


@pytest.mark.parametrize("gap", [-0.5e-3, 0.0, 0.5e-3])
def test_period_doubling_of_one_mode(gap: float) -> None:
    """1 + tr J + det J = 0 with trace and determinant in closed form."""
    system = replace(NOMINAL, gap=gap)
    at = only(boundaries(system, B, (1.3, 3.0), points=201), Kind.DOUBLING, -1)
    beta, r, span, own = 0.015, 0.9, 2 * pi / at.omega, sqrt(1 - 0.015**2)

    def side(b: Boundary, omega: float) -> float:
        force = omega**2 * B * sin(b.phase)
        trace = exp(-beta * span) * (
            (1 + r) * (force - gap) * sin(own * span) / (own * b.velocity) - 2 * r * cos(own * span)
        )
        return 1 + trace + r**2 * exp(-2 * beta * span)

    assert side(at, at.omega) == pytest.approx(0, abs=1e-10)
    assert abs(side(at, at.omega * (1 + 1e-8))) > 1e-10
    before, after = (orbits(system, Drive(at.omega * (1 + d), B))[0].stable for d in (-1e-9, 1e-9))
    assert before
    assert not after


def test_the_flight_solver_doubles_there() -> None:
    at = only(boundaries(NOMINAL, B, (2.5, 2.8), points=31), Kind.DOUBLING)
    grid = at.omega * np.array([0.995, 1.005])
    found = vibeam.sweep(NOMINAL, omega=grid, amplitude=B, settle=1500, hold=40)
    assert isinstance(found, vibeam.FrequencyResponse)
    assert found.period[0] == 1
    assert found.period[1] != 1


def test_neimark_sacker_of_three_modes() -> None:
    found = [b for b in boundaries(THREE, 0.2, (1.2, 1.6), points=101) if b.kind is Kind.NEIMARK_SACKER]
    assert len(found) == 2
    for b, stable in zip(found, [(True, False), (False, True)], strict=True):
        assert abs(b.multipliers[0]) == pytest.approx(1, abs=1e-11)
        assert abs(b.multipliers[0].imag) > 0.1
        for side, expected in zip((-1, 1), stable, strict=True):
            assert orbits(THREE, Drive(b.omega * (1 + side * 1e-9), 0.2))[0].stable == expected


def test_a_second_touch() -> None:
    tight = replace(NOMINAL, gap=-0.5e-3)
    at = only(boundaries(tight, B, (1.7, 1.9), points=41), Kind.TOUCHING)
    sides = [orbits(tight, Drive(at.omega * (1 + d), B))[at.branch].admissible for d in (-1e-8, 1e-8)]
    assert sorted(sides) == [False, True]
    assert [orbits(tight, Drive(at.omega + d, B))[at.branch].admissible for d in (-0.05, 0.05)] == sides


def test_gap_and_amplitude_scale_together() -> None:
    """All lengths doubled is the same motion, so a boundary in the gap moves in proportion to the amplitude."""
    at = only(boundaries(NOMINAL, B, 2.4, gap=(-1e-3, 1e-3)), Kind.DOUBLING)
    twice = only(boundaries(NOMINAL, 2 * B, 2.4, gap=(-2e-3, 2e-3)), Kind.DOUBLING)
    assert twice.gap == pytest.approx(2 * at.gap, rel=1e-10)
    assert twice.phase == pytest.approx(at.phase, abs=1e-8)


def test_wrong_questions_are_named() -> None:
    with pytest.raises(ValueError, match="exactly one"):
        boundaries(NOMINAL, B, 2.0)
    with pytest.raises(ValueError, match="ascend"):
        boundaries(NOMINAL, B, (2.0, 1.0))


@pytest.mark.parametrize("points", [2, 3, 4, 5, 500, 501])
def test_a_boundary_on_a_place_that_is_looked_at_is_not_missed(points: int) -> None:
    """Without damping |H| = Ω²/(9 − Ω²) = 1/8 at Ω = 1 to the bit: the motion grazes at that gap."""
    system = ImpactSystem.from_modes([3.0], 0.0, 1.0, 1.0, restitution=0.5)
    (found,) = boundaries(system, 1.0, 1.0, gap=(0.0625, 0.1875), points=points, kinds=(Kind.GRAZING,))
    assert found.gap == pytest.approx(0.125, rel=1e-14)
    (found,) = boundaries(replace(system, gap=0.125), (1.0, 1.5), 1.0, points=points, kinds=(Kind.GRAZING,))
    assert found.amplitude == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize(
    ("values", "nodes"),
    [
        ([-1.0, 0.0, 2.0, 3.0], [1]),
        ([1.0, 0.0, 2.0], []),  # touches zero
        ([1.0, 0.0, np.nan], [1]),  # ends there
        ([0.0, 1.0, 0.0], [0, 2]),
        ([-1.0, 0.0, 0.0, 1.0], []),
        ([0.0, 0.0, 0.0], []),
        ([np.nan, 0.0, np.nan], []),
    ],
)
def test_a_zero_at_a_node_counts_where_the_function_passes_through_it_or_ends(
    values: list[float], nodes: list[int]
) -> None:
    assert on_nodes(np.array(values)).tolist() == nodes


RESULTS = Path(__file__).parents[2] / "benchmarks" / "results" / "lodz_rule.json"
FOUND: dict[str, Any] = json.loads(RESULTS.read_text())


def stable_share(p: float, q: float, periods: int) -> float:
    """Share of a few two-mode systems with a stable, admissible motion with one impact in ``periods``."""
    has = []
    for share in (0.2, 1.0):
        for restitution in (0.5, 0.9):
            for same in (True, False):
                for gap in (0.0, 0.5):
                    has.append(stable(p, q, periods, share, restitution, same, gap))
    return float(np.mean(has))


def stable(p: float, q: float, periods: int, share: float, restitution: float, same: bool, gap: float) -> bool:
    angle = np.arctan(np.sqrt(share))
    contact = np.array([np.cos(angle), np.sin(angle)])
    load = contact if same else np.array([-np.sin(angle), np.cos(angle)])
    natural = np.array([1.0, p * q])
    swing = abs(np.sum(contact * load * p**2 / (natural**2 - p**2 + 2j * 0.05 * natural * p)))
    system = vibeam.ImpactSystem.from_modes(natural, 0.05, contact, load, gap=gap * swing, restitution=restitution)
    found = vibeam.orbits(system, vibeam.Drive(p, 1.0), periods)
    return any(orbit.stable and orbit.admissible for orbit in found)


def committed(p: float, q: float, periods: int) -> float:
    ratios = FOUND["ratios"]
    return float(FOUND[f"one_impact_in_{periods}"][ratios.index(p)][ratios.index(q)])


def test_no_motion_with_one_impact_a_period_at_four_times_the_first_frequency() -> None:
    assert [stable_share(4.0, q, 1) for q in (2.0, 3.0, 4.5)] == [0.0] * 3
    assert all(share == 0.0 for share in FOUND["one_impact_in_1"][FOUND["ratios"].index(4.0)])
    assert min(stable_share(4.0, q, 2) for q in (2.0, 4.5)) > 0.2


@pytest.mark.parametrize("even", [2.0, 4.0])
def test_a_second_frequency_between_two_harmonics_is_better_than_on_one(even: float) -> None:
    assert stable_share(2.0, even + 0.5, 1) > stable_share(2.0, even, 1) + 0.2
    assert committed(2.0, even + 0.5, 1) > committed(2.0, even, 1) + 0.2


def test_even_multiples_are_no_better_than_odd_ones() -> None:
    for periods, p in ((1, 2.0), (2, 4.0)):
        assert max(committed(p, q, periods) for q in (3.0, 5.0)) > committed(p, 4.0, periods) - 0.01
    assert abs(stable_share(2.0, 4.0, 1) - stable_share(2.0, 5.0, 1)) < 0.15
