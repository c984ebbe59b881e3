"""Reading of a case: from a file, text or tables, with overrides, to its record."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.plans import Direction, FigurePlan, Reference, ShowPlan, SweepPlan
from vibeam.case.study_plans import STUDY_PLANS, CostPlan, InfluencePlan
from vibeam.casefile.checks import checked
from vibeam.casefile.keys import CaseKeys
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.maps import map_plans
from vibeam.casefile.number_keys import fit_plan, keys_chosen, uncertain_inputs
from vibeam.casefile.overrides import OverrideError, tables_of
from vibeam.casefile.tables.cases import AnyCase
from vibeam.casefile.tables.expectations import expectation, measured_number
from vibeam.casefile.tables.sweep import APPLIED, fidelity_of
from vibeam.casefile.tables.table import content, digest, plan_of, toml_text
from vibeam.casefile.toml import parsed
from vibeam.exchange.faults import CaseError, Fault, KeyPath
from vibeam.figures import COMMON, FIGURES

if TYPE_CHECKING:
    from vibeam.observe.measuring_chain import Chain


def load(path: str | PathLike[str] | Mapping[str, Any], set: Mapping[str, Any] | None = None) -> Case:
    """The case in a file, or of tables as Python's own, with the keys in ``set`` put in the place of the file's.

    ``set`` maps dotted keys to values as in a case file (``{"sweep.frequency.points": 31, "stop.gap": "0.1 mm"}``): a
    plain number of a key with a dimension has none here either, unless the case, or ``{"units": "SI"}``, says so; None
    takes a key away. Files that tables name lie in the working directory. CaseError has every fault of file and
    overrides.

    >>> import vibeam
    >>> case = vibeam.load("cases/dtu_neutral.toml", {"sweep.frequency.points": 3})
    >>> case.sweep.frequency.tolist()
    [14.0, 15.5, 17.0]
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


def case_of(tables: dict[str, Any], path: Path, set: Mapping[str, Any]) -> Case:
    """The case of ``tables`` as a case file has them, which are changed in place; otherwise as ``load``."""
    return _case(tables, {}, path, set)


def _case(tables: dict[str, Any], lines: dict[KeyPath, int], file: Path, overrides: Mapping[str, Any]) -> Case:
    declared, changed, place = checked(tables, lines, file, overrides)
    folder, sweep, numbers = file.parent, _sweep(declared.sweep), _numbers(declared, changed, file.parent)
    shared, own = _shared(declared, folder), _keys(declared, changed, folder)
    return Case(
        path=file,
        text=toml_text(content(declared)),
        numbers=toml_text(numbers),
        key=digest(numbers),
        shared=toml_text(shared),
        own=own,
        title=declared.title or file.stem,
        source=declared.source,
        scene=KINDS[declared.kind].scene_of(declared, folder),
        fidelities={name: fidelity_of(name, table) for name, table in declared.fidelity.items()},
        sweep=sweep,
        references=_references(declared, folder, sweep.direction),
        scenes={name: KINDS[other.kind].scene_of(other, folder) for name, other in changed.items()},
        expectations={name: expectation(name, table, sweep.direction) for name, table in declared.expect.items()},
        measured={
            name: measured_number(name, declared, sweep.direction, keys_chosen(name, declared, changed))
            for name in declared.measured
        },
        shows=_shows(declared, sweep, shared, {name: (own[name], _seen(changed.get(name, declared))) for name in own}),
        cost=plan_of(CostPlan, declared.cost),
        influence=plan_of(InfluencePlan, getattr(declared, "influence", InfluencePlan())),
        asked={
            name: plan_of(home.load(), getattr(declared, name))
            for name, home in STUDY_PLANS.items()
            if getattr(declared, name, None) is not None
        },
        figure=plan_of(FigurePlan, declared.figure),
        chain=_chain(declared),
        chains={name: _chain(other) for name, other in changed.items()},
        maps=map_plans(declared, sweep),
        uncertain=uncertain_inputs(declared),
        fit=fit_plan(declared),
        keys=CaseKeys(declared, changed, file, case_of),
        locate=place.fault,
    )


RIPPLE, ATTENUATION = 0.1, 60.0  # dB, of an elliptic filter that does not say
GRID = frozenset({"frequency", "direction"})  # of a sweep


def _numbers(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, Any]:
    """All of a case that decides numbers, with the digests of the files that it and its fidelities are made of."""
    shared = _files(case, folder)
    own = {name: each["files"] for name, each in ((name, _files(one, folder)) for name, one in changed.items()) if each}
    apart = {name: files for name, files in own.items() if files != shared.get("files")}
    return content(case, "numbers") | shared | ({"files_of": apart} if apart else {})


def _files(case: AnyCase, folder: Path) -> dict[str, Any]:
    found = KINDS[case.kind].digests(case, folder)
    return {"files": dict(found)} if found else {}


def _shared(case: AnyCase, folder: Path, sweep: Any = None) -> dict[str, Any]:
    """The physics of a case and how it is swept (as in itself, or by ``sweep``), its frequencies aside."""
    swept = {"sweep": content(sweep or case.sweep, without=GRID)}
    return content(case, "physics", "numbers") | _files(case, folder) | swept


def _keys(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, str]:
    """For each fidelity the key of its physics, how it is swept, and its table."""
    return {
        name: digest(_shared(changed.get(name, case), folder, case.sweep), content(table, "numbers", without=APPLIED))
        for name, table in case.fidelity.items()
    }


def _sweep(table: Any) -> SweepPlan:
    grid = table.frequency
    points = np.array(grid) if isinstance(grid, tuple) else np.linspace(grid.from_, grid.to, grid.points)
    points.setflags(write=False)
    return plan_of(SweepPlan, table, frequency=points)


def _chain(case: AnyCase) -> Chain | None:
    table = case.measurement
    if table is None:
        return None
    from vibeam.observe.measuring_chain import Chain, LowPass

    low_pass: LowPass | None = None
    if table.low_pass is not None:
        family: Any = table.low_pass
        elliptic = (table.ripple or RIPPLE, table.attenuation or ATTENUATION) if family == "elliptic" else ()
        low_pass = LowPass(family, table.order or 0, table.cut_off or 0.0, *elliptic)
    return Chain(table.sampling, low_pass, table.noise, table.seed, table.quantisation)


def _references(case: AnyCase, folder: Path, swept: Direction) -> dict[str, Reference]:
    if not case.reference:
        return {}
    from vibeam.casefile.tables.references import record

    return {name: record(name, table, case, folder, swept) for name, table in case.reference.items()}


def _seen(case: AnyCase) -> dict[str, Any] | None:
    """Content of the measuring chain by which a fidelity is seen."""
    return None if case.measurement is None else content(case.measurement)


def _shows(case: AnyCase, sweep: SweepPlan, shared: Any, seen: Mapping[str, Any]) -> dict[str, ShowPlan]:
    """Plans of all figures; the key of each hangs on its table, and on what is ``seen`` of its fidelities."""
    grid = sweep.frequency.tolist()
    found = {}
    for name, table in case.show.items():
        kind, fidelities = FIGURES[table.kind], table.fidelities or tuple(case.fidelity)
        frequency = tuple(grid) if table.frequency is None else table.frequency
        physics = (shared, *(seen[each] for each in fidelities))
        followed = (grid, sweep.direction) if kind.of_beam and table.direction else ()
        own = {key: getattr(table, key) for key in kind.known if key not in COMMON}
        found[name] = plan_of(
            ShowPlan,
            table,
            name=name,
            kind=table.kind,
            fidelities=fidelities,
            frequency=frequency,
            key=digest(physics, content(table), fidelities, frequency, *followed),
            output=table.output or sweep.output,
            settle=sweep.settle if table.settle is None else table.settle,
            own=own,
        )
    return found
