"""Arrays by name to one file, or one file each, in a format that is read again."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vibeam.exchange.whole_files import write_whole

DIGITS = 17  # of a float, so that it is read as the same
Arrays = Mapping[str, NDArray[np.float64]]


def write_arrays(arrays: Arrays, path: Path) -> dict[str, tuple[Path, str]]:
    """Write arrays to ``path`` (.npz, .h5, .mat), or, as .mtx or .npy, each to a file with its name: where each is.

    (file, name in it, empty where it is alone). ValueError for another ending.
    """
    ending = path.suffix.lower()
    if ending in _TOGETHER:
        write_whole(path, _TOGETHER[ending](arrays))
        return {name: (path, name) for name in arrays}
    if ending not in _ALONE:
        raise ValueError(f"{path}: matrices are written as {', '.join(ENDINGS)}")
    files = {name: path.with_name(f"{path.stem}_{name}{ending}") for name in arrays}
    for name, file in files.items():
        write_whole(file, _ALONE[ending](arrays[name]))
    return {name: (file, "") for name, file in files.items()}


def _npz(arrays: Arrays) -> bytes:
    made = BytesIO()
    np.savez(made, **dict(arrays))  # type: ignore[arg-type]
    return made.getvalue()


def _mat(arrays: Arrays) -> bytes:
    from scipy.io import savemat

    made = BytesIO()
    savemat(made, dict(arrays))
    return made.getvalue()


def _hdf5(arrays: Arrays) -> bytes:
    import h5py

    made = BytesIO()
    with h5py.File(made, "w") as file:
        for name, array in arrays.items():
            file[name] = array
    return made.getvalue()


def _npy(array: Any) -> bytes:
    made = BytesIO()
    np.save(made, array)
    return made.getvalue()


def _mtx(array: Any) -> bytes:
    from scipy.io import mmwrite
    from scipy.sparse import coo_array

    made = BytesIO()
    matrix = np.atleast_2d(array)
    mmwrite(made, coo_array(matrix) if matrix.shape[0] > 1 else matrix.T, precision=DIGITS)
    return made.getvalue()


_TOGETHER = {".npz": _npz, ".h5": _hdf5, ".hdf5": _hdf5, ".mat": _mat}
_ALONE = {".mtx": _mtx, ".npy": _npy}
ENDINGS = (*_TOGETHER, *_ALONE)
