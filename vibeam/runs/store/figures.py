"""Figure data in the results file: ``/show/NAME/FIDELITY/0`` … one group a frequency, with units and long names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.plans import ShowPlan
from vibeam.figures.sheet import Column, Sheet
from vibeam.runs.store.checksum import CHECKSUM, sign, verify
from vibeam.runs.store.layout import fixed
from vibeam.system.quantities import OutputUnits, Quantity, unit_of

if TYPE_CHECKING:
    import h5py


HOME = "show"


def read_sheets(file: h5py.File, plan: ShowPlan) -> tuple[Sheet, ...] | None:
    """Read the data of ``plan``; None without any, or for another plan; ValueError if damaged."""
    group = file.get(f"{HOME}/{plan.name}")
    if group is None or CHECKSUM not in group.attrs or group.attrs.get("key", b"") != plan.key.encode():
        return None
    verify(group)
    return tuple(
        _sheet(group[name][index]) for name in plan.fidelities if name in group for index in _order(group[name])
    )


def _order(group: h5py.Group) -> list[str]:
    return sorted(group, key=int)


def _sheet(group: h5py.Group) -> Sheet:
    columns = {
        name: Column(rows[()], rows.attrs["kind"].decode(), rows.attrs["long_name"]) for name, rows in group.items()
    }
    fidelity = group.parent.name.rsplit("/", 1)[-1]
    return Sheet(fidelity, float(group.attrs["frequency"]), columns, group.attrs["fault"].decode().strip())


def write_sheets(file: h5py.File, plan: ShowPlan, sheets: tuple[Sheet, ...], units: OutputUnits) -> None:
    """Replace the stored data by ``sheets``; ``units``: of the output."""
    place = f"{HOME}/{plan.name}"
    if place in file:
        del file[place]
    group = file.create_group(place)
    group.attrs["kind"] = fixed(plan.kind)
    for name in plan.fidelities:
        for index, sheet in enumerate(_of(sheets, name)):
            _write(group.create_group(f"{name}/{index}"), sheet, units)
    group.attrs["key"] = fixed(plan.key)
    sign(group)


def _of(sheets: tuple[Sheet, ...], name: str) -> Iterator[Sheet]:
    return (sheet for sheet in sheets if sheet.fidelity == name)


def _write(group: h5py.Group, sheet: Sheet, units: OutputUnits) -> None:
    group.attrs["frequency"] = np.float64(sheet.frequency)
    group.attrs["fault"] = fixed(sheet.fault or " ")
    for name, column in sheet.columns.items():
        dataset = group.create_dataset(name, data=column.values)
        dataset.attrs["kind"] = fixed(column.unit)
        dataset.attrs["long_name"] = column.long_name
        kind: Any = column.unit
        dataset.attrs["units"] = unit_of(Quantity(column.long_name, kind), units)
