"""Stops that yield and R(v), against the motions of a free mass integrated or solved by hand."""

from __future__ import annotations

from math import exp, log, pi, sqrt

import free_mass
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

from vibeam_models.laws.compliant import (
    Hertz,
    HuntCrossley,
    LinearStop,
    contact_damping_ratio,
    hunt_crossley_product,
    linear_restitution,
)
from vibeam_models.laws.mechanics import StopLaw
from vibeam_models.laws.restitution import PlasticRestitution, Restitution, TableRestitution, ViscousRestitution

MASS, SPEED = 0.2, 0.35


def rebound(force, speed: float = SPEED, end: float = 1.0) -> tuple[float, float]:
    """Time and velocity at which a free mass leaves a stop: where its force vanishes."""

    def leaving(t, y):
        return force(*y) if t > 0 else speed

    leaving.terminal, leaving.direction = True, -1.0
    start = [0.0, speed]
    found = solve_ivp(
        lambda t, y: [y[1], -max(force(*y), 0.0) / MASS], (0, end), start, method="DOP853", rtol=1e-12, atol=1e-15,
        events=leaving,
    )  # fmt: skip
    return float(found.t_events[0][0]), float(found.y_events[0][0][1])


@pytest.mark.parametrize("restitution", [0.05, exp(-2), 0.3, 0.72, 0.95])
def test_a_matched_linear_stop_gives_back_what_it_was_matched_to(restitution: float) -> None:
    stop = LinearStop.matched(2e5, restitution, MASS)
    time, velocity = rebound(lambda d, v: stop.stiffness * d + stop.damping * v)
    assert -velocity / SPEED == pytest.approx(restitution, rel=1e-9)
    assert free_mass.duration(stop, MASS) == pytest.approx(time, rel=1e-9)
    assert free_mass.restitution(stop, MASS) == pytest.approx(restitution, rel=1e-14)


def test_the_undamped_linear_stop_takes_half_a_period_and_no_energy() -> None:
    stop = LinearStop(2e5)
    assert free_mass.duration(stop, MASS) == pytest.approx(pi * sqrt(MASS / 2e5), rel=1e-15)
    assert free_mass.restitution(stop, MASS) == 1
    assert contact_damping_ratio(1.0) == pytest.approx(0, abs=1e-15)


def test_the_restitution_is_smooth_through_critical_damping() -> None:
    ratios = 1 + np.array([-2e-6, -1e-6, 0, 1e-6, 2e-6])
    steps = np.diff([linear_restitution(zeta) for zeta in ratios])
    assert np.ptp(steps) < 1e-4 * abs(steps[0])
    assert linear_restitution(1.0) == pytest.approx(exp(-2), rel=1e-15)


@pytest.mark.parametrize(("restitution", "exponent"), [(0.3, 1.5), (0.72, 1.5), (0.9, 1.0), (0.99, 2.0)])
def test_hunt_and_crossleys_loss_is_the_one_integrated(restitution: float, exponent: float) -> None:
    stop = HuntCrossley.matched(1e7, restitution, SPEED, exponent)
    x = stop.damping * SPEED
    assert x * (1 + restitution) == pytest.approx(log((1 + x) / (1 - x * restitution)), rel=1e-11)

    def force(d, v):
        return stop.stiffness * max(d, 0.0) ** exponent * (1 + stop.damping * v) if d > 0 else d

    _, velocity = rebound(force)
    assert -velocity / SPEED == pytest.approx(restitution, rel=1e-8)
    assert free_mass.given_back(stop, SPEED) == pytest.approx(restitution, rel=1e-13)
    assert free_mass.given_back(stop, 2 * SPEED) < restitution


def test_hunt_and_crossleys_product_goes_to_the_usual_approximation() -> None:
    """a v → 3 (1 − R) / 2 as R → 1 (Hunt & Crossley 1975), and no digits are lost on the way."""
    for loss in (1e-3, 1e-6, 1e-10):
        assert hunt_crossley_product(1 - loss) == pytest.approx(1.5 * loss, rel=2 * loss + 1e-6)


def test_hertz_penetrates_as_deep_as_the_energy_goes() -> None:
    deep = free_mass.depth(Hertz(1e9), MASS, SPEED)
    assert pytest.approx(1e9 * deep**2.5 / 2.5, rel=1e-14) == MASS * SPEED**2 / 2


def test_a_table_of_restitution_is_monotone_and_passes_through_its_points() -> None:
    law = TableRestitution((0.0, 0.02, 0.05, 0.2), (0.95, 0.9, 0.7, 0.5))
    assert [law.at(v) for v in law.speeds] == list(law.coefficients)
    assert (law.at(-1), law.at(5)) == (0.95, 0.5)
    grid = np.linspace(0, 0.2, 400)
    values = np.array([law.at(v) for v in grid])
    assert np.all(np.diff(values) <= 1e-15)
    inside = (grid >= 0.02) & (grid <= 0.05)  # between inner points: scipy's own monotone cubic
    assert values[inside] == pytest.approx(PchipInterpolator(law.speeds, law.coefficients)(grid)[inside], abs=1e-14)


def test_formulas_of_restitution() -> None:
    plastic = PlasticRestitution(0.6, 0.1)
    assert plastic.at(0.1) == pytest.approx(0.6, rel=1e-15)
    assert plastic.at(1.6) == pytest.approx(0.3, rel=1e-14)
    assert plastic.at(0.1 * 0.6**4 * 0.999) == 1
    viscous = ViscousRestitution(0.5, 0.2)
    assert viscous.at(1.0) == pytest.approx(0.5)
    assert (viscous.at(0.0), viscous.at(100.0)) == (1, 0)
    assert ViscousRestitution.matched(0.8, 0.1).at(0.1) == pytest.approx(0.8, rel=1e-15)


RIGID = [
    Restitution(0.7), TableRestitution((0.05, 0.3, 2.0), (0.9, 0.6, 0.5)), TableRestitution((0.0, 1.0), (0.3, 0.8)),
    PlasticRestitution(0.7, 0.2), ViscousRestitution(0.6), ViscousRestitution(2.0, 0.5),
]  # fmt: skip


@pytest.mark.parametrize("law", RIGID)
def test_many_impacts_at_once_are_those_one_by_one(law: StopLaw) -> None:
    speeds = np.concatenate([[0.0, 0.05, 0.3, 1.0, 2.0], np.geomspace(1e-9, 1e3, 200)])
    np.testing.assert_allclose(law.rebound(speeds), [law.at(v) * v for v in speeds], rtol=1e-14)
    low, high = law.coefficients_up_to(speeds)
    seen = np.array([law.at(v) for v in speeds])
    assert np.all((seen <= high) & ((low <= seen) | (low == 1)))  # least 1 where nothing is known
    inside, step = speeds[(speeds > 1e-3) & (speeds < 0.29)], 1e-6
    slope = (law.rebound(inside + step) - law.rebound(inside - step)) / (2 * step)
    np.testing.assert_allclose(law.rebound_slope(inside), slope, rtol=1e-5, atol=1e-6)


def test_a_capability_that_a_law_lacks_is_refused_by_its_name() -> None:
    asked = {
        lambda: LinearStop(1.0).at(1.0): '"linear" has no coefficient of restitution',
        lambda: Hertz(1.0).rebound_slope(np.ones(1)): '"hertz" has no derivative',
        lambda: Restitution(0.5).force(np.ones(1), np.ones(1)): '"restitution" has no contact force',
        lambda: ViscousRestitution(0.1).balance(1.0, 1.0): '"viscous restitution" has no static contact force',
        lambda: Hertz(1.0).in_series(1.0): 'the law "hertz" in series with a spring has no closed form',
        lambda: Restitution(0.5).in_series(1.0): "its mobility is infinite",
        lambda: LinearStop(1.0, 1.0).in_series(1.0): "a damper behind a contact without mass",
    }
    for call, said in asked.items():
        with pytest.raises(ValueError, match=said):
            call()
    assert LinearStop(2.0).in_series(0.5) == LinearStop(1.0)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: LinearStop(0),
        lambda: LinearStop(1, -1),
        lambda: LinearStop.matched(1e5, 0.0, 1.0),
        lambda: HuntCrossley(1e5, 0, 0.5),
        lambda: HuntCrossley.matched(1e5, 0.0, 1.0),
        lambda: HuntCrossley.matched(1e5, 0.5, 0.0),
        lambda: TableRestitution((0.1, 0.1), (0.5, 0.5)),
        lambda: TableRestitution((0.1,), (0.5,)),
        lambda: TableRestitution((0.1, 0.2), (0.5, 1.5)),
        lambda: PlasticRestitution(0, 1),
        lambda: ViscousRestitution(-1),
    ],
)
def test_what_makes_no_sense_is_refused(wrong) -> None:
    with pytest.raises(ValueError, match=r"stop|restitution"):
        wrong()
