"""Responses for other packages: xarray data sets and pandas tables with units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from vibeam.system.quantities import LAYOUT, METRES, VELOCITIES_KEPT, Ended, OutputUnits, unit_of
from vibeam_models.arrays import Array, Index
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset


class Values(Protocol):
    """Response of one branch: an array of each quantity over frequency."""

    @property
    def mode_energy(self) -> Array:
        """Modal energies (points, n)."""
        ...

    @property
    def ended(self) -> Index:
        """Code of the reason why each point ended, (points,)."""
        ...

    def __len__(self) -> int: ...


Branch = tuple[dict[str, str], Values]  # labels of a branch, such as fidelity and direction, and its response


def optional(name: str, what: str) -> Any:
    """Import an optional package that only ``what`` needs; ImportError with the cure where it is not installed."""
    try:
        return loaded(name)
    except ImportError as missing:
        raise ImportError(f"{what} needs the package {name}: pip install {name}", name=name) from missing


def dataset(response: Values, units: OutputUnits = METRES) -> Dataset:
    """Data set of a response over ``frequency`` (Hz), with dimensions ``mode`` and ``impact``, units as attributes.

    ``units``: of the output.
    """
    xarray = optional("xarray", "to_xarray")
    sizes = {"mode": response.mode_energy.shape[1], "impact": VELOCITIES_KEPT}
    coordinates: dict[str, Any] = {name: np.arange(1, size + 1) for name, size in sizes.items()}
    variables: dict[str, Any] = {}
    for name, quantity in LAYOUT.items():
        attributes: dict[str, Any] = {"long_name": quantity.long_name, "units": unit_of(quantity, units)}
        if name == "ended":
            attributes |= {"flag_values": [kind.code for kind in Ended], "flag_meanings": " ".join(Ended.__members__)}
        dimensions = ("frequency",) if quantity.dimension is None else ("frequency", quantity.dimension)
        variables[name] = dimensions, getattr(response, name), attributes
    coordinates["frequency"] = variables.pop("frequency")
    made: Dataset = xarray.Dataset(variables, coordinates)
    return made


def joined(parts: Mapping[str, Dataset], dimension: str) -> Dataset:
    """Concatenate data sets along a new ``dimension``; NaN where one has no such frequency or mode.

    ValueError where two points of one branch have the same frequency and another branch has other frequencies.
    """
    xarray = optional("xarray", "to_xarray")
    labels = xarray.DataArray(list(parts), dims=dimension, name=dimension)
    made: Dataset = xarray.concat(
        list(parts.values()), labels, data_vars="all", coords="minimal", compat="override", join="outer",
        combine_attrs="override",
    )  # fmt: skip
    return made


def frame(branches: Sequence[Branch], units: OutputUnits = METRES) -> DataFrame:
    """Table with one row a point: labels, frequency in Hz, every quantity, ``mode_energy_1`` … as columns of their own.

    ``ended`` is the name of an ``Ended``; ``frame.attrs["units"]`` has the unit of each column.
    """
    pandas = optional("pandas", "to_dataframe")
    made: DataFrame = pandas.concat([pandas.DataFrame(_columns(*branch)) for branch in branches], ignore_index=True)
    labels = set().union(*(labels for labels, _ in branches))
    made.attrs["units"] = {name: _unit(name, units) for name in made.columns if name not in labels}
    return made


def _columns(labels: dict[str, str], response: Values) -> dict[str, Any]:
    columns: dict[str, Any] = {name: [label] * len(response) for name, label in labels.items()}
    for name, quantity in LAYOUT.items():
        values = getattr(response, name)
        if quantity.dimension is None:
            columns[name] = values
        else:
            columns |= {f"{name}_{number}": column for number, column in enumerate(values.T, 1)}
    return columns | {"ended": [Ended.of_code(int(code)).name for code in response.ended]}


def _unit(column: str, units: OutputUnits) -> str:
    return unit_of(LAYOUT[column if column in LAYOUT else column.rpartition("_")[0]], units)
