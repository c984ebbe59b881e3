"""From the tables of a case to the scene on the bench."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.case import NOT_PHYSICS
from vibeam.case.plans import AccuracyPlan, Direction, Reference, SweepPlan
from vibeam_models.scene import (
    AddedMass,
    Base,
    Beam,
    Clamp,
    Damping,
    Gravity,
    Mass,
    Platform,
    Scene,
    SdofScene,
    Sensor,
    Shaker,
    Stop,
    Torsion,
)

if TYPE_CHECKING:
    from vibeam.case.fidelity import Fidelity
    from vibeam.case.plans import Expectation, ShowPlan
    from vibeam.casefile.tables.beam import BeamTable
    from vibeam.casefile.tables.cases import BeamCase, SdofCase
    from vibeam.casefile.tables.effects import PlatformTable, TorsionTable
    from vibeam.casefile.tables.stop import SdofStopTable, StopTable
    from vibeam.casefile.tables.sweep import SweepTable
    from vibeam.observe.measuring_chain import Chain


def scene_of(case: BeamCase | SdofCase) -> Scene | SdofScene:
    """The scene that a checked case declares, SI units."""
    from vibeam.casefile.tables.cases import SdofCase

    if isinstance(case, SdofCase):
        return SdofScene(
            natural_frequency=case.sdof.natural_frequency,
            damping_ratio=case.sdof.damping_ratio,
            gap=case.stop.gap,
            restitution=1.0 if case.stop.restitution is None else case.stop.restitution,
            amplitude=case.drive.amplitude,
            stop=_sdof_stop(case.stop),
        )
    return Scene(
        beam=_beam(case.beam),
        mass=None if case.mass is None else Mass(**dict(case.mass)),
        stop=_stop(case.stop, 0.0 if case.mass is None else case.mass.position),
        sensor=Sensor(case.sensor.position),
        base=Base(**dict(case.drive)),
        added_masses=tuple(AddedMass(**dict(added)) for added in case.added_mass),
        **_effects(case),
    )


def _sdof_stop(table: SdofStopTable) -> Stop | None:
    beyond = {name: value for name, value in dict(table).items() if name not in ("gap", "restitution")}
    if all(value is None for value in beyond.values()):
        return None
    return Stop(position=0.0, gap=table.gap, restitution=table.restitution, **beyond)


def _effects(case: BeamCase) -> dict[str, Any]:
    """The effects that have a table of their own, those that the case names."""
    made: dict[str, Callable[[Any], Any]] = {
        "clamp": lambda table: Clamp(**dict(table)),
        "gravity": lambda table: Gravity(**dict(table)),
        "torsion": lambda table: _torsion(table, case.beam),
        "platform": _platform,
        "shaker": lambda table: Shaker(**dict(table)),
    }
    named = {name: getattr(case, name) for name in made}
    return {name: made[name](table) for name, table in named.items() if table is not None}


def _beam(table: BeamTable) -> Beam:
    values = dict(table)
    kind, ratios = values.pop("damping"), values.pop("damping_ratio")
    damping = Damping("list", kind) if isinstance(kind, tuple) else Damping(kind, ratios)
    return Beam(damping=damping, **values)


def _torsion(table: TorsionTable, beam: BeamTable) -> Torsion:
    modulus = table.shear_modulus
    if modulus is None:
        modulus = beam.youngs_modulus / (2 * (1 + (table.poissons_ratio or 0.0)))
    return Torsion(table.eccentricity, modulus, table.polar_inertia)


def _platform(table: PlatformTable) -> Platform:
    coupling: Any = table.coupling
    stiffness, calibrated = table.stiffness, table.calibrated_at
    if stiffness is None:
        stiffness = table.mass * (2 * np.pi * (table.frequency or 0.0)) ** 2
    at = None if calibrated is None else 2 * np.pi * calibrated
    return Platform(table.mass, stiffness, table.damping_ratio, coupling, at)


def _stop(table: StopTable, mass_position: float) -> Stop:
    return Stop(**dict(table) | {"position": mass_position if table.position is None else table.position})


RIPPLE, ATTENUATION = 0.1, 60.0  # dB, of an elliptic filter that does not say

GRID = frozenset({"frequency", "direction"})  # of a sweep

NOT_OWN = frozenset({"label", "set", "without"})  # of a fidelity: a name, and what is in its scene already


def _shared(case: BeamCase | SdofCase, sweep: SweepTable) -> str:
    """The physics of a case and how it is swept, its frequencies aside."""
    from vibeam.casefile.canonical import canonical_text

    return canonical_text(case, NOT_PHYSICS) + "\n[sweep]\n" + canonical_text(sweep, GRID)


def _own_numbers(case: BeamCase | SdofCase, changed: Mapping[str, BeamCase | SdofCase]) -> dict[str, str]:
    """For each fidelity its physics, how it is swept, and its table."""
    from vibeam.casefile.canonical import canonical_text

    tables: Any = case.fidelity
    return {
        name: _shared(changed.get(name, case), case.sweep) + "\n[fidelity]\n" + canonical_text(table, NOT_OWN)
        for name, table in tables.items()
    }


def _accuracy(case: BeamCase | SdofCase) -> AccuracyPlan | None:
    if case.accuracy is None:
        return None
    return AccuracyPlan(case.accuracy, case.accuracy_of or AccuracyPlan.quantities)


def _sweep(table: SweepTable) -> SweepPlan:
    grid: Any = table.frequency
    points = np.array(grid) if isinstance(grid, tuple) else np.linspace(grid.from_, grid.to, grid.points)
    points.setflags(write=False)
    direction: Any = table.direction
    return SweepPlan(points, direction, table.settle, table.hold, table.output)


def _fidelities(case: BeamCase | SdofCase) -> dict[str, Fidelity]:
    from vibeam.case.fidelity import Fidelity

    tables: Any = case.fidelity
    return {
        name: Fidelity(name=name, changes=dict(table.set), **table.model_dump(exclude={"set"}))
        for name, table in tables.items()
    }


def _chain(case: BeamCase | SdofCase) -> Chain | None:
    table = case.measurement
    if table is None:
        return None
    from vibeam.observe.low_pass import LowPass
    from vibeam.observe.measuring_chain import Chain

    low_pass: LowPass | None = None
    if table.low_pass is not None:
        family: Any = table.low_pass
        elliptic = (table.ripple or RIPPLE, table.attenuation or ATTENUATION) if family == "elliptic" else ()
        low_pass = LowPass(family, table.order or 0, table.cut_off or 0.0, *elliptic)
    return Chain(table.sampling, low_pass, table.noise, table.seed, table.quantisation)


def _references(case: BeamCase | SdofCase, folder: Path, swept: Direction) -> dict[str, Reference]:
    found = {}
    for name, table in case.reference.items():
        file = (folder / table.file).absolute()
        values = table.model_dump() | {"file": file, "direction": table.direction or swept}
        values["quote"] = file.resolve().is_relative_to(folder.resolve())
        found[name] = Reference(name=name, **values)
    return found


def _expectations(case: BeamCase | SdofCase, swept: Direction) -> dict[str, Expectation]:
    if not case.expect:
        return {}
    from vibeam.case.plans import Expectation

    values = {name: table.model_dump() | {"direction": table.direction or swept} for name, table in case.expect.items()}
    return {name: Expectation(name=name, **value) for name, value in values.items()}


def _shows(
    case: BeamCase | SdofCase, changed: Mapping[str, BeamCase | SdofCase], sweep: SweepPlan
) -> dict[str, ShowPlan]:
    own = _own_numbers(case, changed)
    seen = {name: f"{own[name]}{_measured(changed.get(name, case))}" for name in own}
    return {name: _show(case, name, sweep, seen) for name in case.show}


def _measured(case: BeamCase | SdofCase) -> str:
    from vibeam.casefile.canonical import canonical_text

    return "" if case.measurement is None else canonical_text(case.measurement)


def _show(case: BeamCase | SdofCase, name: str, sweep: SweepPlan, seen: Mapping[str, str]) -> ShowPlan:
    """The plan of one table; its key hangs on the table itself and on what is ``seen`` of its fidelities."""
    from vibeam.case.plans import ShowPlan
    from vibeam.casefile.canonical import canonical_text

    table = case.show[name]
    fidelities = table.fidelities or tuple(case.fidelity)
    frequency = tuple(sweep.frequency.tolist()) if table.frequency is None else table.frequency
    physics = [_shared(case, case.sweep), *(seen[each] for each in fidelities)]
    decisive = [*physics, canonical_text(table), repr(fidelities), repr(frequency)]
    return ShowPlan(
        name=name,
        kind=table.kind,
        fidelities=fidelities,
        frequency=frequency,
        periods=table.periods,
        settle=sweep.settle if table.settle is None else table.settle,
        quantity=table.quantity,
        key=sha256("\n".join(decisive).encode()).hexdigest(),
        output=table.output or sweep.output,
        near=table.near,
        highest=table.highest,
        subdivision=table.subdivision,
    )
