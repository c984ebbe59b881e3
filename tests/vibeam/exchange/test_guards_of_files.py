"""Guards of files with arrays: what lies elsewhere, was never written, or says that it is more than there is."""

import struct
import zipfile
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from box_meshes import nodes_of
from scipy.io import savemat, wavfile

import vibeam
from vibeam.exchange import hdf5, mat
from vibeam.exchange.files import NUMBERS, FormatError, lines_of, require_room, text_of
from vibeam.exchange.matrices.declaration import read_matrix
from vibeam.extensions.solid.meshes.read import read_mesh
from vibeam.system.record_samples import MOST_SAMPLES

K = np.array([[2.0, -1.0], [-1.0, 1.0]])


def external(path: Path) -> None:
    """Values in a file beside it, by name, byte and length."""
    (path.parent / "raw.bin").write_bytes(K.tobytes())
    with h5py.File(path, "w") as file:
        file.create_dataset("K", shape=K.shape, dtype=float, external=[("raw.bin", 0, K.nbytes)])


def virtual(path: Path) -> None:
    """Values of a dataset of another file."""
    with h5py.File(path.with_name("source.h5"), "w") as file:
        file["K"] = K
    layout = h5py.VirtualLayout(shape=K.shape, dtype=float)
    layout[...] = h5py.VirtualSource("source.h5", "K", shape=K.shape)
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("K", layout)


@pytest.mark.parametrize("write", [external, virtual])
def test_values_that_lie_in_other_files_are_not_read(write, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path / "K.h5")
    with h5py.File(tmp_path / "K.h5") as file:  # the library itself would
        np.testing.assert_array_equal(file["K"][()], K)
    with pytest.raises(FormatError, match="'/K' has its values in other files: copy them into this one"):
        read_matrix(tmp_path / "K.h5")


@pytest.mark.parametrize("write", [external, virtual])
def test_nodes_that_lie_in_other_files_are_not_read(write, tmp_path: Path) -> None:
    points, cells = nodes_of("hexahedron")
    meshio.Mesh(points, [("hexahedron", np.array(cells))]).write(tmp_path / "rig.med")
    write(tmp_path / "other.h5")
    with h5py.File(tmp_path / "other.h5") as other, h5py.File(tmp_path / "rig.med", "r+") as file:
        other.copy("K", file, name="far", expand_external=False)
    with pytest.raises(FormatError, match="'far' lies in another file: copy it into this one"):
        read_mesh(tmp_path / "rig.med")


def test_hdf5_with_more_than_is_read(tmp_path: Path, monkeypatch) -> None:
    with h5py.File(tmp_path / "never.h5", "w") as file:
        file.create_dataset("K", shape=(3000, 3000), dtype=float)
    with pytest.raises(FormatError, match="'/K' has no values: they were never written"):
        read_matrix(tmp_path / "never.h5")
    with h5py.File(tmp_path / "vast.h5", "w") as file:
        file.create_dataset("K", shape=(NUMBERS + 1, 1), dtype="i1", chunks=(1, 1))[0] = 1
    with pytest.raises(FormatError, match=r"is 25000001 × 1; an array may have 25 000 000 numbers at most"):
        read_matrix(tmp_path / "vast.h5")
    with h5py.File(tmp_path / "deep.h5", "w") as file:
        file["/".join("a" * (hdf5.DEEPEST + 2)) + "/K"] = K
    with pytest.raises(FormatError, match="has groups that lie deeper than 32 in each other"):
        read_matrix(tmp_path / "deep.h5")
    with h5py.File(tmp_path / "many.h5", "w") as file:
        for name in range(8):
            file[str(name)] = K
    monkeypatch.setattr(hdf5, "MOST", 7)
    with pytest.raises(FormatError, match="has more than 7 groups and datasets"):
        read_matrix(tmp_path / "many.h5", "1")


def test_hdf5_that_names_a_group_within_itself_ends(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "loop.h5", "w") as file:
        file["K"] = K
        file["group/again"] = file["/"]
        file["group/self"] = file["group"]
    np.testing.assert_array_equal(read_matrix(tmp_path / "loop.h5", "K").matrix, K)


def test_an_array_has_25_million_numbers_at_most(tmp_path: Path) -> None:
    require_room((5000, 5000))
    for shape in ((NUMBERS + 1,), (5000, 5001), (2**40, 2**40)):
        with pytest.raises(FormatError, match="an array may have 25 000 000 numbers at most"):
            require_room(shape)
    with pytest.raises(FormatError, match="an array may have 400 MB at most"):
        require_room((NUMBERS,), 17)
    with pytest.raises(FormatError, match=r"says that it is -1 × 2"):
        require_room((-1, 2))
    head = str({"descr": "|i1", "fortran_order": False, "shape": (NUMBERS + 1,)}).encode().ljust(117) + b"\n"
    with (tmp_path / "vast.npy").open("wb") as file:  # all of its bytes are there, on most disks without taking room
        file.write(b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head)
        file.truncate(10 + len(head) + NUMBERS + 1)
    with pytest.raises(FormatError, match="is 25000001; an array may have 25 000 000 numbers at most"):
        read_matrix(tmp_path / "vast.npy")


@pytest.mark.parametrize("packed", [False, True])
def test_a_matlab_variable_that_is_more_than_there_is(packed: bool, tmp_path: Path) -> None:
    """2 × 2 numbers become 2 × 4000, or −2 × 2: scipy would take memory for them, or more."""
    import zlib

    savemat(tmp_path / "K.mat", {"K": K})
    whole = (tmp_path / "K.mat").read_bytes()
    for rows, said in ((4000, "says that it is 2 × 4000"), (-2, "2 × -2"), (NUMBERS, "is 2 × 25000000; an array may")):
        told = struct.pack("<iiii", 5, 8, 2, 2)
        assert whole.count(told) == 1
        changed = whole.replace(told, struct.pack("<iiii", 5, 8, 2, rows))
        if packed:
            body = zlib.compress(changed[128:])
            changed = changed[:128] + struct.pack("<II", mat.PACKED, len(body)) + body
        (tmp_path / "K.mat").write_bytes(changed)
        with pytest.raises(FormatError, match=said):
            read_matrix(tmp_path / "K.mat")


def test_a_matlab_variable_whose_content_is_no_array_of_its_size(tmp_path: Path, monkeypatch) -> None:
    savemat(tmp_path / "deep.mat", {"a": {"b": {"c": {"K": K}}}})
    monkeypatch.setattr(mat, "DEEPEST", 2)
    with pytest.raises(FormatError, match="holds variables in variables, deeper than 2"):
        mat.variables(tmp_path / "deep.mat")
    savemat(tmp_path / "packed.mat", {"K": np.zeros((300, 300))}, do_compression=True)
    monkeypatch.setattr(mat, "BYTES", 100_000)
    with pytest.raises(FormatError, match="holds more than 0 MB"):
        read_matrix(tmp_path / "packed.mat")


TEXT = struct.pack("<IIiiII", 5, 8, 1, 1, 1, 0)  # dimensions and no name, before a text


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b"\x10\0\x01\0g", b"\x2c\0\x01\0g", "there is no type 44 of elements"),
        (TEXT + b"\x10", struct.pack("<IIiiII", 5, 12, 1, 1, 1, 0) + b"\x10", "a variable has 3 elements"),
    ],
)
def test_matlab_elements_that_scipy_would_not_survive(tmp_path: Path, old: bytes, new: bytes, said: str) -> None:
    """Of the type 44 it takes what lies behind its table of types; without its content, the next variable's."""
    savemat(tmp_path / "a.mat", {"run": {"acc": np.arange(5.0), "unit": "g"}})
    whole = (tmp_path / "a.mat").read_bytes()
    assert whole.count(old) == 1
    (tmp_path / "a.mat").write_bytes(whole.replace(old, new))
    with pytest.raises(vibeam.CaseError, match=f"is damaged: {said}"):
        vibeam.record_of_file(tmp_path / "a.mat", rate=1.0)


def test_a_heap_of_hdf5_with_an_empty_piece(tmp_path: Path) -> None:
    """The library takes the free space behind the texts, of 0 bytes, again and again."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["acc"] = np.arange(5.0)
        file["acc"].attrs["units"] = "g"
    whole = (tmp_path / "a.h5").read_bytes()
    free = struct.pack("<QQ", 0, 4096 - 16 - 24)
    assert whole.count(free) == 1
    (tmp_path / "a.h5").write_bytes(whole.replace(free, bytes(16)))
    with pytest.raises(vibeam.CaseError, match=r"is damaged: the heap at byte \d+ has an empty piece"):
        vibeam.record_of_file(tmp_path / "a.h5", rate=1.0)


def test_a_directory_of_many_arrays_is_not_read_whole(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "many.npz", "w") as file:
        for name in range(2000):
            file.writestr(f"{name:0600}.npy", b"")
    with pytest.raises(FormatError, match="has a directory of more than 1 MB: keep fewer arrays in one file"):
        read_matrix(tmp_path / "many.npz", "K")


def test_indices_and_pointers_that_leave_the_matrix(tmp_path: Path) -> None:
    """They go into compiled code, which looks at none of them."""
    sparse = {"data": np.ones(2), "format": np.array("csc"), "shape": np.array([2, 2])}
    for parts, said in (
        ({"indices": [0, 2], "indptr": [0, 1, 2]}, "has the index 2, and they are 0 to 1"),
        ({"indices": [-1, 0], "indptr": [0, 1, 2]}, "has the index -1, and they are 0 to 1"),
        ({"indices": [0, 1], "indptr": [0, 3, 2]}, "has pointers that do not rise from 0"),
        ({"indices": [0, 1], "indptr": [0, 1, 9]}, "has pointers that do not rise from 0"),
        ({"indices": [0, 1], "indptr": [0, 2]}, "has pointers that are not 3 whole numbers"),
        ({"indices": [0.0, 1.0], "indptr": [0, 1, 2]}, "holds float64 in place of whole numbers"),
    ):
        np.savez(tmp_path / "K.npz", **sparse, **{name: np.array(each) for name, each in parts.items()})
        with pytest.raises(FormatError, match=said):
            read_matrix(tmp_path / "K.npz")


def test_text_that_is_none(tmp_path: Path) -> None:
    for content, said in ((b"PK\x03\x04", "is a workbook"), (b"1\0 2", "is not UTF-8 text"), (b"", "is empty")):
        (tmp_path / "a.csv").write_bytes(content)
        with pytest.raises(FormatError, match=said):
            text_of(tmp_path / "a.csv")
    with (tmp_path / "a.csv").open("wb") as file:
        file.truncate(100_000_001)
    with pytest.raises(FormatError, match="has 100 MB; such a file may have 100 MB at most"):
        text_of(tmp_path / "a.csv")


def test_lines_that_are_too_long_or_too_many() -> None:
    assert list(lines_of("1\n\n2", longest=1, most=4)) == [(1, "1"), (3, "2")]
    with pytest.raises(FormatError, match="line 2: has 4 characters; a line may have 3 at most"):
        list(lines_of("1\n1234", longest=3))
    with pytest.raises(FormatError, match="has more than 2 lines: keep fewer"):
        list(lines_of("1\n2\n3", most=2))


def test_a_short_file_that_names_a_long_word(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "words.h5", "w") as file:
        file["words"] = ["up", "a" * (hdf5.WORD + 1)]
        with pytest.raises(FormatError, match="'/words' holds a word of 1001 characters"):
            hdf5.values_of(file["words"])


def test_a_record_of_too_many_samples_is_refused_before_it_is_read(tmp_path: Path, monkeypatch) -> None:
    """The values of a dataset are not asked for; those of other formats are not made numbers of 8 bytes."""
    count = MOST_SAMPLES + 1
    with h5py.File(tmp_path / "long.h5", "w") as file:
        file.create_dataset("acceleration", shape=(count,), dtype="i1", chunks=(1 << 20,))[:4] = 1
    savemat(tmp_path / "long.mat", {"acceleration": np.zeros(count, "i1")}, do_compression=True)
    wavfile.write(tmp_path / "long.wav", 48000, np.zeros(count, "u1"))
    monkeypatch.setattr("vibeam.exchange.curves.arrays.values_of", lambda dataset: pytest.fail("was read"))
    monkeypatch.setattr("vibeam.exchange.curves.arrays._numbers", lambda *_: pytest.fail("was made floats"))
    for name in ("long.h5", "long.mat", "long.wav"):
        with pytest.raises(
            vibeam.CaseError, match=f"{name}: has {count} samples; {MOST_SAMPLES} at most: cut the record"
        ):
            vibeam.record_of_file(tmp_path / name, rate=48000, scale=1.0)
