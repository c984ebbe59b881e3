"""Contact with a stop that yields: its time, indentation and force at a speed, and the modes that such a pulse moves.

A mode counts where it lies below the first zero of a half-sine pulse's spectrum, f < 3/2t_c. The impact is that of a
free mass 1/S on the stop, S the contact mobility of the modes that count: a mass that falls, and a time with it, until
no further mode lies below. Of a round stop also the contact's radius a = √(R d) and the pressure p₀ = 3F/2πa² in it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, nan, pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from vibeam_models.base import Base
from vibeam_models.beam import assemble
from vibeam_models.keys import keys_of
from vibeam_models.laws.hertz import SPHERE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from vibeam_models.laws import ContactLaw
    from vibeam_models.laws.free_impact import FreeImpact
    from vibeam_models.scene import Scene
    from vibeam_models.structure import Structure

SPREAD = 10.0  # of the speeds beside that asked for
SMALL = 0.1  # largest radius of a contact beside the sphere's and the strip's thickness for which Hertz's theory holds
NODE = 1e-9  # share of the mobility below which a mode does not move the contact


@dataclass(frozen=True)
class ContactAtSpeed:
    """Impact at ``speed`` m/s of ``mass`` 1/S in kg, that of the first ``modes``: those that count, of ``of`` in all.

    ``duration`` s, ``depth`` m, ``force`` N, ``restitution`` R of the free mass; of a round stop the contact's
    ``radius`` m and the ``pressure`` Pa in its middle, else NaN.
    """

    speed: float
    modes: int
    of: int
    mass: float
    duration: float
    depth: float
    force: float
    restitution: float
    radius: float = nan
    pressure: float = nan


def contacts(scene: Scene, speed: float) -> tuple[ContactAtSpeed, ...]:
    """Contacts of a scene's beam with its stop at a tenth of a ``speed``, at it and at ten times it.

    Empty where the stop is rigid.
    """
    law = scene.stop.law
    if law is None or not law.compliant:
        return ()
    structure = assemble(replace(scene, base=Base()))
    return tuple(_contact(structure, law, v) for v in (speed / SPREAD, speed, speed * SPREAD))


def counting(structure: Structure, duration: float) -> int:
    """Number of modes up to the last one below 3/2t_c that moves the contact; without one, up to the first."""
    modes = structure.modes()
    shares = (structure.contact @ modes.shapes) ** 2
    moved = np.flatnonzero(shares > NODE * shares.sum())
    return int(moved[modes.frequency[moved] < 1.5 / duration].max(initial=moved[0])) + 1


def _contact(structure: Structure, law: ContactLaw, speed: float) -> ContactAtSpeed:
    shares, count = (structure.contact @ structure.modes().shapes) ** 2, counting(structure, inf)
    while True:
        mobility = float(shares[:count].sum())
        found = law.contact(mobility).free_impact(1 / mobility, speed)
        last = counting(structure, found.duration)
        if last <= count:
            radius, pressure = _hertzian(law, found)
            return ContactAtSpeed(
                speed, count, len(shares), 1 / mobility, found.duration, found.depth, found.force, found.restitution,
                radius, pressure,
            )  # fmt: skip
        count = last


def _hertzian(law: ContactLaw, found: FreeImpact) -> tuple[float, float]:
    """Radius of the contact in m and pressure in its middle in Pa; NaN where the stop is not known to be round."""
    if getattr(law, "body_shape", "") != SPHERE:
        return nan, nan
    radius = sqrt(float(getattr(law, "radius", nan)) * found.depth)
    return radius, 3 * found.force / (2 * pi * radius**2)


def doubts(scene: Scene, found: tuple[ContactAtSpeed, ...]) -> Iterator[str]:
    """Sentences on contacts beyond Hertz's theory, meshes with too few modes, a damping that each fidelity has anew."""
    radius, shape = getattr(scene.stop.law, "radius", None), scene.beam.shape
    sizes = {"radius of the stop": radius} | {
        f"{name} of the beam": getattr(shape, name) for name in ("thickness", "wall") if name in keys_of(type(shape))
    }
    for name, size in sizes.items():
        wide = [each for each in found if size and each.radius > SMALL * size]
        if wide:
            yield (
                f"Hertz's theory is of small contacts: from {wide[0].speed:.3g} m/s on the contact's radius, "
                f"{wide[0].radius * 1e3:.3g} mm, is more than a tenth of the {name}"
            )
    law: Any = scene.stop.law
    spring = law.contact(1 / found[0].mass).spring
    if spring is not None and law.damping is None and spring.damping > 1e-9 * sqrt(spring.stiffness * found[0].mass):
        yield (
            f"each fidelity has a damping of its own for R = {law.restitution}, that of its own 1/S: the "
            f'{found[0].modes} modes that count have it with damping = "{spring.damping:.4g} N s/m" in place of '
            "restitution, which is the same stop in all"
        )
    if any(each.modes == each.of for each in found):
        yield (
            f"all {found[-1].of} modes of the mesh lie below 3/2t_c: the contact is that of the mesh, and not of the "
            "beam; give it a mass, or a stop that is softer"
        )
