"""[matrices]: the user's own matrices in place of a beam."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bounded import Bound
from scipy.integrate import solve_ivp
from scipy.io import mmread, mmwrite
from scipy.linalg import sqrtm
from scipy.sparse import csc_array, diags_array, eye_array, kron, save_npz

import vibeam
from vibeam.casefile.examples import texts
from vibeam.casefile.read import parse
from vibeam.studies.modes import export_matrices
from vibeam_models.beam import structure_of

RIG = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"

FRAME_FILES = {name.removeprefix("frame_"): text for name, text in texts("frame")[1].items()}
M, K = np.diag([2.0, 1.5]), np.array([[9000.0, -4000.0], [-4000.0, 4000.0]])

FRAME = """\
[matrices]
mass = "M.mtx"
stiffness = "K.mtx"
damping_ratio = 0.01
contact = 2
sensor = 1
base = "all"
units = "SI"

[stop]
gap = "1 mm"
restitution = 0.7

[drive]
amplitude = "0.1 mm"

[sweep]
frequency = { from = "5 Hz", to = "7 Hz", points = 5 }
settle = 20
hold = 10

[fidelity.sdof]
reduction = "static_mode"

[fidelity.whole]
reduction = "full"
"""


def frame(folder: Path, text: str = FRAME, **files: str | bytes) -> Path:
    """A case of two storeys in ``folder``."""
    for name, content in (FRAME_FILES | files).items():
        (folder / name.replace("_mtx", ".mtx")).write_bytes(content if isinstance(content, bytes) else content.encode())
    (folder / "frame.toml").write_text(text, encoding="utf-8")
    return folder / "frame.toml"


def faults(folder: Path, text: str = FRAME, **files: str | bytes) -> list[str]:
    with pytest.raises(vibeam.CaseError) as caught:
        vibeam.load(frame(folder, text, **files))
    return str(caught.value).splitlines()


def largest(one: Any, other: Any) -> float:
    return float(np.max(np.abs(np.asarray(one) - np.asarray(other))) / np.max(np.abs(np.asarray(other))))


def rewritten(case: Any, table: str) -> str:
    """The case with its beam's tables replaced by ``table``."""
    return f"""{table}
[stop]
gap = "0 mm"
gap_at = "sensor"
restitution = 0.72
restitution_of = "first mode"
[drive]
amplitude = "{case.base_amplitude!r} m"
[sweep]
frequency = {{ from = "15 Hz", to = "16 Hz", points = 3 }}
settle = 20
hold = 10
[fidelity.sdof]
reduction = "static_mode"
[fidelity.two_modes]
reduction = "modal"
modes = 2
[fidelity.beam]
reduction = "modal"
modes = 8
"""


@pytest.mark.parametrize("ending", ["npz", "h5", "mat", "mtx", "npy"])
def test_an_exported_beam_gives_the_same_response(ending: str, tmp_path: Path) -> None:
    case = vibeam.load(RIG, set={"sweep.frequency": {"from": "15 Hz", "to": "16 Hz", "points": 3}})
    case = replace(case, swept=replace(case.sweep, settle=20, hold=10))
    (tmp_path / "own.toml").write_text(rewritten(case, export_matrices(case, tmp_path / f"rig.{ending}")))
    own = vibeam.load(tmp_path / "own.toml")
    for name in own.fidelities:
        one, other = own.system(name), case.system(name)
        for field in ("omega", "zeta", "contact", "load"):
            assert largest(getattr(one, field), getattr(other, field)) < 1e-12
        assert one.outputs.keys() == other.outputs.keys()
        assert one.restitution == pytest.approx(other.restitution, rel=1e-12)
    amplitudes = [
        vibeam.sweep(
            each.system("two_modes"), omega=2 * np.pi * case.sweep.frequency, amplitude=case.base_amplitude, settle=20,
            hold=10, output="sensor"
        ).amplitude
        for each in (own, case)
    ]  # fmt: skip
    assert largest(*amplitudes) < 1e-12


@pytest.mark.parametrize(("drive", "own"), [("force", "0.2 N"), ("moment", "0.02 N m")])
def test_an_exported_beam_is_driven_where_its_force_or_moment_is(drive: str, own: str, tmp_path: Path) -> None:
    away = {"drive.voltage": None, "drive.gain": None}
    case = vibeam.load(RIG, set={**away, f"drive.{drive}": own, "drive.at": "90 mm"})
    table = export_matrices(case, tmp_path / "rig.npz")
    assert "base =" not in table
    text = rewritten(vibeam.load(RIG), table).replace("[drive]", '[drive]\nforce = "0.2 N"')
    kept = [line for line in text.splitlines() if not line.startswith(("voltage =", "gain =", "amplitude ="))]
    (tmp_path / "own.toml").write_text("\n".join(kept))
    read = vibeam.load(tmp_path / "own.toml")
    for name in case.fidelities:
        assert largest(read.system(name).load, case.system(name).load) < 1e-11


def abaqus(matrix: np.ndarray, name: str) -> str:
    """Node and degree of freedom 1 for each coordinate, lower half."""
    rows, columns = np.nonzero(np.tril(matrix))
    lines = [f"{i + 1},1, {j + 1},1, {matrix[i, j]:.17e}" for i, j in zip(rows, columns, strict=True)]
    return "\n".join([f"** {name}", *lines])


def nastran(matrix: np.ndarray, name: str) -> str:
    """DMIG cards between commas, column by column from the diagonal down."""
    cards = [f"DMIG,{name},0,6,2,0"]
    for column in range(len(matrix)):
        for row in range(column, len(matrix)):
            cards.append(f"DMIG,{name},{column + 1},1,,{row + 1},1,{matrix[row, column]:.17e}")
    return "\n".join(cards)


@pytest.mark.parametrize(("written", "ending"), [(abaqus, "inp"), (nastran, "bdf")])
def test_a_beam_through_the_text_of_other_programs(written: Any, ending: str, tmp_path: Path) -> None:
    case = vibeam.load(RIG)
    structure = structure_of(case.scene)
    table = export_matrices(case, tmp_path / "rig.npz")
    for key, name in (("mass", "M"), ("stiffness", "K"), ("damping_matrix", "C")):
        (tmp_path / f"{name}.{ending}").write_text(written(getattr(structure, name), f"{name}RIG"))
        table = table.replace(f'{{ file = "rig.npz", name = "{name}" }}', f'"{name}.{ending}"')
        assert f'{key} = "{name}.{ending}"' in table
    (tmp_path / "own.toml").write_text(rewritten(case, table))
    one, other = vibeam.load(tmp_path / "own.toml").system("beam"), case.system("beam")
    for field in ("omega", "zeta", "contact", "load"):
        assert largest(getattr(one, field), getattr(other, field)) < 1e-12


def test_two_storeys_by_hand(tmp_path: Path) -> None:
    case = vibeam.load(frame(tmp_path))
    system = case.system("whole")
    middle, product = (4500 + 8000 / 3) / 2, 20e6 / 3  # ω⁴ − (k₁₁/m₁ + k₂₂/m₂) ω² + det K/(m₁m₂) = 0
    half = np.sqrt(middle**2 - product)
    np.testing.assert_allclose(np.sort(system.omega**2), [middle - half, middle + half], rtol=1e-13)
    np.testing.assert_allclose(system.zeta, 0.01, rtol=1e-12)
    assert system.contact @ system.contact == pytest.approx(1 / 1.5, rel=1e-13)  # w M⁻¹ wᵀ
    assert system.load @ system.load == pytest.approx(3.5, rel=1e-13)  # rᵀ M r
    assert system.outputs["sensor"] @ system.load == pytest.approx(1.0, rel=1e-13)  # w M⁻¹ M r
    static = case.system("sdof")
    shape = np.array([0.8, 1.8])  # K x = w, with a load of 4 kN on the upper storey
    assert static.omega[0] ** 2 == pytest.approx(shape @ K @ shape / (shape @ M @ shape), rel=1e-13)


@pytest.mark.parametrize(
    ("units", "length", "force", "time"),
    [("mm N s t", 1e-3, 1.0, 1.0), ("mm kN ms kg", 1e-3, 1e3, 1e-3), ("in lbf s", 0.0254, 4.4482216152605, 1.0)],
)
def test_units_of_the_matrices(units: str, length: float, force: float, time: float, tmp_path: Path) -> None:
    """Stiffness is force over length, mass force times time² over length; what the case reads is in metres."""
    own = vibeam.load(frame(tmp_path)).system("whole")
    for name, matrix in (("M.mtx", M * length / (force * time**2)), ("K.mtx", K * length / force)):
        mmwrite(tmp_path / name, matrix, precision=17)
    text = FRAME.replace('units = "SI"', f'units = "{units}"')
    (tmp_path / "other.toml").write_text(text)
    other = vibeam.load(tmp_path / "other.toml").system("whole")
    for field in ("omega", "zeta", "contact", "load"):
        assert largest(getattr(other, field), getattr(own, field)) < 1e-12
    assert largest(other.outputs["sensor"], own.outputs["sensor"]) < 1e-12


ABAQUS_K = "1,2,1,2,1e36\n1,2,5,2,-5e3\n5,2,5,2,9e3\n5,2,8,2,-4e3\n8,2,8,2,4e3\n"

ABAQUS_M = "1,2,1,2,0.5\n1,2,5,2,0.1\n5,2,5,2,2.0\n8,2,8,2,1.5\n"


def test_nodes_and_directions_of_abaqus(tmp_path: Path) -> None:
    places = FRAME.replace("contact = 2", 'contact = { node = 8, direction = "y" }').replace(
        'base = "all"', 'base = "y"'
    )
    places = places.replace("sensor = 1", "sensor = [{ node = 5, direction = 2 }]")
    case = vibeam.load(frame(tmp_path, places, M_mtx=ABAQUS_M, K_mtx=ABAQUS_K))
    whole, own = case.system("whole"), vibeam.load(frame(tmp_path)).system("whole")
    for field in ("omega", "contact"):
        assert largest(getattr(whole, field), getattr(own, field)) < 1e-12
    shapes = np.linalg.solve(M, np.array([2.1, 1.5]))  # M r of the free nodes, that of the held one coupled in
    pulled = np.array([whole.outputs["sensor"], whole.contact])
    np.testing.assert_allclose(pulled @ whole.load, shapes, rtol=1e-12)
    assert case.scene.moving_mass == pytest.approx(0.5 + 2 * 0.1 + 2.0 + 1.5)


def test_a_force_on_a_row(tmp_path: Path) -> None:
    """Below all resonances the amplitude is the static deflection under the force."""
    text = FRAME.replace('base = "all"', "force = [1, { coordinate = 2, value = 0.5 }]")
    text = text.replace('amplitude = "0.1 mm"', 'force = "2 N"').replace('gap = "1 mm"', 'gap = "1 m"')
    text = text.replace('from = "5 Hz", to = "7 Hz", points = 5', 'from = "0.05 Hz", to = "0.05 Hz", points = 1')
    case = vibeam.load(frame(tmp_path, text))
    omega = 2 * np.pi * case.sweep.frequency
    np.testing.assert_allclose(case.amplitude(omega), 2 / omega**2)
    found = vibeam.sweep(
        case.system("whole"), omega=omega, amplitude=case.amplitude(omega), settle=20, hold=5, output="sensor"
    )
    static = np.linalg.solve(K, 2 * np.array([1.0, 0.5]))
    assert found.amplitude[0] == pytest.approx(static[0], rel=1e-3)


def test_rows_in_files_and_further_outputs(tmp_path: Path) -> None:
    np.savez(tmp_path / "rows.npz", contact=[0.0, 1.0], tip=[0.25, 0.75])
    (tmp_path / "r.csv").write_text("1\n1\n")
    text = FRAME.replace("contact = 2", 'contact = "rows.npz"').replace('base = "all"', 'base = "r.csv"')
    text = text.replace("sensor = 1", 'sensor = 1\noutputs = { mean = { file = "rows.npz", name = "tip" } }')
    text = text.replace("settle = 20", 'settle = 20\noutput = "mean"')
    system, own = vibeam.load(frame(tmp_path, text)).system("whole"), vibeam.load(frame(tmp_path)).system("whole")
    np.testing.assert_allclose(system.load, own.load, rtol=1e-14)
    expected = 0.25 * own.outputs["sensor"] + 0.75 * own.contact
    np.testing.assert_allclose(system.outputs["mean"], expected, rtol=1e-12)


def test_a_damping_matrix_and_ratios_mode_by_mode(tmp_path: Path) -> None:
    mmwrite(tmp_path / "C.mtx", 0.5 * M + 1e-4 * K)
    own = FRAME.replace("damping_ratio = 0.01", 'damping_matrix = "C.mtx"')
    system = vibeam.load(frame(tmp_path, own)).system("whole")
    np.testing.assert_allclose(system.zeta, 0.25 / system.omega + 0.5e-4 * system.omega, rtol=1e-12)
    listed = vibeam.load(frame(tmp_path, FRAME.replace("damping_ratio = 0.01", "damping = [0.02, 0.03]")))
    np.testing.assert_allclose(listed.system("whole").zeta, [0.02, 0.03], rtol=1e-12)


def test_a_platform_under_the_matrices(tmp_path: Path) -> None:
    platform = '\n[platform]\nmass = "5 kg"\nfrequency = "3 Hz"\ndamping_ratio = 0\ncoupling = "two-way"\n'
    text = FRAME.replace('amplitude = "0.1 mm"', 'force = "1 N"') + platform
    system = vibeam.load(frame(tmp_path, text)).system("whole")
    coupled = np.block([[M, (M @ np.ones(2))[:, None]], [M @ np.ones(2), 5 + 3.5]])
    stiffness = np.zeros((3, 3))
    stiffness[:2, :2], stiffness[2, 2] = K, 5 * (2 * np.pi * 3) ** 2
    expected = np.sort(np.linalg.eigvals(np.linalg.solve(coupled, stiffness)).real)
    np.testing.assert_allclose(np.sort(system.omega**2), expected, rtol=1e-11)


def test_what_the_files_hold_decides_the_key(tmp_path: Path) -> None:
    case = vibeam.load(frame(tmp_path))
    assert vibeam.load(frame(tmp_path)).key == case.key
    assert vibeam.load(frame(tmp_path)).scene == case.scene
    other = vibeam.load(frame(tmp_path, K_mtx=FRAME_FILES["K.mtx"].replace("4000.0\n", "4000.1\n")))
    assert other.key != case.key
    assert other.own["sdof"] != case.own["sdof"]
    assert other.text == case.text
    assert len(case.text) < 2000
    vibeam.run(case, out=tmp_path / "frame.h5")
    with pytest.warns(UserWarning, match=r"the case as it was .*kept aside as frame\.1\.h5"):
        vibeam.run(other, out=tmp_path / "frame.h5")


def test_a_fidelity_with_matrices_of_its_own(tmp_path: Path) -> None:
    own = FRAME + 'set = { "matrices.stiffness" = "other.mtx" }\n'
    (tmp_path / "other.mtx").write_text(FRAME_FILES["K.mtx"].replace("9000", "9500"))
    case = vibeam.load(frame(tmp_path, own))
    squared = np.sort(case.system("whole").omega) ** 2
    np.testing.assert_allclose(squared.sum(), 9500 / 2 + 4000 / 1.5, rtol=1e-12)  # the trace of M⁻¹K
    (tmp_path / "other.mtx").write_text(FRAME_FILES["K.mtx"].replace("9000", "9501"))
    other = vibeam.load(frame(tmp_path, own))
    assert (other.key != case.key, other.own["whole"] != case.own["whole"]) == (True, True)
    assert other.own["sdof"] == case.own["sdof"]


def test_the_case_in_a_results_file_is_the_case(tmp_path: Path) -> None:
    case = vibeam.load(frame(tmp_path))
    assert parse(case.text, case.path).key == case.key


def impacts_by_integration(until: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and velocities of impacts of the frame at 5.5 Hz, in its own two coordinates, by scipy alone.

    M ẍ + C ẋ + K x = −M r b̈ from rest, C = 0.02 M (M⁻¹K)^½; v⁺ = v − (1 + R)(w v) M⁻¹wᵀ/(w M⁻¹wᵀ) at w x = 1 mm.
    """
    omega, base, gap, restitution = 2 * np.pi * 5.5, 1e-4, 1e-3, 0.7
    inverse = np.linalg.inv(M)
    stiffness, damper = inverse @ K, 0.02 * np.real(sqrtm(inverse @ K))

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        pull = omega**2 * base * np.sin(omega * t)
        return np.concatenate([y[2:], pull - stiffness @ y[:2] - damper @ y[2:]])

    def contact(t: float, y: np.ndarray) -> float:
        return float(y[1] - gap)

    contact.terminal, contact.direction = True, 1  # type: ignore[attr-defined]
    t, y, found = 0.0, np.zeros(4), []
    within = Bound()
    while within(t < until):
        path = solve_ivp(rate, (t, until), y, method="DOP853", rtol=1e-12, atol=1e-15, events=contact)
        t, y = float(path.t[-1]), path.y[:, -1].copy()
        if path.status == 1:
            found.append((t, y[3]))
            y[3] -= (1 + restitution) * y[3]  # the mass matrix is diagonal: the upper storey alone takes the impulse
    return np.array(found).T


def test_impacts_of_the_frame_in_its_own_coordinates(tmp_path: Path) -> None:
    times, velocities = impacts_by_integration(2.0)
    assert len(times) > 3
    path = vibeam.simulate(
        vibeam.load(frame(tmp_path)).system("whole"), vibeam.Drive(2 * np.pi * 5.5, 1e-4), 2.0, state=REST
    )
    np.testing.assert_allclose(path.impact_times, times, rtol=1e-8)
    np.testing.assert_allclose(path.impact_velocities, velocities, rtol=1e-6)


REST = vibeam.State(np.zeros(2), np.zeros(2))


def test_studies_of_matrices(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = vibeam.load(frame(tmp_path))
    rows = vibeam.modes(case).rows
    assert [row.frequency for row in rows] == pytest.approx(np.sort(case.system("whole").omega) / (2 * np.pi))
    assert rows[-1].share == pytest.approx(1.0, rel=1e-12)
    with pytest.raises(ValueError, match=r"nothing to derive: this case gives matrices in place of a beam"):
        vibeam.derive(case)
    with pytest.raises(ValueError, match="names no effect"):
        vibeam.influence(case)


MASSES = FRAME_FILES["M.mtx"]

DENSE = "%%MatrixMarket matrix array real general\n{} {}\n"

UNSYMMETRIC = "%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 9e3\n1 2 -4e3\n2 1 -3.9e3\n2 2 4e3\n"


OF_FILES = [
    ({"K_mtx": UNSYMMETRIC}, "3: matrices.stiffness: K.mtx: is not symmetric: -4000 at row 1, column 2, but -3900 "),
    ({"K_mtx": UNSYMMETRIC.replace("-3.9e3", "nan")}, "3: matrices.stiffness: K.mtx: line 5: 'nan' is no number"),
    (
        {"K_mtx": FRAME_FILES["K.mtx"].replace("2 2 4000", "2 2 -4000")},
        "3: matrices.stiffness: K.mtx: is not positive semidefinite: 1 of its 2 eigenvalues is below 0, the lowest -3",
    ),
    ({"M_mtx": MASSES.replace("1.5", "0")}, "2: matrices.mass: M.mtx: is singular: coordinate 2 has no mass"),
    (
        {"M_mtx": MASSES.replace("1.5", "-1")},
        "2: matrices.mass: M.mtx: is not positive definite: 1 of its 2 eigenvalues is not above 0, the lowest -1",
    ),
    ({"M_mtx": DENSE.format(3, 3) + "1\n" * 9}, "3: matrices.stiffness: K.mtx: has 2 coordinates, M.mtx has 3"),
    ({"M_mtx": DENSE.format(1, 3) + "1\n" * 3}, "2: matrices.mass: M.mtx: is 1 × 3, not square"),
    ({"M_mtx": ABAQUS_M}, "3: matrices.stiffness: K.mtx: names no nodes, and mass does"),
]


@pytest.mark.parametrize(("files", "expected"), OF_FILES)
def test_faults_of_the_matrices_say_how_much_and_where(files: dict[str, str], expected: str, tmp_path: Path) -> None:
    assert any(line.startswith(expected) for line in at(faults(tmp_path, **files))), faults(tmp_path, **files)


OF_KEYS = [
    ('"M.mtx"', '"N.mtx"', "2: matrices.mass: N.mtx: no such file"),
    ('"M.mtx"', "3", "2: matrices.mass: must be file"),
    ('"M.mtx"', '{ file = "M.mtx", called = "M" }', "2: matrices.mass: unknown key 'called'; known here: file, name"),
    ("contact = 2", "contact = 3", "5: matrices.contact: coordinate 3 is not there: they are 1 to 2"),
    ("contact = 2", "contact = []", "5: matrices.contact: an empty list reads nothing"),
    ("contact = 2", "contact = { node = 3 }", "5: matrices.contact: must say a coordinate = 3, or a place"),
    ("contact = 2", 'contact = { node = 3, direction = "x" }', "5: matrices.contact: the files name no nodes"),
    ("contact = 2", 'contact = "rows.npy"', "5: matrices.contact: rows.npy: no such file"),
    ("contact = 2", 'contact = "/dev/zero"', "5: matrices.contact: /dev/zero: is not a regular file"),
    ("contact = 2", 'contact = ".."', "5: matrices.contact: ..: is a folder, not a file"),
    ('"M.mtx"', '"/dev/zero"', "2: matrices.mass: /dev/zero: is not a regular file"),
    ('"M.mtx"', '"a\\u0000.mtx"', "2: matrices.mass: 'a\\x00.mtx': no such file"),
    ("contact = 2", 'contact = "M.mtx"', "5: matrices.contact: M.mtx: is 2 × 2, the matrices have 2 coordinates"),
    ("contact = 2", "contact = [{ coordinate = 1, value = 0 }]", "5: matrices.contact: reads nothing"),
    ('base = "all"', 'base = "x"', '7: matrices.base: "x" needs the direction of each coordinate'),
    ('base = "all"\n', "", "1: matrices.base: missing (what a base motion moves)"),
    ('base = "all"', 'base = "all"\nforce = 1', "8: matrices.force: the drive is said twice"),
    ("sensor = 1", "sensor = 1\noutputs = { contact = 1 }", "7: matrices.outputs.contact: must be letters"),
    ("damping_ratio = 0.01\n", "", "1: matrices.damping_ratio: missing"),
    ("damping_ratio", 'damping_matrix = "M.mtx"\ndamping_ratio', "4: matrices.damping_matrix: the damping is said"),
    ('"SI"', '"mm"', "8: matrices.units: 'mm' is not one of"),
    ('units = "SI"\n', "", '1: matrices.units: missing (of length, force, time, mass): write units = "SI" or "'),
    ("[stop]", "[gravity]\n[stop]", "10: gravity: [gravity] and [matrices] do not go together: keep [matrices]"),
    ("[stop]", "[beam]\n[stop]", "10: beam: [beam] and [matrices] do not go together: keep [matrices]"),
    ("[stop]", "[sdof]\n[stop]", "1: matrices: [matrices] and [sdof] do not go together: keep one of the two"),
    ('amplitude = "0.1 mm"', "", "14: drive: the base motion is missing"),
    ('amplitude = "0.1 mm"', 'amplitude = "0.1 mm"\ngain = 1.0', "16: drive.gain: unknown key"),
    ('amplitude = "0.1 mm"', 'force = "1 N"', "15: drive.force: acts where matrices.force says"),
    ("settle = 20", 'output = "tip"', "19: sweep.output: 'tip' is no output"),
    ('"full"', '"modal"\nmodes = 3', "27: fidelity.whole.modes: 3 are more than the model has: the matrices give 2"),
]


@pytest.mark.parametrize(("old", "new", "expected"), OF_KEYS)
def test_faults_name_line_key_and_cure(old: str, new: str, expected: str, tmp_path: Path) -> None:
    assert old in FRAME
    found = at(faults(tmp_path, FRAME.replace(old, new, 1)))
    assert any(line.startswith(expected) for line in found), found


def at(lines: list[str]) -> list[str]:
    """The faults from their line on."""
    return [line.partition("frame.toml:")[2] for line in lines]


def test_all_faults_at_once(tmp_path: Path) -> None:
    text = FRAME.replace("contact = 2", "contact = 7").replace("sensor = 1", "sensor = 9").replace("0.7", "1.7")
    lines = faults(tmp_path, text, K_mtx=FRAME_FILES["K.mtx"].replace("2 2 4000", "2 2 -4000"))
    assert {line.split(": ")[1] for line in lines} == {
        "matrices.stiffness", "matrices.contact", "matrices.sensor", "stop.restitution",
    }  # fmt: skip


def test_a_free_body_has_modes_and_no_static_mode(tmp_path: Path) -> None:
    """A mass of 2 kg and one of 1.5 kg with a spring of 4 kN/m between them, free to move along."""
    free = FRAME_FILES["K.mtx"].replace("9000", "4000")
    for damping in ("damping_ratio = 0.01", 'damping_matrix = "C.mtx"'):
        mmwrite(tmp_path / "C.mtx", 1e-4 * np.array([[4000.0, -4000.0], [-4000.0, 4000.0]]))
        case = vibeam.load(frame(tmp_path, FRAME.replace("damping_ratio = 0.01", damping), K_mtx=free))
        omega = np.sort(case.system("whole").omega)
        assert omega[0] < 1e-4
        assert omega[1] ** 2 == pytest.approx(4000 * (1 / 2.0 + 1 / 1.5), rel=1e-12)
    with pytest.raises(ValueError, match="the body is free"):
        case.system("sdof")
    sensor = FRAME.replace('gap = "1 mm"', 'gap = "1 mm"\ngap_at = "sensor"')
    with pytest.raises(ValueError, match=r"no static deflection of this structure carries the gap"):
        vibeam.load(frame(tmp_path, sensor, K_mtx=free)).system("whole")


def membrane(folder: Path, rows: int, columns: int) -> Path:
    """A net of knots of 0.3 kg between springs of 10 kN/m, its edge fixed, as sparse files."""
    one, other = (
        diags_array([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1]) for n in (rows, columns)
    )
    K = 1e4 * (kron(one, eye_array(columns)) + kron(eye_array(rows), other))
    mmwrite(folder / "K.mtx", csc_array(K), symmetry="symmetric")
    save_npz(folder / "M.npz", csc_array(0.3 * eye_array(rows * columns)))
    text = FRAME.replace('"M.mtx"', '"M.npz"').replace("contact = 2", f"contact = {rows * columns // 3}")
    text = text.replace('reduction = "full"', 'reduction = "modal"\nmodes = 20')
    (folder / "net.toml").write_text(text)
    return folder / "net.toml"


def squared_frequencies(rows: int, columns: int) -> np.ndarray:
    """ω² of the net: 4k/m (sin² iπ/2(r+1) + sin² jπ/2(c+1))."""
    one, other = (np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2 for n in (rows, columns))
    return np.sort((4e4 / 0.3 * (one[:, None] + other)).ravel())


def ratio_of_static_mode(rows: int, columns: int) -> float:
    """Σ a 2ζω / (2 (Σ a Σ a ω²)^½) with a = (φ/ω²)², φ the closed-form shapes at the contact, ζ = 0.01."""
    row, column = divmod(rows * columns // 3 - 1, columns)
    at = [np.sin(np.arange(1, n + 1) * np.pi * (k + 1) / (n + 1)) for n, k in ((rows, row), (columns, column))]
    angles = [np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2 for n in (rows, columns)]
    squared = 4e4 / 0.3 * (angles[0][:, None] + angles[1])
    weight = (np.outer(*at) / squared) ** 2
    return float(0.01 * np.sum(weight * np.sqrt(squared)) / np.sqrt(np.sum(weight) * np.sum(weight * squared)))


def test_two_thousand_coordinates_stay_sparse(tmp_path: Path) -> None:
    case = vibeam.load(membrane(tmp_path, 40, 50))
    assert type(structure_of(case.scene)).__name__ == "SparseStructure"
    system = case.system("whole")
    np.testing.assert_allclose(np.sort(system.omega**2), squared_frequencies(40, 50)[:20], rtol=1e-11)
    np.testing.assert_allclose(system.zeta, 0.01, rtol=1e-8)
    assert case.system("sdof").zeta[0] == pytest.approx(ratio_of_static_mode(40, 50), rel=1e-6)
    assert vibeam.modes(case, 3).rows[0].damping_ratio == pytest.approx(0.01, rel=1e-8)
    found = vibeam.run(case, show=False)
    assert np.isfinite(found["whole"].up.amplitude).all()
    with pytest.raises(ValueError, match="2000 coordinates stay sparse, in the files that the case names"):
        export_matrices(case, tmp_path / "full.npz")


def test_a_full_model_of_very_many_coordinates_is_refused(tmp_path: Path) -> None:
    path = membrane(tmp_path, 60, 60)
    path.write_text(path.read_text().replace('reduction = "modal"\nmodes = 20', 'reduction = "full"'))
    with pytest.raises(
        vibeam.CaseError, match=r"26: .*whole.reduction: the shapes of all 3600 modes|25: fidelity.whole"
    ):
        vibeam.load(path)


def test_faults_of_sparse_matrices(tmp_path: Path) -> None:
    path = membrane(tmp_path, 40, 50)
    K = csc_array(mmread(tmp_path / "K.mtx")).tolil()
    K[7, 8] = -9e3
    mmwrite(tmp_path / "K.mtx", K.tocsc(), symmetry="general")
    with pytest.raises(
        vibeam.CaseError, match=r"K.mtx: is not symmetric: -9000 at row 8, column 9, but -10000 opposite"
    ):
        vibeam.load(path)
    K[7, 8], K[5, 5] = -1e4, -4e4
    mmwrite(tmp_path / "K.mtx", K.tocsc(), symmetry="general")
    with pytest.raises(
        vibeam.CaseError, match=r"K.mtx: is not positive semidefinite: 1 of its 2000 eigenvalues is below"
    ):
        vibeam.load(path)


def test_all_modes_of_matrices_are_exact_and_of_given_modes_there_are_no_more(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        rewritten(vibeam.load(RIG), export_matrices(vibeam.load(RIG), tmp_path / "r.npz"))
    )
    case = vibeam.load(tmp_path / "own.toml", set={"fidelity.whole": {"reduction": "full"}})
    assert {each.fidelity: each.whole for each in vibeam.run(case).compare()}["whole"]
    measured = FRAME.partition("[stop]")
    modes = '[modes]\nfrequency = ["5 Hz"]\ndamping_ratio = 0.01\ncontact = [1.0]\nbase = [1.0]\n'
    text = modes + "[stop]" + measured[2].replace('reduction = "full"', 'reduction = "modal"\nmodes = 1')
    (tmp_path / "modes.toml").write_text(text)
    [top] = [each for each in vibeam.run(vibeam.load(tmp_path / "modes.toml")).compare() if not each.reference]
    assert (top.whole, top.why) == (False, "the case gives only these modes")
