"""The platform: in absolute coordinates, by momentum, as a filter, and where it is too heavy to be moved."""

import numpy as np
import pytest

from tests.models.bench import RIG, STEEL, with_effects
from vibeam_models.beam import assemble
from vibeam_models.effects.masses import AddedMass
from vibeam_models.effects.platform import MovingPlatform, PlatformFilter
from vibeam_models.space import bare_beam
from vibeam_models.structure import Structure

DAMPING, STIFFNESS = 7.0, 2085.0
OMEGA = 2 * np.pi * np.array([2.0, 3.25, 7.6, 15.5, 101.0])


def answer(structure, force, omega):
    """Complex coordinates (points, n) under ``force`` (n,), each scaled by its mass before the solution."""
    scale = 1 / np.sqrt(np.diag(structure.M))
    M, C, K = (matrix * np.outer(scale, scale) for matrix in (structure.M, structure.C, structure.K))
    dynamic = [K + 1j * w * C - w**2 * M for w in omega]
    return scale * np.array([np.linalg.solve(matrix, (scale * force).astype(complex)) for matrix in dynamic])


def one_mass(m, c, k):
    row = np.array([1.0])
    return Structure(*(np.array([[value]]) for value in (m, c, k)), -m * row, 0 * row, row, {"sensor": row}, {})


def test_two_masses_by_hand():
    """m ÿ + c(ẏ − ḃ) + k(y − b) = 0 and m_p b̈ + c_p ḃ + k_p b = c(ẏ − ḃ) + k(y − b), with y = b + x."""
    m, c, k, platform = 0.2, 0.3, 450.0, 5.0
    structure = MovingPlatform(platform, DAMPING, STIFFNESS, m).under(one_mass(m, c, k))
    absolute = np.array([[1.0, 1.0], [0.0, 1.0]])  # y and b by x and b
    masses = np.diag([m, platform])
    dampers = np.array([[c, -c], [-c, c + DAMPING]])
    springs = np.array([[k, -k], [-k, k + STIFFNESS]])
    for found, by_hand in ((structure.M, masses), (structure.C, dampers), (structure.K, springs)):
        np.testing.assert_allclose(found, absolute.T @ by_hand @ absolute, rtol=1e-14, atol=1e-12)
    assert np.array_equal(structure.contact, [1.0, 0.0])
    assert np.array_equal(structure.load, [0.0, -platform])
    assert np.array_equal(structure.outputs["platform"], [0.0, 1.0])


def test_the_beam_in_absolute_coordinates():
    """A beam whose foot is free to move but not to turn, with the platform's mass and spring at that foot."""
    bare, space = bare_beam(STEEL)
    carried = STEEL.mass_per_length * STEEL.length
    moved = MovingPlatform(0.4, 0.0, STIFFNESS, carried).under(bare)
    kept = np.r_[0, 2 : 2 * len(space.nodes)]
    M, K = (matrix[np.ix_(kept, kept)] for matrix in (
        space.elements.mass(STEEL.mass_per_length), space.elements.stiffness(STEEL.bending_stiffness)
    ))  # fmt: skip
    M[0, 0] += 0.4
    K[0, 0] += STIFFNESS
    absolute = Structure(M, 0 * M, K, M[0], 0 * M[0], M[0], {}, {})
    force = np.zeros(len(kept))
    force[0] = 1.0
    whole = answer(absolute, force, OMEGA)
    relative = answer(moved, -moved.load / 0.4, OMEGA)
    np.testing.assert_allclose(relative[:, -1], whole[:, 0], rtol=1e-8)
    tip = space.row(STEEL.length)
    np.testing.assert_allclose(relative[:, :-1] @ tip, whole[:, 1:] @ tip - whole[:, 0], rtol=1e-7)


def test_an_impact_keeps_all_momentum():
    structure = MovingPlatform(5.0, DAMPING, STIFFNESS, RIG.moving_mass).under(assemble(RIG))
    jump = np.linalg.solve(structure.M, structure.contact)
    momentum = structure.M[-1] @ jump  # of all masses: the last row sums up what moves with the platform and on it
    assert abs(momentum) < 1e-12
    assert jump[-1] < 0  # the beam bounces off, the platform the other way
    still = assemble(RIG)
    assert structure.contact @ jump > still.mobility(still.contact)


def test_the_carried_mass_is_that_of_all_that_moves():
    """In relative coordinates the load of a rigid motion: the beam, its mass and its accelerometer."""
    scene = with_effects(RIG, AddedMass(0.0024, 0.09))
    assert scene.moving_mass == pytest.approx(0.2 + 0.0024 + 7850 * 0.18 * 0.02 * 1.034e-3, rel=1e-14)


def test_a_platform_too_heavy_to_be_moved_is_a_prescribed_base():
    still = assemble(RIG)
    natural, ratio, heavy = 2 * np.pi * 3.25, 0.05, 1e12
    damping, stiffness = 2 * ratio * natural * heavy, natural**2 * heavy
    moved = MovingPlatform(heavy, damping, stiffness, RIG.moving_mass).under(still)
    base = PlatformFilter(heavy, damping, stiffness).base_per_input(OMEGA) * heavy  # under F = m_p
    two_way = answer(moved, -moved.load, OMEGA)
    prescribed = answer(still, -still.load, OMEGA) * (base * OMEGA**2)[:, None]
    for row in (still.outputs["sensor"], still.contact):
        np.testing.assert_allclose(two_way[:, :-1] @ row, prescribed @ row, rtol=1e-9)
    np.testing.assert_allclose(two_way[:, -1], base, rtol=1e-9)
    mobility = [each.mobility(each.contact) for each in (moved, still)]
    assert mobility[0] == pytest.approx(mobility[1], rel=1e-9)


def test_a_light_platform_is_no_prescribed_base():
    still = assemble(RIG)
    moved = MovingPlatform(5.0, DAMPING, STIFFNESS, RIG.moving_mass).under(still)
    two_way = answer(moved, -moved.load, OMEGA)[:, -1]
    alone = 5.0 * PlatformFilter(5.0, DAMPING, STIFFNESS).base_per_input(OMEGA)
    assert np.all(np.abs(two_way / alone - 1) > 1e-3)


def test_the_platform_of_the_rig_lies_between_constant_force_and_constant_velocity():
    """gain(15.5 Hz)/gain(7.6 Hz) = 0.2055; (7.6/15.5)² = 0.2404 for no spring; 0.490 for constant velocity."""
    low, high = 2 * np.pi * np.array([7.6, 15.5])

    def ratio(frequency, damping):
        platform = PlatformFilter(5.0, damping, 5.0 * (2 * np.pi * frequency) ** 2)
        return abs(platform.base_per_input(high) / platform.base_per_input(low))

    assert ratio(3.25, 0.0) == pytest.approx(0.2055, abs=5e-5)
    assert ratio(0.0, 0.0) == pytest.approx((7.6 / 15.5) ** 2, rel=1e-12)
    assert ratio(3.25, 1e9) == pytest.approx(7.6 / 15.5, rel=1e-9)
    assert round(ratio(3.25, 1e9), 3) == 0.490


@pytest.mark.parametrize("inductance", [0.0, 2e-3])
def test_the_shaker_against_its_two_equations(inductance):
    """m b̈ + c ḃ + k b = Bl i and L i̇ + R i + Bl ḃ = V, solved together."""
    mass, force_factor, resistance = 5.0, 20.0, 4.0
    found = PlatformFilter(mass, DAMPING, STIFFNESS, force_factor, resistance, inductance).base_per_input(OMEGA)
    for w, value in zip(OMEGA, found, strict=True):
        s = 1j * w
        together = np.array(
            [[mass * s**2 + DAMPING * s + STIFFNESS, -force_factor], [force_factor * s, inductance * s + resistance]]
        )
        assert value == pytest.approx(np.linalg.solve(together, [0, 1])[0], rel=1e-12)


def test_without_inductance_the_coil_is_a_damper():
    braked = PlatformFilter(5.0, DAMPING + 20.0**2 / 4.0, STIFFNESS).base_per_input(OMEGA) * 20.0 / 4.0
    np.testing.assert_allclose(
        PlatformFilter(5.0, DAMPING, STIFFNESS, 20.0, 4.0).base_per_input(OMEGA), braked, rtol=1e-13
    )
