"""Random cantilevers with an attached mass and a stop, driven near twice their lowest frequency, randomly reduced."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vibeam.case.fidelity import Fidelity, system
from vibeam.system.impact_system import ImpactSystem
from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.scene import Mass, Scene, Sensor
from vibeam_models.stop import Stop

TRIES = 20


@dataclass(frozen=True)
class RandomBeam:
    """A reduced model and the full one of the same beam, at one drive (rad/s, m)."""

    reduced: ImpactSystem
    full: ImpactSystem
    omega: float
    amplitude: float
    label: str


def random_beam(seed: int) -> RandomBeam:
    """Beam of one seed: length, section, mass, place of the stop, gap, R, damping, drive and reduction are drawn."""
    rng = np.random.default_rng(seed)
    for _ in range(TRIES):
        scene, label = drawn(rng)
        reduction = drawn_reduction(rng)
        try:
            full, reduced = system(scene, Fidelity("full", "full")), system(scene, reduction)
        except ValueError:  # a first-mode restitution that no contact gives
            continue
        first = float(full.omega.min())
        omega = first * rng.uniform(1.6, 2.4)
        amplitude = 10 ** rng.uniform(-4.5, -3.5) * scene.beam.length
        swing = amplitude * abs(float(full.load[0] * full.contact[0])) * omega**2 / abs(first**2 - omega**2)
        share = float(rng.choice([0.0, rng.uniform(-0.3, 0.6)]))
        gap = share * swing
        named = f"{label}, {reduction.name}, {omega / first:.3f} f₁, gap {share:.2f}"
        return RandomBeam(replace(reduced, gap=gap), replace(full, gap=gap), omega, amplitude, named)
    raise RuntimeError(f"no beam of seed {seed} can be built")


def drawn(rng: np.random.Generator) -> tuple[Scene, str]:
    """Scene of steel or aluminium, with the restitution held at the contact or as mode 1 sees it."""
    length = rng.uniform(0.1, 0.6)
    modulus, density = ((210e9, 7850.0), (70e9, 2700.0))[int(rng.integers(2))]
    damping = ("constant", "stiffness")[int(rng.random() < 0.3)]
    width, thickness, ratio = (
        length * rng.uniform(0.05, 0.2),
        length * rng.uniform(0.004, 0.02),
        10 ** rng.uniform(-2.3, -1.3),
    )
    own = length * width * thickness * density
    beam = Beam(
        length, Rectangle(width, thickness), modulus, density, Damping(damping, (ratio,)), int(rng.integers(5, 13)) * 2
    )  # fmt: skip
    place = length * rng.uniform(0.5, 1.0)
    mass = Mass(own * 10 ** rng.uniform(-0.3, 1.0), place)
    held = ("contact", "first mode")[int(rng.integers(2))]
    stop = Stop(place, 0.0, restitution=rng.uniform(0.3, 0.9), restitution_of=held)
    scene = Scene(beam, mass, stop, Sensor(length * rng.uniform(0.3, 1.0)), Base(amplitude=1e-4))
    return scene, f"{damping} damping, R held {'at the contact' if held == 'contact' else 'of mode 1'}"


def drawn_reduction(rng: np.random.Generator) -> Fidelity:
    """Static mode, or one to eight modes."""
    modes = int(rng.integers(0, 9))
    return Fidelity("static mode", "static_mode") if not modes else Fidelity(f"{modes} modes", "modal", modes)
