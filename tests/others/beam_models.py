"""Beams of which others have printed numbers, as vibeam builds them: by its elements, on two meshes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from tests.others.problem import spoiled
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import General, Shape
from vibeam_models.beams.stretch import Material, Stretch
from vibeam_models.space import bare_beam
from vibeam_models.static_shape import static_shape_of
from vibeam_models.structure import Structure, with_inertia

UNDAMPED = Damping("constant", (0.0,))
MESHES = (30, 60)  # elements: finer ones lose to round-off in the first mode what they gain in the fifth
Inertia = tuple[float, float, int]  # kg or kg m², place in m, 0 on the deflection or 1 on the slope


def beam(length: float, shape: Shape, modulus: float, density: float, ends: str = "clamped-free", **more: Any) -> Beam:
    """A beam without damping, its modulus spoiled where a test asks for it."""
    return Beam(length, shape, spoiled() * modulus, density, UNDAMPED, ends=ends, **more)


def unit_beam(ends: str, **more: Any) -> Beam:
    """A beam of length, EI and mass per length 1."""
    return beam(1.0, General(1.0, 1.0), 1.0, 1.0, ends, **more)


def tapered(length: float, near: Shape, far: Shape, modulus: float, density: float) -> Beam:
    """A cantilever whose section goes linearly from ``near`` at the clamp to ``far``."""
    whole = beam(length, near, modulus, density)
    stretch = Stretch(0.0, length, near, Material(whole.youngs_modulus, density), far)
    return replace(whole, sections=(stretch,))


def structure(of: Beam, elements: int, inertias: Iterable[Inertia] = ()) -> Structure:
    """The beam with what is attached to it."""
    made, space = bare_beam(replace(of, elements=elements), [x for _, x, _ in inertias])
    for inertia, x, derivative in inertias:
        made = with_inertia(made, space.row(x, derivative), inertia, translation=1.0 - derivative)
    return made


def omegas(of: Beam, count: int, inertias: tuple[Inertia, ...] = (), rigid: int = 0) -> np.ndarray:
    """Angular frequencies without those of ``rigid`` motions: the two meshes' by Richardson's extrapolation."""
    coarse, fine = (structure(of, n, inertias).modes(rigid + count).omega[rigid:] for n in MESHES)
    return np.asarray((16 * fine - coarse) / 15)


def hertz(of: Beam, count: int) -> np.ndarray:
    """Natural frequencies in Hz."""
    return omegas(of, count) / (2 * pi)


def wave_numbers(ends: str, count: int, rigid: int = 0) -> np.ndarray:
    """βL of the uniform beam."""
    return np.sqrt(omegas(unit_beam(ends), count, rigid=rigid))


def tip_flexibility(of: Beam) -> float:
    """Deflection of the tip under a force of 1 on it."""
    return 1 / static_shape_of(of, of.length, of.length).stiffness
