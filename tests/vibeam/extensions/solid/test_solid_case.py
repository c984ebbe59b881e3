"""A fidelity that flies a solid: its scene, the digests of its case, what a solid cannot have, a case that has none."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

import vibeam
from vibeam.exchange.faults import CaseError
from vibeam.extensions.solid.elasticity.plan import Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene, assumed_poissons_ratio, assumptions
from vibeam_models.scene import Scene

TABLES: dict[str, Any] = {
    "units": "SI",
    "beam": {
        "length": 0.18, "width": 0.025, "thickness": 0.003, "youngs_modulus": 210e9, "density": 7850.0,
        "damping_ratio": 0.01, "elements": 6,
    },
    "mass": {"mass": 0.2, "position": 0.132},
    "stop": {"gap": 0.0, "restitution": 0.7},
    "sensor": {"position": 0.1},
    "drive": {"amplitude": 1e-4},
    "sweep": {"frequency": [14.0, 15.0], "settle": 20, "hold": 5},
    "solid": {"across": 2},
    "fidelity": {
        "beam": {"reduction": "modal", "modes": 3}, "solid": {"model": "solid", "reduction": "modal", "modes": 3},
    },
}  # fmt: skip


def case(**changes: Any) -> vibeam.Case:
    return vibeam.Case.of(TABLES, {key.replace("__", "."): value for key, value in changes.items()})


def faults(**changes: Any) -> list[str]:
    with pytest.raises(CaseError) as caught:
        case(**changes)
    return [str(each) for each in caught.value.faults]


def test_a_fidelity_flies_the_rig_as_a_solid_beside_its_beam() -> None:
    made = case()
    assert type(made.scene_of("beam")) is Scene
    solid: Any = made.scene_of("solid")
    assert type(solid) is SolidScene
    assert solid.solid == Solid(across=2)
    beam: Any = made.scene_of("beam")
    assert all(getattr(solid, name) == getattr(beam, name) for name in vars(beam))
    # The same rig: of a strip whose plate stiffening is a few per cent no mode is farther off than that.
    assert made.system("solid").omega == pytest.approx(made.system("beam").omega, rel=0.12)


def test_a_solid_takes_the_poissons_ratio_of_torsion_where_the_beam_says_none() -> None:
    torsion = {"eccentricity": 0.001, "polar_inertia": 1e-5, "poissons_ratio": 0.25}
    scene: Any = case(torsion=torsion).scene_of("solid")
    assert scene.beam.poissons_ratio == 0.25
    assert not scene.assumed
    plain: Any = case(torsion=torsion).scene_of("beam")
    assert plain.beam.poissons_ratio is None
    of_shear: Any = case(torsion={"eccentricity": 0.001, "polar_inertia": 1e-5, "shear_modulus": 80e9}).scene_of(
        "solid"
    )
    assert of_shear.beam.poissons_ratio is None
    assert of_shear.assumed


def test_a_case_without_the_table_flies_a_solid_too() -> None:
    scene: Any = case(solid=None).scene_of("solid")
    assert scene.solid == Solid()


def test_a_fidelity_sets_keys_of_its_solid() -> None:
    made = vibeam.Case.of(
        TABLES, {"fidelity.fine": {"model": "solid", "reduction": "static_mode", "set": {"solid.across": 6}}}
    )
    fine: Any = made.scene_of("fine")
    assert (fine.solid.across, type(fine)) == (6, SolidScene)
    models = [made.model(name).at({"beam.width": 0.03}).scene() for name in ("fine", "solid", "beam")]
    assert [type(each) for each in models] == [SolidScene, SolidScene, Scene]
    assert [each.beam.shape.width for each in models] == [0.03] * 3  # type: ignore[attr-defined]


def test_the_solid_is_part_of_what_its_own_fidelities_compute_alone() -> None:
    one, other = case(), case(solid__across=3)
    assert one.own["beam"] == other.own["beam"]
    assert one.own["solid"] != other.own["solid"]
    assert one.key != other.key
    plain = {key: value for key, value in TABLES.items() if key != "solid"}
    plain["fidelity"] = {"beam": TABLES["fidelity"]["beam"]}
    assert vibeam.Case.of(plain).own["beam"] == one.own["beam"]


def test_the_text_of_a_case_says_its_solid_again() -> None:
    made = case(solid__contact=[0.006, 0.02], solid__clamp="sliding", solid__mass_size=[0.02, 0.02, 0.01])
    again = vibeam.Case.of(__import__("tomllib").loads(made.text))
    assert again.scene_of("solid") == made.scene_of("solid")
    assert again.own == made.own


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"beam__massless": True, "fidelity__beam__modes": 1}, "beam.massless: a solid has the mass of its material"),
        ({"solid__contact": [0.006]}, "solid.contact: takes 2 numbers, not 1: length and width of the patch"),
        ({"solid__contact": [0.006, 0.03]}, "solid.contact: is 0.03 m wide on a beam 0.025 m wide"),
        ({"solid__contact": [0.1, 0.01]}, "solid.contact: reaches 0.002 m beyond the beam's end"),
        ({"solid__contact": "tip"}, "solid.contact: is a group of a mesh: write length and width"),
        ({"solid__mass_size": [0.02, 0.02]}, "solid.mass_size: takes 3 numbers, not 2: length, width and height"),
        ({"mass": None, "stop__position": 0.1, "solid__mass_size": [0.02, 0.02, 0.1]}, "is of an attached mass: add"),
        ({"solid__clamp": "loose"}, "solid.clamp: must be one of held, sliding"),
        ({"solid__symmetry": "middle"}, "solid.symmetry: goes with a mesh of your own alone"),
        ({"solid__damping_ratio": 0.1}, "solid.damping_ratio: beam.damping_ratio says it"),
        ({"solid__acros": 2}, "solid.acros: unknown key; did you mean 'across'?"),
        ({"fidelity__solid__reduction": "full", "fidelity__solid__modes": None}, 'write reduction = "modal", modes ='),
        ({"fidelity__solid__model": "solids"}, "fidelity.solid.model:"),
    ],
)
def test_what_a_solid_cannot_have_is_said_at_its_key(changes: dict[str, Any], said: str) -> None:
    found = faults(**changes)
    assert any(said in each for each in found), found


def test_a_material_that_keeps_its_volume_is_told_at_its_key() -> None:
    beam: Any = TABLES["beam"]
    [fault] = faults(beam=beam | {"poissons_ratio": 0.5})
    assert "beam.poissons_ratio: is 0.5, and a solid's stiffness grows without limit toward 0.5: write 0.49" in fault
    assert case(beam=beam | {"poissons_ratio": 0.49}).scene_of("solid").assumed == ()
    [fault] = faults(torsion={"eccentricity": 0.0, "polar_inertia": 1e-5, "poissons_ratio": 0.5})
    assert "torsion.poissons_ratio: is 0.5" in fault
    alone = {"beam": {"reduction": "modal", "modes": 3}}
    assert case(beam=beam | {"poissons_ratio": 0.5}, fidelity=alone).scene.in_three_dimensions is False


def test_a_fuller_model_of_a_solid_has_40_modes_and_the_rest_of_the_contacts_flexibility() -> None:
    made = case(stop={"gap": 1e-3, "restitution": 0.7}, sweep={"frequency": [14.0], "settle": 2, "hold": 2})
    [solid] = [each for each in vibeam.run(made).compare() if not each.reference]
    assert (solid.fidelity, solid.modes, solid.why) == ("solid", 41, "")


def test_a_general_section_has_no_form() -> None:
    beam = {key: value for key, value in TABLES["beam"].items() if key not in ("width", "thickness")}
    general = {"shape": "general", "area": 75e-6, "second_moment": 5.6e-11}
    [fault] = faults(beam=beam | general)
    assert 'beam.shape: a "general" section has no form that can be meshed' in fault


def test_a_fidelity_that_leaves_it_out_flies_a_solid_all_the_same() -> None:
    lighter = {"model": "solid", "reduction": "static_mode", "without": ["beam.massless"]}
    made = vibeam.Case.of(
        TABLES,
        {"beam.massless": True, "fidelity.beam.modes": 1, "fidelity.solid": lighter},
    )
    assert made.system("solid").size == 1


def test_poissons_ratio_is_that_of_the_material_and_said() -> None:
    assert [assumed_poissons_ratio(modulus)[0] for modulus in (205e9, 71e9, 115e9, 3e9)] == [0.3, 0.33, 0.34, 0.3]
    scene: Any = case().scene_of("solid")
    [said] = assumptions(scene)
    assert said.startswith("Poisson's ratio 0.3, of steel by E = 210 GPa, is assumed")
    known: Any = case(beam__poissons_ratio=0.28).scene_of("solid")
    assert not list(assumptions(known))


def test_poissons_ratio_of_blocks_and_the_round_off_of_a_very_thin_beam_are_said() -> None:
    blocks = {"solid.mass_size": [0.01, 0.02, 0.01], "solid.mass_youngs_modulus": 70e9, "beam.poissons_ratio": 0.28}
    [said] = assumptions(vibeam.Case.of(TABLES, blocks).scene_of("solid"))  # type: ignore[arg-type]
    assert said.startswith("Poisson's ratio 0.33, of aluminium")
    for thickness, sentences in ((0.18 / 1990, 0), (0.18 / 2010, 1)):
        thin: Any = case(beam__poissons_ratio=0.28, beam__thickness=thickness).scene_of("solid")
        assert len(list(assumptions(thin))) == sentences


def test_a_beams_case_imports_nothing_of_the_solid() -> None:
    code = """
import sys, vibeam
case = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 2})
case.system("beam")
own = "vibeam.extensions.solid"
known = {own, f"{own}.declared", f"{own}.stages"}
print([name for name in sys.modules if ("solid" in name or "meshio" in name) and name not in known])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
