"""[modes]: measured or computed modes in place of a beam."""

import sys
from pathlib import Path

import numpy as np
import pytest
from nastran_files import OP2, Output2

import vibeam
from vibeam.casefile.examples import texts
from vibeam.exchange.faults import CaseError

MODES = """\
[modes]
frequency = ["5 Hz", "12 Hz", "40 Hz"]
damping_ratio = [0.01, 0.02, 0.03]
contact = [0.7, 0.5, -0.2]
sensor = [0.4, -0.6, 0.1]
base = [1.8, -0.5, 0.3]

[stop]
gap = "1 mm"
restitution = 0.7

[drive]
amplitude = "0.1 mm"

[sweep]
frequency = { from = "4 Hz", to = "6 Hz", points = 3 }
settle = 20
hold = 10

[fidelity.sdof]
reduction = "static_mode"

[fidelity.two]
reduction = "modal"
modes = 2

[fidelity.whole]
reduction = "full"
"""

FREQUENCY, DAMPING = np.array([5.0, 12.0, 40.0]), np.array([0.01, 0.02, 0.03])

CONTACT, SENSOR, BASE = np.array([[0.7, 0.5, -0.2], [0.4, -0.6, 0.1], [1.8, -0.5, 0.3]])


def case(folder: Path, text: str = MODES) -> vibeam.Case:
    (folder / "modes.toml").write_text(text, encoding="utf-8")
    return vibeam.load(folder / "modes.toml")


def faults(folder: Path, text: str) -> list[str]:
    with pytest.raises(vibeam.CaseError) as caught:
        case(folder, text)
    return [line.partition("modes.toml:")[2] for line in str(caught.value).splitlines()]


def signed(row: np.ndarray) -> np.ndarray:
    """Modes with a positive contact."""
    return row * np.sign(CONTACT)


def test_modes_are_taken_as_they_are(tmp_path: Path) -> None:
    system = case(tmp_path).system("whole")
    np.testing.assert_allclose(system.omega, 2 * np.pi * FREQUENCY, rtol=1e-14)
    np.testing.assert_allclose(system.zeta, DAMPING, rtol=1e-13)
    np.testing.assert_allclose(system.contact, signed(CONTACT), rtol=1e-14)
    np.testing.assert_allclose(system.outputs["sensor"], signed(SENSOR), rtol=1e-14)
    np.testing.assert_allclose(system.load, signed(BASE), rtol=1e-14)
    two = case(tmp_path).system("two")
    np.testing.assert_allclose(two.load, signed(BASE)[:2], rtol=1e-14)


def test_the_static_mode_of_three_modes_by_hand(tmp_path: Path) -> None:
    """Under a load at the contact each mode deflects by c/ω²; scaled to 1 at the sensor."""
    squared = (2 * np.pi * FREQUENCY) ** 2
    shape = CONTACT / squared
    shape /= SENSOR @ shape
    system = case(tmp_path).system("sdof")
    assert system.omega[0] ** 2 == pytest.approx((shape**2 @ squared) / (shape @ shape), rel=1e-13)
    assert abs(system.contact[0]) == pytest.approx(abs(CONTACT @ shape) / np.sqrt(shape @ shape), rel=1e-13)


def test_the_printed_modes_of_matrices_are_these_matrices(tmp_path: Path) -> None:
    for name, text in texts("frame")[1].items():
        (tmp_path / name.removeprefix("frame_")).write_text(text)
    rest = MODES.partition("[stop]")[2].replace("modes = 2", "modes = 1")
    matrices = 'mass = "M.mtx"\nstiffness = "K.mtx"\ndamping_ratio = 0.01\ncontact = 2\nsensor = 1\nbase = "all"\n'
    frame = case(tmp_path, f'units = "SI"\n[matrices]\n{matrices}[stop]{rest}')
    rows = vibeam.modes(frame).rows
    keys = {"frequency": "frequency", "damping_ratio": "damping_ratio", "contact": "contact", "sensor": "sensor"}
    said = [f"{key} = {[getattr(row, name) for row in rows]}" for key, name in (keys | {"base": "load"}).items()]
    own = case(tmp_path, "\n".join(['units = "SI"', "[modes]", *said, f"[stop]{rest}"]))
    omega = 2 * np.pi * frame.sweep.frequency
    for name in frame.fidelities:
        one, other = (
            vibeam.sweep(
                each.system(name), omega=omega, amplitude=each.base_amplitude, settle=20, hold=10, output="sensor"
            )
            for each in (own, frame)
        )
        np.testing.assert_allclose(one.amplitude, other.amplitude, rtol=1e-10)


def test_shapes_of_any_scale_with_their_modal_masses(tmp_path: Path) -> None:
    mass = np.array([2.0, 0.5, 7.0])
    scaled = [
        f"{name} = {(row * np.sqrt(mass)).tolist()}"
        for name, row in zip(("contact", "sensor", "base"), (CONTACT, SENSOR, BASE), strict=True)
    ]
    lines = MODES.splitlines()
    text = "\n".join([*lines[:3], *scaled, 'modal_mass = ["2 kg", "500 g", "7 kg"]', *lines[6:]])
    one, other = case(tmp_path, text).system("whole"), case(tmp_path).system("whole")
    for field in ("contact", "load"):
        np.testing.assert_allclose(getattr(one, field), getattr(other, field), rtol=1e-14)


def test_a_force_on_modes(tmp_path: Path) -> None:
    text = MODES.replace("base = [1.8, -0.5, 0.3]", "force = [0.1, 0.2, 0.3]").replace(
        'amplitude = "0.1 mm"', 'force = "3 N"'
    )
    forced = case(tmp_path, text)
    np.testing.assert_allclose(forced.system("whole").load, signed(np.array([0.1, 0.2, 0.3])), rtol=1e-14)
    omega = 2 * np.pi * forced.sweep.frequency
    np.testing.assert_allclose(forced.amplitude(omega), 3 / omega**2, rtol=1e-14)


PLATFORM = '\n[platform]\nmass = "5 kg"\nfrequency = "3 Hz"\ndamping_ratio = 0.05\ncoupling = "two-way"\n'

OF_KEYS = [
    ("contact = [0.7, 0.5, -0.2]", "contact = [0.7, 0.5]", "4: modes.contact: 2 numbers for 3 modes"),
    ("contact = [0.7, 0.5, -0.2]", "contact = 2", "4: modes.contact: must be list of numbers, one for each mode"),
    ("contact = [0.7, 0.5, -0.2]", "contact = [0, 0, 0]", "4: modes.contact: reads nothing"),
    ("contact = [0.7, 0.5, -0.2]\n", "", "1: modes.contact: missing"),
    (
        "contact = [0.7, 0.5, -0.2]", 'contact = { node = 1, direction = "x" }',
        "4: modes.contact: a node and its direction are of a file"
    ),
    ("[0.01, 0.02, 0.03]", "[0.01, 0.02]", "3: modes.damping_ratio: 2 numbers for 3 modes"),
    ("damping_ratio = [0.01, 0.02, 0.03]\n", "", "1: modes.damping_ratio: missing: write damping_ratio = […"),
    ('frequency = ["5 Hz", "12 Hz", "40 Hz"]\n', "", "1: modes.frequency: missing: write frequency"),
    ('["5 Hz", "12 Hz", "40 Hz"]', '["12 Hz", "5 Hz", "40 Hz"]', "2: modes.frequency: the list must ascend"),
    ("base = [1.8, -0.5, 0.3]\n", "", "1: modes.base: missing"),
    ("[modes]", '[modes]\nfile = "none.uff"', "2: modes.file: none.uff: no such file"),
    ("[modes]", '[modes]\nfile = "/dev/zero"', "2: modes.file: /dev/zero: is not a regular file"),
    ("modes = 2", "modes = 4", "25: fidelity.two.modes: 4 are more than the model has: [modes] gives 3 at most"),
    ("[stop]", "[torsion]\n[stop]", "8: torsion: [torsion] and [modes] do not go together"),
    ("[stop]", "[matrices]\n[stop]", "1: modes: [modes] and [matrices] do not go together: keep one of the two"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "expected"), OF_KEYS)
def test_faults_name_line_key_and_cure(old: str, new: str, expected: str, tmp_path: Path) -> None:
    assert old in MODES
    found = faults(tmp_path, MODES.replace(old, new, 1))
    assert any(line.startswith(expected) for line in found), found


def test_a_platform_wants_the_mass_that_it_carries(tmp_path: Path) -> None:
    text = MODES.replace('amplitude = "0.1 mm"', 'force = "1 N"') + PLATFORM
    assert "modes.moving_mass: missing" in faults(tmp_path, text)[0]
    light = text.replace("[modes]", '[modes]\nmoving_mass = "3 kg"')
    assert "3 kg is less than the modes move by themselves, 3.58 kg" in faults(tmp_path, light)[0]
    heavy = case(tmp_path, text.replace("[modes]", '[modes]\nmoving_mass = "4 kg"'))
    assert heavy.system("whole").size == 4


def test_without_pyuff_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyuff", None)
    (tmp_path / "rig.uff").write_text("    -1\n")
    found = faults(tmp_path, MODES.replace("[modes]", '[modes]\nfile = "rig.uff"'))
    assert "pip install 'vibeam[lab]'" in found[0]


def universal(path: Path, kind: str = "normal", modal_mass: float = 2.0) -> None:
    """The modes at nodes 3 (contact, z) and 9 (sensor, y; force, z) as pyuff writes them."""
    pyuff = pytest.importorskip("pyuff")
    for index in range(3):
        shape = np.array([[0.0, 0.0, CONTACT[index]], [0.0, SENSOR[index], BASE[index]]]) * np.sqrt(modal_mass)
        data = {
            "type": 55, "model_type": 1, "data_ch": 2, "spec_data_type": 8, "n_data_per_node": 3, "load_case": 1,
            "mode_n": index + 1, "node_nums": np.array([3, 9]), "data_type": 2, "analysis_type": 2,
        }  # fmt: skip
        omega, zeta = 2 * np.pi * FREQUENCY[index], DAMPING[index]
        if kind == "normal":
            data |= {"freq": FREQUENCY[index], "modal_m": modal_mass, "modal_damp_vis": zeta, "modal_damp_his": 0.0}
        else:
            damped = omega * np.sqrt(1 - zeta**2)
            turn = np.exp(0.7j)
            data |= {"analysis_type": 3, "data_type": 5, "eig": -zeta * omega + 1j * damped}
            data |= {"modal_a": 2j * damped * modal_mass * turn**2, "modal_b": 0j}
            out = {"twisted": 0.5, "slightly": 0.05, "second": 0.5 * (index == 1)}.get(kind, 0.0)
            shape = shape * turn * (1 + 1j * out * np.array([[0.0], [1.0]]))
        data |= {f"r{direction + 1}": shape[:, direction] for direction in range(3)}
        pyuff.UFF(str(path))._write_set(data, "overwrite" if index == 0 else "add")


PLACES = MODES.replace('frequency = ["5 Hz", "12 Hz", "40 Hz"]\ndamping_ratio = [0.01, 0.02, 0.03]', 'file = "rig.uff"')
PLACES = PLACES.replace("[0.7, 0.5, -0.2]", '{ node = 3, direction = "z" }')
PLACES = PLACES.replace("[0.4, -0.6, 0.1]", "[{ node = 9, direction = 2 }]").replace(
    "base = [1.8, -0.5, 0.3]", 'force = { node = 9, direction = "z" }'
)
PLACES = PLACES.replace('amplitude = "0.1 mm"', 'force = "1 N"')


@pytest.mark.parametrize("kind", ["normal", "complex"])
def test_modes_of_a_universal_file(kind: str, tmp_path: Path) -> None:
    """Its numbers have six digits."""
    universal(tmp_path / "rig.uff", kind)
    system = case(tmp_path, PLACES).system("whole")
    np.testing.assert_allclose(system.omega, 2 * np.pi * FREQUENCY, rtol=1e-5)
    np.testing.assert_allclose(system.zeta, DAMPING, rtol=1e-4)
    np.testing.assert_allclose(np.abs(system.contact), np.abs(CONTACT), rtol=1e-4)
    np.testing.assert_allclose(system.outputs["sensor"], signed(SENSOR), rtol=1e-4)
    np.testing.assert_allclose(system.load, signed(BASE), rtol=1e-4)


def test_faults_of_a_universal_file(tmp_path: Path) -> None:
    universal(tmp_path / "rig.uff")
    assert "the file has no node 4 with direction 3: its nodes are 3, 9" in faults(
        tmp_path, PLACES.replace("node = 3", "node = 4")
    )[0]  # fmt: skip
    universal(tmp_path / "rig.uff", modal_mass=0.0)
    assert "modes.modal_mass: missing" in faults(tmp_path, PLACES)[0]
    universal(tmp_path / "rig.uff", "twisted")
    assert "mode 1 (5 Hz) is complex, 14 % of it out of phase: at most 10 %" in faults(tmp_path, PLACES)[0]
    (tmp_path / "rig.uff").write_text("nothing of the kind\n")
    assert "rig.uff: " in faults(tmp_path, PLACES)[0]


def test_a_mode_that_is_too_complex_is_named_and_can_be_omitted(tmp_path: Path) -> None:
    universal(tmp_path / "rig.uff", "second")
    assert 'leave it out, skip = ["12 Hz"]' in faults(tmp_path, PLACES)[0]
    without = case(tmp_path, PLACES.replace("[modes]", '[modes]\nskip = ["12.05 Hz"]')).system("whole")
    np.testing.assert_allclose(without.omega, 2 * np.pi * np.array(FREQUENCY)[[0, 2]], rtol=1e-5)
    np.testing.assert_allclose(np.abs(without.contact), np.abs(np.array(CONTACT)[[0, 2]]), rtol=1e-4)
    off = faults(tmp_path, PLACES.replace("[modes]", '[modes]\nskip = ["13 Hz"]'))[0]
    assert "has no mode at 13 Hz to skip: its modes are at 5, 12, 40 Hz" in off
    assert (
        "modes.skip: omits modes of a file" in faults(tmp_path, MODES.replace("[modes]", '[modes]\nskip = ["5 Hz"]'))[0]
    )


def test_a_mode_that_is_slightly_complex_is_taken_as_real_and_said(tmp_path: Path) -> None:
    """Of a shape (a, b w) with w = 1 + 0.05i the part that no turn makes real is at most half of 0.05."""
    universal(tmp_path / "rig.uff", "slightly")
    [taken] = case(tmp_path, PLACES).scene.assumed
    assert taken.startswith("taken: rig.uff, universal file, shapes up to 2.")
    assert taken.endswith("% out of phase taken as real, 3 modes, 5 to 40 Hz, 2 nodes")


def test_the_key_follows_the_file(tmp_path: Path) -> None:
    universal(tmp_path / "rig.uff")
    one = case(tmp_path, PLACES)
    universal(tmp_path / "rig.uff", modal_mass=1.0)
    assert case(tmp_path, PLACES).key != one.key


@pytest.mark.parametrize("key", ["contact", "sensor", "base"])
def test_a_number_that_no_double_holds_is_a_fault(key):
    case = Path(__file__).parents[3] / "cases" / "matrices" / "dtu_modes.toml"
    with pytest.raises(CaseError, match=rf"--set modes\.{key}: "):
        vibeam.load(case, set={f"modes.{key}": [1.0, 10**400]})


def output2(path: Path, modal_mass: list[float] | None, twisted: bool = False) -> None:
    """The modes in OUTPUT2, at point 3 (contact, z), 9 (sensor, y; force, z), and scalar point 12 (contact)."""
    shapes = np.zeros((3, 3, 6))
    scale = np.sqrt(1.0 if modal_mass is None else np.array(modal_mass))
    shapes[:, 0, 2] = shapes[:, 2, 0] = CONTACT * scale
    shapes[:, 1, 1], shapes[:, 1, 2] = SENSOR * scale, BASE * scale
    file = Output2()
    squares = ((2 * np.pi * FREQUENCY) ** 2).tolist()
    points = [(3, 1), (9, 1), (12, 2)]
    file.modes(squares, shapes, points, masses=modal_mass, approach=9 if twisted else 2)
    path.write_bytes(file.content)


OUTPUT2 = PLACES.replace("rig.uff", "rig.op2").replace("[modes]", "[modes]\ndamping_ratio = [0.01, 0.02, 0.03]")


@OP2
@pytest.mark.parametrize("node", ['node = 3, direction = "z"', "node = 12, direction = 1"])
def test_modes_of_output2(node: str, tmp_path: Path) -> None:
    """Its numbers are of single precision."""
    output2(tmp_path / "rig.op2", [2.0, 0.5, 3.0])
    made = case(tmp_path, OUTPUT2.replace('node = 3, direction = "z"', node))
    system = made.system("whole")
    np.testing.assert_allclose(system.omega, 2 * np.pi * FREQUENCY, rtol=1e-6)
    np.testing.assert_allclose(system.zeta, DAMPING, rtol=1e-6)
    np.testing.assert_allclose(np.abs(system.contact), np.abs(CONTACT), rtol=1e-6)
    np.testing.assert_allclose(system.outputs["sensor"], signed(SENSOR), rtol=1e-6)
    np.testing.assert_allclose(system.load, signed(BASE), rtol=1e-6)
    said = "taken: rig.op2, Nastran OUTPUT2, modal masses as kg, 3 modes, 5 to 40 Hz, 3 nodes"
    assert made.scene.assumed == (said,)


@OP2
def test_what_output2_does_not_say_is_asked_for(tmp_path: Path) -> None:
    output2(tmp_path / "rig.op2", None)
    assert 'write modal_mass = "1 kg" if they are mass-normalised' in faults(tmp_path, OUTPUT2)[0]
    assert case(tmp_path, OUTPUT2.replace("[modes]", '[modes]\nmodal_mass = "1 t"')).system("whole").contact == (
        pytest.approx(signed(CONTACT) / np.sqrt(1000), rel=1e-6)
    )
    output2(tmp_path / "rig.op2", [1.0, 1.0, 1.0])
    [said] = faults(tmp_path, OUTPUT2.replace("damping_ratio = [0.01, 0.02, 0.03]", ""))
    assert "modes.damping_ratio: missing: write damping_ratio = […, …], one for each mode" in said
    output2(tmp_path / "rig.op2", None, twisted=True)
    assert "rig.op2: has no real modes (SOL 103)" in faults(tmp_path, OUTPUT2)[0]
    content = (tmp_path / "rig.op2").read_bytes()
    for size in (3, 100, len(content) - 30):
        (tmp_path / "rig.op2").write_bytes(content[:size])
        assert "modes.file: rig.op2: " in faults(tmp_path, OUTPUT2)[0]
