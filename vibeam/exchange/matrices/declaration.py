"""Formats of matrices: their endings and beginnings, their readers; and arrays written in one that is read again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.files import FormatError, State, digest_of, file_fault, read_by, require_coordinates, state_of
from vibeam.exchange.matrices.entries import FileMatrix
from vibeam.exchange.whole_files import beside, write_whole
from vibeam_models.registry import Registry, loaded

HEAD = 512  # bytes by which a format is told where the ending does not
SHOWN = 12  # names in a message


@dataclass(frozen=True)
class MatrixFormat:
    """A format: the ``endings`` of its files, ``read`` (path, name of the matrix in the file or "", what is wanted).

    ``read``: the function or ``"module:function"``, imported when it is asked for; FormatError for a file that is not
    of the format. ``starts``: what such a file begins with, where others have the same ending.
    """

    name: str
    endings: tuple[str, ...]
    read: str | Callable[[Path, str, str], FileMatrix]
    starts: bytes = b""


_HOME = "vibeam.exchange.matrices"

FORMATS = Registry(
    "format of matrices",
    MatrixFormat("Matrix Market", (".mtx",), f"{_HOME}.text:read_matrix_market", b"%%MatrixMarket"),
    MatrixFormat("Abaqus", (".mtx", ".inp"), f"{_HOME}.abaqus:read_abaqus"),
    MatrixFormat("CalculiX", (".sti", ".mas"), f"{_HOME}.abaqus:read_calculix"),
    MatrixFormat("Harwell–Boeing", (".hb", ".rb", ".rsa", ".rua"), f"{_HOME}.harwell_boeing:read_harwell_boeing"),
    MatrixFormat("Nastran OUTPUT4", (".op4",), "vibeam.exchange.nastran_output:read_output"),
    MatrixFormat("Nastran OUTPUT2", (".op2",), "vibeam.exchange.nastran_output:read_output"),
    MatrixFormat("NumPy", (".npy", ".npz"), f"{_HOME}.binary:read_numpy"),
    MatrixFormat("HDF5", (".h5", ".hdf5"), f"{_HOME}.binary:read_hdf5"),
    MatrixFormat("MATLAB 7.3", (".mat",), f"{_HOME}.binary:read_hdf5", b"MATLAB 7.3"),
    MatrixFormat("MATLAB", (".mat",), f"{_HOME}.binary:read_matlab"),
    MatrixFormat("Nastran", (".pch", ".bdf", ".dat", ".nas"), f"{_HOME}.nastran:read_nastran"),
    MatrixFormat("text", (".txt", ".csv"), f"{_HOME}.text:read_text"),
)

ENDINGS = tuple(dict.fromkeys(ending for each in FORMATS.values() for ending in each.endings))


def read_matrix(path: Path, name: str = "", wanted: str = "") -> FileMatrix:
    """The matrix ``name`` of a file; with no name the one that is called ``wanted`` ("M", "K"), or the only one.

    FormatError, without the file's name, for a file that is missing or holds no such thing. What was read is kept for
    as long as the file stays as it is.
    """
    return _read(path, name, wanted, tuple(map(state_of, (path, *_beside(path)))))


def digest_with(path: Path) -> str:
    """SHA-256 of a file, and of those beside it that it is read with; FormatError as ``state_of``."""
    return " ".join(map(digest_of, (path, *_beside(path))))


def _beside(path: Path) -> list[Path]:
    """Files that one is read with: CalculiX' names of nodes."""
    names = path.with_suffix(".dof")
    return [names] if path.suffix.lower() in (".sti", ".mas") and file_fault(names) is None else []


@lru_cache(maxsize=32)
def _read(path: Path, name: str, wanted: str, states: tuple[State, ...]) -> FileMatrix:
    kind = _format_of(path)
    with read_by(f"cannot be read as a file of {kind.name}"):
        found: FileMatrix = loaded(kind.read)(path, name, wanted)
    if len(found.matrix.shape) not in (1, 2):
        told = "a single number" if found.matrix.ndim == 0 else f"an array of {found.matrix.ndim} dimensions"
        raise FormatError(f"holds {told}: a matrix or a row is needed")
    require_coordinates(*found.matrix.shape)
    return replace(found, notes=(kind.name, *found.notes))


def _format_of(path: Path) -> MatrixFormat:
    alike = [each for each in FORMATS.values() if path.suffix.lower() in each.endings]
    if not alike:
        raise FormatError(f"{path.suffix or 'no ending'} is no format of matrices: there are {', '.join(ENDINGS)}")
    with read_by(refusal=OSError), path.open("rb") as file:
        head = file.read(HEAD)
    told = [each for each in alike if each.starts and each.starts.lower() in head.lower()]
    return next(iter([*told, *(each for each in alike if not each.starts), *alike]))


def chosen(names: list[str], name: str, wanted: str) -> str:
    """Name, one of the ``names`` in a file, that is meant; FormatError names them where that is not plain."""
    if not names:
        raise FormatError("holds no matrix")
    some = ", ".join(names[:SHOWN]) + " …" * (len(names) > SHOWN)
    if name:
        if name not in names:
            raise FormatError(f"holds no {name!r}: there are {some}")
        return name
    if wanted in names or len(names) == 1:
        return wanted if wanted in names else names[0]
    raise FormatError(f"holds {some}: say which by name, {{ file = …, name = {names[0]!r} }}")


DIGITS = 17  # of a float, so that it is read as the same
Arrays = Mapping[str, NDArray[np.float64]]


def write_arrays(arrays: Arrays, path: Path) -> dict[str, tuple[Path, str]]:
    """Write arrays to ``path`` (.npz, .h5, .mat), or, as .mtx or .npy, each to a file with its name: where each is.

    (file, name in it, empty where it is alone). ValueError for another ending.
    """
    ending = path.suffix.lower()
    if ending in _TOGETHER:
        write_whole(path, _content(_TOGETHER[ending], dict(arrays)))
        return {name: (path, name) for name in arrays}
    if ending not in _ALONE:
        raise ValueError(f"{path}: matrices are written as {', '.join(WRITTEN)}")
    files = {name: beside(path.with_name(f"{path.stem}_{name}{ending}")) for name in arrays}
    for name, file in files.items():
        write_whole(file, _content(_ALONE[ending], arrays[name]))
    return {name: (file, "") for name, file in files.items()}


def _content(write: Write, what: Any) -> bytes:
    file = BytesIO()
    write(file, what)
    return file.getvalue()


def _npz(file: BytesIO, arrays: Any) -> None:
    np.savez(file, **arrays)


def _mat(file: BytesIO, arrays: Any) -> None:
    from scipy.io import savemat

    savemat(file, arrays)


def _hdf5(file: BytesIO, arrays: Any) -> None:
    import h5py

    with h5py.File(file, "w") as made:
        for name, array in arrays.items():
            made[name] = array


def _mtx(file: BytesIO, array: Any) -> None:
    from scipy.io import mmwrite
    from scipy.sparse import coo_array

    matrix = np.atleast_2d(array)
    mmwrite(file, coo_array(matrix) if matrix.shape[0] > 1 else matrix.T, precision=DIGITS)


Write = Callable[[BytesIO, Any], None]
_TOGETHER: dict[str, Write] = {".npz": _npz, ".h5": _hdf5, ".hdf5": _hdf5, ".mat": _mat}
_ALONE: dict[str, Write] = {".mtx": _mtx, ".npy": np.save}
WRITTEN = (*_TOGETHER, *_ALONE)
