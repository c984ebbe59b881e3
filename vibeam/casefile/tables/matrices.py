"""Table [matrices]: a structure by its own matrices in place of a beam; rules of a case that has it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace
from typing import Annotated, Any

from vibeam.casefile.field_tables import MATRIX_FILE, ROWS, row
from vibeam.casefile.fields import POSITIVE, Quantity, Several, Word
from vibeam.casefile.quantities import MASS
from vibeam.casefile.tables.beam import damping_checks
from vibeam.casefile.tables.given import given_output, given_rules
from vibeam.casefile.tables.table import Ratio, Table, key
from vibeam.casefile.toml_writing import to_toml
from vibeam.casefile.unit_systems import UNIT_SYSTEMS
from vibeam.exchange.faults import Complaint, KeyPath

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
    from vibeam.casefile.matrices import given_matrices

    given, complaints = given_matrices(table, folder)
    yield from complaints
    yield from given_rules(case, "matrices")
    size = 0 if given is None else given.structure.size
    for name, fidelity in case.fidelity.items() if size > FULL else ():
        if fidelity.reduction == "full":
            said = f"the shapes of all {size} modes are {8e-9 * size**2:.1f} GB and their eigenproblem takes hours"
            yield ("fidelity", name, "reduction"), f'{said}: write reduction = "modal", modes = 20'


def matrices_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where a motion is asked for that the case does not name."""
    yield from given_output(case, path, output, "matrices")


def matrices_modes(case: Any, folder: File) -> tuple[int, str]:
    """Number of modes: as many as coordinates."""
    from vibeam.casefile.matrices import given_matrices

    found = given_matrices(case.matrices, folder)[0]
    return (0 if found is None else found.structure.size), "the matrices give"


def matrices_sources(case: Any, folder: File) -> dict[str, str]:
    """The files of a case and what they hold."""
    from vibeam.casefile.matrices import sources

    return sources(case.matrices, folder)


class MatricesTable(Table):
    """A structure by its own mass and stiffness matrix, in place of beam, mass and sensor.

    Files: Matrix Market (.mtx), NumPy and SciPy (.npy, .npz), HDF5 (.h5), MATLAB (.mat), text of Abaqus (.mtx, .inp)
    and Nastran's DMIG (.pch, .bdf). Coordinates are counted from 1, as rows of the matrices; where a file has nodes,
    they may be said by node and direction.
    """

    mass: Annotated[dict[str, str], MATRIX_FILE] = key(
        "file of M, and the matrix's name where it holds several", "M.mtx"
    )
    stiffness: Annotated[dict[str, str], MATRIX_FILE] = key("file of K", "K.mtx")
    damping_matrix: Annotated[dict[str, str] | None, MATRIX_FILE] = key(
        "file of C, instead of damping ratios", "C.mtx", None, written=False
    )
    damping_ratio: Annotated[tuple[float, ...] | None, Several(Ratio, alone=True)] = key(
        "of the first mode; for rayleigh a list of two, of modes 1 and 2; left away where damping is a list", 0.01, None
    )
    damping: Annotated[str | tuple[float, ...], Several(Ratio, words=("constant", "stiffness", "rayleigh"))] = key(
        "constant: the same ratio in every mode; stiffness: in proportion to the frequency; rayleigh: mass and "
        "stiffness; or the ratios mode by mode",
        "constant",
        "constant",
    )
    units: Annotated[str | None, Word(tuple(UNIT_SYSTEMS))] = key(
        "consistent units of the matrices: of length, force, time, mass; absent = those of the case", "SI", None
    )
    contact: Annotated[Any, row()] = key("what meets the stop, positive toward it", 2)
    sensor: Annotated[Any, row()] = key("the sensor of the displacement; absent = the contact", 1, None)
    outputs: Annotated[dict[str, Any], ROWS] = key("further outputs, each a row", {"foot": 1}, {}, written=False)
    base: Annotated[Any, row(("all", "x", "y", "z"))] = key(
        "what each coordinate reads when the base moves by 1 unit of length, r of the load −M r; all = 1 in each",
        "all",
        None,
    )
    force: Annotated[Any, row()] = key("where drive.force acts, instead of a moving base", 2, None, written=False)
    moving_mass: Annotated[float | None, Quantity(MASS, POSITIVE)] = key(
        "that a platform carries; absent = rᵀM r", "3 kg", None, written=False
    )
