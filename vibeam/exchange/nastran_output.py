"""Nastran's OUTPUT4 and OUTPUT2 files by pyNastran, the extra ``fe``: matrices by name, real modes.

pyNastran (1.4.1) asks for numpy below 2, which the extra brings; with a newer one its reader of OUTPUT2 cannot be
imported. Units and damping of modes are nowhere in these files."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np

from vibeam.exchange.files import LARGEST_TEXT, FormatError, State, read_by, require_coordinates, require_room, state_of
from vibeam.exchange.matrices.declaration import chosen
from vibeam.exchange.matrices.entries import FileMatrix, assembled
from vibeam.exchange.matrices.nastran import alike
from vibeam.exchange.uff import FileModes
from vibeam.exchange.uff import read_modes as read_universal

MISSING = "pyNastran reads it, with numpy below 2: pip install 'vibeam[fe]', or export DMIG, modes as a universal file"
FORMS = {1: False, 2: False, 6: True}  # square, rectangular, symmetric
MODAL = 2  # analysis code of real modes
COMPONENTS = {1: 6, 2: 1}  # of grid points and scalar points
RIGID = 1e-6  # of the largest eigenvalue: so far below 0 may lie that of a rigid motion


def read_output(path: Path, name: str, wanted: str) -> FileMatrix:
    """The matrix by that name; with none, the only one that begins with K, M or B (damping)."""
    from scipy.sparse import coo_array

    state_of(path, LARGEST_TEXT)
    content = _read(path)
    found: Mapping[str, Any] = content if path.suffix.lower() == ".op4" else content.matrices
    matrix = found[chosen(list(found), name.upper(), alike(found, wanted))]
    tables = getattr(content, "table_count", {})  # of OUTPUT2, of which pyNastran keeps the last one of a name
    if isinstance(matrix.data, list) or tables.get(matrix.name.encode(), 1) > 1:
        raise FormatError(f"has several matrices {matrix.name!r}: write the one that is meant alone")
    if matrix.form not in FORMS or matrix.data.dtype.kind != "f":
        read = "square (1), rectangular (2) or symmetric (6), and real, are read"
        raise FormatError(f"{matrix.name!r} has form {matrix.form} and is {matrix.data.dtype}: {read}")
    require_coordinates(*matrix.data.shape)
    if isinstance(matrix.data, np.ndarray):
        require_room(matrix.data.shape)
    entries = coo_array(matrix.data)
    there = entries.data != 0
    rows, columns = (each[there].astype(np.int64) for each in entries.coords)
    return assembled(rows, columns, entries.data[there], entries.shape, FORMS[matrix.form])


def read_modes(path: Path, skip: Sequence[float] = ()) -> FileModes:
    """The modes of a file, this or a universal one, by ascending frequency but those at ``skip`` (Hz), taken as real.

    FormatError where there are none, or one is too far from being real.
    """
    if path.suffix.lower() != ".op2":
        return read_universal(path, skip)
    return _modes(path, state_of(path, LARGEST_TEXT)).without(skip)


@lru_cache(maxsize=8)
def _modes(path: Path, state: State) -> FileModes:
    model = _read(path)
    found = [each for each in model.eigenvectors.values() if each.analysis_code == MODAL]
    if len(found) != 1:
        raise FormatError(f"has no real modes (SOL 103) of one subcase: there are {len(found)}")
    order = np.argsort(found[0].eigns, kind="stable")
    squares, values = np.array(found[0].eigns, dtype=float)[order], np.array(found[0].data, dtype=float)[order]
    if not np.isfinite(values).all() or not squares[0] >= -RIGID * max(squares[-1], 1):
        raise FormatError("has shapes that are not finite, or an eigenvalue below 0")
    shapes = {
        (node, direction + 1): values[:, index, direction]
        for index, (node, kind) in enumerate(found[0].node_gridtype.tolist())
        for direction in range(COMPONENTS.get(kind, 0))
    }
    pairs = (zip(each.mode, each.generalized_mass, strict=True) for each in model.eigenvalues.values())
    known = {int(mode): float(mass) for each in pairs for mode, mass in each}
    mass = np.array([known.get(int(found[0].modes[index]), 0.0) for index in order])
    said = "Nastran OUTPUT2" + ", modal masses as kg" * bool(mass.all())
    return FileModes(np.sqrt(np.maximum(squares, 0)) / (2 * np.pi), None, mass, dict(sorted(shapes.items())), said)


def _read(path: Path) -> Any:
    """Content of a file by pyNastran: matrices by name, of OUTPUT2 its model."""
    said, kind = io.StringIO(), path.suffix.lower()[1:]
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            library: Any = import_module(f"pyNastran.{kind}.{kind}")
        except (ImportError, AttributeError):  # of numpy, what is gone since 2
            raise FormatError(MISSING) from None
        with read_by("cannot be read by pyNastran: is it cut off?"):
            if kind == "op4":
                return library.OP4(debug=None).read_op4(str(path))
            _require_whole(path.read_bytes())
            model = library.OP2(debug=None)
            model.read_op2(str(path), build_dataframe=False)
            return model


def _require_whole(content: bytes) -> None:
    """FormatError for OUTPUT2 with a record that is not whole, or has not the words that the key before it says.

    pyNastran takes memory for what a key says. The first row of a string is not counted.
    """
    order: Literal["little", "big"] = "little" if content[1:4] == bytes(3) else "big"
    word, at, key = int.from_bytes(content[:4], order), 0, 0
    while at < len(content):
        size = int.from_bytes(content[at : at + 4], order)
        end = at + 4 + size
        counted = key <= 0 or size in (key * word, (key + 1) * word)
        if content[end : end + 4] != content[at : at + 4] or not counted:
            raise FormatError(f"has no whole record at byte {at}: is it cut off, or was it sent as text?")
        key = 0 if key > 0 else int.from_bytes(content[at + 4 : end], order, signed=True)
        at = end + 4
