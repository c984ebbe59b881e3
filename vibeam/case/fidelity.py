"""Fidelity: reduction of a scene, the impact system built from it, and that as a function of the case's keys."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isnan
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from vibeam.case.reduced_structure import Flight, reduced_structure, with_snapshots
from vibeam.case.study_plans import MOST_ELEMENTS
from vibeam.system.impact_system import ImpactSystem
from vibeam.system.rows import TimeDerivative
from vibeam_models import keys as declare
from vibeam_models.base import ON_PLATFORM
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from vibeam_models.arrays import Array
    from vibeam_models.scene import AnyScene, RigScene
    from vibeam_models.sdof import SdofScene
    from vibeam_models.structure import Structure


@dataclass(frozen=True)
class Fidelity:
    """Model fidelity: a ``reduction`` (to ``modes``, where it counts them) and its ``solver`` with ``options``.

    ``parameters``: of the reduction, by name, as its declaration ``takes`` them.
    ``changes``: physics keys of its own, applied to its scene already; ``without``: keys left out. ``label``:
    its name in figures, None for ``name``. ``flight``: by which a reduction that is made of one flies the full model.

    ValueError for an unknown reduction, or ``modes`` missing, below 1 or given to another reduction.
    """

    name: str
    reduction: str = declare.text(
        "what of the structure is kept: one static deflection, the first few modes, all of the finite elements, …",
        "static_mode",
    )
    modes: int | None = declare.count(
        1, 2 * MOST_ELEMENTS, "how many modes, or coordinates of another reduction that counts them", 8, None
    )
    solver: str = declare.text("how its motion is found", "flight", "flight")
    options: Mapping[str, str | float] = declare.text(
        "of the solver, by name; absent = its own defaults", {"rtol": 1e-9}, {}
    )
    changes: Mapping[str, Any] = field(default_factory=dict)
    without: tuple[str, ...] = ()
    label: str | None = declare.text(
        "its name in figures; absent = the name of its table", "8 modes", None, numbers=False
    )
    parameters: Mapping[str, Any] = field(default_factory=dict)
    flight: Flight | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.reduction not in REDUCTIONS:
            known = ", ".join(REDUCTIONS)
            raise ValueError(f"fidelity {self.name!r}: no reduction {self.reduction!r}, there are {known}")
        if (self.modes is not None) != REDUCTIONS[self.reduction].counts or (self.modes is not None and self.modes < 1):
            raise ValueError(f"fidelity {self.name!r}: modes = {self.modes} with reduction {self.reduction!r}")

    @property
    def rig(self) -> Mapping[str, Any]:
        """Changes of the rig itself: those of [solid] say how its body is modelled."""
        return {key: value for key, value in self.changes.items() if not key.startswith("solid.")}


def system(scene: AnyScene, fidelity: Fidelity) -> ImpactSystem:
    """Impact system of ``scene`` at ``fidelity``: SI units, output ``"sensor"`` (and ``"tip"`` of a beam), and its own.

    A scene that is one mode is that whatever the reduction, in its own units. ValueError for an impossible system: a
    position off the beam, too many modes, a first-mode restitution that no contact restitution in [0, 1] gives.
    """
    rig: Any = scene
    if scene.given_mode is not None:
        return _direct(rig, *scene.given_mode)
    parameters = parameters_of(rig, fidelity)
    return system_of(rig, *reduced_structure(rig, fidelity.reduction, fidelity.modes, parameters))


def system_of(scene: RigScene, small: Structure, static: float) -> ImpactSystem:
    """Impact system of ``scene`` with ``small``, what its structure was reduced to; errors as in ``system``.

    ``static``: the deflection of the structure's static mode at the contact, 1 at the sensor.
    """
    built = _at_its_stop(scene, small, static)
    return _with_derivatives(built, scene) if any(each.kind.rate for each in scene.outputs) else built


def _with_derivatives(built: ImpactSystem, scene: RigScene) -> ImpactSystem:
    """System whose velocities and accelerations are no longer rows of displacements.

    The base of an absolute acceleration is the platform's coordinate where that moves by itself, at rest where a force
    drives the beam, and else the motion that is prescribed.
    """
    rates = {each.name: each for each in scene.outputs if each.kind.rate}
    outputs = {name: row for name, row in built.outputs.items() if name not in rates}
    found = {}
    for name, each in rates.items():
        row, base = built.outputs[name], 0.0
        if each.absolute and "platform" in outputs:
            row = row + outputs["platform"]
        elif each.absolute and scene.base.on_beam is None:
            base = 1.0
        found[name] = TimeDerivative(row, each.kind.rate, base)
    return replace(built, outputs=outputs, derivatives=found)


def restitutions(scene: AnyScene, fidelity: Fidelity) -> tuple[float, float]:
    """Restitution of the contact, R, and of mode 1 of the beam on a fixed base, R₁, in this model.

    NaN where the stop has another law, which no one number describes.
    """
    if scene.given_mode is not None:
        return scene.held[1], scene.held[1]
    from vibeam.observe.restitution import first_mode_restitution

    still = system(scene.without("platform", "shaker"), fidelity)
    if still.law is not None:
        return float("nan"), float("nan")
    return still.restitution, first_mode_restitution(still)


def _direct(scene: SdofScene, omega: float, zeta: float) -> ImpactSystem:
    return ImpactSystem.from_modes(
        [omega],
        [zeta],
        contact=[1.0],
        load=[1.0],
        gap=scene.gap,
        restitution=scene.restitution,
        outputs={"sensor": [1.0]},
        law=None if scene.stop is None or scene.stop.law is None else scene.stop.law.contact(1.0),
        second_gap=None if scene.stop is None else scene.stop.second_gap,
    )


def _at_its_stop(scene: RigScene, small: Structure, static: float) -> ImpactSystem:
    factor, second = 1.0 if scene.stop.gap_at == "contact" else static, scene.stop.second_gap
    if isnan(factor):
        raise ValueError(
            'stop: gap_at = "sensor": no static deflection of this structure carries the gap to the contact'
        )
    stops = scene.named("further_stop")
    further: dict[str, tuple[Any, ...]] = {
        each.output: (each.gap, 1.0 if each.restitution is None else each.restitution) for each in stops
    }
    bare = small.with_(contact_flexibility=0.0) if small.contact_flexibility else small
    built = ImpactSystem.from_structure(
        bare,
        gap=scene.stop.gap * factor,
        restitution=scene.stop.usual_restitution,
        second_gap=None if second is None else second * factor,
        further=further,
    )
    if scene.stop.law is not None:
        built = replace(built, law=scene.stop.law.contact(float(np.sum(built.contact**2))))
    elif scene.stop.restitution_of != "contact":
        built = with_first_mode_restitution(built, built.restitution)
    if small.contact_flexibility:
        built = replace(built, law=built.contact_law.in_series(small.contact_flexibility))
    if built.further is not None:
        laws = {
            each.output: each.contact(float(np.sum(own.row**2))) for each, own in zip(stops, built.further, strict=True)
        }
        further = {name: (*numbers, laws[name]) for name, numbers in further.items()}
        mixed = [replace(own, law=law) for own, law in zip(built.further, laws.values(), strict=True)]
        built = replace(built, further=tuple(mixed))
    if scene.platform is None or scene.platform.coupling == "one-way":
        return built
    from vibeam_models.base_motion import moving_platform

    # After the reduction, so that it carries the whole mass with the modes of the beam on a base held still.
    moved = moving_platform(scene.platform, scene.shaker, scene.moving_mass).under(bare)
    carried = ImpactSystem.from_structure(
        moved, gap=built.gap, restitution=built.restitution, law=built.law, second_gap=built.second_gap, further=further
    )
    if scene.base != ON_PLATFORM:
        return carried
    return replace(carried, load=carried.load / scene.platform.mass)  # which is of b₀ = F/(m_pΩ²), not of the force


def parameters_of(scene: RigScene, fidelity: Fidelity) -> Mapping[str, Any]:
    """Parameters of a reduction, with the flight of the full model that some are made of."""
    if not REDUCTIONS[fidelity.reduction].flown:
        return fidelity.parameters
    if fidelity.flight is None:
        raise ValueError(f"fidelity {fidelity.name!r}: reduction {fidelity.reduction!r} is made of a flight: give one")
    return with_snapshots(scene, fidelity.parameters, _full, fidelity.flight)


def _full(scene: RigScene) -> ImpactSystem:
    return system(scene, Fidelity("full", "full"))


def gap_drift(scene: AnyScene, omega: ArrayLike) -> Array | None:
    """Added gap at the contact at drive frequencies ``omega`` (rad/s), m; None where the gap is constant.

    Held constant beyond the first and the last frequency of the table.
    """
    if scene.stop is None or scene.stop.drift is None or scene.stop.drift_frequency is None:
        return None
    frequency = np.asarray(omega, dtype=float) / (2 * np.pi)
    added = np.interp(frequency, scene.stop.drift_frequency, scene.stop.drift)
    if scene.stop.gap_at == "contact":
        return added
    rig: Any = scene
    _, static = reduced_structure(rig, "static_mode", None)
    return np.asarray(added * static)


def gap_wear(scene: AnyScene) -> float | None:
    """Growth of the contact's gap by each impact, m; None without wear."""
    return None if scene.stop is None else scene.stop.wear


def with_first_mode_restitution(system: ImpactSystem, restitution: float) -> ImpactSystem:
    """System with the contact's restitution with which mode 1 sees so much; ValueError where none in [0, 1] does."""
    from vibeam_models.laws.restitution import contact_restitution

    if system.law is not None or np.isnan(restitution):
        raise ValueError("the contact law has no one coefficient of restitution that could be carried over")
    return replace(system, restitution=contact_restitution(restitution, float(system.contact[0]), system.mobility))


class Model(ABC):
    """Model of one fidelity of a case; ``at`` gives it with other values of keys."""

    @abstractmethod
    def at(self, values: Mapping[str, float]) -> Self:
        """Model with keys at other values, SI; they win over what the fidelity sets, not over what it leaves out.

        CaseError for a key that the case cannot have, or a value that it may not have by itself.
        """

    @abstractmethod
    def checked(self) -> Self:
        """The same model; CaseError where the rules between the keys of the rig refuse it."""

    @abstractmethod
    def value(self, key: str) -> Any:
        """Value of a key, SI; None where the case has none."""

    @property
    @abstractmethod
    def fidelity(self) -> Fidelity:
        """Fidelity, with the number of modes that a key gave it."""

    @property
    @abstractmethod
    def most_modes(self) -> int:
        """Largest number of modes that the structure has; 0 where that is not known."""

    @abstractmethod
    def scene(self) -> AnyScene:
        """Scene; ValueError for an impossible one."""

    def system(self) -> ImpactSystem:
        """Impact system; ValueError for an impossible one."""
        return system(self.scene(), self.fidelity)

    def amplitude(self, omega: Array) -> float | Array:
        """Drive amplitude at ``omega`` (rad/s): one for all, or one each where it depends on that."""
        from vibeam_models.base_motion import drive_amplitude

        return drive_amplitude(self.scene(), omega)
