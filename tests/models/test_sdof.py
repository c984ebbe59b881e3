from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import quad

from tests.models.bench import POINT_MASS, RIG, STEEL, deflection, with_effects
from vibeam_models.effects.masses import AddedMass
from vibeam_models.scene import Mass
from vibeam_models.sdof import sdof_model
from vibeam_models.static_shape import CantileverShape, FiniteElementShape
from vibeam_models.stop import Stop

EI = STEEL.bending_stiffness


def test_shape_at_the_mass_is_equation_44():
    exact = Fraction(2 * 132**3, 100**2 * (3 * 132 - 100))
    assert CantileverShape(STEEL, 0.132, 0.1).at(0.132) == pytest.approx(float(exact), rel=1e-14)


@pytest.mark.parametrize("x", [0.02, 0.1, 0.132, 0.15, 0.18])
@pytest.mark.parametrize("unit_at", [0.1, 0.16])
@pytest.mark.parametrize("kind", [CantileverShape, FiniteElementShape])
def test_shape_and_slope_are_the_static_deflection(kind, x, unit_at):
    def shape(at):
        return deflection(STEEL, at, 0.132) / deflection(STEEL, unit_at, 0.132)

    static = kind(STEEL, 0.132, unit_at)
    assert static.at(x) == pytest.approx(shape(x), rel=1e-9)
    step = 1e-6
    slope = (shape(x + step) - shape(x - step)) / (2 * step)
    assert static.slope(x) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("kind", [CantileverShape, FiniteElementShape])
def test_beam_mass_is_the_integral_of_the_squared_shape(kind):
    def squared(x):
        return STEEL.mass_per_length * (deflection(STEEL, x, 0.132) / deflection(STEEL, 0.1, 0.132)) ** 2

    expected = quad(squared, 0, 0.132, epsabs=0, epsrel=1e-12)[0] + quad(squared, 0.132, 0.18, epsabs=0)[0]
    assert kind(STEEL, 0.132, 0.1).beam_mass(STEEL) == pytest.approx(expected, rel=1e-9)


def test_frequency_is_that_of_a_point_mass_on_a_massless_beam():
    assert sdof_model(RIG).omega == pytest.approx(np.sqrt(3 * EI / (0.2 * 0.132**3)), rel=1e-13)


def test_damping_gap_and_restitution():
    model = sdof_model(replace(RIG, stop=Stop(0.132, 1e-4, 0.72)))
    assert model.damping_ratio == 0.017
    assert model.gap == pytest.approx(1e-4 / (1.5540324324324324 * 0.18))
    assert model.restitution == 0.72


def test_a_gap_measured_at_the_sensor_is_divided_by_the_length_alone():
    model = sdof_model(replace(RIG, stop=Stop(0.132, 1e-4, 0.72, gap_at="sensor")))
    assert model.gap == pytest.approx(1e-4 / 0.18, rel=1e-14)


def test_what_the_model_leaves_out_does_not_change_it():
    bare = POINT_MASS
    assert sdof_model(bare) == sdof_model(with_effects(RIG, AddedMass(0.1, 0.1)))


def test_gain_and_back():
    model = sdof_model(RIG)
    assert model.gain(model.base_per_volt(5.16e-4)) == pytest.approx(5.16e-4, rel=1e-14)


@pytest.mark.parametrize("ratio", [0.5, 1.7, 2.1])
def test_the_forced_response_in_si_is_the_nondimensional_one(ratio):
    """Undamped, linear: m ü + k u = m Ω² b at the mass, against q = Ω²B/(1 − Ω²)."""
    model = sdof_model(RIG)
    base, drive = 1e-4, ratio * model.omega
    stiffness = 3 * EI / 0.132**3
    at_mass = 0.2 * drive**2 * base / (stiffness - 0.2 * drive**2)
    at_sensor = at_mass * deflection(STEEL, 0.1, 0.132) / deflection(STEEL, 0.132, 0.132)
    scene = model.scene(base)
    q = ratio**2 * scene.amplitude / (scene.natural_frequency**2 - ratio**2)
    assert q * model.length == pytest.approx(at_sensor, rel=1e-12)


def test_a_mass_at_the_clamp_is_refused():
    with pytest.raises(ValueError, match="away from the clamp"):
        sdof_model(replace(RIG, mass=Mass(0.2, 0.0)))
