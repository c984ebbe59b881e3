"""NAFEMS' benchmarks of free vibration, as published (``nafems.json``), by the elements of a solid."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import skfem
from elastic_forms import torsion_constant
from solid_bodies import components, frequencies, hexahedra, matrices, plane

from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam_models.beams.stretch import Material

PUBLISHED = json.loads((Path(__file__).parent / "nafems.json").read_text(encoding="utf-8"))
PLATE = Material(**PUBLISHED["material"])


def around(elements):
    """Nodes on the four edges of a plate of 10 m."""
    return np.any([plane(elements, axis, at) for axis in (0, 1) for at in (0, 10)], axis=0)


def test_fv32_a_tapered_membrane():
    """A thin body whose clamp lets it contract across is in plane stress: six frequencies to 0.02 %."""
    own = PUBLISHED["FV32"]
    box = hexahedra((16, 1, 8), (1, own["thickness"] / 2, 2), (0, 0, -1))
    x, y, z = box.p
    height = own["height_at_clamp"] + (own["height_at_tip"] - own["height_at_clamp"]) * x
    elements, stiff, mass = matrices(skfem.MeshHex(np.array([own["length"] * x, y, z * height / 2]), box.t), PLATE)
    clamp, middle = plane(elements, 0, 0), plane(elements, 1, 0)
    found = frequencies(stiff, mass, components(clamp, middle, clamp), 6)
    np.testing.assert_allclose(found, own["frequencies"], rtol=2e-4)
    held = frequencies(stiff, mass, components(clamp, middle | clamp, clamp), 6)
    assert (held > found).all()  # a clamp that holds the contraction is no plane stress
    assert held[0] / own["frequencies"][0] - 1 > 1e-3


def test_fv52_a_solid_plate_held_along_edges_of_one_face():
    """NAFEMS' own mesh of 4 × 4 × 1: three rigid motions, then within 2 % of its bricks of 20 nodes, and below them.

    The line of support is a singularity of elasticity: finer meshes leave the benchmark, to ever lower frequencies.
    """
    own = PUBLISHED["FV52"]
    found = []
    for counts in ((4, 4, 1), (8, 8, 2)):
        elements, stiff, mass = matrices(hexahedra(counts, own["sides"]), PLATE)
        held = components(None, None, around(elements) & plane(elements, 2, 0))
        found.append(frequencies(stiff, mass, held, 10, -1.0))
    coarse, fine = found
    assert (coarse[: own["rigid_motions"]] < 1e-2).all()
    np.testing.assert_allclose(coarse[3:], own["by_20_node_bricks"], rtol=0.018)
    np.testing.assert_allclose(coarse[3:], own["frequencies"], rtol=0.03)
    assert (coarse[3:] <= np.array(own["by_20_node_bricks"]) * (1 + 1e-4)).all()
    assert fine[3] < 0.985 * coarse[3]


def test_fv16_a_cantilevered_thin_plate():
    """One element of 0.05 m through, 1.25 m across: six frequencies to 2 %, where tetrahedra of ten nodes lock."""
    own = PUBLISHED["FV16"]
    elements, stiff, mass = matrices(hexahedra((8, 8, 1), own["sides"]), PLATE)
    clamp = plane(elements, 0, 0)
    np.testing.assert_allclose(
        frequencies(stiff, mass, components(clamp, clamp, clamp), 6), own["frequencies"], rtol=0.02
    )


def test_fv5_a_deep_beam_on_simple_supports():
    """Ends held across, free along: bending to 0.3 % of Timoshenko's beam, each twice; torsion by Saint-Venant."""
    own = PUBLISHED["FV5"]
    elements, stiff, mass = matrices(hexahedra((8, 2, 2), (own["length"], *own["section"]), (0, -1, -1)), PLATE)
    ends, axis = plane(elements, 0, 0) | plane(elements, 0, own["length"]), np.hypot(*elements.points[1:]) < 1e-9
    found = frequencies(stiff, mass, components(axis, ends, ends), 5, -1.0)  # nothing stretches
    np.testing.assert_allclose(found[[0, 1]], own["bending"][0], rtol=3e-3)
    np.testing.assert_allclose(found[[3, 4]], own["bending"][1], rtol=1e-2)
    speed = np.sqrt(PLATE.shear_modulus / PLATE.density)
    twist = speed / (2 * own["length"]) * np.sqrt(torsion_constant(2, 2) / (16 / 6))
    assert found[2] == pytest.approx(twist, rel=1e-2)
    assert twist == pytest.approx(2 * own["torsion"][0] * np.sqrt(torsion_constant(2, 2) / (16 / 6)), rel=1e-3)


@pytest.mark.slow
def test_fv22_a_clamped_thick_rhombic_plate():
    """45°, all edges held: within 3 % of Mindlin's plate, from above."""
    own = PUBLISHED["FV22"]
    box = hexahedra((16, 16, 2), (own["side"],) * 2 + (own["thickness"],), (0, 0, -0.5))
    edges = around(SolidElements(box))
    slope = np.cos(np.radians(own["angle"]))
    sheared = skfem.MeshHex(np.array([box.p[0] + slope * box.p[1], slope * box.p[1], box.p[2]]), box.t)
    elements, stiff, mass = matrices(sheared, PLATE)
    held = edges | plane(elements, 2, 0)  # of the plate's own plane: bending alone
    found = frequencies(stiff, mass, components(held, held, edges), 5)
    np.testing.assert_allclose(found, own["frequencies"], rtol=0.03)
