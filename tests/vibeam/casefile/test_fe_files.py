"""A beam of another program's finite elements, in mm, N, s, t: its files in each format make the same rig."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from nastran_files import OP2, OP4, Output2, op4_binary, op4_text
from scipy.io import hb_write, mmwrite
from scipy.sparse import csc_array

import vibeam

ELEMENTS, LENGTH, E, WIDTH, HEIGHT, DENSITY = 8, 240.0, 70e3, 20.0, 4.0, 2.7e-9  # mm, MPa, t/mm³


def beam() -> tuple[np.ndarray, np.ndarray]:
    """M and K of a cantilever by cubic elements (Craig & Kurdila, Fundamentals of Structural Dynamics, 14.2)."""
    h, inertia = LENGTH / ELEMENTS, WIDTH * HEIGHT**3 / 12
    stiff = np.array(
        [[12, 6 * h, -12, 6 * h], [0, 4 * h**2, -6 * h, 2 * h**2], [0, 0, 12, -6 * h], [0, 0, 0, 4 * h**2]]
    )
    mass = np.array(
        [[156, 22 * h, 54, -13 * h], [0, 4 * h**2, 13 * h, -3 * h**2], [0, 0, 156, -22 * h], [0, 0, 0, 4 * h**2]]
    )
    M, K = np.zeros((2, 2 * ELEMENTS + 2, 2 * ELEMENTS + 2))
    for at in range(0, 2 * ELEMENTS, 2):
        part = slice(at, at + 4)
        M[part, part] += DENSITY * WIDTH * HEIGHT * h / 420 * (mass + np.triu(mass, 1).T)
        K[part, part] += E * inertia / h**3 * (stiff + np.triu(stiff, 1).T)
    return M[2:, 2:], K[2:, 2:]


M, K = beam()
TIP = 2 * ELEMENTS - 1  # counted from 1


def place(row: int) -> tuple[int, int]:
    """Node and degree of freedom of a row, from 0: along z, and about y."""
    return row // 2 + 1, 3 + 2 * (row % 2)


def abaqus(folder: Path) -> tuple[str, str]:
    for name, matrix in (("M", M), ("K", K)):
        lower = zip(*np.nonzero(np.tril(matrix)), strict=True)
        rows = [(*place(row), *place(column), float(matrix[row, column]) / 1000) for row, column in lower]
        head = f"*MATRIX INPUT, NAME={name}, SCALE FACTOR=1e3"
        (folder / f"{name}.inp").write_text("\n".join([head, *(", ".join(map(str, row)) for row in rows)]))
    return '"M.inp"', '"K.inp"'


def calculix(folder: Path) -> tuple[str, str]:
    for name, matrix in (("rig.mas", M), ("rig.sti", K)):
        entries = zip(*np.nonzero(np.triu(matrix)), strict=True)
        (folder / name).write_text(
            "\n".join(f"{row + 1} {column + 1} {matrix[row, column]:.17e}" for row, column in entries)
        )
    (folder / "rig.dof").write_text("\n".join("{}.{}".format(*place(row)) for row in range(len(M))))
    return '"rig.mas"', '"rig.sti"'


def market(folder: Path) -> tuple[str, str]:
    for name, matrix in (("M", M), ("K", K)):
        mmwrite(folder / f"{name}.mtx", csc_array(matrix), symmetry="symmetric", precision=17)
    return '"M.mtx"', '"K.mtx"'


def harwell(folder: Path) -> tuple[str, str]:
    for name, matrix in (("M", M), ("K", K)):
        hb_write(folder / f"{name}.hb", csc_array(matrix))
    return '"M.hb"', '"K.hb"'


def output4(folder: Path, text: bool) -> tuple[str, str]:
    both = {"MAA": (6, M), "KAA": (6, K)}
    (folder / "rig.op4").write_bytes(op4_text(both, sparse=True).encode() if text else op4_binary(both))
    return '"rig.op4"', '{ file = "rig.op4", name = "kaa" }'


def output2(folder: Path) -> tuple[str, str]:
    file = Output2()
    file.matrix("MAA", 6, M)
    file.matrix("KAA", 6, K)
    (folder / "rig.op2").write_bytes(file.content)
    return '"rig.op2"', '"rig.op2"'


FORMATS: dict[str, Callable[[Path], tuple[str, str]]] = {
    "Abaqus": abaqus, "CalculiX": calculix, "Matrix Market": market, "Harwell–Boeing": harwell,
    "OUTPUT4": lambda folder: output4(folder, False), "OUTPUT4 text": lambda folder: output4(folder, True),
    "OUTPUT2": output2,
}  # fmt: skip

CASE = """\
[matrices]
mass = {}
stiffness = {}
units = "mm N s t"
damping_ratio = 0.01
contact = {}
base = {}
[stop]
gap = "0.4 mm"
restitution = 0.7
[drive]
acceleration = "5 m/s^2"
[sweep]
frequency = {{ from = "50 Hz", to = "60 Hz", points = 3 }}
settle = 20
hold = 10
[fidelity.whole]
reduction = "full"
"""


MARKS = {"OUTPUT2": OP2, "OUTPUT4": OP4, "OUTPUT4 text": OP4}


@pytest.mark.parametrize("name", [pytest.param(name, marks=MARKS.get(name, ())) for name in FORMATS])
def test_each_format_makes_the_same_rig(name: str, tmp_path: Path) -> None:
    """Against eigenvalues of L⁻¹ K L⁻ᵀ, M = L Lᵀ, by numpy; in N/m and kg both are 1 000 times the files'."""
    files = FORMATS[name](tmp_path)
    named = name in ("Abaqus", "CalculiX")
    np.savetxt(tmp_path / "base.csv", np.tile([1.0, 0.0], ELEMENTS))
    places = (f'{{ node = {ELEMENTS}, direction = "z" }}', '"z"') if named else (str(TIP), '"base.csv"')
    (tmp_path / "rig.toml").write_text(CASE.format(*files, *places), encoding="utf-8")
    case = vibeam.load(tmp_path / "rig.toml")
    system = case.system("whole")
    root = np.linalg.cholesky(1000 * M)
    squares, vectors = np.linalg.eigh(np.linalg.solve(root, np.linalg.solve(root, 1000 * K).T))
    shapes = np.linalg.solve(root.T, vectors)
    np.testing.assert_allclose(system.omega, np.sqrt(squares), rtol=1e-8)
    contact = shapes[TIP - 1]
    np.testing.assert_allclose(system.contact, np.abs(contact), rtol=1e-6)
    load = shapes.T @ (1000 * M) @ np.tile([1.0, 0.0], ELEMENTS)
    np.testing.assert_allclose(system.load, load * np.sign(contact), rtol=1e-6, atol=1e-9)
    assert [line.split(", ")[1] for line in case.scene.assumed] == ["16 × 16", "16 × 16"]
