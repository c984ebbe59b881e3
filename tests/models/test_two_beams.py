"""Two beams that meet: statics, symmetry and limits of the relative contact."""

from dataclasses import replace

import numpy as np
import pytest

from tests.models.bench import POINT_MASS, STEEL, deflection, with_effects
from vibeam_models.beam import assemble
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.effects.masses import AddedMass
from vibeam_models.effects.opposite import Opposite
from vibeam_models.effects.sections import Section

BARE = replace(POINT_MASS, mass=None)
EI = STEEL.bending_stiffness


def flexibility(structure):
    return float(structure.contact @ np.linalg.solve(structure.K, structure.contact))


@pytest.mark.parametrize("arm", [0.0, 0.03, -0.02])
def test_flexibilities_of_both_beams_add_up(arm):
    """A force at an arm a beyond x bends by x³/3 + x²a + x a² over EI."""
    x = 0.12
    own = float(deflection(STEEL, 0.132, 0.132))
    other = (x**3 / 3 + x**2 * arm + x * arm**2) / EI
    found = flexibility(assemble(with_effects(BARE, Opposite(x, arm))))
    assert found == pytest.approx(own + other, rel=1e-8)


def test_equal_beams_move_together():
    """Driven at the base, equal beams have no relative motion: no mode that the base drives moves the contact."""
    structure = assemble(with_effects(BARE, Opposite(0.132)))
    response = np.linalg.solve(structure.K - 300.0**2 * structure.M, structure.load)
    assert abs(structure.contact @ response) < 1e-9 * abs(structure.outputs["sensor"] @ response)
    uneven = assemble(with_effects(BARE, Opposite(0.132), AddedMass(1e-3, 0.15, on="opposite")))
    response = np.linalg.solve(uneven.K - 300.0**2 * uneven.M, uneven.load)
    assert abs(uneven.contact @ response) > 1e-3 * abs(uneven.outputs["sensor"] @ response)


def test_a_stiff_opposite_beam_is_a_stop_on_the_base():
    stiff = assemble(with_effects(BARE, Opposite(0.132, youngs_modulus=210e17)))
    alone = assemble(BARE)
    assert stiff.modes(3).omega == pytest.approx(alone.modes(3).omega, rel=1e-6)
    assert flexibility(stiff) == pytest.approx(flexibility(alone), rel=1e-6)


def test_what_is_on_the_opposite_beam_is_that_of_a_beam_of_its_own():
    """Its frequencies are those of the same beam standing alone."""
    parts = {"thickness": 2e-3}
    both = assemble(
        with_effects(
            BARE,
            Opposite(0.1, length=0.15, width=0.03),
            Section(0.0, 0.05, on="opposite", **parts),
            AddedMass(0.02, 0.14, 1e-6, on="opposite"),
        )
    )
    beam = replace(STEEL, length=0.15, shape=Rectangle(0.03, 1.034e-3))
    alone = replace(BARE, beam=beam, sensor=replace(BARE.sensor, position=0.1), stop=replace(BARE.stop, position=0.1))
    other = assemble(with_effects(alone, Section(0.0, 0.05, **parts), AddedMass(0.02, 0.14, 1e-6)))
    expected = np.sort(np.concatenate([assemble(BARE).modes(3).omega, other.modes(3).omega]))
    assert both.modes(4).omega == pytest.approx(expected[:4], rel=1e-8)
    assert both.size == assemble(BARE).size + other.size


def test_outputs_of_the_opposite_beam_move_with_it_alone():
    structure = assemble(with_effects(BARE, Opposite(0.1)))
    count = assemble(BARE).size
    assert not structure.outputs["opposite"][:count].any()
    assert not structure.outputs["sensor"][count:].any()
    assert np.array_equal(structure.contact[count:], -structure.outputs["opposite"][count:])


def test_both_beams_weigh():
    scene = with_effects(BARE, Opposite(0.1, length=0.36), AddedMass(0.5, 0.3, on="opposite"))
    assert scene.moving_mass == pytest.approx(3 * STEEL.mass_per_length * STEEL.length + 0.5, rel=1e-14)
    assert scene.weights == ()
