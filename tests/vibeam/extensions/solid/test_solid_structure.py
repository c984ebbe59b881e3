"""Structure of a solid scene against the beam's: signs, loads and rows, half bodies, masses, effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import skfem

from vibeam.extensions.solid.elasticity.body import BodyMass
from vibeam.extensions.solid.elasticity.geometry.bodies import body_of
from vibeam.extensions.solid.elasticity.own_mesh import BodyRow, OwnRig
from vibeam.extensions.solid.elasticity.own_structure import body_structure
from vibeam.extensions.solid.elasticity.plan import Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam.extensions.solid.elasticity.slender import SlenderElements
from vibeam.extensions.solid.elasticity.structure import solid_fields
from vibeam_models.base import Base
from vibeam_models.beam import structure_of
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.beams.stretch import Material
from vibeam_models.effects.field_points import FieldPoints
from vibeam_models.effects.gravity import Gravity
from vibeam_models.effects.masses import AddedMass, MasslessBeam, RigidZone, RotaryInertia
from vibeam_models.effects.opposite import Opposite
from vibeam_models.effects.sections import Section, Theory
from vibeam_models.effects.supports import BeamEnds, Clamp, FurtherSupport
from vibeam_models.outputs import Output
from vibeam_models.scene import Mass, Scene, Sensor
from vibeam_models.stop import Stop

LENGTH = 0.2


def scene(cls=Scene, *, mass=None, effects=(), outputs=(), stop=0.18, ratio=0.0, base=None, beam=None, **solid):
    own = {"length": LENGTH, "shape": Rectangle(0.01, 0.004), "youngs_modulus": 210e9, "density": 7850.0}
    made = Beam(
        **own | {"damping": Damping("constant", (0.01,)), "elements": 20, "poissons_ratio": ratio} | (beam or {})
    )
    rung = {"solid": Solid(**{"across": 2, **solid})} if cls is SolidScene else {}
    return cls(made, mass, Stop(stop, 0.0), Sensor(0.1), base or Base(), tuple(effects), tuple(outputs), **rung)


def both(**said):
    """The structure of Timoshenko's beam and that of the solid."""
    beam = scene(**{name: value for name, value in said.items() if name not in ("across", "whole", "clamp", "through")})
    beam = replace(beam, effects=(*beam.effects, Theory("timoshenko")))
    return structure_of(beam), structure_of(scene(SolidScene, **said))


@pytest.mark.parametrize(("heights", "through"), [(29, 2), (31, 1)])
def test_two_elements_bear_the_shear_of_a_beam_shorter_than_thirty_heights(heights, through):
    def frequencies(**said):
        made = scene(SolidScene, stop=0.1, beam={"shape": Rectangle(0.01, LENGTH / heights)}, along=6, **said)
        return structure_of(made).modes(3).frequency

    np.testing.assert_array_equal(frequencies(), frequencies(through=through))


def test_a_contact_ever_so_small_beside_the_body_is_read():
    """1e-5 of the length: the local places of its facets are round-off from the last digit of x on."""
    small, usual = (structure_of(scene(SolidScene, contact=size)) for size in ((2e-6, 0.01), (4e-3, 0.01)))
    assert small.modes(1).frequency == pytest.approx(usual.modes(1).frequency, rel=1e-4)
    shares = [each.contact @ each.modes(1).shapes for each in (small, usual)]
    assert shares[0] == pytest.approx(shares[1], rel=1e-3)


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
    assert (held > 1.002 * free).all()


BODIES = {
    "mass": ({"mass": Mass(0.2, 0.15)}, []),
    "rotary inertia": ({"mass": Mass(0.2, 0.15)}, [RotaryInertia(3e-5)]),
    "rigid zone": ({"mass": Mass(0.2, 0.15), "stop": 0.15}, [RotaryInertia(3e-5), RigidZone(0.0117)]),
    "added mass": ({}, [AddedMass(0.02, 0.1, 1e-6)]),
    "pinned": ({}, [BeamEnds("pinned-pinned")]),
    "guided": ({}, [BeamEnds("clamped-guided")]),
    "held twice": ({}, [BeamEnds("clamped-clamped")]),
    "support": ({}, [FurtherSupport(0.12)]),
    "springs": ({}, [FurtherSupport(0.12, 2000.0, 5.0)]),
    "on springs alone": ({}, [BeamEnds("free-free"), FurtherSupport(0.05, 3000.0), FurtherSupport(0.16, 2000.0, 5.0)]),
    "clamp": ({}, [Clamp(50.0)]),
    "hanging": ({}, [Gravity("hanging", 2e4)]),
    "standing": ({}, [Gravity("standing", 2e4)]),
    "opposite": ({}, [Opposite(0.15, 0.02, thickness=0.003)]),
}


@pytest.mark.parametrize("of", BODIES)
def test_what_a_solid_carries_and_what_holds_it_are_those_of_the_beam(of):
    """Two frequencies to the next order of the beam's theory; the contact under a force on it and under the base."""
    said, effects = BODIES[of]
    beam, solid = both(**said, effects=effects)
    np.testing.assert_allclose(solid.modes(2).frequency, beam.modes(2).frequency, rtol=2e-3)
    assert solid.flexibility(solid.contact) == pytest.approx(beam.flexibility(beam.contact), rel=2e-2)
    drawn = [each.contact @ each.deflection(each.load) for each in (beam, solid)]
    assert drawn[1] == pytest.approx(drawn[0], rel=1e-3)


def test_a_strain_gauge_follows_a_taper():
    """The face of a wedge: strain c w″ with half of its height there, 1 % between gauge and point."""
    wedge = [Section(0.0, 0.2, end_thickness=0.002)]
    beam, solid = both(effects=wedge, outputs=(Output("strain", 0.1, "strain"),))
    read = [each.outputs["strain"] @ each.deflection(each.contact) for each in (beam, solid)]
    assert read[1] == pytest.approx(read[0], rel=1e-2)


def test_weight_across_and_a_force_on_the_beam():
    for said, name in (({"effects": [Gravity("transverse")]}, "static"), ({"base": Base(at=0.12, force=1.0)}, "load")):
        beam, solid = both(**said)
        pushed = [each.contact @ each.deflection(getattr(each, name)) for each in (beam, solid)]
        assert pushed[1] == pytest.approx(pushed[0], rel=5e-4)


def test_a_slender_standing_solid_buckles():
    with pytest.raises(ValueError, match="buckles"):
        structure_of(scene(SolidScene, effects=[Gravity("standing", 1e7)]))


@pytest.mark.parametrize("ends", ["pinned-pinned", "free-free"])
def test_a_whole_body_is_held_across_too(ends):
    """Half and whole have the same deflection; nothing of the whole is left free."""
    effects = [BeamEnds(ends), FurtherSupport(0.06, 2000.0, 5.0)]
    half, whole = (structure_of(scene(SolidScene, effects=effects, whole=each)) for each in (None, True))
    assert whole.flexibility(whole.contact) == pytest.approx(half.flexibility(half.contact), rel=1e-7)
    assert whole.modes(1).omega[0] > 10


def test_an_effect_that_knows_beams_alone_is_refused():
    with pytest.raises(ValueError, match="massless: is not known of a solid"):
        structure_of(scene(SolidScene, mass=Mass(0.2, 0.15), effects=[MasslessBeam()]))


def test_a_support_inside_a_rigid_zone_is_said():
    with pytest.raises(ValueError, match=r"rigid zone at 0\.15 m: a support"):
        structure_of(scene(SolidScene, mass=Mass(0.2, 0.15), effects=[RigidZone(0.06), BeamEnds("clamped-clamped")]))


def test_frequencies_of_a_thin_solid_converge_with_the_fourth_power_of_its_elements():
    """18 of 10 heights each; without the shear at two points along them the order would be two, the error 2 %."""
    beam = {"shape": Rectangle(0.01, 0.001)}
    coarse, fine, finest = (
        structure_of(scene(SolidScene, beam=beam, ratio=0.3, along=along, clamp="sliding")).modes(3).frequency
        for along in (10, 20, 80)
    )
    first, second = coarse / finest - 1, fine / finest - 1
    assert abs(second).max() < 1e-3
    assert (np.log2(first / second)[1:] > 3.7).all()  # round-off is in the first


def test_slender_elements_have_six_motions_without_force():
    """Two points for the shear leave no motion of elements free; bases of planes are of the same displacements."""
    elements = SlenderElements(skfem.MeshHex.init_tensor([0.0, 0.1, 0.3], [0.0, 0.1], [0.0, 0.02]))
    inner = elements.stiffness((Material(210e9, 7850.0, 0.3),), np.zeros(2, dtype=int)).toarray()
    back = np.linalg.inv(elements.relative.toarray())
    values = np.linalg.eigvalsh(back.T @ inner @ back)
    assert np.abs(values[:6]).max() < 1e-12 * values[-1]
    assert values[6] > 1e-6 * values[-1]
    assert len(np.unique(elements.bases)) == 5


def test_a_strip_a_thousand_times_as_long_as_thick_keeps_its_stiffness():
    """Without the bases of its planes round-off would take 3e-4 of its first frequency."""
    beam, solid = both(beam={"shape": Rectangle(0.01, 0.0002)})
    assert solid.modes(1).frequency[0] == pytest.approx(beam.modes(1).frequency[0], rel=4e-6)
    assert solid.flexibility(solid.contact) == pytest.approx(beam.flexibility(beam.contact), rel=4e-6)


@pytest.mark.parametrize("whole", [None, True])
def test_a_mesh_of_ones_own_is_the_scenes_structure(whole):
    """The body of a scene, read and held by groups; what remains is its shear, which is integrated in full here."""
    effects = [RotaryInertia(3e-5), RigidZone(0.0117)]
    rig = scene(SolidScene, mass=Mass(0.2, 0.15), effects=effects, ratio=0.3, whole=whole)
    body, none, up = body_of(rig), np.zeros(0, dtype=int), np.array([0.0, 0.0, 1.0])
    zone = np.flatnonzero(np.abs(body.mesh.p[0] - 0.15) <= 0.0117 + 1e-9)
    body = replace(body, masses=(BodyMass("block", none, zone, 0.2, 3e-5),))
    read = OwnRig({"contact": BodyRow(((body.patches["contact"], none, up, 1.0),))}, up)
    one, other = structure_of(rig), body_structure(body, read)
    assert one.size == other.size
    count = 2  # a third of the whole body is its twist, whose inertia the scene has none of
    np.testing.assert_allclose(other.modes(count).frequency, one.modes(count).frequency, rtol=1e-3)
    for name in ("contact", "load"):
        pushed = [each.contact @ each.deflection(getattr(each, name)) for each in (one, other)]
        assert pushed[1] == pytest.approx(pushed[0], rel=6e-4)


def test_readings_alone_make_no_new_matrices():
    """Sensor, outputs and points of another scene share M, K and their factors; another mass does not."""
    rig = scene(SolidScene)
    read = replace(rig, sensor=Sensor(0.05), outputs=(Output("turn", 0.1, "slope"),), effects=(FieldPoints((0.1,)),))
    one, other, heavy = (structure_of(each) for each in (rig, read, replace(rig, mass=Mass(0.1, 0.1))))
    assert other.K is one.K
    assert other.stiffness_factor is one.stiffness_factor
    assert heavy.M is not one.M
    assert list(other.outputs) == ["sensor", "tip", "turn", "beam deflection 0", "beam slope 0"]
    assert other.units["turn"] == "rad"
    np.testing.assert_array_equal(other.outputs["turn"], other.outputs["beam slope 0"])


def test_fields_expand_the_coordinates_of_both_bodies():
    """The contact's displacement is that of its nodes, u = Z y, on either body."""
    rig = scene(SolidScene, effects=[Opposite(0.15, 0.0, thickness=0.003)])
    structure, fields = structure_of(rig), solid_fields(rig)
    motion = structure.deflection(structure.contact)
    tips = {name: field.elements.points[0] == LENGTH for name, field in fields.items()}
    moved = {name: (field.basis @ motion).reshape(-1, 3) for name, field in fields.items()}
    means = {name: each[tips[name], 2].mean() for name, each in moved.items()}
    assert means["beam"] == pytest.approx(structure.outputs["tip"] @ motion, rel=1e-3)
    assert means["opposite"] == pytest.approx(structure.outputs["opposite_tip"] @ motion, rel=1e-3)


def test_a_solid_too_large_for_the_memory_is_told_before_it_is_assembled(monkeypatch):
    monkeypatch.setattr("vibeam_models.memory.free_bytes", lambda: 1e6)
    with pytest.raises(ValueError, match=r"matrices of \d+ coordinates: needs .* GB of memory, 0\.001 GB are free"):
        structure_of(scene(SolidScene, stop=0.1234))
