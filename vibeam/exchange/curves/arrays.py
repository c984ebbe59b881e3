"""Curves in MATLAB's files and in HDF5: variables by name, or a column as ``name:2``; moduli of complex ones.

Units, steps and starts are attributes of a variable or its groups, or stand beside it: ``acc``, ``unit``, ``fs``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.exchange.curves.columns import TIMES, Columns, CurveColumn, WantedColumn, missing, split_head
from vibeam.exchange.files import FormatError, read_by, require_samples
from vibeam.exchange.hdf5 import MOST, contents, opened, referred, values_of, words_of
from vibeam.exchange.mat import Variable, variables
from vibeam_models.arrays import Array

UNITS = (
    "unit", "units", "unit_str", "unit_string", "ni_unitdescription", "y_unit", "yunit", "y_units", "y_unit_label",
    "engineering_units", "measure_unit",
)  # fmt: skip
RATES = ("fs", "sampling_rate", "sample_rate", "samplerate", "sampling_frequency")
STEPS = ("dt", "delta_t", "wf_increment", "sampling_interval")
STARTS = ("t0", "x0", "wf_start_offset")
OVER = ("wf_xunit_string", "x_unit", "xunit", "x_unit_label", "dt_unit", "dt_units")  # of steps and starts
WORDS = (*UNITS, *RATES, *STEPS, *STARTS, *OVER)
CLOCK = "time"  # column of times that are made of a rate or step
COLUMNS = 33  # of an array whose units stand in cells, from 1
ROUNDED = 1e-3  # relative difference of a rate and a step that are both said
#: how the values of a variable are read, by its path; of an attribute by ``path@attribute``
Held = Mapping[str, Callable[[], Any]]
Place = tuple[str, int | None]  # path of a variable, and its column


def read_matlab(path: Path, wanted: Mapping[str, WantedColumn]) -> Columns:
    """The variables wanted of a .mat file, by scipy up to version 7, by h5py of version 7.3; FormatError as ``of``."""
    import h5py

    if h5py.is_hdf5(path):
        return read_hdf5(path, wanted, "variable")
    with read_by("is no MATLAB file that can be read"):
        found: dict[str, Callable[[], Any]] = {}
        for each in variables(path):
            if each.plain or each.object:
                found[each.name] = partial(_of_matlab, each)
            else:
                inside = _inside(each.name, each.read(simplify_cells=True))
                found |= {name: partial(_dense, value) for name, value in inside}
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
        raise _object(variable.name)
    return _dense(variable.read(simplify_cells=True))


def _object(name: str) -> FormatError:
    cure = f"save its numbers as variables of their own, of a timeseries {name}.Time and {name}.Data"
    return FormatError(f"{name!r} is an object of a class of MATLAB's: {cure}")


def _dense(value: Any) -> Any:
    from scipy.sparse import issparse

    if issparse(value):
        raise FormatError("holds a sparse matrix in place of a column")
    return np.asarray(value)


def read_hdf5(path: Path, wanted: Mapping[str, WantedColumn], what: str = "dataset") -> Columns:
    """The datasets wanted, by their paths, with what their attributes and those of their groups say of them."""
    import h5py

    with read_by("is no HDF5 file that can be read"), opened(path) as file:
        found = _attributes("", file)
        for place, item, again in contents(file):
            if isinstance(item, h5py.Group):
                found |= _attributes(place, item)
            elif not again and isinstance(item, h5py.Dataset) and item.ndim <= 2 and not place.startswith("#refs#/"):
                for name, each in referred(place, item):
                    found |= _attributes(name, each)
                    found[name] = partial(_of_hdf5, name, each, what == "variable")
            if len(found) > MOST:
                raise FormatError(f"has more than {MOST} datasets and attributes")
        return of(found, wanted, what)


def _attributes(place: str, item: Any) -> dict[str, Callable[[], Any]]:
    return {f"{place}@{word}": partial(np.asarray, value) for word, value in words_of(item, WORDS).items()}


def _of_hdf5(name: str, dataset: Any, turned: bool) -> Any:
    """Values of a dataset; of MATLAB's, whose columns are rows of HDF5, ``turned``."""
    made = words_of(dataset, ("matlab_class", "matlab_object_decode"))
    if made.get("matlab_object_decode"):
        raise _object(name)
    require_samples(dataset.shape)
    array = np.asarray(values_of(dataset))
    array = array.T if turned else array
    if made.get("matlab_class") == "char":
        return "".join(map(chr, array.ravel()))
    fields = array.dtype.names  # MATLAB 7.3 keeps complex numbers as pairs of fields
    return array["real"] + 1j * array["imag"] if fields and {"real", "imag"} <= set(fields) else array


def of(held: Held, wanted: Mapping[str, WantedColumn], what: str) -> Columns:
    """Columns of variables with their units; FormatError where one is missing, no numbers, or of another length.

    Those alone that are wanted are read, and what stands beside them. Times are made of a step or rate where no
    variable is called so. ``what``: word for a variable.
    """
    heads = [name for name in held if _last(name) not in WORDS]
    places = {role: _place([each for each in held if not _is_attribute(each)], one) for role, one in wanted.items()}
    if not any(_last(name) in TIMES for name in heads) and len(heads) < len(held):
        heads.append(CLOCK)
        if "frequency" in wanted and places["frequency"] is None:
            places["frequency"] = _place([CLOCK], wanted["frequency"])
    if fault := missing(heads, wanted, {role: place and 0 for role, place in places.items()}):
        raise fault
    columns = {
        role: _read(held, place, wanted[role], what, role != "frequency")
        for role, place in places.items()
        if place and place[0] in held
    }
    at, value = places.get("frequency"), places.get("value")
    if at and value and at[0] not in held:
        made = _times(held, value[0], len(columns["value"].values))
        if made is None and wanted["frequency"].needed:
            raise FormatError(f"{value[0]!r} has no times, and neither a rate nor a step is said of it: say the rate")
        columns |= {} if made is None else {"frequency": made}
    lengths = {role: len(column.words or column.values) for role, column in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{columns[role].head!r} has {length}" for role, length in lengths.items())
        raise FormatError(f"its columns are of different lengths: {told}")
    return Columns(columns, range(1, next(iter(lengths.values())) + 1))


def _is_attribute(name: str) -> bool:
    return "@" in name and _last(name) in WORDS


def _last(name: str) -> str:
    return re.split("[./@]", name)[-1].casefold()


def _place(heads: list[str], wanted: WantedColumn) -> Place | None:
    """Name and column of the variable wanted: by its path, by its last part, or as ``name:2``."""
    for text in (each.strip("/") for each in wanted.names if isinstance(each, str)):
        name, colon, number = text.rpartition(":")
        name, column = (name, int(number)) if colon and number.isdecimal() else (text, None)
        for known in (str.casefold, _last):
            places = [head for head in heads if known(head) == name.casefold()]
            if len(places) > 1:
                raise FormatError(f"has several {name!r}: {', '.join(places)}; say the whole path")
            if places:
                return places[0], column
    return None


def _said(
    held: Held, name: str, words: tuple[str, ...], beside: bool = True, column: int | None = None
) -> tuple[str | None, str]:
    """Text under one of these words, and where: of a variable itself, ``beside`` it, at the top; or None.

    Of several texts the one of the ``column``, or all of them: these stand for it where it is not ``beside`` too.
    Words that contradict each other are joined to one that nobody knows.
    """
    known = {each.casefold(): each for each in held}
    above = name[: len(name) - len(_last(name))]
    own = (f"{name}@", f"{name}_", name)
    for stem in (*own, *((above, f"{above[:-1]}@", "", "@") if beside or column is not None else ())):
        said = dict[str, str]()
        for word in (f"{stem}{word}".casefold() for word in words):
            cells = [known[each] for each in (word, *(f"{word}({n})" for n in range(1, COLUMNS))) if each in known]
            found = np.concatenate([np.ravel(np.asarray(held[each]())) for each in cells]) if cells else np.empty(0)
            if len(found) < 2 and not beside and stem not in own:
                continue
            if column is not None and len(found) >= column:
                found = found[column - 1 : column]
            if len(found) == 1 or (words is UNITS and 0 < len(found) < MOST):
                said[cells[0]] = ", ".join(str(each).strip() for each in found)
        if said:
            return " or ".join(dict.fromkeys(said.values())), f"from {next(iter(said))}"
    return None, ""


def _times(held: Held, name: str, count: int) -> CurveColumn | None:
    """Times of a rate or step that is said of a variable; None where neither is."""
    said = {}
    for words in (RATES, STEPS, STARTS):
        value, origin = _said(held, name, words)
        if value is not None:
            with read_by(f"the number {origin} cannot be used"):
                said[words] = float(value), origin
            if not isfinite(said[words][0]) or (words is not STARTS and said[words][0] <= 0):
                raise FormatError(f"the number {origin} cannot be used: {value}")
    if not said.keys() & {RATES, STEPS}:
        return None
    step, origin = said[STEPS] if STEPS in said else (1 / said[RATES][0], said[RATES][1])
    if RATES in said and abs(said[RATES][0] * step - 1) > ROUNDED:
        raise FormatError(
            f"{name!r} has {said[RATES][0]:g} samples a second and steps of {step:g} s: delete one of both"
        )
    times = said.get(STARTS, (0.0, ""))[0] + step * np.arange(count)
    unit = _said(held, name, OVER)[0] if STEPS in said else None
    return CurveColumn(CLOCK, unit or "s", np.asarray(times, dtype=float), place="times", origin=origin)


def _read(held: Held, place: Place, wanted: WantedColumn, what: str, beside: bool) -> CurveColumn:
    """One column with its unit: what is said of it, ``beside`` it too, or by its name."""
    name, column = place
    array = np.asarray(held[name]())
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
    unit, origin = _said(held, name, UNITS, beside, column)
    unit = unit or split_head(name.rpartition("/")[2])[1]
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
