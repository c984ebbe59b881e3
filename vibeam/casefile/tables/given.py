"""Tables of a structure that is given, by matrices or modes, in place of a beam; the rules of cases that have one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

from vibeam.casefile.field_tables import MATRIX_FILE, ROWS, SHAPE, SHAPES, row
from vibeam.casefile.fields import TEXT, Quantity, Several, Word
from vibeam.casefile.quantities import MASS, POSITIVE, UNIT_SYSTEMS
from vibeam.casefile.tables.beam import damping_checks
from vibeam.casefile.tables.declared import Table, key
from vibeam.casefile.tables.drive import MOTIONS, DriveTable, drive_checks, list_checks
from vibeam.casefile.tables.effects import effect_checks, platform_output
from vibeam.casefile.tables.figures import show_table
from vibeam.casefile.tables.stop import stop_table
from vibeam.casefile.tables.sweep import SWEPT, sweep_table
from vibeam.casefile.tables.table import NAME, Frequency, Ratio, less
from vibeam.casefile.toml_writing import to_toml
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, suggest
from vibeam.figures import FIGURES
from vibeam_models.given import GivenStructure

OWN = ("sensor", "contact", "platform")  # outputs that no row of one's own is called
OF_BEAM = ("gain", "moment", "at")  # keys of a beam's drive


def given_structure(case: Any, folder: File) -> tuple[GivenStructure | None, tuple[Complaint, ...]]:
    """The structure of a case (None: it cannot be made), and every complaint about it."""
    if case.kind == "modes":
        from vibeam.casefile.modes import given_modes

        return given_modes(case.modes, folder)
    from vibeam.casefile.matrices import given_matrices

    return given_matrices(case.matrices, folder)


def most_modes(case: Any, folder: File) -> tuple[int, str]:
    """Number of modes, as many as coordinates, and what gives it."""
    found = given_structure(case, folder)[0]
    gives = {"matrices": "the matrices give", "modes": "[modes] gives"}[case.kind]
    return (0 if found is None else found.structure.size), gives


def sources(case: Any, folder: File) -> dict[str, str]:
    """The files of a case and what they hold."""
    from vibeam.casefile import matrices, modes
    from vibeam.casefile.coordinates import digests

    module = modes if case.kind == "modes" else matrices
    return digests(module.files_of(getattr(case, case.kind)), folder)


def given_rules(case: SimpleNamespace, kind: str) -> Iterator[Complaint]:
    """Complaints about outputs, stop, drive and platform of a case with [``kind``]."""
    table = getattr(case, kind)
    for name in table.outputs or {}:
        if name in OWN or not NAME.fullmatch(name):
            yield (kind, "outputs", name), f"must be letters, digits, - or _, and none of {', '.join(OWN)}"
    if table.base is not None and table.force is not None:
        yield (kind, "force"), f"the drive is said twice: keep {kind}.base, of a base that moves, or {kind}.force"
    elif case.record is None and table.force is not None:
        yield from _forced(case, kind)
    elif case.record is None:
        yield from _moved(case, kind)
    yield from effect_checks(case)


def _forced(case: SimpleNamespace, kind: str) -> Iterator[Complaint]:
    for name in (*MOTIONS, "voltage"):
        if getattr(case.drive, name) is not None:
            yield ("drive", name), f"moves a base, and {kind}.force says a force drives it: write force, or {kind}.base"
    if case.drive.force is None:
        yield ("drive", "force"), f'missing ({kind}.force says where it acts): write force = "5 N"'
    if case.platform is not None:
        yield ("platform",), f"moves a base: write {kind}.base in place of {kind}.force"
    yield from list_checks(case)


def _moved(case: SimpleNamespace, kind: str) -> Iterator[Complaint]:
    if case.drive.force is not None and case.platform is None:
        yield ("drive", "force"), f"acts where {kind}.force says, or on a platform: write it, or add [platform]"
        return
    if getattr(case, kind).base is None and kind != "solid":  # whose base moves along its contact's direction
        yield (
            (kind, "base"),
            f"missing (what a base motion moves): write base, or, for a drive by a force, {kind}.force",
        )
    elif case.platform is None and not any(getattr(case.drive, name) is not None for name in (*MOTIONS, "voltage")):
        yield ("drive",), 'the base motion is missing: write amplitude = "0.05 mm", or velocity or acceleration'
    else:
        yield from drive_checks(case)


def given_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that the table of the structure does not name."""
    known = [*OWN, *(getattr(case, case.kind).outputs or {})]
    if output is not None and output not in known:
        yield path, f"{as_shown_in_message(output)} is no output; {suggest(output, known)}"
    else:
        yield from platform_output(case, path, output)


GivenDriveTable = less(
    DriveTable,
    "GivenDriveTable",
    "The drive, harmonic or an input over time. With [sweep] a base motion by amplitude, velocity or acceleration, or "
    "a force where the structure's table says. With [platform] a force on that, with [shaker] its voltage. Any of "
    "these may be a list, of amplitudes at as many frequencies. With [record] a file, a shape, or a random input by "
    "its density; none where [start] says what moves.",
    *OF_BEAM,
)


def given_stop_table() -> type[Table]:
    """The stop of a given structure: where it is says the contact row."""
    return less(stop_table(), "GivenStopTable", stop_table().__doc__, "position")


_READ = key(TEXT, "whose displacement is read: sensor, contact, or one of outputs", "sensor", "sensor")
GivenSweepTable = sweep_table("GivenSweepTable", SWEPT, output=_READ)


def given_show_table() -> Any:
    """The table of a further figure, whose output is one of those that the case names."""
    meaning = "whose motion is shown: sensor, contact, or one of outputs; absent = the sweep's"
    return show_table("GivenShowTable", tuple(FIGURES), key(TEXT, meaning, "sensor", None))


_SYSTEMS = " or ".join(map(to_toml, UNIT_SYSTEMS))
FULL = 3000  # coordinates up to which all modes can be had


def matrices_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the matrices, the rows over them, the drive."""
    table = case.matrices
    if table.damping_matrix is None:
        yield from damping_checks(table, "matrices")
    elif table.damping_ratio is not None or table.damping != "constant":
        yield ("matrices", "damping_matrix"), "the damping is said twice: keep the matrix, or damping and damping_ratio"
    if table.units is None:
        yield ("matrices", "units"), f"missing (of length, force, time, mass): write units = {_SYSTEMS}"
    given, complaints = given_structure(case, folder)
    yield from complaints
    yield from given_rules(case, "matrices")
    size = 0 if given is None else given.structure.size
    for name, fidelity in case.fidelity.items() if size > FULL else ():
        if fidelity.reduction == "full":
            said = f"the shapes of all {size} modes are {8e-9 * size**2:.1f} GB and their eigenproblem takes hours"
            yield ("fidelity", name, "reduction"), f'{said}: write reduction = "modal", modes = 20'


class MatricesTable(Table):
    """A structure by its own mass and stiffness matrix, in place of beam, mass and sensor.

    Files: Matrix Market (.mtx), Harwell–Boeing (.hb, .rsa), NumPy and SciPy (.npy, .npz), HDF5 (.h5), MATLAB (.mat),
    Abaqus (.mtx, .inp), CalculiX (.sti, .mas), Nastran (.op4, .op2; DMIG: .pch, .bdf). Coordinates are counted from 1,
    as rows of the matrices; where a file has nodes, they may be said by node and direction.
    """

    mass = key(MATRIX_FILE, "file of M, and the matrix's name where it holds several", "M.mtx")
    stiffness = key(MATRIX_FILE, "file of K", "K.mtx")
    damping_matrix = key(MATRIX_FILE, "file of C, instead of damping ratios", "C.mtx", None)
    damping_ratio = key(
        Several(Ratio, alone=True),
        "of the first mode; for rayleigh a list of two, of modes 1 and 2; left away where damping is a list",
        0.01,
        None,
    )
    damping = key(
        Several(Ratio, words=("constant", "stiffness", "rayleigh")),
        "constant: the same ratio in every mode; stiffness: in proportion to the frequency; rayleigh: mass and "
        "stiffness; or the ratios mode by mode",
        "constant",
        "constant",
    )
    units = key(
        Word(tuple(UNIT_SYSTEMS)),
        "consistent units of the matrices: of length, force, time, mass; absent = those of the case",
        "SI",
        None,
    )
    contact = key(row(), "what meets the stop, positive toward it", 2)
    sensor = key(row(), "the sensor of the displacement; absent = the contact", 1, None)
    outputs = key(ROWS, "further outputs, each a row", {"foot": 1}, {})
    base = key(
        row(("all", "x", "y", "z")),
        "what each coordinate reads when the base moves by 1 unit of length, r of the load −M r; all = 1 in each",
        "all",
        None,
    )
    force = key(row(), "where drive.force acts, instead of a moving base", 2, None)
    moving_mass = key(Quantity(MASS, POSITIVE), "that a platform carries; absent = rᵀM r", "3 kg", None)


def modes_rules(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Complaints about the modes, the drive, and the mass that a platform carries."""
    yield from given_structure(case, folder)[1]
    yield from given_rules(case, "modes")
    if case.platform is not None and case.platform.coupling == "two-way" and case.modes.moving_mass is None:
        said = "the mass that a platform carries is more than that of so many modes"
        yield ("modes", "moving_mass"), f'missing ({said}): write moving_mass = "3 kg"'


class ModesTable(Table):
    """A structure by its modes, measured or computed, in place of beam, mass and sensor.

    Shapes are one number for each mode, mass-normalised (kg^-½), as vibeam modes prints them; or, with a file of modes
    (Nastran's .op2; universal, data set 55: pip install 'vibeam[lab]'), a node and its direction.
    """

    file = key(TEXT, "file with the modes; absent = they stand here", "rig.uff", None)
    skip = key(Several(Frequency), "modes of the file to omit", ["9.3 Hz"], None)
    frequency = key(
        Several(Frequency, ascending=True), "natural frequencies; absent = the file's", ["5.2754 Hz", "12.398 Hz"], None
    )
    damping_ratio = key(
        Several(Ratio, alone=True), "of each mode, or one of all; absent = the file's", [0.01, 0.012], None
    )
    modal_mass = key(
        Several(Quantity(MASS, POSITIVE), alone=True),
        "of each mode, or one of all, in the scale of the shapes; absent = 1 kg, or the file's",
        "1 kg",
        None,
    )
    contact = key(SHAPE, "shapes where it meets the stop, positive toward it, kg^-½", [0.6755, 0.4586])
    sensor = key(SHAPE, "shapes at the sensor; absent = at the contact", [0.3972, -0.585], None)
    outputs = key(SHAPES, "further outputs, each shapes", {"foot": [0.3972, -0.585]}, {})
    base = key(
        SHAPE,
        "what a moving base does to each mode, its participation φᵀM r, kg^½ (vibeam modes calls it load)",
        [1.8077, -0.482],
        None,
    )
    force = key(SHAPE, "shapes where drive.force acts, no base then", [0.6755, 0.4586], None)
    moving_mass = key(Quantity(MASS, POSITIVE), "that a platform carries", "3.5 kg", None)
