"""Fidelity: reduction of a scene, and the impact system built from it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam.case.reduced_beam import reduced_beam
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.scene import Scene, SdofScene
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vibeam_models.structure import Structure

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fidelity:
    """Model fidelity: a ``reduction`` (to ``modes``, where it counts them) and its ``solver`` with ``options``.

    ``changes``: physics keys of its own, applied to its scene already; ``without``: keys left out. ``label``:
    its name in figures, None for ``name``.

    ValueError for an unknown reduction, or ``modes`` missing, below 1 or given to another reduction.
    """

    name: str
    reduction: str
    modes: int | None = None
    solver: str = "flight"
    options: Mapping[str, str | float] = field(default_factory=dict)
    changes: Mapping[str, Any] = field(default_factory=dict)
    without: tuple[str, ...] = ()
    label: str | None = None

    def __post_init__(self) -> None:
        if self.reduction not in REDUCTIONS:
            known = ", ".join(REDUCTIONS)
            raise ValueError(f"fidelity {self.name!r}: no reduction {self.reduction!r}, there are {known}")
        if (self.modes is not None) != REDUCTIONS[self.reduction].counts or (self.modes is not None and self.modes < 1):
            raise ValueError(f"fidelity {self.name!r}: modes = {self.modes} with reduction {self.reduction!r}")


def reduced(structure: Structure, fidelity: Fidelity) -> Structure:
    """Reduce ``structure`` as ``fidelity`` says; ValueError for more modes than it has."""
    return REDUCTIONS[fidelity.reduction].make(structure, fidelity.modes).structure


def system(scene: Scene | SdofScene, fidelity: Fidelity) -> ImpactSystem:
    """Impact system of ``scene`` at ``fidelity``: SI units, output ``"sensor"`` (and ``"tip"`` of a beam).

    A SdofScene is one mode whatever the reduction, in its own units. ValueError for an impossible system: a position
    off the beam, too many modes, a first-mode restitution that no contact restitution in [0, 1] gives.
    """
    return _direct(scene) if isinstance(scene, SdofScene) else _of_beam(scene, fidelity)


def restitutions(scene: Scene | SdofScene, fidelity: Fidelity) -> tuple[float, float]:
    """Restitution of the contact, R, and of mode 1 of the beam on a fixed base, R₁, in this model.

    NaN where the stop has another law, which no one number describes.
    """
    if isinstance(scene, SdofScene):
        return scene.restitution, scene.restitution
    from vibeam.observe.apparent_restitution import first_mode_restitution

    still = system(scene.without("platform", "shaker"), fidelity)
    if still.law is not None:
        return float("nan"), float("nan")
    return still.restitution, first_mode_restitution(still)


def _direct(scene: SdofScene) -> ImpactSystem:
    return ImpactSystem.from_modes(
        [scene.natural_frequency],
        [scene.damping_ratio],
        contact=[1.0],
        load=[1.0],
        gap=scene.gap,
        restitution=scene.restitution,
        outputs={"sensor": [1.0]},
        law=None if scene.stop is None or scene.stop.law is None else scene.stop.law.contact(1.0),
        second_gap=None if scene.stop is None else scene.stop.second_gap,
    )


def _of_beam(scene: Scene, fidelity: Fidelity) -> ImpactSystem:
    small, static = reduced_beam(scene, fidelity.reduction, fidelity.modes)
    factor, second = 1.0 if scene.stop.gap_at == "contact" else static, scene.stop.second_gap
    built = ImpactSystem.from_structure(
        small,
        gap=scene.stop.gap * factor,
        restitution=scene.stop.usual_restitution,
        second_gap=None if second is None else second * factor,
    )
    if scene.stop.law is not None:
        built = replace(built, law=scene.stop.law.contact(float(np.sum(built.contact**2))))
    elif scene.stop.restitution_of != "contact":
        built = _seen_by_first_mode(built)
    if scene.platform is None or scene.platform.coupling == "one-way":
        return built
    from vibeam_models.base_motion import moving_platform

    # After the reduction, so that it carries the whole mass with the modes of the beam on a base held still.
    moved = moving_platform(scene.platform, scene.shaker, scene.moving_mass).under(small)
    return ImpactSystem.from_structure(
        moved, gap=built.gap, restitution=built.restitution, law=built.law, second_gap=built.second_gap
    )


def gap_drift(scene: Scene | SdofScene, omega: ArrayLike) -> NDArray[np.float64] | None:
    """Added gap at the contact at drive frequencies ``omega`` (rad/s), m; None where the gap is constant.

    Held constant beyond the first and the last frequency of the table.
    """
    if scene.stop is None or scene.stop.drift is None or scene.stop.drift_frequency is None:
        return None
    frequency = np.asarray(omega, dtype=float) / (2 * np.pi)
    added = np.interp(frequency, scene.stop.drift_frequency, scene.stop.drift)
    if isinstance(scene, SdofScene) or scene.stop.gap_at == "contact":
        return added
    _, static = reduced_beam(scene, "static_mode", None)
    return np.asarray(added * static)


def gap_wear(scene: Scene | SdofScene) -> float | None:
    """Growth of the contact's gap by each impact, m; None without wear."""
    return None if scene.stop is None else scene.stop.wear


def _seen_by_first_mode(built: ImpactSystem) -> ImpactSystem:
    """System with the contact restitution that gives mode 1 the restitution of the case."""
    from vibeam_models.laws.restitution import contact_restitution

    mobility = float(np.sum(built.contact**2))
    return replace(built, restitution=contact_restitution(built.restitution, float(built.contact[0]), mobility))
