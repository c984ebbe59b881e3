"""Structure of a solid scene against the beam's: signs, loads and rows, half bodies, masses, effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vibeam_models.base import Base
from vibeam_models.beam import structure_of
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.effects.sections import Theory
from vibeam_models.outputs import Output
from vibeam_models.scene import Scene, Sensor
from vibeam_models.solid.plan import Solid
from vibeam_models.solid.scene import SolidScene
from vibeam_models.stop import Stop

LENGTH = 0.2


def scene(cls=Scene, *, mass=None, effects=(), outputs=(), stop=0.18, ratio=0.0, base=None, beam=None, **solid):
    made = Beam(
        LENGTH,
        Rectangle(0.01, 0.004),
        210e9,
        7850.0,
        Damping("constant", (0.01,)),
        40,
        poissons_ratio=ratio,
        **(beam or {}),
    )
    rung = {"solid": Solid(**{"across": 2, **solid})} if cls is SolidScene else {}
    return cls(made, mass, Stop(stop, 0.0), Sensor(0.1), base or Base(), tuple(effects), tuple(outputs), **rung)


def both(**said):
    """The structure of Timoshenko's beam and that of the solid."""
    beam = scene(**{name: value for name, value in said.items() if name not in ("across", "whole", "clamp", "through")})
    beam = replace(beam, effects=(*beam.effects, Theory("timoshenko")))
    return structure_of(beam), structure_of(scene(SolidScene, **said))


def test_a_slender_solid_without_contraction_is_timoshenkos_beam():
    """Length 50 heights, ν = 0: frequencies, flexibility, static deflection under the base's acceleration, outputs.

    What remains is of the order of the shear's own share: the held face hinders the warping that shear would bring.
    """
    outputs = (Output("strain", 0.05, "strain"), Output("turn", 0.15, "slope"))
    beam, solid = both(outputs=outputs)
    np.testing.assert_allclose(solid.modes(3).frequency, beam.modes(3).frequency, rtol=1e-3)
    assert solid.flexibility(solid.contact) == pytest.approx(beam.flexibility(beam.contact), rel=2e-4)
    pushed = beam.deflection(beam.contact), solid.deflection(solid.contact)
    drawn = beam.deflection(beam.load), solid.deflection(solid.load)
    assert solid.outputs.keys() == beam.outputs.keys()
    for name in beam.outputs:
        for of_beam, of_solid in (pushed, drawn):
            assert solid.outputs[name] @ of_solid == pytest.approx(beam.outputs[name] @ of_beam, rel=1e-3), name
    assert solid.units == beam.units


def test_half_a_body_is_the_whole_one_in_symmetric_motion():
    """Contact, load and outputs of half are those of the whole, modes too but for lateral bending and twist."""
    half, whole = (structure_of(scene(SolidScene, ratio=0.3, whole=each)) for each in (None, True))
    for row in ("contact", "load"):
        one, other = (each.deflection(getattr(each, row)) for each in (half, whole))
        assert half.contact @ one == pytest.approx(whole.contact @ other, rel=1e-8)
        assert half.outputs["sensor"] @ one == pytest.approx(whole.outputs["sensor"] @ other, rel=1e-8)
    symmetric = [f for f in whole.modes(6).frequency if np.isclose(f, half.modes(3).frequency, rtol=1e-8).any()]
    assert len(symmetric) == 3


def test_without_contraction_the_solid_has_the_shear_modulus_of_its_poissons_ratio():
    """ν = 0.3 in G alone is Timoshenko's beam with κ of that ν; with the contraction the held face stiffens."""
    beam = structure_of(scene(ratio=0.3, effects=[Theory("timoshenko")])).modes(2).frequency
    free, held = (
        structure_of(replace(scene(SolidScene, ratio=0.3, through=2), contraction=each)).modes(2).frequency
        for each in (False, True)
    )
    np.testing.assert_allclose(free, beam, rtol=2e-4)
    assert (held > 1.003 * free).all()
