"""Scenes of a case of each kind, from its checked tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vibeam.casefile.tables.effects import effects_of_scene
from vibeam.casefile.tables.input import said_of
from vibeam.casefile.tables.stop import contact_law
from vibeam.casefile.tables.table import plan_of
from vibeam_models.base import ON_PLATFORM, Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import SHAPES
from vibeam_models.keys import keys_of
from vibeam_models.outputs import Output
from vibeam_models.scene import Mass, Scene, Sensor
from vibeam_models.sdof import SdofScene
from vibeam_models.stop import Stop

if TYPE_CHECKING:
    from vibeam.casefile.tables.cases import AnyCase
    from vibeam_models.given import GivenScene


def beam_scene(case: AnyCase, folder: Path) -> Scene:
    """The scene of a beam, SI units."""
    place = 0.0 if case.mass is None else case.mass.position
    return Scene(
        beam=_beam(case.beam),
        mass=None if case.mass is None else plan_of(Mass, case.mass),
        stop=_stop(case.stop, place if case.stop.position is None else case.stop.position, case.beam),
        sensor=plan_of(Sensor, case.sensor),
        base=_base(case),
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
    stop, drive = _stop(case.stop, 0.0), case.drive
    plain = case.record is None and isinstance(drive.amplitude, float) and not drive.harmonic
    return SdofScene(
        natural_frequency=case.sdof.natural_frequency,
        damping_ratio=case.sdof.damping_ratio,
        gap=stop.gap,
        restitution=stop.usual_restitution,
        amplitude=drive.amplitude if plain else _base(case),
        stop=None if stop == Stop(0.0, stop.gap, stop.restitution) else stop,
    )


def given_scene(case: AnyCase, folder: Path) -> GivenScene:
    """The scene of matrices or modes of one's own, SI units."""
    from vibeam.casefile.tables.given import given_structure
    from vibeam_models.given import GivenScene

    given, _ = given_structure(case, folder)
    assert given is not None  # its rules have found nothing wrong
    on_structure = {} if getattr(case, case.kind).force is None else {"at": 0.0}
    return GivenScene(given, _stop(case.stop, 0.0), _base(case, **on_structure), effects_of_scene(case))


def _base(case: AnyCase, **own: float) -> Base:
    """The drive; of a record, whose size its input has, where it acts."""
    said: dict[str, Any] = {name: getattr(case.drive, name, None) for name in keys_of(Base)}
    drive = Base(**said | own)
    if case.record is not None and getattr(case, "platform", None) is not None:
        return ON_PLATFORM
    if case.record is None:
        return drive
    return replace(drive, moment=0.0).place if said_of(case) == "moment" else drive.place


def _stop(table: Any, position: float, beam: Any = None) -> Stop:
    """The stop with its law, whose own keys are the law's."""
    own = {name: value for name, value in dict(table).items() if name in keys_of(Stop)}
    return Stop(**own | {"position": position, "law": contact_law(table, beam)})


def _beam(table: Any) -> Beam:
    kind: Any = table.damping
    damping = Damping("list", kind) if isinstance(kind, tuple) else Damping(kind, table.damping_ratio or ())
    shape = SHAPES[table.shape or "rectangle"]
    own = {name: getattr(table, name) for name in keys_of(shape)}
    given = {name: getattr(table, name) for name in ("length", "youngs_modulus", "density", "elements")}
    return Beam(shape=shape(**own), damping=damping, poissons_ratio=table.poissons_ratio, **given)
