from dataclasses import replace

import numpy as np
import pytest
from refusals import other_answers
from scipy.linalg import eigh

from tests.models.bench import POINT_MASS, RIG, STEEL, cantilever_omega, deflection, with_effects
from vibeam_models.beam import assemble, assemble_with_space
from vibeam_models.effects.masses import AddedMass
from vibeam_models.scene import Mass, Sensor
from vibeam_models.space import bare_beam
from vibeam_models.stop import Stop

FOUR = cantilever_omega(STEEL, 4)


def omega(elements, count=4):
    return bare_beam(replace(STEEL, elements=elements))[0].modes(count).omega


def lumped_omega(elements):
    structure = bare_beam(replace(STEEL, elements=elements))[0]
    h = STEEL.length / elements
    masses = STEEL.mass_per_length * np.tile([h, h**3 / 12], elements)
    masses[-2:] /= 2
    return np.sqrt(eigh(structure.K, np.diag(masses), eigvals_only=True)[:4])


def orders(computed, meshes):
    errors = np.array([np.abs(computed(n) / FOUR - 1) for n in meshes])
    return np.log(errors[:-1] / errors[1:]) / np.log(meshes[1] / meshes[0])


def test_first_four_frequencies_of_a_cantilever():
    np.testing.assert_allclose(omega(72), FOUR, rtol=1e-6)


def test_a_coarse_mesh_misses_that_tolerance():
    assert np.max(np.abs(omega(12) / FOUR - 1)) > 1e-5


def test_frequencies_converge_with_order_four():
    observed = orders(omega, [7, 14, 28])
    print("observed orders, rows 7→14 and 14→28 elements, columns modes 1 to 4:\n", np.round(observed, 3))
    assert np.all((observed > 3.8) & (observed < 4.2)), observed


def test_lumped_mass_would_fail_that_order():
    assert not np.any(orders(lumped_omega, [7, 14, 28]) > 3.8)


def test_frequencies_come_from_above():
    assert np.all(omega(14) > FOUR)


def test_every_mesh_has_an_element_of_its_own():
    first = bare_beam(replace(STEEL, elements=8))[0]
    bare_beam(replace(STEEL, elements=16))
    again = bare_beam(replace(STEEL, elements=8))[0]
    assert np.array_equal(first.K, again.K)
    assert np.array_equal(first.M, again.M)


@pytest.mark.parametrize("at", [0.18, 0.132, 0.0713])
def test_static_deflection_at_and_between_nodes(at):
    structure, space = bare_beam(STEEL, [at])
    x = np.array([0.0011, 0.05, 0.0707, 0.0999, 0.1317, 0.132, 0.1777, 0.18])
    found = space.rows(x) @ np.linalg.solve(structure.K, space.row(at))
    np.testing.assert_allclose(found, deflection(STEEL, x, at), rtol=1e-9)


def test_static_deflection_is_wrong_by_more_without_a_node_under_the_load():
    structure, space = bare_beam(replace(STEEL, elements=4))
    at = 0.0713
    found = space.row(at) @ np.linalg.solve(structure.K, space.row(at))
    assert abs(found / deflection(STEEL, at, at) - 1) > 1e-4


def test_tip_under_a_steady_base_acceleration():
    structure, _ = bare_beam(STEEL)
    weight = STEEL.mass_per_length * STEEL.length**4 / (8 * STEEL.bending_stiffness)
    assert structure.contact @ np.linalg.solve(structure.K, structure.load) == pytest.approx(-weight, rel=1e-9)


def test_the_attached_mass_shares_in_the_base_load():
    bench = replace(POINT_MASS, beam=replace(STEEL, density=1e-6))
    structure = assemble(bench)
    hanging = 0.2 * deflection(STEEL, 0.1, 0.132)
    assert structure.outputs["sensor"] @ np.linalg.solve(structure.K, structure.load) == pytest.approx(
        -hanging, rel=1e-8
    )


def test_a_point_mass_on_a_nearly_massless_beam():
    light = replace(POINT_MASS, beam=replace(STEEL, density=7850e-9))
    expected = np.sqrt(3 * STEEL.bending_stiffness / (0.2 * 0.132**3))
    assert assemble(light).modes(1).omega[0] == pytest.approx(expected, rel=1e-7)
    assert assemble(replace(light, beam=STEEL)).modes(1).omega[0] < 0.97 * expected


def test_rows_read_a_cubic_anywhere():
    _, space = bare_beam(STEEL, [0.132])
    x = space.nodes[1:]
    coordinates = np.column_stack([2 * x**2 - 3 * x**3, 4 * x - 9 * x**2]).ravel()
    at = np.array([0.0, 1e-5, 0.0333, 0.0817, 0.132, 0.15001, 0.18])
    np.testing.assert_allclose(space.rows(at) @ coordinates, 2 * at**2 - 3 * at**3, atol=1e-11)
    np.testing.assert_allclose(space.rows(at, 1) @ coordinates, 4 * at - 9 * at**2, atol=1e-8)
    assert np.array_equal(space.row(0.0817), space.rows([0.0817])[0])


def test_rows_refuse_what_is_off_the_beam():
    _, space = bare_beam(STEEL)
    with pytest.raises(ValueError, match="positions must lie"):
        space.row(0.181)
    with pytest.raises(ValueError, match="beam elements offer"):
        space.row(0.1, 3)


def test_the_reference_beam_of_the_rig():
    frequencies = assemble(RIG).modes(2).frequency
    assert round(frequencies[0], 2) == 7.60
    assert round(frequencies[1], 1) == 101.1


def test_the_rig_in_the_hammer_test_carries_its_accelerometer():
    hammered = with_effects(RIG, AddedMass(0.0024, 0.09))
    assert round(assemble(hammered).modes(2).frequency[1], 2) == 98.75


def test_the_rig_under_a_point_mass():
    """Neither rotary inertia nor rigid zone, with the accelerometer: "bending 2" goes to 151 Hz."""
    bench = with_effects(POINT_MASS, AddedMass(0.0024, 0.09))
    assert round(assemble(bench).modes(2).frequency[1]) == 151


def test_outputs_and_units():
    structure, space = assemble_with_space(RIG)
    assert set(structure.outputs) == {"sensor", "tip"}
    assert set(structure.units.values()) == {"m"}
    np.testing.assert_array_equal(structure.outputs["sensor"], space.row(0.1))
    np.testing.assert_array_equal(structure.outputs["tip"], space.row(0.18))
    np.testing.assert_array_equal(structure.contact, space.row(0.132))


def test_positions_off_the_beam_are_named():
    off = {"mass": Mass(0.2, 0.19), "stop": Stop(0.0, 0.0, 1.0), "sensor": Sensor(-0.1)}
    wrong = {rf"{name}\.position": {name: part} for name, part in off.items()}
    assert other_answers(lambda change: assemble(replace(RIG, **change)), wrong) == []
