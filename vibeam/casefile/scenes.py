"""Scenes of a case of each kind, from its checked tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.casefile.kinds import KINDS, MODELS
from vibeam.casefile.tables.effects import effects_of_scene
from vibeam.casefile.tables.input import said_of
from vibeam.casefile.tables.stop import contact_law
from vibeam.casefile.tables.sweep import model_named
from vibeam.casefile.tables.table import plan_of
from vibeam_models.base import ON_PLATFORM, Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import SHAPES
from vibeam_models.keys import keys_of
from vibeam_models.outputs import Output
from vibeam_models.registry import loaded
from vibeam_models.scene import AnyScene, Mass, Scene, Sensor
from vibeam_models.sdof import SdofScene
from vibeam_models.stop import Stop

if TYPE_CHECKING:
    from vibeam.casefile.tables.cases import AnyCase
    from vibeam_models.given import GivenScene


def fidelity_scene(case: AnyCase, folder: Path, name: str) -> AnyScene:
    """The scene of one fidelity of a case, whose changes are made in its tables."""
    made, model = KINDS[case.kind].scene_of(case, folder), model_named(case.fidelity[name])
    return loaded(MODELS[model].scene)(case, folder, made) if model else made


def beam_scene(case: AnyCase, folder: Path) -> Scene:
    """The scene of a beam, SI units."""
    place = 0.0 if case.mass is None else case.mass.position
    return Scene(
        beam=_beam(case.beam),
        mass=None if case.mass is None else plan_of(Mass, case.mass),
        stop=stop_of(case.stop, place if case.stop.position is None else case.stop.position, case.beam),
        sensor=plan_of(Sensor, case.sensor),
        base=base_of(case),
        effects=effects_of_scene(case),
        outputs=_outputs(case.output),
    )


def _outputs(tables: Mapping[str, Any] | None) -> tuple[Output, ...]:
    """The outputs of a case; an acceleration is absolute unless it says otherwise."""
    return tuple(plan_of(Output, each, name=name, absolute=_is_absolute(each)) for name, each in (tables or {}).items())


def _is_absolute(table: Any) -> bool:
    return table.quantity == "acceleration" and table.absolute is not False


def sdof_scene(case: AnyCase, folder: Path) -> SdofScene:
    """The scene of a single degree of freedom, in its own units."""
    stop, drive = stop_of(case.stop, 0.0), case.drive
    plain = case.record is None and isinstance(drive.amplitude, float) and not drive.harmonic
    return SdofScene(
        natural_frequency=case.sdof.natural_frequency,
        damping_ratio=case.sdof.damping_ratio,
        gap=stop.gap,
        restitution=stop.usual_restitution,
        amplitude=drive.amplitude if plain else base_of(case),
        stop=None if stop == Stop(0.0, stop.gap, stop.restitution) else stop,
    )


def given_scene(case: AnyCase, folder: Path) -> GivenScene:
    """The scene of matrices or modes of one's own, SI units."""
    from vibeam.casefile.tables.given import given_structure
    from vibeam_models.given import GivenScene

    given, _ = given_structure(case, folder)
    assert given is not None  # its rules have found nothing wrong
    on_structure = {} if getattr(case, case.kind).force is None else {"at": 0.0}
    return GivenScene(given, stop_of(case.stop, 0.0), base_of(case, **on_structure), effects_of_scene(case))


def base_of(case: AnyCase, **own: float | None) -> Base:
    """The drive; of a record, whose size its input has, where it acts."""
    said: dict[str, Any] = {name: getattr(case.drive, name, None) for name in keys_of(Base)}
    drive = Base(**said | own)
    if case.record is not None and getattr(case, "platform", None) is not None:
        return ON_PLATFORM
    if case.record is None:
        return drive
    return replace(drive, moment=0.0).place if said_of(case) == "moment" else drive.place


def stop_of(table: Any, position: float, beam: Any = None) -> Stop:
    """The stop with its law, whose own keys are the law's."""
    own = {name: value for name, value in vars(table).items() if name in keys_of(Stop)}
    return Stop(**own | {"position": position, "law": contact_law(table, beam)})


def damping_of(table: Any) -> Damping:
    """The damping by modal ratios that a table says."""
    kind: Any = table.damping
    return Damping("list", kind) if isinstance(kind, tuple) else Damping(kind, table.damping_ratio or ())


def _beam(table: Any) -> Beam:
    shape = SHAPES[table.shape or "rectangle"]
    own = {name: getattr(table, name) for name in keys_of(shape)}
    given = {name: getattr(table, name) for name in ("length", "youngs_modulus", "density", "elements")}
    return Beam(shape=shape(**own), damping=damping_of(table), poissons_ratio=table.poissons_ratio, **given)
