"""Sprung clamp, massless beam, gravity, torsion: closed forms, and the limits in which each is not there."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

from tests.models.bench import RIG, STEEL, deflection, with_effects
from tests.models.test_effects import EI, PLAIN, end_flexibility
from vibeam_models.beam import assemble, assemble_with_space
from vibeam_models.effects.gravity import AxialGravity, Gravity
from vibeam_models.effects.masses import AddedMass, MasslessBeam, RigidZone
from vibeam_models.effects.supports import Clamp
from vibeam_models.effects.torsion import Torsion, inertia_per_length, torsion_constant
from vibeam_models.scene import Mass
from vibeam_models.space import bare_beam
from vibeam_models.stop import Stop

L = STEEL.length
FINE = replace(STEEL, elements=72)
SHEAR = 80e9
TWISTED = Torsion(1e-3, 2.84e-5, shear_modulus=SHEAR)


def roots(function, first, last, count):
    """The first ``count`` zeros of ``function`` in a range, by bracketing."""
    grid = np.linspace(first, last, 4000)
    values = np.array([function(x) for x in grid])
    signs = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)
    return np.array([brentq(function, grid[i], grid[i + 1], xtol=1e-14) for i in signs[:count]])


def same_motion(one, two, count=4, rtol=1e-9):
    """Frequencies, contact values, loads and static contact flexibility of the first modes."""
    a, b = one.modes(count), two.modes(count)
    np.testing.assert_allclose(a.omega, b.omega, rtol=rtol)
    for row in ("contact", "load"):
        x, y = getattr(one, row) @ a.shapes, getattr(two, row) @ b.shapes
        np.testing.assert_allclose(x, y, rtol=0, atol=rtol * np.max(np.abs(y)))


# clamp


@pytest.mark.parametrize("stiffness", [0.5, 20.0])
def test_frequencies_of_a_sprung_cantilever(stiffness):
    """cos, sin, cosh, sinh with w = 0, EI w″ = k w′ at the clamp and w″ = w‴ = 0 at the tip."""
    ratio = stiffness * L / EI

    def determinant(x):
        c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
        rows = [[1, 0, 1, 0], [-x, -ratio, x, -ratio], [-c, -s, ch, sh], [s, -c, sh, ch]]
        return np.linalg.det(np.array(rows))

    exact = roots(determinant, 0.3, 12.0, 4) ** 2 * np.sqrt(EI / STEEL.mass_per_length) / L**2
    structure, _ = bare_beam(Clamp(stiffness).carrier(FINE))
    np.testing.assert_allclose(structure.modes(4).omega, exact, rtol=1e-6)
    assert exact[0] < 0.99 * bare_beam(FINE)[0].modes(1).omega[0]


def test_a_sprung_clamp_adds_its_rotation_to_the_static_deflection():
    structure = assemble(replace(PLAIN, effects=(Clamp(50.0),)))
    found = structure.flexibility(structure.contact)
    assert found == pytest.approx(deflection(STEEL, 0.132, 0.132) + 0.132**2 / 50.0, rel=1e-9)


@pytest.mark.parametrize("scene", [RIG, PLAIN], ids=["rig", "plain"])
def test_a_stiff_clamp_is_the_rigid_one(scene):
    same_motion(assemble(with_effects(scene, Clamp(1e12))), assemble(scene))
    with pytest.raises(AssertionError):
        same_motion(assemble(with_effects(scene, Clamp(1e6))), assemble(scene))


# massless beam


def test_a_massless_beam_is_equation_45():
    structure = assemble(replace(PLAIN, effects=(MasslessBeam(),)))
    assert structure.size == 1
    assert structure.modes().omega[0] ** 2 == pytest.approx(
        3 * EI / (0.2 * 0.132**3), rel=1e-9
    )  # round-off of 36 elements
    sensor = structure.outputs["sensor"][0] / structure.contact[0]
    assert sensor == pytest.approx(1 / 1.5540324324324324, rel=1e-9)
    drive = -structure.load[0] / structure.M[0, 0] * structure.outputs["sensor"][0]
    assert drive == pytest.approx(1 / 1.5540324324324324, rel=1e-9)


def test_a_massless_beam_has_as_many_coordinates_as_inertias():
    arm = np.array([[1.0, 0.0117], [0.0, 1.0]])
    flexibility = arm @ end_flexibility(0.132 - 0.0117) @ arm.T
    massless = with_effects(RIG, MasslessBeam())
    structure = assemble(massless)
    inertia = np.diag([0.2, RIG.effects[0].rotary_inertia])
    squared = 1 / np.linalg.eigvals(flexibility @ inertia)
    np.testing.assert_allclose(structure.modes().omega, np.sqrt(np.sort(squared)), rtol=1e-9)
    np.testing.assert_allclose(structure.mobility(structure.contact), 1 / 0.2, rtol=1e-9)
    assert assemble(with_effects(massless, AddedMass(0.0024, 0.09))).size == 3


def test_a_light_beam_is_a_massless_one():
    lighter = [assemble(replace(RIG, beam=replace(STEEL, density=7850 * share))) for share in (1e-4, 1e-10)]
    massless = assemble(with_effects(RIG, MasslessBeam()))
    same_motion(lighter[1], massless, 2)
    with pytest.raises(AssertionError):
        same_motion(lighter[0], massless, 2)


# gravity


def tension_stiffness(force, length):
    """Of a massless cantilever under a lateral force at the tip, where a dead ``force`` also pulls along the axis."""
    k = np.sqrt(abs(force) / EI)
    function = np.tanh if force > 0 else np.tan
    return abs(force) * k / abs(k * length - function(k * length))


@pytest.mark.parametrize(("direction", "acceleration"), [("hanging", 9.81), ("standing", 9.81), ("hanging", 2000.0)])
def test_a_mass_at_the_tip_of_a_massless_beam(direction, acceleration):
    scene = replace(PLAIN, mass=Mass(0.2, L), effects=(MasslessBeam(), Gravity(direction, acceleration)))
    force = 0.2 * acceleration * (1 if direction == "hanging" else -1)
    expected = np.sqrt(tension_stiffness(force, L) / 0.2)
    assert assemble(scene).modes().omega[0] == pytest.approx(expected, rel=1e-7)
    assert abs(expected / np.sqrt(3 * EI / 0.2 / L**3) - 1) > 0.02


def test_a_heavy_pendulum():
    """Where weight rules, ω² = g/(L − 1/k): a string, but for the boundary layer 1/k at the clamp."""
    scene = replace(PLAIN, beam=FINE, mass=Mass(0.2, L), effects=(MasslessBeam(), Gravity("hanging", 1e4)))
    layer = np.sqrt(EI / (0.2 * 1e4))
    assert assemble(scene).modes().omega[0] ** 2 == pytest.approx(1e4 / (L - layer), rel=1e-5)


def test_the_standing_column_of_greenhill():
    """ρgA L³/EI = (9/4) j², j the first zero of J₋₁/₃: 7.8373."""
    critical = float(2.25 * mp.findroot(lambda x: mp.besselj(mp.mpf(-1) / 3, x), 1.87) ** 2)
    assert critical == pytest.approx(7.8373, abs=1e-4)
    least = critical * EI / (STEEL.mass_per_length * L**3)
    bare = bare_beam(FINE)
    AxialGravity(-least * (1 - 1e-6), FINE, ()).apply(*bare)
    with pytest.raises(ValueError, match=f"buckles under its weight: it bears {least:.4g} m/s²"):
        AxialGravity(-least * (1 + 1e-6), FINE, ()).apply(*bare)


def test_a_mass_between_the_nodes_pulls_on_what_is_above_it_alone():
    effect = AxialGravity(10.0, STEEL, ((0.3, 0.0907),))
    _, space = bare_beam(STEEL)
    line = np.column_stack([space.nodes[1:], np.ones(len(space.nodes) - 1)]).ravel()
    # w = x but in the first element, where it bends to the clamp: two masses beyond that differ by the straight part.
    other = AxialGravity(10.0, STEEL, ((0.3, 0.0507),))
    found = line @ (effect.geometric_stiffness(space) - other.geometric_stiffness(space)) @ line
    assert found == pytest.approx(10.0 * 0.3 * (0.0907 - 0.0507), rel=1e-12)


def test_weight_across_a_bare_beam():
    """wL⁴/8EI at the tip."""
    structure, _ = Gravity("transverse", 9.81).apply(*bare_beam(STEEL), RIG)
    tip = structure.outputs["tip"] @ np.linalg.solve(structure.K, structure.static)
    assert tip == pytest.approx(STEEL.mass_per_length * 9.81 * L**4 / (8 * EI), rel=1e-9)


@pytest.mark.parametrize("direction", ["hanging", "standing", "transverse"])
def test_without_weight_nothing_is_left_of_gravity(direction):
    plain = assemble(RIG)
    none = assemble(with_effects(RIG, Gravity(direction, 1e-9)))
    same_motion(none, plain)
    np.testing.assert_allclose(none.static, 0, atol=1e-9)
    some = assemble(with_effects(RIG, Gravity(direction, 9.81)))
    assert np.any(some.static) == (direction == "transverse")
    assert (abs(some.modes(1).omega[0] / plain.modes(1).omega[0] - 1) > 0.01) == (direction != "transverse")


# torsion


def bar(polar_inertia=0.0, mass_at=L, half_width=0.0, elements=36):
    beam = replace(STEEL, elements=elements)
    effect = Torsion(1e-3, polar_inertia, shear_modulus=SHEAR)
    zone = (RigidZone(half_width),) if half_width else ()
    scene = replace(RIG, beam=beam, mass=Mass(0.2, mass_at), stop=replace(RIG.stop, position=mass_at), effects=zone)
    bare = bare_beam(beam, [mass_at, mass_at - half_width, min(mass_at + half_width, L)])
    return effect, effect.apply(*bare, scene)[0], bare[0].size


def twist_only(structure, bending):
    part = slice(bending, None)
    return structure.with_(
        **{name: getattr(structure, name)[part, part] for name in "MCK"},
        **{name: getattr(structure, name)[part] for name in ("load", "static", "contact")},
        outputs={},
    ).modes(3).omega  # fmt: skip


@pytest.mark.parametrize(("ratio", "factor"), [(1, 0.1406), (2, 0.2287), (4, 0.2808), (10, 0.3123)])
def test_torsion_constant_of_a_rectangle(ratio, factor):
    """Timoshenko & Goodier, Theory of Elasticity, table of k₁ (J_t = k₁ b t³)."""
    assert torsion_constant(ratio * 0.01, 0.01) == pytest.approx(factor * ratio * 1e-8, rel=5e-4)
    assert torsion_constant(0.01, ratio * 0.01) == torsion_constant(ratio * 0.01, 0.01)


def test_torsional_frequencies_of_a_fixed_free_bar():
    effect, structure, bending = bar()
    speed = np.sqrt(effect.rigidity(STEEL) / inertia_per_length(STEEL))
    np.testing.assert_allclose(twist_only(structure, bending), np.array([1, 3, 5]) * np.pi / (2 * L) * speed, rtol=1e-5)


def test_a_bar_with_a_disc_at_its_end():
    """λ tan λ = ρI_pL/J."""
    effect, structure, bending = bar(polar_inertia=2e-6)
    ratio = inertia_per_length(STEEL) * L / 2e-6
    exact = roots(lambda x: x * np.sin(x) - ratio * np.cos(x), 0.01, 9.0, 3)
    speed = np.sqrt(effect.rigidity(STEEL) / inertia_per_length(STEEL))
    np.testing.assert_allclose(twist_only(structure, bending), exact * speed / L, rtol=1e-5)


def test_a_light_bar_with_a_rigid_zone():
    effect, structure, bending = bar(2.84e-5 * 1e4, 0.132, 0.0117)
    expected = np.sqrt(effect.rigidity(STEEL) / (0.132 - 0.0117) / (2.84e-5 * 1e4))
    assert twist_only(structure, bending)[0] == pytest.approx(expected, rel=2e-6)


def test_bending_and_torsion_meet_at_the_contact_alone():
    plain, twisted = assemble(RIG), assemble(with_effects(RIG, TWISTED))
    n = plain.size
    for name in "MK":
        assert np.array_equal(getattr(twisted, name)[:n, :n], getattr(plain, name))
        assert not np.any(getattr(twisted, name)[:n, n:])
    assert np.array_equal(twisted.outputs["sensor"][:n], plain.outputs["sensor"])
    for row in (twisted.outputs["sensor"], twisted.load):
        assert not np.any(row[n:])


def test_the_mobility_of_an_eccentric_contact():
    """S(e) = S(0) + e² S_θ: from e = 1 mm to 2 mm the difference to e = 0 is fourfold."""

    def mobility(scene):
        structure = assemble(scene)
        return structure.mobility(structure.contact)

    centred = mobility(RIG)
    assert mobility(with_effects(RIG, replace(TWISTED, eccentricity=0.0))) == pytest.approx(centred, rel=1e-12)
    one, two = (mobility(with_effects(RIG, replace(TWISTED, eccentricity=e))) - centred for e in (1e-3, -2e-3))
    assert two == pytest.approx(4 * one, rel=1e-9)
    assert one == pytest.approx(1e-6 / 2.84e-5, rel=0.02)  # the disc's inertia, and a little of the strip's


def test_without_eccentricity_no_mode_of_bending_changes():
    plain, twisted = assemble(RIG), assemble(with_effects(RIG, replace(TWISTED, eccentricity=0.0)))
    modes = twisted.modes(9)
    struck = np.abs(twisted.contact @ modes.shapes) > 0
    assert np.count_nonzero(~struck) >= 1
    count = int(np.count_nonzero(struck))
    np.testing.assert_allclose(modes.omega[struck], plain.modes(count).omega, rtol=1e-9)
    np.testing.assert_allclose(
        (twisted.contact @ modes.shapes)[struck], plain.contact @ plain.modes(count).shapes, rtol=1e-7
    )


# the rig (paper, Fig. 17; the section is inferred, see PHYSICS)


def test_the_torsion_of_the_rig():
    """66.1 Hz is what a strip gives with J_t = bt³/3 and the discs' 2.84e-5 kg m²; St Venant's J_t is 3.3 % smaller."""
    shear = 210e9 / (2 * 1.29)
    twisted = assemble(with_effects(RIG, Torsion(1e-3, 2.84e-5, shear_modulus=shear))).modes(2).frequency[1]
    thin = STEEL.shape.width * STEEL.shape.thickness**3 / 3 / torsion_constant(STEEL.shape.width, STEEL.shape.thickness)
    assert thin == pytest.approx(1 + 0.63 * STEEL.shape.thickness / STEEL.shape.width, rel=2e-3)
    assert twisted * np.sqrt(thin) == pytest.approx(66.1, abs=0.05)
    assert twisted == pytest.approx(65.0, abs=0.05)


# contact eccentricity along the beam


def test_the_contact_may_lie_off_the_mass_inside_the_rigid_zone():
    shifted = assemble(replace(RIG, stop=Stop(0.133, 0.0, 0.72)))
    flexibility = np.array([1.0, 0.0127]) @ end_flexibility(0.132 - 0.0117) @ np.array([1.0, 0.0127])
    found = shifted.flexibility(shifted.contact)
    assert found == pytest.approx(flexibility, rel=1e-8)


@pytest.mark.parametrize("scene", [RIG, PLAIN], ids=["rig", "plain"])
@pytest.mark.parametrize("offset", [1.7e-4, 1e-7, -1e-6])
def test_a_contact_very_near_the_mass_leaves_the_beam_as_it_is(scene, offset):
    """A node there would part an element of that length: its round-off made the first mode 24 Hz at 0.1 µm."""
    near, at = assemble(replace(scene, stop=Stop(0.132 + offset, 0.0, 0.72))), assemble(scene)
    np.testing.assert_allclose(near.modes(4).omega, at.modes(4).omega, rtol=1e-9)
    shift = near.contact @ np.linalg.solve(near.K, at.contact) / (at.flexibility(at.contact)) - 1
    slope = 1.5 / 0.132 if scene is PLAIN else deflection_slope()
    assert shift == pytest.approx(offset * slope, rel=2e-3)


def deflection_slope():
    """Of the rigid zone over its deflection, under a force in its middle."""
    arm = np.array([[1.0, 0.0117], [0.0, 1.0]])
    whole = arm @ end_flexibility(0.132 - 0.0117) @ arm.T
    return whole[1, 0] / whole[0, 0]


def test_the_node_of_bending_2_lies_two_millimetres_beyond_the_mass():
    structure, space = assemble_with_space(RIG)
    shape = structure.modes(2).shapes[:, 1]
    node = brentq(lambda x: float(space.row(x) @ shape), 0.13, 0.14)
    assert node - 0.132 == pytest.approx(0.002, abs=0.0005)
