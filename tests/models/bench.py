"""The reference beam of the rig and the closed forms of cantilevers, for the tests."""

from __future__ import annotations

from dataclasses import replace

import mpmath as mp
import numpy as np

from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.effects.masses import RigidZone, RotaryInertia
from vibeam_models.scene import Effect, Mass, Scene, Sensor
from vibeam_models.stop import Stop

STEEL = Beam(0.18, Rectangle(0.02, 1.034e-3), 210e9, 7850.0, Damping("constant", (0.017,)))


def discs() -> float:
    """J in kg m² of four 50 g discs of 7 mm × ⌀35 mm, two each side of the strip, about the strip's middle."""
    own = 4 * 0.05 * (3 * 0.0175**2 + 0.007**2) / 12
    offsets = [STEEL.shape.thickness / 2 + 0.0035, STEEL.shape.thickness / 2 + 0.0105]
    return own + sum(2 * 0.05 * d**2 for d in offsets)


RIG = Scene(
    beam=STEEL,
    mass=Mass(0.2, 0.132),
    stop=Stop(0.132, 0.0, 0.72),
    sensor=Sensor(0.1),
    base=Base(voltage=0.6, gain=5.16e-4),
    effects=(RotaryInertia(discs()), RigidZone(0.0117)),
)

POINT_MASS = replace(RIG, effects=())


def with_effects(scene: Scene, *effects: Effect) -> Scene:
    """The scene with further effects."""
    return replace(scene, effects=(*scene.effects, *effects))


def cantilever_omega(beam: Beam, count: int) -> np.ndarray:
    """Circular frequencies in rad/s from the roots of cos λ cosh λ = −1."""
    guesses = [1.875, *((k + 0.5) * mp.pi for k in range(1, count))]
    roots = [float(mp.findroot(lambda x: mp.cos(x) * mp.cosh(x) + 1, guess)) for guess in guesses]
    return np.array(roots) ** 2 * np.sqrt(beam.bending_stiffness / beam.mass_per_length) / beam.length**2


def deflection(beam: Beam, x: np.ndarray | float, at: float) -> np.ndarray:
    """Static deflection in m per N at ``x`` under a force at ``at``: x²(3a − x)/6EI, straight beyond."""
    x = np.asarray(x, dtype=float)
    near, far = x**2 * (3 * at - x), at**2 * (3 * x - at)
    return np.where(x <= at, near, far) / (6 * beam.bending_stiffness)
