"""Every effect and contact law: work put in = dissipated + stored, to 1e-9 over a thousand impacts.

Energies are those of the structure's own M, C and K (and of the shaker's coil), not of the modal system that a solver
gets: what is lost or gained between the two shows too. Impacts take ½(1 − R²)v²/(w M⁻¹wᵀ).
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import vibeam
from vibeam.case.fidelity import Fidelity
from vibeam.case.fidelity import system as system_of
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.regimes import layout as regime_layout
from vibeam.flight.trajectory import Trajectory
from vibeam.observe.motion import integral
from vibeam_models.base import Base
from vibeam_models.base_motion import drive_amplitude, moving_platform
from vibeam_models.beam import assemble
from vibeam_models.effects.gravity import Gravity
from vibeam_models.effects.leaf import Leaf
from vibeam_models.effects.masses import AddedMass, MasslessBeam
from vibeam_models.effects.opposite import Opposite
from vibeam_models.effects.platform import Platform, Shaker
from vibeam_models.effects.supports import Clamp
from vibeam_models.effects.torsion import Torsion
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.laws.mechanics import StopLaw
from vibeam_models.laws.restitution import TableRestitution, ViscousRestitution
from vibeam_models.scene import Scene
from vibeam_models.structure import Structure

sys.path.insert(0, str(Path(__file__).parents[2] / "models"))
from bench import POINT_MASS, RIG, STEEL

IMPACTS = 1000
BAR = 1e-9
GAP, SECOND = 5e-5, 3e-4
OMEGA = 2 * np.pi * 15.3
PLATFORM = Platform(mass=5.0, frequency=3.25, damping_ratio=0.05, coupling="two-way", calibrated_at=15.3)
BARE = replace(POINT_MASS, beam=replace(STEEL, elements=12), base=Base(amplitude=1e-4))
INERTIA, ZONE = RIG.effects
SCENES = {
    "none": BARE,
    "clamp": replace(BARE, effects=(Clamp(500.0),)),
    "massless": replace(BARE, effects=(MasslessBeam(), INERTIA)),
    "hanging": replace(BARE, effects=(Gravity("hanging"),)),
    "standing": replace(BARE, effects=(Gravity("standing"),)),
    "transverse": replace(BARE, effects=(Gravity("transverse"),)),
    "torsion, eccentric": replace(BARE, effects=(Torsion(1e-3, 2.8e-5, shear_modulus=80e9),)),
    "added mass": replace(BARE, effects=(AddedMass(2.4e-3, 0.09),)),
    "leaf": replace(BARE, effects=(Opposite(0.12, 0.04), Leaf(0.04, 0.012, 0.6e-3, 2.3e-3))),
    "rotary inertia": replace(BARE, effects=(INERTIA,)),
    "rigid zone": replace(BARE, effects=(ZONE,)),
    "platform": replace(BARE, effects=(PLATFORM,)),
    "shaker": replace(BARE, effects=(replace(PLATFORM, calibrated_at=None), Shaker(4.0, 20.0)), base=Base(voltage=3.0)),
}
MODES = {"massless": 2}


@dataclass(frozen=True)
class Rig:
    """A system, its drive, and the structure that it is of: on its platform, where it has one."""

    scene: Scene
    system: vibeam.ImpactSystem
    drive: vibeam.Drive
    structure: Structure
    shapes: np.ndarray


def rig(name: str) -> Rig:
    """The scene with few modes, the stop where the contact stands in equilibrium."""
    scene = SCENES[name]
    few = Fidelity("few", "modal", MODES.get(name, 3))
    system = system_of(scene, few)
    structure = vibeam.modal(assemble(scene), MODES.get(name, 3)).structure
    if scene.platform is not None:
        structure = moving_platform(scene.platform, scene.shaker, scene.moving_mass).under(structure)
    place = float(structure.contact @ np.linalg.solve(structure.K, structure.static))
    amplitude = float(np.atleast_1d(drive_amplitude(scene, np.array([OMEGA])))[0])
    drive = vibeam.Drive(OMEGA, amplitude)
    return Rig(scene, replace(system, gap=place), drive, structure, structure.modes().shapes)


def moved(made: Rig) -> Trajectory:
    """A thousand impacts."""
    path = vibeam.simulate(made.system, made.drive, 1e4, max_impacts=IMPACTS)
    assert len(path.impact_times) == IMPACTS
    return path


def energy(made: Rig, pose: np.ndarray) -> float:
    """½ẋᵀMẋ + ½xᵀKx less the potential of the constant load, J, of modal displacement and velocity (2, n)."""
    (x, v), s = pose @ made.shapes.T, made.structure
    return float(v @ s.M @ v + x @ s.K @ x) / 2 - float(s.static @ x)


def flows(made: Rig, path: Trajectory) -> Callable[[np.ndarray], np.ndarray]:
    """(m, 2) at times (m,): power put in and dissipated, W."""
    s, drive, shaker = made.structure, made.drive, made.scene.shaker
    damping = s.C
    if shaker is not None:
        assert made.scene.platform is not None
        bare = moving_platform(made.scene.platform, None, made.scene.moving_mass)
        damping = bare.under(vibeam.modal(assemble(made.scene), 3).structure).C

    def of(t: np.ndarray) -> np.ndarray:
        v = path.modes_at(t)[:, 1] @ made.shapes.T
        heat = np.einsum("ti,ij,tj->t", v, damping, v)
        if shaker is not None:
            voltage = made.scene.base.voltage * np.sin(drive.omega * t)
            current = (voltage - shaker.force_factor * (v @ s.outputs["platform"])) / shaker.resistance
            return np.stack([voltage * current, heat + shaker.resistance * current**2], axis=1)
        acceleration = -(drive.omega**2) * drive.amplitude * np.sin(drive.omega * t)
        return np.stack([(v @ s.load) * acceleration, heat], axis=1)

    return of


def struck(made: Rig, path: Trajectory) -> float:
    """What the impacts took, J."""
    mobility = float(made.structure.contact @ np.linalg.solve(made.structure.M, made.structure.contact))
    speeds = path.impact_velocities
    left = np.array([made.system.contact_law.at(v) for v in speeds])
    return float(np.sum((1 - left**2) * speeds**2)) / (2 * mobility)


def balance(made: Rig, path: Trajectory, taken: float) -> float:
    """(put in − dissipated − taken by impacts − stored) over all that was turned over."""
    first, last = path.modes_at(path.t_start), np.stack([path.state.displacement, path.state.velocity])
    put_in, heat = integral(path, path.t_start, path.t_end, flows(made, path))
    stored = energy(made, last) - energy(made, first)
    return (put_in - heat - taken - stored) / (heat + taken + abs(stored))


@pytest.mark.parametrize("name", SCENES)
def test_every_effect_keeps_account_of_its_energy(name: str) -> None:
    made = rig(name)
    path = moved(made)
    taken = struck(made, path)
    assert taken > 0
    assert abs(balance(made, path, taken)) < BAR


def test_the_account_sees_a_restitution_that_is_off_by_a_ten_millionth() -> None:
    made = rig("none")
    path = moved(made)
    wrong = replace(made, system=replace(made.system, restitution=made.system.restitution * (1 + 1e-7)))
    assert abs(balance(made, path, struck(wrong, path))) > 10 * BAR


def test_the_platforms_damping_couples_the_modes() -> None:
    assert rig("platform").system.coupling is not None
    assert rig("shaker").system.coupling is not None


# ---------------------------------------------------------------------------------------------------------------- laws

TABLE = TableRestitution((0.0, 0.02, 0.05, 0.2), (0.95, 0.9, 0.7, 0.5))


@pytest.mark.parametrize(
    ("name", "law", "second"),
    [
        ("none", TABLE, None), ("none", None, SECOND), ("none", TABLE, SECOND), ("none", ViscousRestitution(0.3), None),
        ("platform", TABLE, SECOND), ("platform", None, SECOND),
    ],
)  # fmt: skip
def test_laws_of_restitution_and_two_stops(name: str, law: StopLaw | None, second: float | None) -> None:
    """On the platform damping couples the modes."""
    made = rig(name)
    made = replace(made, system=replace(made.system, law=law, gap=GAP, second_gap=second))
    path = moved(made)
    assert abs(balance(made, path, struck(made, path))) < BAR


@pytest.mark.parametrize(
    ("name", "restitution", "second"),
    [("none", 1.0, SECOND), ("none", 0.7, None), ("platform", 0.7, None), ("platform", 1.0, SECOND)],
)
def test_a_stop_that_yields(name: str, restitution: float, second: float | None) -> None:
    """Its dashpot takes c d′² while it pushes, and what its spring still holds when the force is none."""
    made = rig(name)
    mobility = float(made.system.contact @ made.system.contact)
    law = LinearStop.matched(3e5, restitution, 1 / mobility)
    made = replace(made, system=replace(made.system, law=law, gap=GAP, second_gap=second))
    path = moved(made)
    put_in, heat, dashpot = panels(made, path, law)
    first, last = path.modes_at(path.t_start), np.stack([path.state.displacement, path.state.velocity])
    stored = energy(made, last) - energy(made, first)
    assert restitution == 1.0 or dashpot > 0.1 * heat
    assert abs(put_in - heat - dashpot - stored) / (heat + dashpot + abs(stored)) < BAR


def panels(made: Rig, path: Trajectory, law: LinearStop) -> np.ndarray:
    """Put in, dissipated in the structure, and in the stop, J: Gauss–Legendre, twenty nodes to four radians."""
    trace, contact = path.segments.trace, made.system.contact
    pushing = trace[:, layout.WHAT] == regime_layout.CONTACT
    fastest = np.sqrt(made.system.omega.max() ** 2 + pushing * law.stiffness * (contact @ contact))
    counts = np.maximum(1, np.ceil(fastest * trace[:, layout.DURATION] / 4)).astype(int)
    which = np.repeat(np.arange(len(trace)), counts)
    step = trace[which, layout.DURATION] / counts[which]
    begin = trace[which, layout.START] + step * (np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts))
    nodes, weights = np.polynomial.legendre.leggauss(20)
    times = np.clip((begin[:, None] + step[:, None] * (nodes + 1) / 2).ravel(), path.t_start, path.t_end)
    share = (step[:, None] * weights / 2).ravel()
    speed = path.velocity_at(times)
    dashpot = float(share @ (np.repeat(pushing[which], len(nodes)) * law.damping * speed**2))
    ends = np.flatnonzero(pushing & ~np.append(pushing[1:], True))
    held = path.at(trace[ends, layout.START] + trace[ends, layout.DURATION])
    depth = np.where(held > 0, held - made.system.gap, -held - (made.system.second_gap or np.inf))
    left = float(np.sum(np.where(law.damping > 0, law.stiffness * np.maximum(depth, 0.0) ** 2 / 2, 0.0)))
    return np.array([*(share @ flows(made, path)(times)), dashpot + left])
