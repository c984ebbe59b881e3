"""Stiffness of a contact from radius and materials, and impacts of a free mass on it, against published numbers."""

from __future__ import annotations

from math import exp, log, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vibeam_models.laws.compliant import Hertz, HuntCrossley, LinearStop
from vibeam_models.laws.hertz import contact_modulus, contact_stiffness
from vibeam_models.laws.restitution import Restitution
from vibeam_models.laws.yielding import DampedContact, ElasticContact, LinearBodies

STEEL = (210e9, 0.3)


def test_two_equal_spheres_pressed_together() -> None:
    """code_aster SSNV104 (V6.04.104): R = 50 mm, E = 20 000 MPa, ν = 0.3, approach 4 mm: a = 10 mm, p₀ = 2798.3 MPa."""
    modulus, radius, depth = contact_modulus((20e9, 0.3), (20e9, 0.3)), 0.025, 0.004  # 1/R = 1/50 + 1/50
    force, wide = contact_stiffness("sphere", radius, modulus) * depth**1.5, sqrt(radius * depth)
    assert wide == pytest.approx(0.01, rel=1e-12)
    assert 3 * force / (2 * pi * wide**2) == pytest.approx(2798.3e6, rel=2e-5)


def test_a_sphere_pressed_against_a_rigid_flat() -> None:
    """Textbook problem: r = 8 mm, E = 1000 MPa, ν = 0.3, F = 30·2π N: a = 1.010 mm."""
    stiffness = contact_stiffness("sphere", 8e-3, contact_modulus((1e9, 0.3), (1e30, 0.3)))
    depth = (60 * pi / stiffness) ** (2 / 3)
    assert sqrt(8e-3 * depth) == pytest.approx(1.010e-3, rel=5e-4)


def test_a_rigid_punch_pushes_in_as_it_does_by_its_pressure() -> None:
    """Johnson (1985) eq. 3.36: u = π (1 − ν²) p₀ a/E under p = p₀ (1 − r²/a²)^−½, whose sum is 2π a² p₀."""
    pressure, radius = 1e6, 2e-3
    depth = pi * (1 - 0.3**2) * pressure * radius / 210e9
    stiffness = contact_stiffness("flat punch", radius, contact_modulus(STEEL, (1e30, 0.0)))
    assert stiffness * depth == pytest.approx(2 * pi * radius**2 * pressure, rel=1e-12)


def logarithmic(force: float, length: float, radius: float, deep: float) -> float:
    """Approach of a cylinder's axis to a point ``deep`` in the flat body: Johnson (1985) eq. 4.57 and 5.58."""
    line, half = force / length, sqrt(4 * force / length * radius / (pi * contact_modulus(STEEL, STEEL)))
    factor = line * (1 - STEEL[1] ** 2) / (pi * STEEL[0])
    return factor * (2 * log(4 * radius / half) - 1 + 2 * log(2 * deep / half) - STEEL[1] / (1 - STEEL[1]))


def test_palmgrens_roller() -> None:
    """3.84·10⁻⁵ Q^0.9/l^0.8 mm of steel rollers (his E is 207 GPa), and the logarithm to 40 % for 10 N to 10 kN."""
    stiffness = contact_stiffness("cylinder", 0.01, contact_modulus((207e9, 0.3), (207e9, 0.3)))
    for force in (100.0, 3000.0):
        approach = (force / stiffness) ** 0.9
        assert approach == pytest.approx(3.84e-8 * force**0.9 / 10**0.8, rel=5e-3)
    modulus = contact_modulus(STEEL, STEEL)
    ratios = [
        (force / contact_stiffness("cylinder", length, modulus)) ** 0.9 / logarithmic(force, length, radius, radius)
        for force in (10.0, 100.0, 1e3, 1e4) for length in (5e-3, 20e-3) for radius in (3e-3, 20e-3)
    ]  # fmt: skip
    assert 0.9 < min(ratios) < max(ratios) < 1.4


def test_laws_of_two_bodies() -> None:
    met = {"youngs_modulus": 210e9, "poissons_ratio": 0.3, "counterbody_youngs_modulus": 70e9}
    ratio = {"counterbody_poissons_ratio": 0.33}
    modulus = 1 / (0.91 / 210e9 + (1 - 0.33**2) / 70e9)
    found = ElasticContact(radius=5e-3, **met, **ratio).contact(2.0)
    assert found.stiffness == pytest.approx(4 / 3 * modulus * sqrt(5e-3), rel=1e-14)
    assert (found.damping, found.exponent) == (0.0, 1.5)
    assert ElasticContact(shape="cylinder", length=0.01, **met, **ratio).contact(2.0).exponent == 10 / 9
    damped = DampedContact(radius=5e-3, restitution=0.7, velocity=0.1, **met, **ratio).contact(2.0)
    assert damped == HuntCrossley.matched(found.stiffness, 0.7, 0.1)
    punch = LinearBodies(shape="flat punch", radius=5e-3, damping=3.0, **met, **ratio).contact(2.0)
    assert (punch.stiffness, punch.damping) == (pytest.approx(2 * modulus * 5e-3, rel=1e-14), 3.0)
    for wrong in (
        ElasticContact(**met, **ratio), ElasticContact(radius=5e-3, **met),
        ElasticContact(shape="flat punch", radius=5e-3, **met, **ratio), LinearBodies(radius=5e-3, **met, **ratio),
    ):  # fmt: skip
        with pytest.raises(ValueError, match="stop: "):
            wrong.contact(1.0)


STOPS = [
    LinearStop(2e5), LinearStop(2e5, 30.0), LinearStop(2e5, 300.0), LinearStop(2e5, 900.0), Hertz(1e9),
    HuntCrossley.matched(1e9, 0.72, 0.35), HuntCrossley.matched(1e8, 0.9999, 0.35, 10 / 9),
    HuntCrossley.matched(1e6, 0.4, 0.35, 1.0),
]  # fmt: skip


@pytest.mark.parametrize("stop", STOPS)
def test_an_impact_is_the_one_integrated(stop) -> None:
    """To 1e-7; the force is read at 2000 steps of the integration, so that its peak is missed by 1e-6."""
    mass, speed, power = 0.2, 0.35, getattr(stop, "exponent", 0.0)
    found = stop.free_impact(mass, speed)

    def force(d: float, v: float) -> float:
        if not power:
            return stop.stiffness * d + stop.damping * v
        return stop.stiffness * max(d, 0.0) ** power * (1 + stop.damping * v)

    def leaving(t, y):
        return 1.0 if t < 1e-3 * found.duration else y[0] if power else force(*y)

    def deepest(t, y):
        return y[1]

    leaving.terminal, leaving.direction = True, -1.0
    flown = solve_ivp(
        lambda t, y: [y[1], -force(*y) / mass], (0, 3 * found.duration), [0.0, speed], method="DOP853", rtol=1e-12,
        atol=1e-18, events=[leaving, deepest], max_step=found.duration / 2000,
    )  # fmt: skip
    assert found.duration == pytest.approx(flown.t_events[0][0], rel=1e-7)
    assert found.depth == pytest.approx(flown.y_events[1][0][0], rel=1e-9)
    assert found.restitution == pytest.approx(-flown.y_events[0][0][1] / speed, rel=1e-9)
    assert found.force == pytest.approx(max(force(*y) for y in flown.y.T), rel=1e-5)


def test_hertz_contact_time_has_its_known_factors() -> None:
    """t = 2.94 δ/v = 2.868 (m²/(R E*² v))^{1/5}: Johnson (1985) eq. 11.24."""
    modulus, radius, mass = contact_modulus(STEEL, STEEL), 5e-3, 0.02
    stop = Hertz(contact_stiffness("sphere", radius, modulus))
    for speed in (1e-3, 0.1, 2.0):
        found = stop.free_impact(mass, speed)
        assert found.duration * speed / found.depth == pytest.approx(2.943275, abs=1e-6)
        assert found.duration == pytest.approx(2.868 * (mass**2 / (radius * modulus**2 * speed)) ** 0.2, rel=2e-4)
        assert found.force == pytest.approx(stop.stiffness * found.depth**1.5, rel=1e-9)
        assert found.restitution == 1


def test_critical_damping_lies_between_its_neighbours_and_a_rigid_stop_has_no_time() -> None:
    below, at, above = (LinearStop(2e5, 2 * z * sqrt(2e5)).free_impact(1.0, 1.0) for z in (1 - 1e-6, 1.0, 1 + 1e-6))
    assert at.restitution == pytest.approx(exp(-2), rel=1e-15)
    for name in ("duration", "depth", "force", "restitution"):
        assert getattr(at, name) == pytest.approx(np.mean([getattr(below, name), getattr(above, name)]), rel=1e-9)
    with pytest.raises(ValueError, match="no contact time"):
        Restitution(0.5).free_impact(1.0, 1.0)
