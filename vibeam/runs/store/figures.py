"""Figure data in the results file: ``/show/NAME/FIDELITY/0`` … one group a frequency, with units and long names."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import units_of_output
from vibeam.case.plans import ShowPlan
from vibeam.figures.sheet import Column, Sheet, sheets
from vibeam.runs.store.records import KeyedRecord
from vibeam.store.hdf5 import described, fixed, text_of
from vibeam.system.quantities import METRES, DatasetQuantity, OutputUnits, unit_of

if TYPE_CHECKING:
    import h5py

    from vibeam.case.case import Case

HOME = "show"


def sheets_of(plan: ShowPlan, units: OutputUnits = METRES) -> KeyedRecord[tuple[Sheet, ...]]:
    """Record of the data of ``plan``; ``units``: of the output that it shows."""

    def write(group: h5py.Group, sheets: tuple[Sheet, ...]) -> None:
        group.attrs["kind"] = fixed(plan.kind)
        for name in plan.fidelities:
            for index, sheet in enumerate(each for each in sheets if each.fidelity == name):
                _write(group.create_group(f"{name}/{index}"), sheet, units)

    def read(group: h5py.Group) -> tuple[Sheet, ...]:
        named = [name for name in plan.fidelities if name in group]
        return tuple(_sheet(group[name][index]) for name in named for index in sorted(group[name], key=int))

    return KeyedRecord(f"{HOME}/{plan.name}", write, read)


def shown_of(
    case: Case, kept_or_made: Callable[[KeyedRecord[tuple[Sheet, ...]], str, Callable[[], Any]], tuple[Sheet, ...]]
) -> dict[str, tuple[Sheet, ...]]:
    """Data of the case's figures by name, each kept in the file or made."""
    return {
        name: kept_or_made(sheets_of(plan, units_of_output(case, plan.output)), plan.key, partial(sheets, case, plan))
        for name, plan in case.shows.items()
    }


def _sheet(group: h5py.Group) -> Sheet:
    columns = {
        name: Column(rows[()], rows.attrs["kind"].decode(), rows.attrs["long_name"]) for name, rows in group.items()
    }
    fidelity = group.parent.name.rsplit("/", 1)[-1]
    return Sheet(fidelity, float(group.attrs["frequency"]), columns, text_of(group, "fault"))


def _write(group: h5py.Group, sheet: Sheet, units: OutputUnits) -> None:
    group.attrs["frequency"] = np.float64(sheet.frequency)
    group.attrs["fault"] = fixed(sheet.fault)
    for name, column in sheet.columns.items():
        kind: Any = column.unit
        unit = unit_of(DatasetQuantity(column.long_name, kind), units)
        described(group, name, column.values, column.long_name, unit).attrs["kind"] = fixed(column.unit)
