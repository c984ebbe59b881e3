"""Checks of a case's tables: the case as declared, in SI units, or every fault at its line.

Each check between keys takes what could be read (None: could not) and yields complaints, so that one fault does not
hide another.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import partial
from pathlib import Path as File
from typing import Any

from vibeam.casefile.fidelity_changes import FidelityCase, variants
from vibeam.casefile.keys import model_of, rig_checks
from vibeam.casefile.maps import map_complaints, maps_in_si, value_complaints
from vibeam.casefile.number_keys import (
    absent_checks,
    chosen_checks,
    fit_checks,
    fit_in_si,
    uncertain_checks,
    uncertain_in_si,
)
from vibeam.casefile.overrides import OverrideError, Places, override
from vibeam.casefile.records import record_in_si, varied_complaints
from vibeam.casefile.tables.cases import AnyCase
from vibeam.casefile.tables.expectations import amount_checks, amounts_in_si, expectation_checks, measured_checks
from vibeam.casefile.tables.figures import figure_checks, measurement_checks
from vibeam.casefile.tables.references import reference_checks
from vibeam.casefile.tables.studies import study_checks
from vibeam.casefile.tables.table import name_checks
from vibeam.casefile.validation import read, unnamed_map
from vibeam.exchange.faults import OVERRIDE, CaseError, Complaint, Fault, KeyPath, shortened


def cross_checks(case: AnyCase, folder: File) -> Iterator[Complaint]:
    """Every complaint about keys that do not go together; files are looked for from ``folder``."""
    yield from rig_checks(case, folder)
    yield from name_checks(case)
    yield from reference_checks(case, folder)
    yield from expectation_checks(case)
    yield from measured_checks(case)
    yield from amount_checks(case)
    yield from figure_checks(case)
    yield from measurement_checks(case.measurement)
    yield from study_checks(case)
    if case.record is None:
        yield from map_complaints(case)
    yield from uncertain_checks(case)
    yield from chosen_checks(case)
    yield from fit_checks(case)


def _model_checks(case: AnyCase, changed: Mapping[str, AnyCase], file: File) -> Iterator[Complaint]:
    """Complaints about a case whose tables are right by themselves, in the models of its fidelities."""
    model = partial(model_of, case, changed, file)
    yield from value_complaints(case, model)
    yield from varied_complaints(case, model)
    yield from absent_checks(case, changed)


def checked(
    tables: dict[str, Any], text: str, file: File, overrides: Mapping[str, Any]
) -> tuple[AnyCase, dict[str, AnyCase], Places]:
    """The declared case in SI units, that of each fidelity that changes it, and where keys come from in ``text``.

    CaseError with all faults.
    """
    tables, faults, paths = _overridden(tables, overrides)
    place = Places(str(file), text, paths, bool(unnamed_map(tables)))
    case, wrong = _validated(tables, file.parent)
    changed, more = variants(tables, wrong, lambda own: _validated(own, file.parent))
    own = {name: variant.declared for name, variant in changed.items()}
    if case is not None and not wrong + more:
        more = [*_model_checks(case, own, file)]
    faults += [place.fault(complaint) for complaint in wrong + more]
    if faults or case is None:
        raise CaseError(faults)
    settled = {name: each.with_(units="SI") for name, each in own.items()}
    return _settled(case, changed), settled, place


def _settled(case: AnyCase, changed: Mapping[str, FidelityCase]) -> AnyCase:
    """The case with all that is written in its own units in SI, so that equal cases have equal texts."""
    own, compared = dict(case.fidelity), amounts_in_si(case)
    for name, variant in changed.items():
        own[name] = own[name].with_(set=dict(sorted(variant.changes.items())) or None)
    if case.record is not None:
        compared = record_in_si(case, compared)
    further = {"uncertain": uncertain_in_si, "fit": fit_in_si, "map": maps_in_si}
    written = {name: in_si(case) for name, in_si in further.items() if getattr(case, name)}
    return case.with_(units="SI", fidelity=own, **compared, **written)


def _overridden(
    tables: dict[str, Any], overrides: Mapping[str, Any]
) -> tuple[dict[str, Any], list[Fault], set[KeyPath]]:
    """The tables with the overrides, the faults in these, and the paths that they set."""
    faults, paths = [], set()
    for key, value in overrides.items():
        try:
            tables, path = override(tables, key, value)
        except OverrideError as error:
            faults.append(Fault(OVERRIDE, None, shortened(ascii(str(key))[1:-1], 80), str(error)))
        else:
            paths.add(path)
    return tables, faults, paths


def _validated(tables: dict[str, Any], folder: File) -> tuple[AnyCase | None, list[Complaint]]:
    case, reading = read(tables)
    alone = reading.complaints
    together = [*cross_checks(case, folder)]
    return None if alone else case, alone + _unreported(together, {path for path, _ in alone} | reading.excused)


#: (table, key): keys that say what other keys of their table mean
DECIDING = {("stop", "law"), *((name, "shape") for name in ("beam", "opposite", "section")), ("drive", "at"),
            ("drive", "frequency"), ("drive", "shape"), ("drive", "density"), ("drive", "file"),
            ("drive", "acceleration"), ("drive", "force"), ("drive", "moment")}  # fmt: skip


def _unreported(together: Collection[Complaint], reported: set[KeyPath]) -> list[Complaint]:
    """Complaints across keys where nothing has been reported of the key, of one it names, or of its table, before.

    One about a whole table waits until its keys can be read: what it misses may be what is wrong. So do those about
    the keys of a table beside one that says what they mean.
    """
    unread = {path[:1] for path in reported}
    named = {".".join(map(str, path)) for path in reported}
    unclear = {path[:-1] for path in reported if (path[0], path[-1]) in DECIDING}
    if unclear & {("beam",), ("opposite",)}:  # a section takes from its beam what it does not say
        unclear |= {path[:-1] for path, _ in together if path[0] == "section"}
    return [
        (path, message)
        for path, message in together
        if not {path, path[:-1]} & unclear
        and path not in unread
        and not (path[0] in ("uncertain", "fit") and path[-1] in named)
        and not any(path[:length] in reported for length in range(1, len(path) + 1))
    ]
