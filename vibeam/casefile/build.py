"""Scene, fidelities and plans of a case from its checked tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import BaseModel

from vibeam.case.plans import AccuracyPlan, Direction, FitPlan, Reference, ShowPlan, SweepPlan
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.number_keys import keys_chosen
from vibeam.casefile.tables.effects import effects_of_scene
from vibeam.casefile.tables.expectations import expectation, measured_number
from vibeam.casefile.tables.stop import contact_law
from vibeam.casefile.tables.sweep import APPLIED
from vibeam.casefile.tables.table import content, digest, plan_of
from vibeam.figures import COMMON, FIGURES
from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import SHAPES
from vibeam_models.keys import keys_of
from vibeam_models.outputs import Output
from vibeam_models.scene import Mass, Scene, Sensor
from vibeam_models.sdof import SdofScene
from vibeam_models.stop import Stop

if TYPE_CHECKING:
    from vibeam.case.plans import Expectation, MeasuredNumber
    from vibeam.casefile.tables.cases import AnyCase
    from vibeam.casefile.tables.sweep import SweepTable
    from vibeam.observe.measuring_chain import Chain
    from vibeam_models.given import GivenScene


def beam_scene(case: AnyCase, folder: Path) -> Scene:
    """The scene of a beam, SI units."""
    place = 0.0 if case.mass is None else case.mass.position
    return Scene(
        beam=_beam(case.beam),
        mass=None if case.mass is None else Mass(case.mass.mass, case.mass.position),
        stop=_stop(case.stop, place if case.stop.position is None else case.stop.position),
        sensor=Sensor(case.sensor.position),
        base=Base(**dict(case.drive)),
        effects=effects_of_scene(case),
        outputs=_outputs(case.output),
    )


def _outputs(tables: Mapping[str, Any] | None) -> tuple[Output, ...]:
    """The outputs of a case; an acceleration is absolute unless it says otherwise."""
    return tuple(
        Output(
            name,
            each.position,
            each.quantity,
            each.distance,
            each.quantity == "acceleration" and each.absolute is not False,
        )
        for name, each in (tables or {}).items()
    )


def sdof_scene(case: AnyCase, folder: Path) -> SdofScene:
    """The scene of a single degree of freedom, in its own units."""
    stop, drive = _stop(case.stop, 0.0), case.drive
    return SdofScene(
        natural_frequency=case.sdof.natural_frequency,
        damping_ratio=case.sdof.damping_ratio,
        gap=stop.gap,
        restitution=stop.usual_restitution,
        amplitude=drive.amplitude if isinstance(drive.amplitude, float) and not drive.harmonic else Base(**dict(drive)),
        stop=None if stop == Stop(0.0, stop.gap, stop.restitution) else stop,
    )


def given_scene(case: AnyCase, folder: Path) -> GivenScene:
    """The scene of matrices or modes of one's own, SI units."""
    from vibeam.casefile.tables.given import given_structure
    from vibeam_models.given import GivenScene

    given, _ = given_structure(case, folder)
    assert given is not None  # its rules have found nothing wrong
    on_structure = {} if getattr(case, case.kind).force is None else {"at": 0.0}
    return GivenScene(given, _stop(case.stop, 0.0), Base(**dict(case.drive) | on_structure), effects_of_scene(case))


def _stop(table: Any, position: float) -> Stop:
    """The stop with its law, whose own keys are the law's."""
    return Stop(**_own(Stop, table) | {"position": position, "law": contact_law(table)})


def _own(kind: type[Any], table: BaseModel) -> dict[str, Any]:
    """The values of a table that are fields of a record."""
    return {field.name: getattr(table, field.name) for field in fields(kind) if field.name in type(table).model_fields}


def _beam(table: Any) -> Beam:
    kind: Any = table.damping
    damping = Damping("list", kind) if isinstance(kind, tuple) else Damping(kind, table.damping_ratio or ())
    shape = SHAPES[table.shape or "rectangle"]
    own = {name: getattr(table, name) for name in keys_of(shape)}
    given = {name: getattr(table, name) for name in ("length", "youngs_modulus", "density", "elements")}
    return Beam(shape=shape(**own), damping=damping, poissons_ratio=table.poissons_ratio, **given)


RIPPLE, ATTENUATION = 0.1, 60.0  # dB, of an elliptic filter that does not say
GRID = frozenset({"frequency", "direction"})  # of a sweep


def numbers_of(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, Any]:
    """All of a case that decides numbers, with the digests of the files that it and its fidelities are made of."""
    shared = _files(case, folder)
    own = {name: each["files"] for name, each in ((name, _files(one, folder)) for name, one in changed.items()) if each}
    apart = {name: files for name, files in own.items() if files != shared.get("files")}
    return content(case, "numbers") | shared | ({"files_of": apart} if apart else {})


def _files(case: AnyCase, folder: Path) -> dict[str, Any]:
    found = KINDS[case.kind].digests(case, folder)
    return {"files": dict(found)} if found else {}


def _shared(case: AnyCase, sweep: SweepTable, folder: Path) -> dict[str, Any]:
    """The physics of a case and how it is swept, its frequencies aside."""
    return content(case, "physics", "numbers") | _files(case, folder) | {"sweep": content(sweep, without=GRID)}


def _keys(case: AnyCase, changed: Mapping[str, AnyCase], folder: Path) -> dict[str, str]:
    """For each fidelity the key of its physics, how it is swept, and its table."""
    tables: Any = case.fidelity
    return {
        name: digest(_shared(changed.get(name, case), case.sweep, folder), content(table, "numbers", without=APPLIED))
        for name, table in tables.items()
    }


def _accuracy(case: AnyCase) -> AccuracyPlan | None:
    if case.accuracy is None:
        return None
    return AccuracyPlan(case.accuracy, case.accuracy_of or AccuracyPlan.quantities)


def _sweep(table: SweepTable) -> SweepPlan:
    grid: Any = table.frequency
    points = np.array(grid) if isinstance(grid, tuple) else np.linspace(grid.from_, grid.to, grid.points)
    points.setflags(write=False)
    direction: Any = table.direction
    return SweepPlan(points, direction, table.settle, table.hold, table.output)


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


def _expectations(case: AnyCase, swept: Direction) -> dict[str, Expectation]:
    return {name: expectation(name, table, swept) for name, table in case.expect.items()}


def _fit(case: AnyCase) -> FitPlan | None:
    if case.fit is None:
        return None
    from vibeam.casefile.number_keys import plan_of

    return plan_of(case.fit, case)


def _measurements(case: AnyCase, changed: Mapping[str, AnyCase], swept: Direction) -> dict[str, MeasuredNumber]:
    return {name: measured_number(name, case, swept, keys_chosen(name, case, changed)) for name in case.measured}


def _shows(case: AnyCase, changed: Mapping[str, AnyCase], sweep: SweepPlan, folder: Path) -> dict[str, ShowPlan]:
    seen = {name: (key, _measured(changed.get(name, case))) for name, key in _keys(case, changed, folder).items()}
    return {name: _show(case, name, sweep, seen, folder) for name in case.show}


def _measured(case: AnyCase) -> dict[str, Any] | None:
    return None if case.measurement is None else content(case.measurement)


def _show(case: AnyCase, name: str, sweep: SweepPlan, seen: Mapping[str, Any], folder: Path) -> ShowPlan:
    """The plan of one table; its key hangs on the table itself and on what is ``seen`` of its fidelities."""
    table = case.show[name]
    fidelities = table.fidelities or tuple(case.fidelity)
    frequency = tuple(sweep.frequency.tolist()) if table.frequency is None else table.frequency
    physics = (_shared(case, case.sweep, folder), *(seen[each] for each in fidelities))
    followed = (sweep.frequency.tolist(), sweep.direction) if FIGURES[table.kind].of_beam and table.direction else ()
    kind = FIGURES[table.kind]
    own = {key: getattr(table, key) for key in kind.known if key not in COMMON}
    return plan_of(
        ShowPlan, table, name=name, kind=table.kind, fidelities=fidelities, frequency=frequency,
        key=digest(physics, content(table), fidelities, frequency, *followed), output=table.output or sweep.output,
        settle=sweep.settle if table.settle is None else table.settle, own=own,
        format=own.get("format") or kind.formats,
    )  # fmt: skip
