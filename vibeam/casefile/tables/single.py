"""Table of a single degree of freedom by itself; rules of a case that is one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Annotated

from vibeam.case.faults import Complaint, KeyPath
from vibeam.casefile import quantities as units
from vibeam.casefile.fields import POSITIVE, Quantity
from vibeam.casefile.tables.drive import sdof_drive_checks
from vibeam.casefile.tables.table import Ratio, Table, key


def sdof_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the drive, and about [cost]: there is one mode."""
    yield from sdof_drive_checks(case)
    if case.cost is not None and case.cost.modes:
        yield ("cost", "modes"), "a single degree of freedom has one mode: leave this out"


def sdof_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that is another's."""
    if output not in ("sensor", "contact", None):
        yield path, f'a single degree of freedom has no "{output}": write "sensor"'


class SdofTable(Table):
    """A single degree of freedom in place of beam, mass and sensor: the paper's model, nondimensional."""

    natural_frequency: Annotated[float, Quantity(units.ANGULAR_FREQUENCY, POSITIVE)] = key(
        "of free motion, with its unit; 1 rad/s = nondimensional time", "1 rad/s", 1.0
    )
    damping_ratio: Annotated[float, Ratio] = key("β, of critical", 0.015)
