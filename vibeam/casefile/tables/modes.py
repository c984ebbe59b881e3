"""Table [modes]: a structure by its modes, measured or computed, in place of a beam; rules of a case that has it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.casefile.field_tables import SHAPE, SHAPES
from vibeam.casefile.fields import POSITIVE, TEXT, Quantity, Several
from vibeam.casefile.quantities import MASS
from vibeam.casefile.tables.given import given_output, given_rules
from vibeam.casefile.tables.table import Frequency, Ratio, Table, key
from vibeam.exchange.faults import Complaint, KeyPath


def modes_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the modes, the drive, and the mass that a platform carries."""
    from vibeam.casefile.modes import given_modes

    yield from given_modes(case.modes, folder)[1]
    yield from given_rules(case, "modes")
    if case.platform is not None and case.platform.coupling == "two-way" and case.modes.moving_mass is None:
        said = "the mass that a platform carries is more than that of so many modes"
        yield ("modes", "moving_mass"), f'missing ({said}): write moving_mass = "3 kg"'


def modes_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that the case does not name."""
    yield from given_output(case, path, output, "modes")


def modes_count(case: Any, folder: File) -> tuple[int, str]:
    """Number of modes."""
    from vibeam.casefile.modes import given_modes

    found = given_modes(case.modes, folder)[0]
    return (0 if found is None else found.structure.size), "[modes] gives"


def modes_sources(case: Any, folder: File) -> dict[str, str]:
    """The file of a case and what it holds."""
    from vibeam.casefile.modes import sources

    return sources(case.modes, folder)


class ModesTable(Table):
    """A structure by its modes, measured or computed, in place of beam, mass and sensor.

    Shapes are one number for each mode, mass-normalised (kg^-½), as vibeam modes prints them; or, with a universal
    file of modes (data set 55; needs pip install 'vibeam[lab]'), a node and its direction.
    """

    file: Annotated[str | None, TEXT] = key(
        "universal file with the modes; absent = they stand here", "rig.uff", None, written=False
    )
    frequency: Annotated[tuple[float, ...] | None, Several(Frequency, ascending=True)] = key(
        "natural frequencies; absent = the file's", ["5.2754 Hz", "12.398 Hz"], None
    )
    damping_ratio: Annotated[tuple[float, ...] | None, Several(Ratio, alone=True)] = key(
        "of each mode, or one of all; absent = the file's", [0.01, 0.012], None
    )
    modal_mass: Annotated[tuple[float, ...] | None, Several(Quantity(MASS, POSITIVE), alone=True)] = key(
        "of each mode, or one of all, in the scale of the shapes; absent = 1 kg, or the file's",
        "1 kg",
        None,
        written=False,
    )
    contact: Annotated[Any, SHAPE] = key("shapes where it meets the stop, positive toward it, kg^-½", [0.6755, 0.4586])
    sensor: Annotated[Any, SHAPE] = key("shapes at the sensor; absent = at the contact", [0.3972, -0.585], None)
    outputs: Annotated[dict[str, Any], SHAPES] = key(
        "further outputs, each shapes", {"foot": [0.3972, -0.585]}, {}, written=False
    )
    base: Annotated[Any, SHAPE] = key(
        "what a moving base does to each mode, its participation φᵀM r, kg^½ (vibeam modes calls it load)",
        [1.8077, -0.482],
        None,
    )
    force: Annotated[Any, SHAPE] = key(
        "shapes where drive.force acts, instead of a moving base", [0.6755, 0.4586], None, written=False
    )
    moving_mass: Annotated[float | None, Quantity(MASS, POSITIVE)] = key(
        "that a platform with two-way coupling carries", "3.5 kg", None, written=False
    )
