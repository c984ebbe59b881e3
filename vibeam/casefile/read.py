"""Reading of a case: from a file, text or tables, with overrides, to its record."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from vibeam.case.case import Case
from vibeam.case.input_plan import InputPlan
from vibeam.case.plans import Direction, FigurePlan, Reference, ShowPlan, SweepPlan
from vibeam.case.study_plans import STUDY_PLANS, CostPlan, InfluencePlan
from vibeam.casefile.checks import checked
from vibeam.casefile.keys import CaseKeys
from vibeam.casefile.kinds import KINDS, MODELS
from vibeam.casefile.maps import map_plans
from vibeam.casefile.number_keys import fit_plan, keys_chosen, uncertain_inputs
from vibeam.casefile.overrides import OverrideError, tables_of
from vibeam.casefile.records import located, record_plan, start_plan
from vibeam.casefile.scenes import fidelity_scene
from vibeam.casefile.tables.cases import AnyCase
from vibeam.casefile.tables.expectations import expectation, measured_number
from vibeam.casefile.tables.input import input_plan
from vibeam.casefile.tables.outputs import main_output
from vibeam.casefile.tables.references import record
from vibeam.casefile.tables.sweep import APPLIED, fidelity_of, model_named
from vibeam.casefile.tables.table import content, digest, plan_of
from vibeam.casefile.toml import parsed, read_text
from vibeam.casefile.toml_writing import toml_text
from vibeam.exchange.faults import CaseError, Fault
from vibeam.figures import COMMON, FIGURES
from vibeam.observe.measuring_chain import Chain, LowPass
from vibeam_models.keys import defaults_of, keys_of
from vibeam_models.registry import loaded
from vibeam_models.scene import AnyScene


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
    if not isinstance(path, Mapping):
        return parse(read_text(Path(path)), path, set)
    file = Path("case.toml")
    try:
        return case_of(tables_of(path), file, set or {})
    except OverrideError as error:
        raise CaseError([Fault(str(file), None, "", str(error))]) from None


def parse(text: str, path: str | PathLike[str] = "case.toml", set: Mapping[str, Any] | None = None) -> Case:
    """The case that ``text`` says, as ``load``; ``path`` is what faults call it, references lie in its folder."""
    file = Path(path)
    return case_of(parsed(text, file), file, set or {}, text)


def case_of(tables: dict[str, Any], file: Path, set: Mapping[str, Any], text: str = "") -> Case:
    """The case of ``tables`` as a case file has them, whose ``text`` has their lines; otherwise as ``load``."""
    declared, changed, place = checked(tables, text, file, set)
    folder, numbers = file.parent, _numbers(declared, changed, file.parent)
    swept = None if declared.sweep is None else _sweep(declared.sweep)
    inputs = _inputs(declared, changed, folder)
    way = "both" if swept is None else swept.direction
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
        scene=_scene(declared, changed, folder),
        fidelities={name: fidelity_of(name, table) for name, table in declared.fidelity.items()},
        swept=swept,
        references=_references(declared, folder, way),
        scenes={
            name: fidelity_scene(changed.get(name, declared), folder, name)
            for name, table in declared.fidelity.items()
            if name in changed or model_named(table)
        },
        expectations=located(
            declared, {name: expectation(name, table, way) for name, table in declared.expect.items()}
        ),
        measured=located(
            declared,
            {
                name: measured_number(name, declared, way, keys_chosen(name, declared, changed))
                for name in declared.measured
            },
        ),
        shows=_shows(declared, swept, shared, {name: (own[name], _seen(changed.get(name, declared))) for name in own}),
        cost=plan_of(CostPlan, declared.cost),
        influence=plan_of(InfluencePlan, getattr(declared, "influence", InfluencePlan())),
        asked={
            name: plan
            for name, home in STUDY_PLANS.items()
            if (plan := _asked(home.load(), getattr(declared, name, None))) is not None
        },
        figure=plan_of(FigurePlan, declared.figure),
        chain=_chain(declared),
        chains={name: _chain(other) for name, other in changed.items()},
        maps={} if swept is None else map_plans(declared, swept),
        uncertain=uncertain_inputs(declared),
        fit=fit_plan(declared),
        record=None if declared.record is None else record_plan(declared, inputs[next(iter(inputs))]),
        starts={name: start_plan(changed.get(name, declared)) for name in inputs},
        inputs=inputs,
        keys=CaseKeys(declared, changed, file, case_of),
        locate=place.fault,
    )


def _asked(plan: type[Any], table: Any) -> Any:
    """Plan of a study that a table says, the usual one without; None where that has keys that must be said."""
    if table is not None:
        return plan_of(plan, table)
    return plan() if keys_of(plan).keys() == defaults_of(plan).keys() else None


def _scene(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> AnyScene:
    """The scene of a case: its beam, or where all of its fidelities have the same other model, that of this."""
    first, *_ = case.fidelity
    models = {"" if name in changed else model_named(table) for name, table in case.fidelity.items()}
    one = len(models) == 1 and "" not in models
    return fidelity_scene(case, folder, first) if one else KINDS[case.kind].scene_of(case, folder)


RIPPLE, ATTENUATION = 0.1, 60.0  # dB, of an elliptic filter that does not say
GRID = frozenset({"frequency", "direction"})  # of a sweep
VARIED = frozenset({"values", "realisations"})  # of a record


def _numbers(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, Any]:
    """All of a case that decides numbers, with the digests of the files that it and its fidelities are made of."""
    shared = _files(case, folder, *MODELS)
    own = {
        name: each["files"]
        for name, each in ((name, _files(one, folder, *MODELS)) for name, one in changed.items())
        if each
    }
    apart = {name: files for name, files in own.items() if files != shared.get("files")}
    return content(case, "numbers") | shared | ({"files_of": apart} if apart else {})


def _files(case: AnyCase, folder: Path, *models: str) -> dict[str, Any]:
    """Digests of the files of a case, and of those of these of its models."""
    found = dict(KINDS[case.kind].digests(case, folder))
    for name in models if case.kind == "beam" else ():
        if MODELS[name].sources and getattr(case, name) is not None:
            found |= loaded(MODELS[name].sources)(case, folder)
    if case.drive.file is not None:
        found["drive.file"] = sha256((folder / case.drive.file).read_bytes()).hexdigest()
    return {"files": found} if found else {}


def _shared(case: AnyCase, folder: Path, sweep: Any = None, model: str = "") -> dict[str, Any]:
    """The physics of a case and how it is swept (as in itself, or by ``sweep``), its frequencies aside.

    ``model``: of a fidelity that has one in place of the beam, with what its table says.
    """
    aside = [name for name in MODELS if name not in (model, case.kind)]
    own = content(case, "physics", "numbers", without=aside) | _files(case, folder, *[model] * bool(model))
    if case.record is None:
        return own | {"sweep": content(sweep or case.sweep, without=GRID)}
    own["drive"].pop("seed", None)
    return own | {"record": content(case.record, without=VARIED)}


def _keys(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, str]:
    """For each fidelity the key of its physics, how it is swept, and its table."""
    return {
        name: digest(
            _shared(changed.get(name, case), folder, case.sweep, model_named(table)),
            content(table, "numbers", without=APPLIED),
        )
        for name, table in case.fidelity.items()
    }


def _inputs(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, InputPlan]:
    """The input of every fidelity of a record case; nothing of one that sweeps."""
    if case.record is None:
        return {}
    return {name: input_plan(changed.get(name, case), folder) for name in case.fidelity}


def _sweep(table: Any) -> SweepPlan:
    grid = table.frequency
    points = np.array(grid) if isinstance(grid, tuple) else np.linspace(grid.from_, grid.to, grid.points)
    points.setflags(write=False)
    return plan_of(SweepPlan, table, frequency=points)


def _chain(case: AnyCase) -> Chain | None:
    table = case.measurement
    if table is None:
        return None
    low_pass: LowPass | None = None
    if table.low_pass is not None:
        family: Any = table.low_pass
        elliptic = (table.ripple or RIPPLE, table.attenuation or ATTENUATION) if family == "elliptic" else ()
        low_pass = LowPass(family, table.order or 0, table.cut_off or 0.0, *elliptic)
    return Chain(table.sampling, low_pass, table.noise, table.seed, table.quantisation)


def _references(case: AnyCase, folder: Path, swept: Direction) -> dict[str, Reference]:
    if not case.reference:
        return {}
    return {name: record(name, table, case, folder, swept) for name, table in case.reference.items()}


def _seen(case: AnyCase) -> dict[str, Any] | None:
    """Content of the measuring chain by which a fidelity is seen."""
    return None if case.measurement is None else content(case.measurement)


def _shows(case: AnyCase, sweep: SweepPlan | None, shared: Any, seen: Mapping[str, Any]) -> dict[str, ShowPlan]:
    """Plans of all figures; the key of each hangs on its table, and on what is ``seen`` of its fidelities."""
    grid = [] if sweep is None else sweep.frequency.tolist()
    found = {}
    for name, table in case.show.items():
        kind, fidelities = FIGURES[table.kind], table.fidelities or tuple(case.fidelity)
        frequency = tuple(grid) if table.frequency is None else table.frequency
        physics = (shared, *(seen[each] for each in fidelities))
        followed = (grid, sweep.direction) if sweep and kind.of_beam and table.direction else ()
        own = {key: getattr(table, key) for key in kind.known if key not in COMMON}
        found[name] = plan_of(
            ShowPlan,
            table,
            name=name,
            kind=table.kind,
            fidelities=fidelities,
            frequency=frequency,
            key=digest(physics, content(table), fidelities, frequency, *followed),
            output=table.output or main_output(case),
            settle=(sweep.settle if sweep else 0) if table.settle is None else table.settle,
            own=own,
        )
    return found
