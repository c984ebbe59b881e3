"""Cases: what a file says is what the scene holds; overrides, identity, template and table of keys."""

import math
import pickle
import subprocess
import sys
import tomllib
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
from stand_in import one_mode

import vibeam
from vibeam.casefile.documentation import reference_table
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.read import case_of, parse
from vibeam.casefile.template import template
from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.effects.masses import AddedMass, RigidZone, RotaryInertia
from vibeam_models.scene import Mass, Scene, Sensor
from vibeam_models.sdof import SdofScene
from vibeam_models.stop import Stop

CASES = Path(__file__).parents[3] / "cases"
RIG = Beam(0.18, Rectangle(0.02, 0.001034), 210e9, 7850.0, Damping("constant", (0.017,)), 36)
SDOF = one_mode('{ from = "1.5 rad/s", to = "2.5 rad/s", points = 3 }', 0, 1, "[fidelity.exact]")


def test_the_rig_in_si_units():
    case = vibeam.load(CASES / "dtu_neutral.toml")
    assert case.scene == Scene(
        beam=RIG,
        mass=Mass(0.2, 0.132),
        stop=Stop(0.132, 0.0, 0.72, "sensor", "first mode"),
        sensor=Sensor(0.1),
        base=Base(voltage=0.6, gain=5.16e-4),
        effects=(RotaryInertia(2.988e-5), RigidZone(0.0117)),
    )
    assert (case.sweep.direction, case.sweep.settle, case.sweep.hold, case.sweep.output) == ("both", 300, 50, "sensor")
    assert np.array_equal(case.sweep.frequency, np.linspace(14, 17, 121))
    assert [(f.name, f.reduction, f.modes, f.solver) for f in case.fidelities.values()] == [
        ("sdof", "static_mode", None, "flight"),
        ("two_modes", "modal", 2, "flight"),
        ("beam", "modal", 8, "flight"),
    ]
    exact = case.references["exact"]
    assert exact.file == CASES / "references" / "dtu_neutral_sdof.csv"
    assert (exact.fidelity, exact.quantity, exact.tolerance, exact.direction) == ("sdof", "amplitude", 1e-5, "both")


@pytest.mark.parametrize("file", sorted(CASES.glob("*.toml")), ids=lambda file: file.stem)
def test_every_case_loads_says_its_source_and_builds_its_systems(file):
    case = vibeam.load(file)
    assert case.title
    assert case.source
    assert np.all(np.asarray(case.amplitude(2 * np.pi * case.sweep.frequency)) > 0)
    assert all(case.system(name).size >= 1 for name in case.fidelities)


@pytest.mark.parametrize(
    ("name", "gap", "restitution", "gain"), [("loose", 1e-4, 0.59, 7.66e-4), ("tight", -1e-4, 0.80, 3.78e-4)]
)
def test_the_other_gaps_have_their_own_fit(name, gap, restitution, gain):
    scene = vibeam.load(CASES / f"dtu_{name}.toml").scene
    assert scene.beam == RIG
    assert (scene.stop.gap, scene.stop.restitution, scene.base.gain) == (gap, restitution, gain)


def test_a_single_degree_of_freedom():
    case = parse(SDOF)
    assert case.scene == SdofScene(1.0, 0.015, 0.0, 0.9, 0.5e-3)
    assert 2 * math.pi * case.sweep.frequency == pytest.approx([1.5, 2, 2.5], rel=1e-15)
    assert case.fidelities["exact"].reduction == "static_mode"
    assert case.base_amplitude == 0.5e-3
    assert case.system("exact").size == 1
    assert case.title == "case"
    with pytest.raises(KeyError, match="no fidelity 'beam': there are exact"):
        case.system("beam")


def test_all_that_may_be_left_out_or_said_otherwise():
    case = parse(
        template(),
        set={
            "drive.voltage": None,
            "drive.gain": None,
            "drive.amplitude": "0.1 mm",
            "mass.rotary_inertia": None,
            "mass.rigid_half_width": None,
            "stop.position": "150 mm",
            "added_mass": [{"mass": "2.4 g", "position": "90 mm"}],
            "sweep.frequency": ["14 Hz", "15 Hz"],
            "sweep.output": "tip",
            "beam.damping": [0.017, "1 %"],
            "beam.damping_ratio": None,
        },
    )
    assert case.scene.mass == Mass(0.2, 0.132)
    assert case.scene.base == Base(amplitude=1e-4)
    assert case.scene.stop.position == 0.15
    assert case.scene.effects == (AddedMass(0.0024, 0.09),)
    assert case.scene.beam.damping == Damping("list", (0.017, 0.01))
    assert case.sweep.frequency.tolist() == [14.0, 15.0]
    assert case.sweep.output == "tip"
    assert parse(case.text).key == case.key
    rayleigh = parse(template(), set={"beam.damping": "rayleigh", "beam.damping_ratio": [0.017, 0.02]})
    assert rayleigh.scene.beam.damping == Damping("rayleigh", (0.017, 0.02))


def test_a_reference_is_checked_on_the_branches_that_are_swept():
    text = template() + '[reference.own]\nfile = "a.csv"\nfidelity = "sdof"\nquantity = "reach"\ntolerance = "1 %"\n'
    case = parse(text.replace("a.csv", __file__), set={"sweep.direction": "down"})
    assert case.references["own"].direction == "down"
    assert case.references["own"].file == Path(__file__)


@pytest.mark.parametrize("value", [31, "31", np.int64(31)])
def test_an_override_is_a_value_or_its_text(value):
    assert len(parse(template(), set={"sweep.frequency.points": value}).sweep.frequency) == 31


def test_an_override_opens_a_table_and_reaches_into_a_list():
    changes = {
        "fidelity.all.reduction": "full",
        "added_mass": [{"mass": "1 kg", "position": "0.1 m"}],
        "added_mass.0.mass": "1 g",
    }
    case = parse(template(), set=changes)
    assert case.fidelities["all"].reduction == "full"
    assert case.scene.effects[0].mass == 1e-3


def test_the_text_is_the_case():
    case = parse(template())
    assert parse(case.text).text == case.text
    assert len(case.key) == 64
    same = parse("# other words\n" + template().replace('"180 mm"', '"0.18 m"').replace("\n", "\r\n"))
    assert same.key == case.key
    assert parse(template(), set={"sweep.frequency.points": 121}).key == case.key
    other = parse(template(), set={"sweep.frequency.points": 31})
    assert other.key != case.key
    assert parse(other.text).key == other.key
    assert parse(parse(SDOF).text).key == parse(SDOF).key


def test_a_byte_order_mark_is_no_part_of_the_case(tmp_path):
    (tmp_path / "case.toml").write_text(template(), encoding="utf-8-sig")
    assert vibeam.load(tmp_path / "case.toml").key == parse(template()).key


def test_a_case_can_be_sent_elsewhere():
    case = parse(template())
    assert pickle.loads(pickle.dumps(case)).key == case.key


def test_the_template_is_the_rig():
    case = parse(template())
    assert case.scene == vibeam.load(CASES / "dtu_neutral.toml").scene
    assert list(case.fidelities) == ["sdof", "two_modes", "beam"]


def test_the_template_shows_every_key_and_fits_the_line():
    lines = template().splitlines()
    assert max(map(len, lines)) <= 120
    shown = {line.removeprefix("# ").split(" = ")[0] for line in lines if " = " in line}
    inside = {
        "from",
        "to",
        "points",
        "key",
        "values",
        "group",
        "rigid",
    }  # in lines of frequency, axes, materials, masses
    assert {key for key, _ in every_key(KINDS["beam"].declaration())} <= shown | inside


def test_the_template_explains_every_key_once():
    text = " ".join(" ".join(line.removeprefix("# ") for line in template().splitlines()).split())
    for key, meaning in every_key(KINDS["beam"].declaration()):
        assert " ".join(meaning.split()) in text, key
    assert text.count("how its motion is found") == 1
    lines = template().splitlines()
    assert "  " not in "\n".join(line.removeprefix("#   ") for line in lines if " = " not in line)


def every_key(model):
    for name, field in model.KEYS.items():
        if field.entry:
            yield name, field.description
        if field.table:
            yield from every_key(field.table)


def test_the_table_of_keys_has_them_all():
    rows = {(row.key, row.meaning) for row in reference_table()}
    assert rows == {key for kind in KINDS.values() for key in every_key(kind.declaration())}
    assert all(row.meaning and row.unit for row in reference_table())
    length = next(row for row in reference_table() if row.table == "[beam]")
    assert (length.table, length.key, length.unit, length.default, length.required) == (
        "[beam]",
        "length",
        "m > 0",
        "",
        True,
    )


def test_importing_loads_nothing_heavy():
    code = (
        "import sys, vibeam, vibeam.exchange.faults;"
        "assert not {'scipy', 'numba', 'numpy'} & set(sys.modules), sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": ":".join(sys.path)})


def test_loading_a_case_loads_no_solver():
    code = (
        "import sys, vibeam; vibeam.load(sys.argv[1]);"
        "assert not {'pydantic', 'scipy.linalg', 'scipy.sparse', 'numba', 'matplotlib', 'skfem'} & set(sys.modules)"
    )
    command = [sys.executable, "-c", code, str(CASES / "dtu_neutral.toml")]
    subprocess.run(command, check=True, env={"PYTHONPATH": ":".join(sys.path)})


def test_cases_are_equal_by_what_they_say(tmp_path):
    text = (CASES / "dtu_loose.toml").read_text("utf-8").split("[reference")[0]
    (tmp_path / "other.toml").write_text(f"# the same\n{text.replace('0.1 mm', '100 µm')}", "utf-8")
    one, same = parse(text), vibeam.load(tmp_path / "other.toml")
    assert one == same
    assert hash(one) == hash(same)
    assert one != parse(text, set={"stop.gap": "0.11 mm"})
    assert one != parse(text, set={"title": "another"})
    assert one != text
    for file in (
        CASES / "matrices" / "frame.toml",
        CASES / "maps" / "basins.toml",
        CASES / "experiment" / "fig27.toml",
    ):
        assert vibeam.load(file) == vibeam.load(file)


def test_a_case_is_tables_of_python_too():
    file = CASES / "dtu_loose.toml"
    tables = tomllib.loads(file.read_text("utf-8").split("[reference")[0])
    tables["sweep"]["frequency"] = tuple(f"{each} Hz" for each in np.linspace(14, 17, 3))
    tables["beam"]["elements"] = np.int64(12)
    case = vibeam.load(tables, set={"stop.gap": "0.2 mm"})
    assert case == vibeam.load(file, set={"sweep.frequency": ["14 Hz", "15.5 Hz", "17 Hz"], "beam.elements": 12,
                                          "stop.gap": "0.2 mm", "reference": None})  # fmt: skip
    with pytest.raises(vibeam.CaseError, match=r"case\.toml: beam\.length: 0\.18 has no unit"):
        vibeam.load(tables | {"beam": tables["beam"] | {"length": 0.18}})
    with pytest.raises(vibeam.CaseError, match="a object is no value of a case"):
        vibeam.load(tables | {"beam": object()})


def test_reading_changes_no_table():
    """Neither those that were read, whatever is set and left out in them, nor what was read."""
    axis = {"key": "sweep.frequency", "from": "14 Hz", "to": "15 Hz", "points": 2}
    own = {"reduction": "static_mode", "set": {"stop.gap": "1 mm"}, "without": ["mass.rotary_inertia"]}
    tables = tomllib.loads((CASES / "dtu_loose.toml").read_text("utf-8").split("[reference")[0])
    tables |= {"map": {"fidelity": "sdof", "picture": "values", "axes": [axis]}, "fidelity": {"sdof": own}}
    before = deepcopy(tables)
    case = case_of(tables, CASES / "loose.toml", {"mass.mass": "0.1 kg", "map.axes.0.points": 3, "title": None})
    assert tables == before
    assert case.maps["map"].fidelities == ("sdof",)
    assert case.scene_of("sdof").stop.gap == 1e-3
    with pytest.raises(AttributeError, match="StopTable is frozen"):
        case.keys.declared.stop.gap = 1.0


def test_functions_of_a_case_take_its_file():
    file = CASES / "dtu_loose.toml"
    assert vibeam.modes(str(file), 1).rows == vibeam.modes(vibeam.load(file), count=1).rows
    assert vibeam.modes(tomllib.loads(file.read_text("utf-8").split("[reference")[0]), 1).rows[0].number == 1
    assert pickle.loads(pickle.dumps(vibeam.run)) is vibeam.run
    with pytest.raises(vibeam.CaseError, match="no such file"):
        vibeam.run("nowhere.toml")
