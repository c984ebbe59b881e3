"""Curves in MATLAB's files and in HDF5: variables by name, or a column as ``name:2``; moduli of complex ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import Columns, CurveColumn, WantedColumn, missing, split_head
from vibeam.exchange.files import FormatError, dotted, read_by, require_samples
from vibeam.exchange.hdf5 import contents, opened, text_at, values_of
from vibeam.exchange.mat import Variable, variables
from vibeam_models.arrays import Array

Read = Callable[[], tuple[Any, str]]  # an array and its unit


def read_matlab(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """The variables wanted of a .mat file, by scipy up to version 7, by h5py of version 7.3; FormatError as ``of``."""
    import h5py

    if h5py.is_hdf5(path):
        return read_hdf5(path, wanted)
    with read_by("is no MATLAB file that can be read"):
        found: dict[str, Read] = {}
        for each in variables(path):
            if each.plain:
                found[each.name] = partial(_of_matlab, each)
            else:
                inside = dotted({each.name: each.read(simplify_cells=True)})
                found |= {name: partial(_known, value) for name, value in inside}
        return of(found, wanted)


def _of_matlab(variable: Variable) -> tuple[Any, str]:
    return _known(variable.read(simplify_cells=True))


def _known(value: Any) -> tuple[Any, str]:
    if getattr(value, "format", ""):
        raise FormatError("holds a sparse matrix in place of a column")
    return np.asarray(value), ""


def read_hdf5(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """The datasets wanted, by their paths; their attributes ``units`` or ``unit`` are their units."""
    import h5py

    with read_by("is no HDF5 file that can be read"), opened(path) as file:
        held = ((place, item) for place, item, again in contents(file) if not again)
        found: dict[str, Read] = {
            place: partial(_of_hdf5, item) for place, item in held if isinstance(item, h5py.Dataset) and item.ndim <= 2
        }
        return of(found, wanted)


def _of_hdf5(dataset: Any) -> tuple[Any, str]:
    require_samples(dataset.shape)
    return _plain(values_of(dataset)), text_at(dataset, "units", "unit")


def _plain(value: Any) -> Any:
    """MATLAB 7.3 keeps complex numbers as pairs of fields."""
    array = np.asarray(value)
    fields = array.dtype.names
    if fields and {"real", "imag"} <= set(fields):
        return array["real"] + 1j * array["imag"]
    return array


def of(variables: Mapping[str, Read], wanted: Mapping[str, WantedColumn]) -> Columns:
    """Columns of variables with their units; FormatError where one is missing, no numbers, or of another length.

    Those alone that are wanted are read.
    """
    names = list(variables)
    places = {role: _place(names, each) for role, each in wanted.items()}
    if fault := missing(names, wanted, {role: place and place[0] + 1 for role, place in places.items()}):
        raise fault
    columns = {}
    for role, place in places.items():
        if place is not None:
            name, column = place[1], place[2]
            value, unit = variables[name]()
            columns[role] = _column(name, unit or split_head(name.rpartition("/")[2])[1], value, column, wanted[role])
    lengths = {role: len(column.words or column.values) for role, column in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{columns[role].head!r} has {length}" for role, length in lengths.items())
        raise FormatError(f"its columns are of different lengths: {told}")
    return Columns(columns, tuple(range(1, next(iter(lengths.values())) + 1)))


def _place(names: list[str], wanted: WantedColumn) -> tuple[int, str, int | None] | None:
    """Index, name and column of the variable wanted: by its path, by its last part, or as ``name:2``."""
    last = [name.replace(".", "/").rpartition("/")[2] for name in names]
    for text in wanted.names:
        if isinstance(text, int):
            continue
        name, colon, number = text.strip("/").rpartition(":")
        name, column = (name, int(number)) if colon and number.isdecimal() else (text.strip("/"), None)
        for heads in (names, last):
            places = [place for place, head in enumerate(heads) if head.casefold() == name.casefold()]
            if len(places) > 1:
                raise FormatError(
                    f"has several {name!r}: {', '.join(names[each] for each in places)}; say the whole path"
                )
            if places:
                return places[0], names[places[0]], column
    return None


def _column(name: str, unit: str, value: Any, column: int | None, wanted: WantedColumn) -> CurveColumn:
    array = np.asarray(value)
    require_samples(array.shape)
    if column is not None:
        if array.ndim != 2 or not 0 < column <= array.shape[1]:
            raise FormatError(f"{name!r} has the shape {array.shape}: it has no column {column}")
        array = array[:, column - 1]
    if array.ndim > 1 and sorted(array.shape)[:-1] != [1] * (array.ndim - 1):
        raise FormatError(f'{name!r} has the shape {array.shape}: say which column, "{name}:2"')
    array = array.reshape(-1)
    if wanted.words:
        words = tuple(each.decode() if isinstance(each, bytes) else str(each).strip() for each in array)
        return CurveColumn(name, "", np.full(len(words), np.nan), words)
    return CurveColumn(name, unit, _numbers(name, array))


def _numbers(name: str, array: Any) -> Array:
    if array.dtype.kind == "c":
        return np.asarray(np.abs(array), dtype=float)
    if array.dtype.kind not in "fiub":
        raise FormatError(f"{name!r} holds no numbers")
    numbers = np.asarray(array, dtype=float)
    if np.isinf(numbers).any():
        raise FormatError(f"{name!r} holds an infinite number, at row {int(np.flatnonzero(np.isinf(numbers))[0]) + 1}")
    return numbers
