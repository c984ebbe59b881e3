"""What the outputs of a case are, by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vibeam.system.quantities import PLAIN, OutputUnits
from vibeam_models.outputs import DISPLACEMENT, OutputQuantity

if TYPE_CHECKING:
    from vibeam.case.case import Case


def quantity_of(case: Case, output: str) -> OutputQuantity:
    """What an output reads; a displacement where it is none of the case's own."""
    return next((each.kind for each in case.scene.outputs if each.name == output), DISPLACEMENT)


def units_of_output(case: Case, output: str) -> OutputUnits:
    """SI units of an output and of its rate; those of a model without dimensions where the case is one."""
    if case.scene.natural_unit is not None:
        return PLAIN
    found = quantity_of(case, output)
    return OutputUnits("m", found.unit, found.unit_of_rate)


def require_displacement(case: Case, study: str) -> None:
    """ValueError where the sweep's output is no displacement, which is all that a ``study`` takes."""
    found = quantity_of(case, case.sweep.output)
    if found is not DISPLACEMENT:
        said = f"{study} reads displacements, sweep.output {case.sweep.output!r} is of the quantity {found.name}"
        raise ValueError(f"{said}: --set sweep.output=sensor")
