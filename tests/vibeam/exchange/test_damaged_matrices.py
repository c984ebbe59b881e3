"""Files of finite-element programs that are damaged: no crash, no memory, no other number because of a head."""

import io
import random
import tracemalloc
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from nastran_files import OP2, OP4, Output2, op4_binary, op4_text
from scipy.io import savemat
from scipy.sparse import csc_array
from test_fe_matrices import DECK, LOWER, MARKET, K, M, full, harwell_boeing

from vibeam.exchange.files import FormatError
from vibeam.exchange.matrices.declaration import read_matrix
from vibeam.exchange.nastran_output import read_modes

PARTS = csc_array(K)
BOTH = {"KAA": (6, K), "MAA": (6, M)}
MOST = 50_000_000  # bytes that a file of a few kB may take


def output2(*, modal: bool) -> bytes:
    file = Output2()
    if modal:
        shapes = np.arange(36.0).reshape(2, 3, 6)
        file.modes([100.0, 2500.0], shapes, [(1, 1), (2, 1), (7, 2)], masses=[1.0, 2.0])
    else:
        file.matrix("KAA", 6, K)
        file.matrix("MAA", 6, M)
    return file.content


def dmig() -> bytes:
    """Symmetric, in short fields of a free format."""
    rows = [
        f"DMIG,K,{column},1,,{row},1,{K[row - 1, column - 1]}" for column in range(1, 5) for row in range(column, 5)
    ]
    return "\n".join(["DMIG,K,0,6,2,0", *rows, ""]).encode()


def by_savez(**arrays: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()


def by_savemat(matrix: Any) -> bytes:
    file = io.BytesIO()
    savemat(file, {"K": matrix, "M": M})
    return file.getvalue()


def by_h5py(**arrays: Any) -> bytes:
    file = io.BytesIO()
    with h5py.File(file, "w") as made:
        made.update(arrays)
    return file.getvalue()


def universal_modes() -> bytes:
    """Two modes at three points, data set 55."""
    head = ["    -1", "    55", "NONE", "NONE", "NONE", "NONE", "NONE", f"{1:10}{2:10}{3:10}{8:10}{2:10}{6:10}"]
    sets = []
    for mode, frequency in enumerate((16.0, 93.5), 1):
        sets += [*head, f"{2:10}{4:10}{0:10}{mode:10}", f"{frequency:13.5e}{1.0:13.5e}{0.01:13.5e}{0.0:13.5e}"]
        for node in (1, 2, 3):
            sets += [f"{node:10}", "".join(f"{mode * node * way:13.5e}" for way in range(1, 7))]
        sets.append("    -1")
    return "\n".join([*sets, ""]).encode()


FILES = {
    "deck.inp": DECK.replace("NAME=ONE", "NAME=K").encode(),
    "scaled.inp": b"*MATRIX INPUT, NAME=K, TYPE=SYMMETRIC, SCALE FACTOR=1e3\n" + LOWER.encode(),
    "rig.sti": b"1 1 9.0\n2 2 4.\n3 3 1.\n1 2 -4.\n",
    "rig.hb": harwell_boeing(K, "RSA").encode(),
    "rig.bdf": dmig(),
    "rig.npz": by_savez(K=K, M=M),
    "sparse.npz": by_savez(format="csc", shape=(4, 4), data=PARTS.data, indices=PARTS.indices, indptr=PARTS.indptr),
    "rig.mat": by_savemat(K),
    "sparse.mat": by_savemat(PARTS),
    "rig.h5": by_h5py(K=K, M=M),
    "modes.uff": universal_modes(),
    "rig.mtx": MARKET.format("real symmetric", 3, "").encode(),
    "binary.op4": op4_binary(BOTH),
    "big.op4": op4_binary(BOTH, sparse=True, big=True),
    "text.op4": op4_text(BOTH).encode(),
    "sparse.op4": op4_text(BOTH, sparse=True).encode(),
    "matrices.op2": output2(modal=False),
    "modes.op2": output2(modal=True),
}


def marked(names: Iterable[str]) -> list[Any]:
    """Names of files, with the mark of those that pyNastran reads."""
    marks = {".op2": OP2, ".op4": OP4}
    return [pytest.param(name, marks=marks.get(Path(name).suffix, ())) for name in names]


HEADS = {  # the bytes of a head, in which no number of the matrix is said
    "scaled.inp": range(52), "rig.hb": range(324), "rig.mtx": range(47), "rig.bdf": range(14),
    "binary.op4": range(8, 32), "big.op4": range(8, 32), "text.op4": range(53), "sparse.op4": range(53),
    "matrices.op2": range(300),
}  # fmt: skip


def taken(path: Path) -> Any:
    """Numbers that are taken of a file."""
    if Path(path.name).stem.endswith("modes"):
        found = read_modes(path)
        shapes = {label: shape.tolist() for label, shape in found.shapes.items()}
        mass = None if found.mass is None else found.mass.tolist()
        return found.frequency.tolist(), mass, shapes
    return full(read_matrix(path, "", "K"))


def damaged(content: bytes, chance: random.Random) -> bytes:
    """The content with one to three changes: a byte, some taken out or doubled, the end cut off, a large number."""
    found = bytearray(content)
    for _ in range(chance.randint(1, 3)):
        at, kind = chance.randrange(len(found)), chance.randrange(6)
        if kind == 0:
            found[at] = chance.randrange(256)
        elif kind == 1:
            found[at] = chance.choice(b"0123456789-+.eED,*= \n")
        elif kind == 2:
            del found[at : at + chance.randint(1, 8)]
        elif kind == 3:
            found[at:at] = found[at : at + chance.randint(1, 40)]
        elif kind == 4:
            del found[at + 1 :]
        else:
            found[at : at + 4] = chance.choice([b"\xff\xff\xff\x7f", b"\0\0\0\0", b"\xff" * 4, b"\0\0\0\1", b"9999"])
        found = found or bytearray(b"\n")
    return bytes(found)


def run(name: str, folder: Path, count: int) -> None:
    chance, said = random.Random(name), list[str]()
    tracemalloc.start()
    for number in range(count):
        path = folder / f"{number}{name}"
        path.write_bytes(damaged(FILES[name], chance))
        try:
            taken(path)
        except FormatError as fault:
            said.append(str(fault))
    assert all("\n" not in each and len(each) < 400 for each in said)
    if not name.endswith((".op2", ".op4")):  # pyNastran reserves what a head says, and touches none of it
        assert tracemalloc.get_traced_memory()[1] < MOST
    tracemalloc.stop()


@pytest.mark.parametrize("name", marked(FILES))
def test_a_damaged_file_is_read_or_refused(name: str, tmp_path: Path) -> None:
    run(name, tmp_path, 40)


@pytest.mark.slow
@pytest.mark.parametrize("name", marked(FILES))
def test_many_damaged_files_are_read_or_refused(name: str, tmp_path: Path) -> None:
    run(name, tmp_path, 500)


@pytest.mark.parametrize("name", marked(HEADS))
def test_a_damaged_head_changes_no_number(name: str, tmp_path: Path) -> None:
    """Every byte in turn becomes another: the matrix is the same or refused; one of another shape is none of a rig."""
    (tmp_path / name).write_bytes(FILES[name])
    right = taken(tmp_path / name)
    for at in HEADS[name]:
        for other in b"x7 ":
            content = bytearray(FILES[name])
            content[at] = other
            path = tmp_path / f"{at}_{other}_{name}"
            path.write_bytes(content)
            try:
                found = taken(path)
            except FormatError:
                continue
            assert found == right or len(found) != len(right)
