"""Reading of a case: from a file, text or tables, with overrides, to its record."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from pathlib import Path as File
from typing import Any

from vibeam.case.case import Case
from vibeam.case.plans import CostPlan, FigurePlan, InfluencePlan
from vibeam.casefile.build import (
    _accuracy,
    _chain,
    _expectations,
    _fit,
    _keys,
    _measurements,
    _references,
    _shared,
    _shows,
    _sweep,
    numbers_of,
)
from vibeam.casefile.checks import checked
from vibeam.casefile.keys import CaseKeys
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.maps import map_plans
from vibeam.casefile.number_keys import uncertain_inputs
from vibeam.casefile.overrides import OverrideError, tables_of
from vibeam.casefile.tables.sweep import fidelity_of
from vibeam.casefile.tables.table import content, digest, plan_of, toml_text
from vibeam.casefile.toml import parsed
from vibeam.exchange.faults import CaseError, Fault, KeyPath


def load(path: str | PathLike[str] | Mapping[str, Any], set: Mapping[str, Any] | None = None) -> Case:
    """The case in a file, or of tables as Python's own, with the keys in ``set`` put in the place of the file's.

    ``set`` maps dotted keys to values as in a case file (``{"sweep.frequency.points": 31, "stop.gap": "0.1 mm"}``): a
    plain number of a key with a dimension has none here either, unless the case, or ``{"units": "SI"}``, says so; None
    takes a key away. Files that tables name lie in the working directory. CaseError has every fault of file and
    overrides.
    """
    from vibeam.casefile.toml import read_text

    if not isinstance(path, Mapping):
        return parse(read_text(Path(path)), path, set)
    file = Path("case.toml")
    try:
        return _case(tables_of(path), {}, file, set or {})
    except OverrideError as error:
        raise CaseError([Fault(str(file), None, "", str(error))]) from None


def parse(text: str, path: str | PathLike[str] = "case.toml", set: Mapping[str, Any] | None = None) -> Case:
    """The case that ``text`` says, as ``load``; ``path`` is what faults call it, references lie in its folder."""
    file = Path(path)
    return _case(*parsed(text, file), file, set or {})


def case_of(tables: dict[str, Any], path: File, set: Mapping[str, Any]) -> Case:
    """The case of ``tables`` as a case file has them, which are changed in place; otherwise as ``load``."""
    return _case(tables, {}, path, set)


def _case(tables: dict[str, Any], lines: dict[KeyPath, int], file: File, overrides: Mapping[str, Any]) -> Case:
    declared, changed, place = checked(tables, lines, file, overrides)
    sweep, numbers = _sweep(declared.sweep), numbers_of(declared, changed, file.parent)
    return Case(
        path=file,
        text=toml_text(content(declared)),
        numbers=toml_text(numbers),
        key=digest(numbers),
        shared=toml_text(_shared(declared, declared.sweep, file.parent)),
        own=_keys(declared, changed, file.parent),
        title=declared.title or file.stem,
        source=declared.source,
        scene=KINDS[declared.kind].scene_of(declared, file.parent),
        fidelities={name: fidelity_of(name, table) for name, table in declared.fidelity.items()},
        sweep=sweep,
        references=_references(declared, file.parent, sweep.direction),
        scenes={name: KINDS[own.kind].scene_of(own, file.parent) for name, own in changed.items()},
        expectations=_expectations(declared, sweep.direction),
        measured=_measurements(declared, changed, sweep.direction),
        shows=_shows(declared, changed, sweep, file.parent),
        cost=plan_of(CostPlan, declared.cost),
        influence=plan_of(InfluencePlan, getattr(declared, "influence", InfluencePlan())),
        figure=plan_of(FigurePlan, declared.figure),
        chain=_chain(declared),
        chains={name: _chain(own) for name, own in changed.items()},
        accuracy=_accuracy(declared),
        maps=map_plans(declared, sweep),
        uncertain=uncertain_inputs(declared),
        fit=_fit(declared),
        keys=CaseKeys(declared, changed, file, case_of),
        locate=place.fault,
    )


def without_accuracy(case: Case) -> Case:
    """Same case without its ``accuracy``: every fidelity at every frequency."""
    said = [key for key in ("accuracy", "accuracy_of") if case.keys.value(key) is not None]
    return case.with_keys(dict.fromkeys(said)) if said else case
