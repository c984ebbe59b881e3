"""Rigs as solids beside the second program: hexahedra of 27 nodes against tetrahedra of ten, halves against wholes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from make_solid_rigs import RIGS, SIZES
from scipy.sparse.linalg import spsolve as solve_sparse
from solid_rigs import answer

from vibeam.extensions.solid.elasticity.plan import Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam_models.base import Base
from vibeam_models.beam import structure_of
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.effects.masses import RigidZone, RotaryInertia
from vibeam_models.effects.sections import BondedPlate, Section
from vibeam_models.effects.supports import BeamEnds
from vibeam_models.scene import Mass, Sensor
from vibeam_models.stop import Stop
from vibeam_reductions.modes import modal, residual_flexibility
from vibeam_reductions.static_shapes import craig_bampton

TRUTH = json.loads((Path(__file__).parent / "solid_rigs.json").read_text(encoding="utf-8"))
STRIP = Beam(0.12, Rectangle(0.024, 0.008), 210e9, 7850.0, Damping("constant", (0.01,)), poissons_ratio=0.3)
NARROW, WIDE = (0.008, 0.012), (0.008, 0.024)
BLOCKS = {"mass_size": (0.02, 0.03, 0.01), "mass_youngs_modulus": 70e9}


def scene(*effects, stop=0.1, contact=WIDE, mass=None, **solid):
    """The strip with ``effects``, met at ``stop`` m."""
    plan = Solid(**({"along": 24, "across": 4, "through": 2, "contact": contact} | solid))
    return SolidScene(STRIP, mass, Stop(stop, 0.0, 0.7), Sensor(0.06), Base(amplitude=1e-4), effects, solid=plan)


def plate(**said):
    return BondedPlate(0.04, 0.08, **({"width": 0.024, "thickness": 0.004} | said))


SCENES = {
    "bare": scene(contact=NARROW),
    "both ends": scene(BeamEnds("clamped-clamped"), stop=0.06),
    "zone": scene(RotaryInertia(3e-5), RigidZone(0.01), mass=Mass(0.2, 0.08)),
    "step": scene(Section(0.04, 0.08, thickness=0.012)),
    "plate": scene(plate(youngs_modulus=70e9, density=2700.0)),
    "narrow plates": scene(plate(width=0.012, thickness=0.002, density=7850.0, sides="both")),
    "block": scene(mass=Mass(0.2, 0.08), **BLOCKS),
    "taper": scene(Section(0.04, 0.12, thickness=0.008, end_thickness=0.004)),
}


def read(structure, count=3):
    """As ``solid_rigs.Answer`` of a structure, its sign that of the contact."""
    modes = structure.modes(count)
    return modes.frequency, structure.contact @ modes.shapes, structure.load @ modes.shapes


@pytest.mark.parametrize("name", SCENES)
def test_hexahedra_and_tetrahedra_agree(name):
    """Frequencies, rows and load to 0.3 %, flexibility to 0.5 %: corners are sharp, both meshes are coarse."""
    truth, structure = TRUTH[name], structure_of(SCENES[name])
    assert structure.size < 6000
    frequency, contact, load = read(structure)
    np.testing.assert_allclose(frequency, truth["frequencies"], rtol=3e-3)
    assert (frequency > truth["limit"]).all()
    assert structure.flexibility(structure.contact) == pytest.approx(truth["flexibility"], rel=5e-3)
    np.testing.assert_allclose(np.abs(contact), truth["contact"], rtol=0, atol=3e-3 * max(truth["contact"]))
    seen = np.abs(contact) > 1e-2 * max(np.abs(contact))  # of a mode whose node is there the sign is open
    np.testing.assert_allclose(-load[seen], np.array(truth["load"])[seen], rtol=0, atol=2e-3 * max(truth["load"]))


@pytest.mark.parametrize("name", ["bare", "zone", "plate"])
def test_a_half_is_the_whole(name):
    """The same mesh, one with its mirror image: modes, rows, flexibility alike; its other modes are new."""
    coarse = replace(SCENES[name].solid, along=10, through=1)
    half, whole = (structure_of(replace(SCENES[name], solid=replace(coarse, whole=each))) for each in (None, True))
    assert whole.size > 1.6 * half.size
    frequency, contact, load = read(half, 3)
    modes = whole.modes(6)
    kept = [int(np.argmin(np.abs(modes.frequency - each))) for each in frequency]
    np.testing.assert_allclose(modes.frequency[kept], frequency, rtol=1e-8)
    np.testing.assert_allclose(whole.contact @ modes.shapes[:, kept], contact, atol=1e-6 * np.abs(contact).max())
    others = np.delete(np.arange(6), kept)
    assert len(others) == 3
    assert np.abs(whole.contact @ modes.shapes[:, others]).max() < 1e-6 * np.abs(contact).max()
    assert np.abs(whole.load @ modes.shapes[:, others]).max() < 1e-6 * np.abs(load).max()
    for row in ("tip", "sensor"):
        ours = half.deflection(half.contact) @ half.outputs[row]
        assert whole.deflection(whole.contact) @ whole.outputs[row] == pytest.approx(ours, rel=1e-8)
        assert half.deflection(half.outputs[row]) @ half.contact == pytest.approx(ours, rel=1e-8)  # Maxwell


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_the_second_program_gives_what_is_stored(name):
    found = answer(RIGS[name], SIZES[0])
    np.testing.assert_allclose(found.frequencies, TRUTH[name]["coarse"], rtol=1e-9)
    assert found.mass == pytest.approx(TRUTH[name]["mass"], rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_fine_hexahedra_go_where_tetrahedra_go(name):
    """Below the tetrahedra and their own coarse mesh, above the limit."""
    coarse, _, _ = read(structure_of(SCENES[name]))
    plan = replace(SCENES[name].solid, along=40, across=6, through=4)
    frequency, _, _ = read(structure_of(replace(SCENES[name], solid=plan)))
    assert (frequency < coarse).all()
    assert (frequency < TRUTH[name]["frequencies"]).all()
    assert (frequency > TRUTH[name]["limit"]).all()


def receptance(structure, omega):
    """Contact's displacement in m under a force of 1 N at ``omega`` on it, without damping."""
    dynamic = structure.K - omega**2 * structure.M
    return structure.contact @ (solve_sparse(dynamic.tocsc(), structure.contact))


REDUCED = {
    "modal": (lambda s: modal(s, 8), 2e-3),
    "residual_flexibility": (lambda s: residual_flexibility(s, 4), 2e-7),
    "craig_bampton": (lambda s: craig_bampton(s, 6, ("contact",)), 1e-4),
}


@pytest.fixture(scope="module")
def zone():
    return structure_of(SCENES["zone"])


@pytest.mark.parametrize("name", REDUCED)
def test_a_reduced_solid_answers_as_the_solid_solved_directly(name, zone):
    """Contact's receptance at rest, below the first mode and between the first two, by sparse factors of K − ω²M."""
    make, share = REDUCED[name]
    reduced = make(zone).structure
    first, second = zone.modes(2).omega
    for omega in (0.0, 0.6 * first, 0.4 * second):
        direct = receptance(zone, omega)
        dynamic = reduced.K - omega**2 * reduced.M
        found = reduced.contact @ np.linalg.solve(dynamic, reduced.contact) + reduced.contact_flexibility
        assert found == pytest.approx(direct, rel=share), omega
