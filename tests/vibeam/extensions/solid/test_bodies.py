"""Meshes of a scene's bodies: volumes, masses, one sign of the Jacobian, conformity, symmetry, patches."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.extensions.solid.elasticity.body import SolidBody
from vibeam.extensions.solid.elasticity.elasticity import SolidElements
from vibeam.extensions.solid.elasticity.geometry.bodies import body_of
from vibeam.extensions.solid.elasticity.geometry.lines import continued_lines
from vibeam.extensions.solid.elasticity.plan import CLAMPS, Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene

BEAM: dict[str, Any] = {
    "length": "200 mm", "width": "20 mm", "thickness": "4 mm", "youngs_modulus": "210 GPa", "density": "8000 kg/m^3",
    "damping_ratio": 0.01, "elements": 12,
}  # fmt: skip


def scene(beam: dict[str, Any] | None = None, **more: Any) -> SolidScene:
    return scene_of({**BEAM, **(beam or {})}, **more)


def scene_of(beam: dict[str, Any], **more: Any) -> SolidScene:
    plan = more.pop("plan", Solid())
    case = {
        "beam": beam, "stop": {"gap": "1 mm", "restitution": 0.5, "position": "150 mm"},
        "sensor": {"position": "100 mm"}, "drive": {"amplitude": "0.1 mm"},
        "sweep": {"frequency": {"from": "10 Hz", "to": "20 Hz", "points": 2}, "settle": 10, "hold": 10},
        "fidelity": {"one": {"reduction": "static_mode"}}, **more,
    }  # fmt: skip
    return SolidScene(**vars(vibeam.load(case).scene), solid=plan)


def assert_sound(body: SolidBody) -> None:
    """One sign of all Jacobians; every inner facet is in two cells, every outer one on the surface alone."""
    elements = SolidElements(body.mesh)
    found = np.linalg.det(elements.jacobian(elements.quadrature[0]))
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


def plate(**keys: Any) -> dict[str, Any]:
    return {"start": "60 mm", "end": "100 mm", "width": "12 mm", "thickness": "1 mm", "density": "8000 kg/m^3", **keys}


FLAT = {
    "hollow": {"beam": {"shape": "hollow rectangle", "thickness": "10 mm", "wall": "2 mm"}},
    "I": {"beam": {"shape": "I", "thickness": "20 mm", "web": "4 mm", "flange": "3 mm"}},
    "steps": {
        "section": [
            {"start": "0 mm", "end": "50 mm", "width": "30 mm", "thickness": "6 mm"},
            {"start": "120 mm", "end": "200 mm", "width": "10 mm", "end_width": "20 mm", "thickness": "3 mm"},
        ]
    },
    "taper": {"section": [{"start": "20 mm", "end": "200 mm", "end_width": "8 mm", "end_thickness": "1 mm"}]},
    "tapered hollow": {
        "beam": {"shape": "hollow rectangle", "thickness": "10 mm", "wall": "2 mm"},
        "section": [{"start": "20 mm", "end": "200 mm", "end_width": "10 mm", "end_thickness": "6 mm"}],
    },
    "plates": {
        "plate": [plate(), plate(sides="both", width="26 mm", start="90 mm"), plate(stiffens=False, end="200 mm")]
    },
    "added": {"beam": {"added_mass_per_length": "0.2 kg/m"}},
}  # fmt: skip


@pytest.mark.parametrize("name", FLAT)
@pytest.mark.parametrize("whole", [None, True])
def test_flat_bodies_have_the_mass_of_their_beam(name: str, whole: bool | None) -> None:
    made = scene(**FLAT[name], plan=Solid(whole=whole, along=8))
    body = body_of(made)
    assert_sound(body)
    assert body.mass == pytest.approx(made.carrier.mass, rel=1e-9)


def test_a_mass_of_blocks_weighs_what_the_case_says() -> None:
    made = scene(mass={"mass": "0.2 kg", "position": "190 mm"}, plan=Solid(mass_size=(0.02, 0.03, 0.01)))
    body = body_of(made)
    assert_sound(body)
    assert body.mass == pytest.approx(made.carrier.mass + 0.2, rel=1e-9)
    blocks = body.mesh.p[:, body.mesh.t[:, ~body.beam]]
    assert blocks[0].min() == pytest.approx(0.18)
    assert blocks[0].max() == pytest.approx(0.2)
    assert blocks[2].max() == pytest.approx(0.012)


def test_the_stop_meets_the_block_where_the_mass_is() -> None:
    body = body_of(scene(mass={"mass": "0.2 kg", "position": "150 mm"}, plan=Solid(mass_size=(0.02, 0.03, 0.01))))
    assert np.allclose(body.mesh.p[2, body.mesh.facets[:, body.patches["contact"]]], 0.012)


@pytest.mark.parametrize(
    ("shape", "beam", "further"),
    [
        ("round", {"diameter": "10 mm"}, {}),
        ("tube", {"outer_diameter": "10 mm", "wall": "2 mm"}, {}),
        ("round", {"diameter": "10 mm"}, {"section": [{"start": "40 mm", "end": "200 mm", "end_diameter": "4 mm"}]}),
        (
            "round",
            {"diameter": "10 mm"},
            {
                "section": [
                    {"start": "60 mm", "end": "140 mm", "shape": "tube", "outer_diameter": "14 mm", "wall": "3 mm"}
                ]
            },
        ),
    ],
)
def test_circular_bodies_converge_to_their_mass_with_the_fourth_power(
    shape: str, beam: dict[str, Any], further: dict[str, Any]
) -> None:
    bar = {key: value for key, value in BEAM.items() if key not in ("width", "thickness")}
    case = {**bar, "shape": shape, **beam}
    off = []
    for across in (4, 8):
        made = scene_of(case, plan=Solid(along=8, across=across), **further)
        body = body_of(made)
        assert_sound(body)
        off.append(abs(body.mass / made.carrier.mass - 1))
    assert off[0] < 3e-4
    assert off[1] < off[0] / 12  # 16 with h⁴


def test_held_faces_have_planes_in_their_boundary_layer() -> None:
    """A quarter of the height from the clamp and on, where elements are longer; none where the clamp slides."""
    thin = {"thickness": "1 mm"}
    planes = {clamp: np.unique(body_of(scene(thin, plan=Solid(clamp=clamp))).mesh.p[0]) for clamp in CLAMPS}
    assert np.isin(np.round([0.00025, 0.00075, 0.0017, 0.0035], 9), np.round(planes["held"], 9)).all()
    assert planes["sliding"][1] > 0.01


def test_sections_that_touch_in_a_line_alone_are_refused() -> None:
    bar = {key: value for key, value in BEAM.items() if key not in ("width", "thickness")} | {"shape": "round"}
    tube = {"start": "90 mm", "end": "200 mm", "shape": "tube", "outer_diameter": "16 mm", "wall": "2 mm"}
    with pytest.raises(ValueError, match="before and after 90 mm share no area"):
        body_of(scene_of({**bar, "diameter": "12 mm"}, section=[tube]))
    body_of(scene_of({**bar, "diameter": "12.1 mm"}, section=[tube]))


MASS = {"mass": "1 kg", "position": "100 mm"}
TAPER = {"start": "50 mm", "end": "110 mm", "end_width": "3 mm"}


@pytest.mark.parametrize(
    ("beam", "further", "plan", "told"),
    [
        ({"shape": "general", "area": "20 mm^2", "second_moment": "2 mm^4"}, {}, {}, "no geometry"),
        ({"shape": "round", "diameter": "9 mm"}, {"mass": MASS}, {"mass_size": (0.01, 0.01, 0.01)}, "circular"),
        ({"width": "9 mm", "thickness": "3 mm"}, {"mass": MASS}, {"mass_size": (0.3, 0.01, 0.01)}, "300 mm about"),
        ({"width": "9 mm", "thickness": "3 mm"}, {}, {"contact": (0.01, 0.01)}, "reaches 5 mm off the axis"),
        ({"width": "9 mm", "thickness": "3 mm"}, {"plate": [plate(width="6 mm")], "section": [TAPER]}, {}, "cross"),
    ],
)  # fmt: skip
def test_what_has_no_structured_mesh_is_said(
    beam: dict[str, Any], further: dict[str, Any], plan: dict[str, Any], told: str
) -> None:
    bar = {key: value for key, value in BEAM.items() if key not in ("width", "thickness")}
    with pytest.raises(ValueError, match=told):
        body_of(scene_of({**bar, **beam}, plan=Solid(**plan), **further))
