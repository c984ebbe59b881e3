"""Verdict of the solid on the beam, on rigs whose answer is known: slender, of ratio 3, a wide thin strip."""

from __future__ import annotations

import json
from importlib import import_module
from math import isnan, pi, sqrt
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import vibeam
from vibeam.cli.main import app
from vibeam.extensions.solid.sheet import sheet
from vibeam.extensions.solid.verdict.steps import ladder, solid_of
from vibeam.extensions.solid.verdict.study import FREQUENCIES, QUANTITIES
from vibeam.report.run_answer import run_answer
from vibeam_models.beam import structure_of

pytestmark = pytest.mark.usefixtures("undrawn")
STEEL = {"youngs_modulus": "210 GPa", "density": "7850 kg/m^3", "damping_ratio": 0.03}
YIELDING = {"law": "linear", "stiffness": "5e5 N/m", "damping": "20 N s/m", "gap": "0 mm"}


def rig(millimetres: tuple[float, float, float], hertz: tuple[float, float], **more: Any) -> dict[str, Any]:
    """Tables of a cantilever of length, width and thickness, met at 0.8 of its length, swept over a few frequencies."""
    length, width, thickness = millimetres
    at = f"{0.8 * length} mm"
    tables: dict[str, Any] = {
        "beam": {
            "length": f"{length} mm", "width": f"{width} mm", "thickness": f"{thickness} mm", "elements": 12, **STEEL
        },
        "stop": {"position": at, **YIELDING},
        "sensor": {"position": at},
        "drive": {"amplitude": "0.02 mm"},
        "sweep": {
            "frequency": {"from": f"{hertz[0]} Hz", "to": f"{hertz[1]} Hz", "points": 5}, "direction": "up",
            "settle": 120, "hold": 4,
        },
        "fidelity": {"beam": {"reduction": "modal", "modes": 3}},
    }  # fmt: skip
    return tables | more


RIGS = {
    "slender": rig(
        (100, 4, 4), (270, 390), mass={"mass": "20 g", "position": "80 mm"},
        stop={"gap": "0 mm", "restitution": 0.7, "restitution_of": "first mode"},
    ),
    "ratio 3": rig((30, 10, 10), (7500, 11000)),
    "wide strip": rig((10, 80, 0.5), (4200, 5800)),
}  # fmt: skip


@pytest.fixture(scope="module")
def found() -> dict[str, vibeam.studies.SolidVerdict]:
    accuracy = {"wide strip": 0.03}
    return {
        name: vibeam.solid_verdict(vibeam.load(tables), accuracy=accuracy.get(name, 0.05))
        for name, tables in RIGS.items()
    }


def test_of_a_slender_beam_the_beam_is_enough(found: dict[str, vibeam.studies.SolidVerdict]) -> None:
    slender = found["slender"]
    said = sheet(slender).answer
    assert slender.enough
    assert said.startswith("The beam suffices for 5 %: amplitudes within ")
    assert all(abs(slender.error(name)) < 0.02 for name in FREQUENCIES)


def test_of_a_beam_of_ratio_three_shear_is_the_largest_part(found: dict[str, vibeam.studies.SolidVerdict]) -> None:
    """The step is that of Timoshenko's beam, read off the case's own table."""
    short = found["ratio 3"]
    assert (short.enough, short.worst, short.largest) == (False, "amplitudes", "shear")
    sheared = vibeam.load(RIGS["ratio 3"], {"beam.theory": "timoshenko", "beam.poissons_ratio": 0.3})
    third = vibeam.modes(sheared, 3).rows[2].frequency
    by_hand = (third - short.beam.value("f3")) / short.solid.value("f3")
    assert short.steps["shear"]["f3"] == pytest.approx(by_hand, rel=1e-9)
    assert "; shear is the largest part. The worst of its first three natural frequencies is 8" in sheet(short).answer


def test_a_wide_strip_is_a_plate_and_bends_by_ei_over_one_less_the_square_of_the_ratio(
    found: dict[str, vibeam.studies.SolidVerdict],
) -> None:
    """Eight times as wide as long: cylindrical bending, ω ∝ 1/√(1 − ν²), to the mesh's error."""
    wide = found["wide strip"]
    parts = {cause: changes["f1"] for cause, changes in wide.steps.items()}
    before = wide.solid.value("f1") * (1 - parts["plate stiffening"] - parts["the clamp"])
    assert wide.solid.value("f1") / before == pytest.approx(1 / sqrt(1 - 0.3**2), abs=0.005)
    assert (wide.enough, max(parts, key=lambda cause: abs(parts[cause]))) == (False, "plate stiffening")
    assert abs(parts["three dimensions"]) < 1e-3


@pytest.mark.parametrize("name", list(RIGS))
def test_steps_add_up_to_what_the_beam_is_off(found: dict[str, vibeam.studies.SolidVerdict], name: str) -> None:
    """To the rounding of their sum, in every quantity that beam and solid have."""
    case = found[name]
    known = [each for each in QUANTITIES if not isnan(case.error(each))]
    assert {"f1", "f2", "f3", "flexibility", "mobility", "peak"} <= set(known)
    for quantity in known:
        assert sum(changes[quantity] for changes in case.steps.values()) == pytest.approx(
            -case.error(quantity), abs=1e-13
        )


def test_the_error_of_the_mesh_holds_what_a_finer_one_changes(
    found: dict[str, vibeam.studies.SolidVerdict],
) -> None:
    """Of the natural frequencies of the slender beam, on twice as many elements along it."""
    finer = with_solid("slender", **{"solid.along": 24, "solid.across": 4, "solid.through": 3})
    better = finer.system("body").omega / (2 * pi)
    for place, name in enumerate(FREQUENCIES):
        change = abs(float(better[place]) / found["slender"].solid.value(name) - 1)
        assert change < found["slender"].mesh_error(name) + 1e-5


def test_what_is_held_is_held_in_every_model(found: dict[str, vibeam.studies.SolidVerdict]) -> None:
    """R₁ is the case's; R of the contact follows by (1 + R₁) S/c₁² − 1, of the solid's own mobility S."""
    models = found["slender"].models
    assert {model.value("first_mode_restitution") for model in models} == {0.7}
    beam = vibeam.load(RIGS["slender"]).system("beam")
    assert models[0].value("restitution") == pytest.approx(beam.restitution, rel=1e-9)
    assert models[0].value("mobility") == pytest.approx(float((beam.contact**2).sum()), rel=1e-9)
    structure = structure_of(vibeam.load(RIGS["slender"]).scene)
    assert models[0].value("flexibility") == pytest.approx(structure.flexibility(structure.contact), rel=1e-7)
    ratio = (1 + models[-1].value("restitution")) / (1 + models[0].value("restitution"))
    assert ratio == pytest.approx(
        models[-1].value("mobility") / models[0].value("mobility"), rel=0.01
    )  # c₁ is the same to 1 %
    assert all(isnan(model.value("restitution")) for model in found["ratio 3"].models)


def test_the_way_to_the_solid_is_as_long_as_the_case_has_reasons() -> None:
    def causes(**settings: Any) -> list[str]:
        scene: Any = vibeam.load(RIGS["slender"], settings or None).scene
        return [step.cause for step in ladder(solid_of(scene))]

    assert causes() == ["", "shear", "three dimensions", "plate stiffening", "the clamp"]
    assert causes(**{"beam.ends": "pinned-pinned"}) == ["", "shear", "three dimensions", "plate stiffening"]
    assert "shear" not in causes(**{"beam.theory": "timoshenko", "beam.poissons_ratio": 0.3})
    twisted = {"torsion.eccentricity": "0.5 mm", "torsion.polar_inertia": "1e-6 kg m^2", "torsion.poissons_ratio": 0.3}
    assert [causes(**twisted)[at] for at in (1, -1)] == ["less St Venant's torsion", "torsion"]


def test_models_that_the_budget_does_not_hold_are_left_out_and_their_steps_stand_in_the_next() -> None:
    case = vibeam.load(RIGS["slender"])
    whole = vibeam.solid_verdict(case, budget=1e-9)
    assert whole.left_out == 4  # shear, three dimensions, plate stiffening, the coarser mesh
    cause = "shear, three dimensions, plate stiffening and the clamp"
    assert whole.steps[cause]["f1"] == pytest.approx(-whole.error("f1"), abs=1e-13)
    assert (list(whole.steps), whole.enough) == ([cause], None)  # how far the mesh is off is not known
    shown = sheet(whole)
    assert shown.answer.startswith("The beam is within 5 % of the solid: amplitudes within ")
    assert "; whether the solid's mesh is fine enough is open. " in shown.answer
    assert "did not fit into 1e-09 s of CPU time: vibeam verdict" in shown.notes[0]


def test_the_command_has_table_page_and_json(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    case = vibeam.load(RIGS["slender"])
    Path("rig.toml").write_text(case.text, encoding="utf-8")
    done = CliRunner().invoke(app, ["verdict", "rig.toml", "--only", "solid"])
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert lines[0].startswith("The beam suffices for 5 %")
    assert [line for line in lines if line.startswith(("+ shear", "+ three", "+ plate", "+ the clamp"))]
    assert {each.suffix for each in tmp_path.glob("rig_solid*")} >= {".csv"}
    head, *rows = (tmp_path / "rig_solid.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("model,cause,modes,cpu_seconds,number,mean,change,")
    assert {row.split(",")[0] for row in rows} >= {"beam", "Timoshenko's beam", "solid with held clamps"}
    made = json.loads(CliRunner().invoke(app, ["verdict", "rig.toml", "--only", "solid", "--json"]).stdout)
    assert made["enough"] is True
    assert list(made["steps"]) == ["shear", "three dimensions", "plate stiffening", "the clamp"]


SOLID = {"model": "solid", "reduction": "modal", "modes": 3}


def with_solid(name: str, **settings: Any) -> vibeam.Case:
    """A rig with a fidelity more, which is a solid."""
    tables = RIGS[name]
    return vibeam.load(tables | {"fidelity": tables["fidelity"] | {"body": SOLID}}, settings or None)


def test_the_stage_joins_where_a_fidelity_is_a_solid(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(import_module("vibeam.studies.verdict"), "_record", lambda name, *given: name)

    def stages(case: vibeam.Case, **settings: Any) -> list[str]:
        return [stage.name for stage in vibeam.studies.verdict(case, **settings).stages]

    beam, solid = vibeam.load(RIGS["slender"]), with_solid("slender")
    assert stages(solid) == ["modes", "effects", "solvers", "map", "solid"]
    assert stages(solid, only="modes") == ["modes"]
    assert stages(beam) == ["modes", "effects", "solvers", "map"]
    assert stages(beam, only=["modes", "solid"]) == ["modes", "solid"]


def test_a_run_measures_the_beam_by_the_solid() -> None:
    """With as many modes the beam is another model, less than the solid, and no other solver of it."""
    result = vibeam.run(with_solid("slender"), compare=True)
    assert result.finest == {"beam": "body", "body": "body"}
    [beam] = [each for each in result.compare() if each.reference]
    assert (beam.fidelity, beam.reference) == ("beam", "body")
    assert beam.comparison is not None
    assert beam.comparison.amplitude is not None
    words = f"beam is {round(100 * beam.comparison.amplitude_error, 1):g} % too"
    strict = with_solid("slender", **{"verdict.accuracy": beam.comparison.amplitude_error / 2})
    assert words in run_answer(vibeam.run(strict, compare=True))


def test_the_rigid_zone_that_a_measured_frequency_chose_calibrates_the_beam_and_blocks_predict() -> None:
    zone = {
        "mass": {"mass": "20 g", "position": "80 mm", "rotary_inertia": "6e-7 kg m^2", "rigid_half_width": "5 mm"},
        "show": {"modes": {"kind": "modal"}},
        "measured": {
            "second": {
                "fidelity": "beam", "show": "modes", "quantity": "mode_frequency", "number": 2, "value": "2100 Hz",
                "source": "a test",
            }
        },
        "chosen_by": {"mass.rigid_half_width": ["second"]},
        "solid": {"mass_size": ["10 mm", "12 mm", "10 mm"], "along": 12, "across": 2},
    }  # fmt: skip
    case = vibeam.load(RIGS["slender"] | zone | {"fidelity": RIGS["slender"]["fidelity"] | {"body": SOLID}})
    found = vibeam.solid_verdict(case)
    assert list(found.steps)[-1] == "the mass as a block"
    shown = sheet(found)
    columns = enumerate(shown.tables[1].columns)
    cells = {column.header or f"mark {at}": next(iter(column.cells)) for at, column in columns}
    assert (cells["mark 4"], cells["mark 6"]) == ("calibrated", "predicted")
    off = [100 * (model.value("f2") / 2100 - 1) for model in (found.beam, found.solid)]
    assert [float(str(cells[name]).split()[0]) for name in ("beam", "solid")] == pytest.approx(off, rel=5e-3)
    said = "the beam is calibrated by them; the solid reads no mass.rigid_half_width"
    assert any(said in each for each in shown.details)


def test_a_stop_off_the_axis_twists_the_solid_as_st_venant_has_it_of_a_square() -> None:
    """Little warps in a square that its clamp could hold; two elements through it resolve what does."""
    twisted = {"torsion.eccentricity": "1 mm", "torsion.polar_inertia": "1e-5 kg m^2", "torsion.poissons_ratio": 0.3}
    case = with_solid("slender", **twisted, **{"solid.through": 2, "solid.along": 6, "solid.across": 2})
    found = vibeam.solid_verdict(case, budget=1e-9)
    assert abs(found.error("twist")) < 0.015
    assert found.quantity(found.beam.twisted) == "twist"
    assert found.quantity(found.beam.numbers[1]) == "f2"


def test_a_case_without_a_beam_is_told_so() -> None:
    with pytest.raises(ValueError, match="nothing to compare with a solid"):
        vibeam.solid_verdict("cases/sdof_nominal.toml")
    with pytest.raises(ValueError, match="a massless beam has no solid: take"):
        vibeam.solid_verdict("cases/paper/eq38.toml")
