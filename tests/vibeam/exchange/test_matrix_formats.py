"""Files of matrices: each format as its own programs write it, by other writers than vibeam's readers."""

import os
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import mmwrite, savemat
from scipy.sparse import csc_array, save_npz

from vibeam.exchange.files import FormatError
from vibeam.exchange.matrices.declaration import read_matrix, write_arrays

K = np.array([[9000.5, -4000.25, 0.0], [-4000.25, 4000.25, -1 / 3], [0.0, -1 / 3, 7e-5]])

NAMED = {"K": K, "M": np.eye(3)}


def full(path: Path, name: str = "", wanted: str = "K") -> np.ndarray:
    found = read_matrix(path, name, wanted).matrix
    return found if isinstance(found, np.ndarray) else found.toarray()


def matlab_73(path: Path) -> None:
    """As MATLAB writes it: a user block, then HDF5; a sparse matrix is a group."""
    sparse = csc_array(K)
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("K")
        group.attrs["MATLAB_sparse"] = np.uint64(3)
        parts = {"data": sparse.data, "ir": sparse.indices.astype(np.uint64), "jc": sparse.indptr.astype(np.uint64)}
        for name, part in parts.items():
            group[name] = part
        file["M"] = NAMED["M"]
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM")


def hdf5_sparse(path: Path) -> None:
    sparse = csc_array(K).tocsr()
    with h5py.File(path, "w") as file:
        group = file.create_group("rig/K")
        group.attrs["format"] = "csr"
        for name in ("data", "indices", "indptr"):
            group[name] = getattr(sparse, name)


WRITERS = {
    "sparse.mtx": lambda path: mmwrite(path, csc_array(K), symmetry="symmetric", precision=17),
    "lower.mtx": lambda path: mmwrite(path, K, symmetry="symmetric", precision=17),
    "dense.mtx": lambda path: mmwrite(path, K, precision=17),
    "one.npy": lambda path: np.save(path, K),
    "several.npz": lambda path: np.savez(path, **NAMED),
    "sparse.npz": lambda path: save_npz(path, csc_array(K)),
    "several.h5": lambda path: write_arrays(NAMED, path),
    "sparse.hdf5": hdf5_sparse,
    "five.mat": lambda path: savemat(path, NAMED),
    "sparse.mat": lambda path: savemat(path, {"K": csc_array(K)}),
    "seven.mat": matlab_73,
    "rows.csv": lambda path: np.savetxt(path, K, delimiter=", ", fmt="%.17g"),
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_matrix_is_read_as_it_was_written(name: str, tmp_path: Path) -> None:
    WRITERS[name](tmp_path / name)
    np.testing.assert_array_equal(full(tmp_path / name), K)


@pytest.mark.parametrize("ending", ["npz", "h5", "mat", "mtx", "npy"])
def test_what_is_written_is_read_to_the_bit(ending: str, tmp_path: Path) -> None:
    row = np.array([1 / 3, 0.0, -2e-300])
    places = write_arrays(NAMED | {"contact": row}, tmp_path / f"rig.{ending}")
    for name, array in (NAMED | {"contact": row}).items():
        file, inside = places[name]
        np.testing.assert_array_equal(np.squeeze(full(file, inside, "")), array)


ABAQUS = """\
** Abaqus matrix input: node, dof, node, dof, value
*MATRIX INPUT, NAME=STIF, TYPE=SYMMETRIC
7,1, 7,1,  1.000000000000000e+36
12,1, 7,1, -1.0e3
12,1, 12,1, 5.5e3
12,6, 12,1, 20.
12,6, 12,6, 4.e1
"""


def test_abaqus_names_nodes_and_what_is_held(tmp_path: Path) -> None:
    (tmp_path / "job_STIF1.mtx").write_text(ABAQUS)
    found = read_matrix(tmp_path / "job_STIF1.mtx")
    assert found.labels == ((7, 1), (12, 1), (12, 6))
    assert found.held == {0}
    np.testing.assert_array_equal(found.matrix.toarray(), [[1e36, -1e3, 0], [-1e3, 5.5e3, 20], [0, 20, 40]])


def test_abaqus_both_halves_and_coordinates(tmp_path: Path) -> None:
    (tmp_path / "labels.mtx").write_text("1 1 1 1 2.0\n1 1 2 1 -1.0\n2 1 1 1 -1.5\n2 1 2 1 1.0\n")
    np.testing.assert_array_equal(full(tmp_path / "labels.mtx"), [[2, -1], [-1.5, 1]])  # whether it may is asked later
    (tmp_path / "coordinate.mtx").write_text("1 1 2.0\n2 1 -1.0\n2 2 1.0\n")
    np.testing.assert_array_equal(full(tmp_path / "coordinate.mtx"), [[2, -1], [-1, 1]])


WIDE = """\
$ from a superelement
DMIG    KAAX           0       6       2       0                       3
DMIG*   KAAX                           1               3
*                      1               3 9.000500000D+03
DMIG*   KAAX                           2               3
*                      1               3-4.000250000D+03
*                      2               3 4.000250000D+03
DMIG    MAAX           0       6       1       0
DMIG    MAAX           1       3               1       3     1.5
DMIG    MAAX           2       3               2       32.5-3
DMIG    RECT           0       9       1       0                       1
DMIG    RECT           1       0               1       3     1.0
"""


def test_nastran_in_wide_and_small_fields(tmp_path: Path) -> None:
    (tmp_path / "rig.pch").write_text(WIDE)
    found = read_matrix(tmp_path / "rig.pch", "", "K")
    assert found.labels == ((1, 3), (2, 3))
    np.testing.assert_array_equal(found.matrix.toarray(), [[9000.5, -4000.25], [-4000.25, 4000.25]])
    np.testing.assert_array_equal(full(tmp_path / "rig.pch", "", "M"), [[1.5, 0], [0, 2.5e-3]])


def test_nastran_between_commas_and_continued(tmp_path: Path) -> None:
    cards = ["DMIG,KGG,0,6,1,0", "DMIG,KGG,5,1,,5,1,3.,", "+,6,1,-1.", "DMIG,KGG,6,1,,6,1,2.", "ENDDATA"]
    (tmp_path / "rig.bdf").write_text("BEGIN BULK\n" + "\n".join(cards))
    np.testing.assert_array_equal(full(tmp_path / "rig.bdf"), [[3, -1], [-1, 2]])


def test_a_half_matrix_of_scalar_points(tmp_path: Path) -> None:
    card = (
        "DMIG    K              0       6       1\nDMIG    K             11       0              11       0     4.0\n"
    )
    (tmp_path / "points.dat").write_text(card)
    assert read_matrix(tmp_path / "points.dat").labels == ((11, 1),)


REAL, ARRAY = (b"%%MatrixMarket matrix " + kind + b" real general\n" for kind in (b"coordinate", b"array"))

FAULTS = {
    "none.npz": (None, "no such file"),
    "a.xyz": (b"1", ".xyz is no format of matrices: there are .mtx, .inp, .sti"),
    "b.npz": (b"PK nothing", "cannot be read as a file of NumPy"),
    "c.mat": (b"nothing at all" * 20, "is no MATLAB file that can be read"),
    "d.h5": (b"nothing", "cannot be read as a file of HDF5"),
    "e.mtx": (
        REAL + b"2 2 9\n1 1 1.0\n",
        "has 1 entries, and its line of sizes says 9: is it cut off?",
    ),
    "f.mtx": (
        REAL.replace(b"real", b"complex") + b"1 1 1\n1 1 1.0 2.0\n",
        "line 1: its matrix is 'complex': real or integer",
    ),
    "ea.mtx": (
        REAL + b"2 2 1\n1 1 4.0e+",
        "line 3: '4.0e+' is no number",
    ),
    "eb.mtx": (
        REAL + b"2 2 1\n3 1 4.0",
        "line 3: '3 1 4.0' is outside the matrix",
    ),
    "ec.mtx": (ARRAY + b"2 1\n4.0", "has 1 numbers, and its line of sizes says 2"),
    "ed.mtx": (ARRAY + b"2\n4.0", "line 2: '2' are no sizes"),
    "ee.mtx": (b"%%MatrixMarket vector", "line 1: is no Matrix Market head"),
    "ef.mtx": (ARRAY + b"% no more\n", "has no line of sizes"),
    "eg.mtx": (ARRAY + b"2 1\n4.0 1.0\n2.0", "line 3: '4.0 1.0' has more numbers in place of 1"),
    "g.mtx": (b"** nothing\n", "holds no entries"),
    "h.mtx": (b"1,1,1,1,2.0\n1,1,2,1\n", "line 2: '1 1 2 1' has 4 numbers in place of 5"),
    "i.mtx": (b"1,1,1,1,2.0\n1,1,1,1,2.0\n", "the entry of node 1 direction 1, node 1 direction 1 is there twice"),
    "j.mtx": (
        b"1,1,1,1,2.0\n1.5,1,1,1,2.0\n",
        "line 2: '1.5 1 1 1 2.0' is outside the matrix, or its place is no whole number",
    ),
    "k.mtx": (b"1,1,1,1,2.0\n1,1,2,1,x\n", "line 2: 'x' is no number"),
    "l.mtx": (b"0 1 2.0\n", "line 1: '0 1 2.0' is outside the matrix"),
    "m.pch": (b"DMIG    K              0       9       1\n", "line 1: IFO 9 is a rectangular matrix"),
    "n.pch": (b"DMIG    K              0       6       3\n", "line 1: TIN 3 is complex"),
    "o.pch": (
        b"DMIG    K              1       1               1       1     x.0\n",
        "needs one header, here there are 0",
    ),
    "p.pch": (b"GRID 1\n", "holds no matrix"),
    "q.csv": (b"1, 2\n3\n", "line 2: '3' has 1 numbers in place of 2"),
    "r.csv": (b"1, two\n", "line 1: 'two' is no number"),
    "s.npy": (b"\x93NUMPY nothing", "begins with no head of NumPy's: is it cut off?"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_file_that_cannot_be_read_says_why(name: str, tmp_path: Path) -> None:
    content, message = FAULTS[name]
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(FormatError) as caught:
        read_matrix(tmp_path / name)
    assert message in str(caught.value)


def test_several_matrices_want_a_name(tmp_path: Path) -> None:
    np.savez(tmp_path / "several.npz", one=K, two=K)
    with pytest.raises(FormatError, match="holds one, two: say which by name"):
        read_matrix(tmp_path / "several.npz", "", "K")
    with pytest.raises(FormatError, match="holds no 'K': there are one, two"):
        read_matrix(tmp_path / "several.npz", "K")
    np.savez(tmp_path / "words.npz", K=np.array(["a"]))
    with pytest.raises(FormatError, match="holds <U1 in place of real numbers"):
        read_matrix(tmp_path / "words.npz", "K")
    (tmp_path / "own.npz").mkdir()
    os.mkfifo(tmp_path / "pipe.npz")
    with pytest.raises(FormatError, match="is not a regular file"):
        read_matrix(tmp_path / "pipe.npz")
    with (tmp_path / "vast.npz").open("wb") as file:
        file.truncate(6 * 10**9)
    with pytest.raises(FormatError, match="has 6000 MB; such a file may have 2000 MB at most"):
        read_matrix(tmp_path / "vast.npz")
    with pytest.raises(FormatError, match="no such file"):
        read_matrix(tmp_path / "a\0.npz")
    with pytest.raises(FormatError, match="folder"):
        read_matrix(tmp_path / "own.npz")


def test_nothing_is_unpickled(tmp_path: Path) -> None:
    np.save(tmp_path / "objects.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(FormatError, match="holds object in place of real numbers"):
        read_matrix(tmp_path / "objects.npy")


@pytest.mark.parametrize("name", WRITERS)
def test_a_file_that_is_cut_off_is_refused_or_whole(name: str, tmp_path: Path) -> None:
    """Cut at every 37th byte, before the last line of a text, whose last number may be another where it is cut."""
    WRITERS[name](tmp_path / name)
    content = (tmp_path / name).read_bytes()
    text = name.endswith((".mtx", ".csv"))
    for length in range(0, content.rstrip().rfind(b"\n") if text else len(content), 37):
        cut = tmp_path / f"{length}{name}"
        cut.write_bytes(content[:length])
        try:
            found = full(cut)
        except FormatError:
            continue
        assert np.array_equal(found, K) or found.shape != K.shape
