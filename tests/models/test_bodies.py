"""Meshes of a scene's bodies: volumes, masses, one sign of the Jacobian, conformity, symmetry, patches."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam_models.solid.body import SolidBody, jacobians
from vibeam_models.solid.geometry.bodies import body_of
from vibeam_models.solid.geometry.lines import continued_lines
from vibeam_models.solid.plan import Solid
from vibeam_models.solid.scene import SolidScene

BEAM: dict[str, Any] = {
    "length": "200 mm", "width": "20 mm", "thickness": "4 mm", "youngs_modulus": "210 GPa", "density": "8000 kg/m^3",
    "damping_ratio": 0.01, "elements": 12,
}  # fmt: skip


def scene(beam: dict[str, Any] | None = None, **more: Any) -> SolidScene:
    plan = more.pop("plan", Solid())
    case = {
        "beam": {**BEAM, **(beam or {})}, "stop": {"gap": "1 mm", "restitution": 0.5, "position": "150 mm"},
        "sensor": {"position": "100 mm"}, "drive": {"amplitude": "0.1 mm"},
        "sweep": {"frequency": {"from": "10 Hz", "to": "20 Hz", "points": 2}, "settle": 10, "hold": 10},
        "fidelity": {"one": {"reduction": "static_mode"}}, **more,
    }  # fmt: skip
    return SolidScene(**vars(vibeam.load(case).scene), solid=plan)


def assert_sound(body: SolidBody) -> None:
    """One sign of all Jacobians; every inner facet is in two cells, every outer one on the surface alone."""
    found, _ = jacobians(body.mesh)
    assert np.all(found < 0) or np.all(found > 0)
    corners = np.sort(body.mesh.t[body.mesh.elem.refdom.facets], axis=1)
    faces, counts = np.unique(corners.transpose(0, 2, 1).reshape(-1, 4), axis=0, return_counts=True)
    assert counts.max() <= 2
    assert len(faces) == body.mesh.facets.shape[1]
    # no two nodes in one place: cells that touch share their nodes, so that none hangs
    assert len(np.unique(np.round(body.mesh.p, 9), axis=1).T) == body.mesh.p.shape[1]


def test_a_beam_is_a_block_of_its_size_half_or_whole() -> None:
    half, whole = body_of(scene()), body_of(scene(plan=Solid(whole=True)))
    for body in (half, whole):
        assert_sound(body)
        assert body.mass == pytest.approx(0.2 * 0.02 * 0.004 * 8000, rel=1e-9)
    assert half.half
    assert not whole.half
    assert whole.mesh.t.shape[1] == 2 * half.mesh.t.shape[1]
    mirrored = whole.mesh.p * np.array([[1.0], [-1.0], [1.0]])
    assert np.array_equal(*(np.unique(np.round(each, 12), axis=1) for each in (mirrored, whole.mesh.p)))


def test_the_contact_is_as_long_as_the_section_is_high_and_faces_the_stop() -> None:
    body = body_of(scene())
    corners = body.mesh.p[:, body.mesh.facets[:, body.patches["contact"]]]
    assert corners[0].min() == pytest.approx(0.148)
    assert corners[0].max() == pytest.approx(0.152)
    assert np.allclose(corners[2], 0.002)
    assert corners[1].max() == pytest.approx(0.01)


def test_lines_go_on_through_the_pieces_beside_their_own() -> None:
    wide, narrow = [(0.0, 0.0), (10.0, 10.0)], [(0.0, 0.0), (5.0, 5.0)]
    assert np.allclose(continued_lines([wide, narrow, wide], 10.0), [[0, 5, 10]] * 4)
    taper = [(0.0, 0.0), (10.0, 5.0)]
    assert np.allclose(continued_lines([wide, taper, narrow], 10.0), [[0, 10], [0, 10], [0, 5], [0, 5]])
    with_plate = [(0.0, 0.0), (4.0, 4.0), (10.0, 10.0)]
    assert np.allclose(
        continued_lines([with_plate, taper, narrow], 10.0), [[0, 4, 10], [0, 4, 10], [0, 2, 5], [0, 2, 5]]
    )
    with pytest.raises(ValueError, match="cross"):
        continued_lines([[(0.0, 0.0), (10.0, 4.0), (6.0, 6.0)]], 10.0)
