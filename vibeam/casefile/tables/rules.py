"""Rules between the keys of a case: those of its kind, fidelities that exist, numbers that can be read.

Each check takes what could be read (None: could not) and yields complaints, so that one fault does not hide another.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as File
from types import SimpleNamespace

from vibeam.case.faults import Complaint
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.tables.expectations import expectation_checks
from vibeam.casefile.tables.figures import figure_checks, measurement_checks
from vibeam.casefile.tables.harmonics import harmonic_checks
from vibeam.casefile.tables.measured import measured_checks
from vibeam.casefile.tables.names import name_checks
from vibeam.casefile.tables.readings import amount_checks
from vibeam.casefile.tables.references import reference_checks
from vibeam.casefile.tables.stop import stop_checks
from vibeam.casefile.tables.studies import study_checks
from vibeam.casefile.tables.sweep import plan_checks


def cross_checks(case: SimpleNamespace, folder: File) -> Iterator[Complaint]:
    """Every complaint about keys that do not go together; files are looked for from ``folder``."""
    yield from KINDS[case.kind].complaints(case, folder)
    yield from stop_checks(case)
    yield from harmonic_checks(case)
    yield from plan_checks(case, folder)
    yield from name_checks(case)
    yield from reference_checks(case, folder)
    yield from expectation_checks(case)
    yield from measured_checks(case)
    yield from amount_checks(case)
    yield from figure_checks(case)
    yield from measurement_checks(case.measurement)
    yield from study_checks(case)
