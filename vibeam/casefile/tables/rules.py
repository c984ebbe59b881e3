"""Rules between the keys of a case: positions on the beam, one way to say the drive, fidelities that exist.

Each check takes what could be read (None: could not) and yields complaints, so that one fault does not hide another.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace

from vibeam.case.faults import Complaint
from vibeam.casefile.tables.beam import beam_checks
from vibeam.casefile.tables.drive import drive_checks
from vibeam.casefile.tables.effects import effect_checks
from vibeam.casefile.tables.expectations import expectation_checks, reference_checks
from vibeam.casefile.tables.figures import figure_checks, measurement_checks
from vibeam.casefile.tables.measured import measured_checks
from vibeam.casefile.tables.names import name_checks
from vibeam.casefile.tables.stop import stop_checks
from vibeam.casefile.tables.studies import study_checks
from vibeam.casefile.tables.sweep import plan_checks


def cross_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Every complaint about keys that do not go together; files are looked for from ``folder``."""
    if case.with_beam:
        yield from beam_checks(case)
        yield from drive_checks(case)
        yield from effect_checks(case)
    yield from stop_checks(case)
    yield from plan_checks(case)
    yield from name_checks(case)
    yield from reference_checks(case, folder)
    yield from expectation_checks(case)
    yield from measured_checks(case)
    yield from figure_checks(case)
    yield from measurement_checks(case.measurement)
    yield from study_checks(case)
