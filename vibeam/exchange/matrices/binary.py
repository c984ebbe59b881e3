"""Matrices in binary files: NumPy's and scipy's (.npy, .npz), HDF5, MATLAB's.

Of HDF5 a dataset, or a group that holds a sparse matrix as MATLAB 7.3 or scipy's csc and csr have it; MATLAB's files up
to version 7 are read by scipy, those of version 7.3 are HDF5."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import ZipFile

import numpy as np

from vibeam.exchange.files import FormatError, require_room
from vibeam.exchange.hdf5 import contents, opened, text_at, values_of
from vibeam.exchange.mat import variables
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, compressed, numbers, scattered
from vibeam.exchange.matrices.text import require_no_name

COMPRESSED = {"data", "indices", "indptr"}  # datasets of a sparse matrix as scipy has it
MATLAB = {"data", "ir", "jc"}  # and as MATLAB has it, with the attribute MATLAB_sparse


def read_hdf5(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix at a path in the file; MATLAB's, whose arrays lie by columns, are symmetric either way."""
    import h5py

    with opened(path) as file:
        found = _matrices(file)
        name = name.strip("/")
        if found.get(name or wanted, file) is None:
            raise FormatError(f"{name or wanted!r} is a link to another place: copy the values into this file")
        meant = found[chosen([place for place in found if found[place] is not None], name, wanted)]
        return FileMatrix(numbers(values_of(meant)) if isinstance(meant, h5py.Dataset) else _sparse(meant))


def _matrices(file: Any) -> dict[str, Any]:
    """Possible matrices by path: datasets, links, and groups that are one, whose own datasets are not listed."""
    import h5py

    found: dict[str, Any] = {}
    inside = "/"
    for place, item, _ in contents(file):
        if place.startswith(inside):
            continue
        if isinstance(item, h5py.Group) and (set(item) >= COMPRESSED or set(item) >= MATLAB):
            inside = f"{place}/"
        if item is None or isinstance(item, h5py.Dataset) or inside == f"{place}/":
            found[place] = item
    return found


def _sparse(group: Any) -> Any:
    names, by_rows = ("data", "ir", "jc"), False
    if set(group) >= COMPRESSED:
        names = ("data", "indices", "indptr")
        by_rows = "csr" in text_at(group, "format", "h5sparse_format")
    values, indices, starts = (_part(group, name) for name in names)
    size = len(starts) - 1
    return compressed(values, indices, starts, (size, size), by_rows=by_rows)


def _part(group: Any, name: str) -> Any:
    import h5py

    if type(group.get(name, getlink=True)) is not h5py.HardLink or not isinstance(group[name], h5py.Dataset):
        raise FormatError(f"{group.name + '/' + name!r} is no dataset of this file: copy it into it")
    return values_of(group[name])


def read_matlab(path: Path, name: str, wanted: str) -> FileMatrix:
    """The variable by that name, full or sparse."""
    held = {each.name: each for each in variables(path) if each.plain}
    found: Any = held[chosen(list(held), name, wanted)].read()
    if isinstance(found, np.ndarray):
        require_room(found.shape)
        return FileMatrix(numbers(found))
    if found.format == "coo":
        return FileMatrix(scattered(found.data, found.row, found.col, found.shape))
    return FileMatrix(compressed(found.data, found.indices, found.indptr, found.shape))


MAGIC = b"\x93NUMPY"
LONGEST_HEAD = 10_000  # bytes, as numpy's own limit
DIRECTORY = 1_000_000  # bytes of the directory of a .npz: some thousand arrays
SPARSE = {"format", "shape", "data"}  # what scipy.sparse.save_npz writes in every file
Part = Callable[[str], Any]


def read_numpy(path: Path, name: str, wanted: str) -> FileMatrix:
    """The array of a file, or the one by that name; objects of Python's are none."""
    with path.open("rb") as file:
        if path.suffix.lower() == ".npz":
            return FileMatrix(_npz(file, name, wanted))
        require_no_name(name)
        return FileMatrix(numbers(_array(file)))


def _npz(file: BinaryIO, name: str, wanted: str) -> Any:
    _require_small_directory(file)
    with ZipFile(file) as members:
        names = [each.removesuffix(".npy") for each in members.namelist()]

        def part(each: str) -> Any:
            if each not in names:
                raise FormatError(f"holds a sparse matrix without its {each!r}")
            place = names.index(each)
            with members.open(members.infolist()[place]) as member:
                return _array(member, kinds="fiubSU")

        if set(names) >= SPARSE:
            return _scipy(part, names)
        return numbers(part(chosen(names, name, wanted)))


def _require_small_directory(file: BinaryIO) -> None:
    """FormatError for a directory of members that zipfile would read whole (APPNOTE 6.3.10, 4.3.12 and 4.3.16)."""
    size = file.seek(0, 2)
    file.seek(max(0, size - (1 << 16) - 22))
    end = file.read()
    at = end.rfind(b"PK\x05\x06")
    if at >= 0 and (int.from_bytes(end[at + 12 : at + 16], "little") > DIRECTORY or b"PK\x06\x07" in end[at - 20 : at]):
        raise FormatError(f"has a directory of more than {DIRECTORY / 1e6:.0f} MB: keep fewer arrays in one file")
    file.seek(0)


def _array(file: Any, kinds: str = "fiu") -> Any:
    """The array of an open .npy file, after a look at how large it is."""
    start = file.read(12)
    if start[:6] != MAGIC or start[6:7] not in b"\x01\x02":
        raise FormatError("begins with no head of NumPy's: is it cut off?")
    if int.from_bytes(start[8 : 10 if start[6] == 1 else 12], "little") > LONGEST_HEAD:
        raise FormatError(f"has a head of more than {LONGEST_HEAD} bytes")
    file.seek(len(MAGIC) + 2)
    head = np.lib.format.read_array_header_1_0 if start[6] == 1 else np.lib.format.read_array_header_2_0
    shape, _, kind = head(file)
    if kind.kind not in kinds:
        raise FormatError(f"holds {kind} in place of real numbers")
    require_room(shape, kind.itemsize)
    file.seek(0)
    return np.lib.format.read_array(file, allow_pickle=False)


def _scipy(part: Part, names: Collection[str]) -> Any:
    """A matrix as scipy writes it: compressed, or entry by entry."""
    kind, shape = np.asarray(part("format")).astype(str).item(), _shape(part("shape"))
    values = part("data")
    if kind in ("csc", "csr"):
        return compressed(values, part("indices"), part("indptr"), shape, by_rows=kind == "csr")
    if kind == "coo":
        places = part("coords") if "coords" in names else (part("row"), part("col"))
        return scattered(values, places[0], places[1], shape)
    raise FormatError(f"holds no sparse matrix of the format {kind!r} that can be read: save it as csc")


def _shape(found: Any) -> tuple[int, int]:
    if found.shape != (2,) or found.dtype.kind not in "iu":
        raise FormatError("holds a sparse matrix whose shape is not two whole numbers")
    return int(found[0]), int(found[1])
