"""A case of a mesh, and a mesh beside a beam: the same strip by vibeam's elements and by a file; what cannot go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from tests.vibeam.extensions.solid.test_solid_case import TABLES
from vibeam.exchange.faults import CaseError
from vibeam.extensions.solid.meshes import own
from vibeam.extensions.solid.sheet import answer
from vibeam_models.given import GivenScene

meshio = pytest.importorskip("meshio")

ALONG, ACROSS = 30, 2


def strip(path: Path, places: tuple[float, float] = (0.132, 0.1)) -> None:
    """Write the strip of TABLES in mm: eight-node elements, patches on top about the stop and the sensor."""
    ends = (180.0, 25.0, 3.0)
    counts = (ALONG, ACROSS, 1)
    axes = [
        np.linspace(-end / 2 * bool(i), end / (1 + bool(i)), n + 1)
        for i, (end, n) in enumerate(zip(ends, counts, strict=True))
    ]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)

    def at(i: int, j: int, k: int) -> int:
        return (i * (ACROSS + 1) + j) * 2 + k

    def top(i: int, j: int) -> list[int]:
        return [at(i, j, 1), at(i + 1, j, 1), at(i + 1, j + 1, 1), at(i, j + 1, 1)]

    cells = [
        [*(at(i + a, j + b, 0) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))), *top(i, j)]
        for i in range(ALONG) for j in range(ACROSS)
    ]  # fmt: skip
    faces = [([at(0, j, 0), at(0, j + 1, 0), at(0, j + 1, 1), at(0, j, 1)], 1) for j in range(ACROSS)]
    for tag, place in enumerate(places, 2):
        middle = round(1e3 * place / 180 * ALONG)
        faces += [(top(i, j), tag) for i in (middle - 1, middle) for j in range(ACROSS)]
    data = [np.full(len(cells), 9), np.array([tag for _, tag in faces])]
    made = meshio.Mesh(
        points,
        [("hexahedron", np.array(cells)), ("quad", np.array([face for face, _ in faces]))],
        cell_data={"gmsh:physical": data, "gmsh:geometrical": data},
        field_data={name: np.array([tag, 2]) for tag, name in enumerate(("clamp", "contact", "sensor"), 1)},
    )
    meshio.write(path, made, file_format="gmsh22", binary=False)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    strip(tmp_path / "strip.msh")
    monkeypatch.chdir(tmp_path)
    return tmp_path


MESH: dict[str, Any] = {"mesh": "strip.msh", "mesh_unit": "mm", "sensor": "sensor"}
STEEL: dict[str, Any] = {"youngs_modulus": 210e9, "density": 7850.0}
BARE = {key: value for key, value in TABLES.items() if key != "mass"} | {
    "stop": {"gap": 0.0, "restitution": 0.7, "position": 0.132},
    "solid": {"across": 2, "along": ALONG, "contact": [0.012, 0.025]},
}


def alone() -> dict[str, Any]:
    shared = {key: TABLES[key] for key in ("units", "drive", "sweep")}
    return shared | {
        "solid": MESH | {"damping_ratio": 0.01, "material": [STEEL]},
        "stop": {"gap": 0.0, "restitution": 0.7},
        "fidelity": {"many": {"reduction": "modal", "modes": 8}},
    }


def test_a_mesh_is_a_rig(folder: Path) -> None:
    case = vibeam.Case.of(alone())
    scene = case.scene
    assert isinstance(scene, GivenScene)
    assert scene.given.kind == "solid"
    assert scene.moving_mass == pytest.approx(7850 * 0.18 * 0.025 * 0.003, rel=1e-12)
    assert scene.assumed[0].startswith("Poisson's ratio 0.3, of steel")
    found, meshed = case.system("many"), vibeam.Case.of(BARE, {"fidelity.solid.modes": 3}).system("solid")
    # Bending alone moves the contact's mean. Both meshes are coarse, and their lines differ: 0.2 % of each other.
    bending = found.omega[np.abs(found.contact) > 1e-6 * np.abs(found.contact).max()]
    assert bending[:3] == pytest.approx(meshed.omega, rel=2e-3)


def test_a_mesh_flies_beside_its_beam(folder: Path) -> None:
    made = vibeam.Case.of(BARE | {"solid": MESH}, {"fidelity.solid.modes": 8})
    assert isinstance(made.scene_of("solid"), GivenScene)
    replaced = 'the mesh "strip.msh" stands for [beam]: its groups say clamp, contact, sensor, masses'
    assert replaced in made.scene_of("solid").assumed
    # A strip's plate stiffening and clamp are a few per cent.
    assert made.system("solid").omega[0] == pytest.approx(made.system("beam").omega[0], rel=0.05)
    strip(folder / "strip.msh", places=(0.12, 0.1))
    moved = vibeam.Case.of(BARE | {"solid": MESH}, {"fidelity.solid.modes": 8})
    assert moved.own["solid"] != made.own["solid"]
    assert moved.own["beam"] == made.own["beam"]


def test_a_mesh_without_faults_is_read_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read again where the file changed, or what is kept of it is damaged, and where it has faults."""
    monkeypatch.setenv("VIBEAM_CACHE", str(folder / "kept"))
    read, files = own.read_mesh, []
    monkeypatch.setattr(own, "read_mesh", lambda path: files.append(path.name) or read(path))

    def counted(**changes: Any) -> tuple[GivenScene, int]:
        own._body.cache_clear()
        files.clear()
        scene: Any = vibeam.Case.of(alone(), changes).scene
        return scene, len(files)

    (first, once), (second, none) = counted(), counted()
    assert (once, none, second) == (1, 0, first)
    assert (second.assumed, second.moving_mass) == (first.assumed, first.moving_mass)
    for kept in (folder / "kept").rglob("*.json"):
        kept.write_bytes(kept.read_bytes()[:-1])
    assert counted()[1] == 1
    strip(folder / "strip.msh", places=(0.12, 0.1))
    assert counted()[1] == 1
    with pytest.raises(CaseError, match=r"solid\.sensor"):
        counted(**{"solid.sensor": "nowhere"})
    with pytest.raises(CaseError, match=r"solid\.sensor"):
        counted(**{"solid.sensor": "nowhere"})


def test_the_verdict_on_a_beam_beside_a_mesh_says_which_solid_it_is_by(folder: Path) -> None:
    said = "The solid is meshed from the case's tables; it is not the mesh of fidelity solid."
    beside = vibeam.Case.of(BARE | {"solid": MESH}, {"fidelity.solid.modes": 8})
    assert answer(vibeam.solid_verdict(beside, budget=1e-9)).endswith(said)
    assert said not in answer(vibeam.solid_verdict(vibeam.Case.of(BARE), budget=1e-9))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"solid.mesh": "none.msh"}, "solid.mesh: none.msh"),
        ({"solid.mesh_unit": None}, "solid.mesh_unit: missing"),
        ({"solid.mesh_unit": "kg"}, "solid.mesh_unit:"),
        ({"solid.material": None}, "solid.material: missing (what the mesh is made of)"),
        ({"solid.contact": [0.01, 0.02]}, "solid.contact: a mesh has the contact as a group of facets"),
        ({"solid.contact": "stop"}, "solid.contact:"),
        ({"solid.sensor": {"group": "sensor", "direction": "up"}}, "solid.sensor: direction must be one of"),
        ({"solid.across": 3}, "solid.across: is of a body that is meshed"),
        ({"solid.damping_ratio": None}, "solid.damping_ratio: missing (damping ratio of the first mode)"),
        ({"fidelity.many": {"reduction": "full"}}, "too many coordinates"),
        ({"sweep.output": "tip"}, "sweep.output: 'tip' is no output"),
        ({"drive": {"force": 1.0}}, "drive.force: acts where solid.force says"),
        ({"beam": TABLES["beam"]}, "solid.damping_ratio: beam.damping_ratio says it"),
    ],
)
def test_what_a_case_of_a_mesh_cannot_have_is_said_at_its_key(folder: Path, changes: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError) as caught:
        vibeam.Case.of(alone(), changes)
    found = [str(each) for each in caught.value.faults]
    assert any(said in each for each in found), found


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"gravity": {"direction": "transverse"}}, "gravity: a mesh of your own does not know it"),
        ({"sweep.output": "tip"}, 'sweep.output: the mesh has no "tip": write outputs = { tip = "GROUP" }'),
        ({"drive": {"moment": 1.0, "at": 0.1}}, "drive.moment: acts on a beam"),
        ({"drive": {"force": 1.0, "at": 0.1}}, "solid.force: is where drive.force acts on the mesh"),
    ],
)
def test_what_a_mesh_beside_a_beam_cannot_have_is_said(folder: Path, changes: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError) as caught:
        vibeam.Case.of(BARE | {"solid": MESH}, changes)
    found = [str(each) for each in caught.value.faults]
    assert any(said in each for each in found), found


def test_a_mesh_is_assembled_where_its_structure_is_first_asked_for(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from vibeam.extensions.solid.elasticity import own_structure

    made, assemble = [], own_structure.body_structure
    monkeypatch.setattr(own_structure, "body_structure", lambda *given: made.append(given) or assemble(*given))
    scene: Any = vibeam.Case.of(alone(), {"solid.material": [STEEL | {"density": 7801.0}]}).scene
    assert made == []
    assert scene.given.structure is scene.given.structure
    assert len(made) == 1
