"""Records for notebooks and other packages: views, xarray data sets and pandas tables with units, title, versions."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibeam.system.public_names import handed_in
from vibeam.system.quantities import FURTHER, LAYOUT, METRES, Ended, OutputUnits, unit_of
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset

NOTHING: Mapping[str, str] = {}
DIMENSIONS = {  # of a quantity beyond the axes
    "strobes": "strobe", "mode_energy": "mode", "impact_velocities": "impact", "state": "coordinate",
}  # fmt: skip


class LabelledPart(NamedTuple):
    """Quantities by name over axes by name, in the order of their dimensions; labels, such as fidelity, direction."""

    labels: Mapping[str, str]
    axes: Mapping[str, Any]
    values: Mapping[str, NDArray[Any]]


class DataNames(NamedTuple):
    """Units of the output and of the axes; what the data are of: title, source and key of a case."""

    units: OutputUnits = METRES
    axes: Mapping[str, str] = {"frequency": "Hz"}
    about: Mapping[str, str] = NOTHING


class Viewed:
    """Record with a view: its answer, tables and figure, as its command shows them (``vibeam.report.views``)."""

    def _repr_html_(self) -> str:
        """View as HTML, which a notebook shows in place of the repr."""
        made: str = handed_in("html")(self)
        return made

    def plot(self, *paths: str | Path, quantity: str = "amplitude") -> Figure:
        """Plot it and write the figure to ``paths``, as ``vibeam.plot``."""
        made: Figure = handed_in("plot")(self, *paths, quantity=quantity)
        return made


class LabelledData(Viewed):
    """Record of quantities over axes, as data for xarray and pandas, which are installed where this is wanted."""

    def _parts(self) -> Sequence[LabelledPart]:
        raise NotImplementedError

    @property
    def _names(self) -> DataNames:
        return DataNames()

    def to_xarray(self) -> Dataset:
        """Data set over fidelity and direction, where it has several, and its axes; needs xarray.

        NaN where one has no such frequency or mode. Attributes: long name and unit of each variable (a response alone
        has those of a displacement); title, source and key of the case, where it is of one, and versions. ValueError
        where two points of one branch have the same frequency and another branch has other frequencies.
        """
        parts = self._parts()
        made = {tuple(part.labels.values()): _dataset(part, self._names) for part in parts}
        for dimension in reversed(list(parts[0].labels)):
            groups: dict[tuple[str, ...], dict[str, Dataset]] = {}
            for labels, each in made.items():
                groups.setdefault(labels[:-1], {})[labels[-1]] = each
            made = {labels: _joined(group, dimension) for labels, group in groups.items()}
        return made[()]

    def to_dataframe(self) -> DataFrame:
        """Table of one row a point: labels, axes, every quantity (``mode_energy_1`` …) as columns; needs pandas.

        ``ended`` is the name of an ``Ended``; ``attrs["units"]`` has the unit of each column, ``attrs`` what else is
        an attribute of ``to_xarray``.
        """
        pandas, (parts, units) = optional("pandas", "to_dataframe"), self.columns()
        made: DataFrame = pandas.concat([pandas.DataFrame(part) for part in parts], ignore_index=True)
        made.attrs = {"units": units, **_about(self._names.about, "pandas")}
        return made

    def columns(self) -> tuple[list[dict[str, Any]], dict[str, str]]:
        """Columns of ``to_dataframe`` by name, of each part its own, and the units of those that have one."""
        parts, names = [_columns(part) for part in self._parts()], self._names
        known = dict.fromkeys(name for part in parts for name in part)
        found = {name: _attributes(name, names.units).get("units") for name in known if name != "ended"}
        return parts, {name: unit for name, unit in (found | dict(names.axes)).items() if unit and name in known}


class ViewedTable(Viewed):
    """Record with a view whose rows are a table."""

    def to_dataframe(self) -> DataFrame:
        """Convert to a table, one row each as in the CSV file of its command; needs pandas.

        ``attrs["units"]``: units of the columns, where a column has one of its own.
        """
        rows, units, about = handed_in("rows")(self)
        made: DataFrame = optional("pandas", "to_dataframe").DataFrame(rows)
        made.attrs = {"units": dict(units), **_about(about, "pandas")}
        return made


def optional(name: str, what: str) -> Any:
    """Import an optional package that only ``what`` needs; ImportError with the cure where it is not installed."""
    try:
        return loaded(name)
    except ImportError as missing:
        raise ImportError(f"{what} needs the package {name}: pip install {name}", name=name) from missing


def _dataset(part: LabelledPart, names: DataNames) -> Dataset:
    coordinates: dict[str, Any] = {
        name: (name, np.asarray(each), {"long_name": name, "units": names.axes[name]} if name in names.axes else {})
        for name, each in part.axes.items()
    }
    variables = {}
    for name, each in part.values.items():
        own = [DIMENSIONS.get(name, f"of {name}")] * (each.ndim - len(part.axes))
        variables[name] = (*part.axes, *own), each, _attributes(name, names.units)
        for numbered in {"mode", "impact"}.intersection(own):
            number = np.arange(1, each.shape[-1] + 1)
            coordinates[numbered] = numbered, number, {"long_name": f"number of the {numbered}", "units": "1"}
    made: Dataset = optional("xarray", "to_xarray").Dataset(variables, coordinates, _about(names.about, "xarray"))
    return made


def _joined(parts: Mapping[str, Dataset], dimension: str) -> Dataset:
    """Concatenate data sets along a new ``dimension``."""
    xarray = optional("xarray", "to_xarray")
    labels = xarray.DataArray(list(parts), dims=dimension, name=dimension, attrs={"long_name": dimension})
    made: Dataset = xarray.concat(
        list(parts.values()), labels, data_vars="all", coords="minimal", compat="override", join="outer",
        combine_attrs="override",
    )  # fmt: skip
    return made


def _columns(part: LabelledPart) -> dict[str, Any]:
    places = np.meshgrid(*(np.asarray(each) for each in part.axes.values()), indexing="ij")
    size = places[0].size
    columns: dict[str, Any] = {name: [label] * size for name, label in part.labels.items()}
    columns |= {name: place.ravel() for name, place in zip(part.axes, places, strict=True)}
    for name, each in part.values.items():
        rows = each.reshape(size, -1).T
        if name == "ended":
            columns[name] = [Ended.of_code(int(code)).name for code in rows[0]]
        elif each.ndim == len(part.axes):
            columns[name] = rows[0]
        else:
            columns |= {f"{name}_{number}": row for number, row in enumerate(rows, 1)}
    return columns


def _attributes(column: str, units: OutputUnits) -> dict[str, Any]:
    """Long name and unit of a quantity, or of one of its columns; nothing where it is none."""
    name = column if column in LAYOUT or column in FURTHER else column.rpartition("_")[0]
    quantity = LAYOUT.get(name) or FURTHER.get(name)
    if quantity is None:
        return {}
    flags = {"flag_values": [kind.code for kind in Ended], "flag_meanings": " ".join(Ended.__members__)}
    return {"long_name": quantity.long_name, "units": unit_of(quantity, units), **(flags if name == "ended" else {})}


def _about(about: Mapping[str, str], package: str) -> dict[str, str]:
    """Attributes of the whole: what it is of, and the versions of the program and of the ``package`` that made it."""
    packages = {name: str(vars(sys.modules[name])["__version__"]) for name in ("vibeam", "numpy", package)}
    return {**about, **{f"{name}_version": version for name, version in packages.items()}}
