"""Curves in MATLAB's files and in HDF5: variables by name, or a column as ``name:2``; moduli of complex ones.

Units, steps and starts are attributes of a variable or its groups, or stand beside it: ``acc``, ``unit``, ``fs``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import TIMES, Columns, CurveColumn, WantedColumn, missing, split_head
from vibeam.exchange.files import FormatError, read_by, require_samples, shown
from vibeam.exchange.hdf5 import MOST, contents, opened, referred, values_of, words_of
from vibeam.exchange.mat import Variable, variables
from vibeam_models.arrays import Array

UNITS = ("unit", "units", "unit_str", "unit_string", "ni_unitdescription")
RATES = ("fs", "sampling_rate", "sample_rate", "samplerate", "sampling_frequency")
STEPS = ("dt", "delta_t", "wf_increment", "sampling_interval")
STARTS = ("t0", "x0", "wf_start_offset")
CLOCKS = (*RATES, *STEPS, *STARTS)
SCALE = "scale"
LOOKED_AT = 100  # variables, for a clock, where none is asked for
CLOCK = "time"  # column of times that are made of a rate or step
COLUMNS = 33  # of an array whose units stand in cells, from 1
ROUNDED = 1e-3  # relative difference of a rate and a step that are both said


@dataclass(frozen=True)
class Stored:
    """Variable of a file: how it is read, and how what is ``said`` of it, by small words, ``SCALE`` its abscissa."""

    read: Callable[[], Any]
    said: Callable[[], Mapping[str, Any]] = dict


def read_matlab(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """The variables wanted of a .mat file, by scipy up to version 7, by h5py of version 7.3; FormatError as ``of``."""
    import h5py

    if h5py.is_hdf5(path):
        return read_hdf5(path, wanted, "variable")
    with read_by("is no MATLAB file that can be read"):
        found: dict[str, Stored] = {}
        for each in variables(path):
            if each.plain or each.object:
                found[each.name] = Stored(partial(_of_matlab, each))
            else:
                inside = _inside(each.name, each.read(simplify_cells=True))
                found |= {name: Stored(partial(_dense, value)) for name, value in inside}
        return of(found, wanted, "variable")


def _inside(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Values of nested structures by dotted names, of arrays of them with numbers from 1: ``run(2).acc``."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _inside(f"{name}.{key}", inner)
    elif isinstance(value, list) and any(isinstance(each, Mapping) for each in value):
        for number, inner in enumerate(value, 1):
            yield from _inside(f"{name}({number})", inner)
    else:
        yield name, value


def _of_matlab(variable: Variable) -> Any:
    if variable.object:
        _refuse_object(variable.name, variable.object)
    return _dense(variable.read(simplify_cells=True))


def _refuse_object(name: str, kind: str) -> None:
    parts = f"{name}.Time and {name}.Data" if kind == "timeseries" else "its numbers"
    raise FormatError(f"{name!r} is an object of MATLAB's class {kind}: save {parts} as variables of their own")


def _dense(value: Any) -> Any:
    if hasattr(value, "nnz"):
        raise FormatError("holds a sparse matrix in place of a column")
    return np.asarray(value)


def read_hdf5(path: Path, wanted: Mapping[str, WantedColumn], what: str = "dataset") -> Columns:
    """The datasets wanted, by their paths, with what their attributes and those of their groups say of them."""
    import h5py

    with read_by("is no HDF5 file that can be read"), opened(path) as file:
        found: dict[str, Stored] = {}
        for place, item, again in contents(file):
            if not again and isinstance(item, h5py.Dataset) and item.ndim <= 2 and not place.startswith("#refs#/"):
                for name, each in referred(place, item):
                    found[name] = Stored(partial(_of_hdf5, name, each, what == "variable"), partial(_attributes, each))
                    if len(found) > MOST:
                        raise FormatError(f"has more than {MOST} datasets")
        return of(found, wanted, what)


def _attributes(dataset: Any) -> dict[str, Any]:
    """Unit of a dataset, clock of it or its groups, and the path of the one scale of its dimension."""
    said = words_of([dataset], UNITS) | words_of([dataset, dataset.parent, dataset.file], CLOCKS)
    scales: Any = dataset.dims[0].values() if dataset.ndim == 1 else ()
    return said | ({SCALE: str(scales[0].name).strip("/")} if len(scales) == 1 else {})


def _of_hdf5(name: str, dataset: Any, turned: bool) -> Any:
    """Values of a dataset; of MATLAB's, whose columns are rows of HDF5, ``turned``."""
    made = words_of([dataset], ("matlab_class", "matlab_object_decode"))
    if made.get("matlab_object_decode"):
        _refuse_object(name, str(made.get("matlab_class")))
    require_samples(dataset.shape)
    array = np.asarray(values_of(dataset))
    array = array.T if turned else array
    if made.get("matlab_class") == "char":
        return "".join(map(chr, array.ravel()))
    fields = array.dtype.names  # MATLAB 7.3 keeps complex numbers as pairs of fields
    return array["real"] + 1j * array["imag"] if fields and {"real", "imag"} <= set(fields) else array


def of(held: Mapping[str, Stored], wanted: Mapping[str, WantedColumn], what: str) -> Columns:
    """Columns of variables with their units; FormatError where one is missing, no numbers, or of another length.

    Those alone that are wanted are read, and what stands beside them. Times are made of a step or rate where no
    variable is called so. ``what``: word for a variable.
    """
    names, heads = list(held), [name for name in held if _last(name).casefold() not in (*UNITS, *CLOCKS)]
    timed = any(_last(name).casefold() in TIMES for name in names)
    value = _place(names, wanted["value"]) if "value" in wanted else None
    asked = [value[1]] if value else names[:LOOKED_AT]
    if not timed and (len(heads) < len(names) or any(held[each].said().keys() - {*UNITS} for each in asked)):
        names, heads = [*names, CLOCK], [*heads, CLOCK]
    places = {role: _place(names if role == "frequency" else list(held), each) for role, each in wanted.items()}
    if fault := missing(heads, wanted, {role: place and place[0] + 1 for role, place in places.items()}):
        raise fault
    columns = {
        role: _read(held, place, wanted[role], what, role != "frequency")
        for role, place in places.items()
        if place and place[1] in held
    }
    at = places.get("frequency")
    if at and value and at[1] not in held:
        made = _abscissa(held, value[1], len(columns["value"].values), what)
        if made is None and wanted["frequency"].needed:
            raise FormatError(f"{value[1]!r} has no times, and neither a rate nor a step is said of it: say the rate")
        columns |= {} if made is None else {"frequency": made}
    lengths = {role: len(column.words or column.values) for role, column in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{columns[role].head!r} has {length}" for role, length in lengths.items())
        raise FormatError(f"its columns are of different lengths: {told}")
    return Columns(columns, range(1, next(iter(lengths.values())) + 1))


def _last(name: str) -> str:
    return name.replace(".", "/").rpartition("/")[2]


def _place(names: list[str], wanted: WantedColumn) -> tuple[int, str, int | None] | None:
    """Index, name and column of the variable wanted: by its path, by its last part, or as ``name:2``."""
    last = [_last(name) for name in names]
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


def _said(
    held: Mapping[str, Stored], name: str, words: tuple[str, ...], column: int | None = None, beside: bool = True
) -> tuple[Any, str]:
    """Words on a variable under one of these names, and where: of itself, ``beside`` it, at the top; or None.

    Of several texts the one of the ``column``, or all of them.
    """
    own = held[name].said()
    for word in words:
        if word in own:
            return own[word], f"from its attribute {word}"
    stem = name[: len(name) - len(_last(name))]
    known = {each.casefold(): each for each in held}
    places = [f"{name}_{word}" for word in words]
    places += [above + word for above in (stem, "") for word in words] if beside else []
    for place in (each.casefold() for each in places):
        cells = [known[each] for each in (place, *(f"{place}({n})" for n in range(1, COLUMNS))) if each in known]
        if not cells or name in cells:
            continue
        found = np.concatenate([np.ravel(np.asarray(held[each].read())) for each in cells])
        if column is not None and len(found) >= column:
            found = found[column - 1 : column]
        if len(found) == 1 or (words is UNITS and 0 < len(found) < MOST):
            return (found[0] if len(found) == 1 else ", ".join(map(str, found))), f"from {cells[0]} beside it"
    return None, ""


def _abscissa(held: Mapping[str, Stored], name: str, count: int, what: str) -> CurveColumn | None:
    """Abscissa of a variable: the one that it names, or times of a rate or step; None where neither is said."""
    place = str(held[name].said().get(SCALE, ""))
    if place in held:
        return _read(held, (0, place, None), WantedColumn((place,)), what, False)
    said = {}
    for words in (RATES, STEPS, STARTS):
        value, origin = _said(held, name, words)
        if value is not None:
            said[words] = _number(value, origin, least=-inf if words is STARTS else 0.0), origin
    if not said.keys() & {RATES, STEPS}:
        return None
    step, origin = said[STEPS] if STEPS in said else (1 / said[RATES][0], said[RATES][1])
    if RATES in said and abs(said[RATES][0] * step - 1) > ROUNDED:
        raise FormatError(
            f"{name!r} has {said[RATES][0]:g} samples a second and steps of {step:g} s: delete one of both"
        )
    times = said.get(STARTS, (0.0, ""))[0] + step * np.arange(count)
    return CurveColumn(CLOCK, "s", np.asarray(times, dtype=float), place="times", origin=origin)


def _number(value: Any, origin: str, least: float) -> float:
    try:
        if isfinite(number := float(value)) and number > least:
            return number
    except (ValueError, TypeError):
        pass
    raise FormatError(f"{shown(str(value))}, {origin}, is no number that can be used")


def _read(
    held: Mapping[str, Stored], place: tuple[int, str, int | None], wanted: WantedColumn, what: str, beside: bool
) -> CurveColumn:
    """One column with its unit: what is said of it, ``beside`` it too, or by its name."""
    _, name, column = place
    array = np.asarray(held[name].read())
    require_samples(array.shape)
    if column is not None:
        if array.ndim != 2 or not 0 < column <= array.shape[1]:
            raise FormatError(f"{name!r} has the shape {array.shape}: it has no column {column}")
        array, what = array[:, column - 1], f"column {column} of {what}"
    if array.ndim > 1 and sorted(array.shape)[:-1] != [1] * (array.ndim - 1):
        raise FormatError(f'{name!r} has the shape {array.shape}: say which column, "{name}:2"')
    array = array.reshape(-1)
    if wanted.words:
        words = tuple(each.decode() if isinstance(each, bytes) else str(each).strip() for each in array)
        return CurveColumn(name, "", np.full(len(words), np.nan), words, what)
    unit, origin = _said(held, name, UNITS, column, beside)
    unit = str(unit or split_head(name.rpartition("/")[2])[1])
    numbers, whole = _numbers(name, array)
    return CurveColumn(name, unit, numbers, (), what, origin, whole)


def _numbers(name: str, array: Any) -> tuple[Array, Array | None]:
    """Values, and the complex ones whose moduli they are; FormatError for what are no numbers."""
    if array.dtype.kind not in "fiubc":
        raise FormatError(f"{name!r} holds no numbers")
    numbers = np.asarray(np.abs(array) if array.dtype.kind == "c" else array, dtype=float)
    if np.isinf(numbers).any():
        raise FormatError(f"{name!r} holds an infinite number, at row {int(np.flatnonzero(np.isinf(numbers))[0]) + 1}")
    return numbers, array if array.dtype.kind == "c" else None
