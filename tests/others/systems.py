"""Systems of which others have published numbers, as vibeam builds and moves them.

vibeam's stop is above: a ball that falls has its displacement counted downwards, and the floor is a gap of 0. Every
frequency, stiffness and constant force is multiplied by ``spoiled()``, by which a test makes the systems wrong.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import vibeam
from tests.others.problem import spoiled
from vibeam.extensions.paper.mapping import fixed_points
from vibeam.extensions.paper.one_mode import Oscillator
from vibeam.periodic.bifurcation_functions import Kind
from vibeam_models.laws.compliant import Hertz, LinearStop

STILL = vibeam.Drive(0.0, 0.0)


def modes(omega: ArrayLike, zeta: ArrayLike = 0.0, contact: ArrayLike = 1.0, load: ArrayLike = 1.0, **more: Any):
    """``ImpactSystem.from_modes`` with the stop at 0 and no force, unless said."""
    more = {"gap": 0.0, **more, "static": spoiled() * np.asarray(more.get("static", 0.0))}
    return vibeam.ImpactSystem.from_modes(spoiled() * np.asarray(omega), zeta, contact, load, **more)


def ball(gravity: float, **more: Any) -> vibeam.ImpactSystem:
    return modes(0.0, static=gravity, **more)


def motion(system: vibeam.ImpactSystem, end: float, place: ArrayLike, speed: ArrayLike, drive: vibeam.Drive = STILL):
    state = vibeam.State(np.atleast_1d(np.asarray(place, float)), np.atleast_1d(np.asarray(speed, float)))
    return vibeam.simulate(system, drive, end, state)


def certified(system: vibeam.ImpactSystem, drive: Any, end: float, state: Any) -> vibeam.Trajectory:
    """A motion with a proof that no event was missed or invented; RuntimeError where it leaves anything open."""
    path = vibeam.simulate(system, drive, end, state, certify=True)
    if not path.certificate.complete:
        raise RuntimeError(f"not proved: {path.certificate.unproved}")
    return path


def impacts(path: vibeam.Trajectory, which: list[int]) -> np.ndarray:
    """Times and velocities of some of the impacts."""
    return np.stack([path.impact_times[which], path.impact_velocities[which]])


def fallen(gravity: float, restitution: float, end: float, height: float = 1.0, speed: float = 0.0):
    """A ball thrown up from a height at a speed, m/s."""
    return motion(ball(gravity, restitution=restitution), end, -height, -speed)


def oscillator() -> vibeam.Trajectory:
    """Siconos' LinearOscillatorED: 1 g on 100 N/m, its weight presses it on the stop; the same across, free."""
    rate = np.sqrt(1e5)
    system = modes([rate, rate], 0.0, [1, 0], 0.0, restitution=0.9, static=[9.81, 0], outputs={"across": [0, 1]})
    return motion(system, 1.0, [-1.0, 0.001], [0.0, 0.0])


def boxed() -> vibeam.Trajectory:
    """Siconos' TwoContacts: a ball between a floor and a ceiling at 1.5 m, thrown up from 1 m at 10 m/s."""
    return motion(ball(10.0, restitution=0.8, second_gap=1.5), 10.0, -1.0, -10.0)


def cam_follower() -> vibeam.Trajectory:
    """Siconos' CamFollower-Rheonomous: 1.221 kg on 1430.8 N/m; its plugin leaves the cam out of the gap, y = q."""
    return motion(modes(np.sqrt(1430.8 / 1.221), restitution=0.8), 1.0, -0.4, -0.4)


def on_moving_plane() -> vibeam.Trajectory:
    """Siconos' BallOnMovingPlane: a ball dropped on a plane that rises at 2 + cos(πt/2) m/s, seen from the plane."""
    rate = np.pi / 2
    return motion(ball(9.81, restitution=0.9), 10.0, -1.0, 3.0, vibeam.Drive(rate, -1 / rate))


def chatter() -> list[float]:
    """Budd & Dux' low frequency: release, two impacts and rest again, from rest on the stop at phase 0 of the force."""
    drive = vibeam.Drive(0.3, 1 / 0.3**2)
    path = vibeam.simulate(modes(1.0, restitution=0.8), drive, 30.0, vibeam.State([0.0], [0.0], resting=True))
    return [path.rests[0, 1], *path.impact_times[:2], path.rests[1, 0]]


def coco() -> vibeam.ImpactSystem:
    return modes(1.0, 0.05, gap=1.0, restitution=0.8)


def orbit(system: vibeam.ImpactSystem, omega: float, force: float, periods: int = 1) -> vibeam.Orbit:
    """The least unstable admissible orbit under a force of that amplitude."""
    found = vibeam.orbits(system, vibeam.Drive(omega, force / omega**2), periods)
    return min((each for each in found if each.admissible), key=lambda each: abs(each.multipliers[0]))


def impact_three_ways(system: vibeam.ImpactSystem, omega: float) -> list[list[float]]:
    """Phase of the force cos ωt and speed at the orbit's impact: in closed form, by the pointwise mapping, flown."""
    closed = orbit(system, omega, 1.0)
    model = Oscillator(float(system.zeta[0]), omega**-2, system.gap, system.restitution)
    (mapped,) = fixed_points(model, omega)
    end = closed.time + 1.5 * closed.span
    flown = vibeam.simulate(system, closed.drive, end, closed.state, t_start=closed.time)
    found = [(closed.phase, closed.velocity), (omega * mapped.time, mapped.velocity)]
    found += [(omega * flown.impact_times[0], flown.impact_velocities[0])]
    return [[(phase - np.pi / 2) % (2 * np.pi), speed] for phase, speed in found]


def grazing(omega: float) -> float:
    """Force at which COCO's oscillator touches its stop."""
    (found,) = vibeam.boundaries(coco(), (0.01 / omega**2, 2.0 / omega**2), omega, kinds=(Kind.GRAZING,))
    return found.amplitude * omega**2


def shaken(restitution: float, periods: int, kind: Kind) -> float:
    """Table's acceleration over gravity at a boundary of the motion that repeats every so many periods."""
    span = tuple(np.array([0.1, 3.0]) * 9.81 / 30.0**2)
    (found,) = vibeam.boundaries(ball(9.81, restitution=restitution), span, 30.0, periods, kinds=(kind,))
    return found.amplitude * 30.0**2 / 9.81


def bounces(acceleration: float) -> int:
    """Periods after which the settled motion of a ball, e = 0.5, repeats on a table brought to an acceleration."""
    table = ball(9.81, restitution=0.5)
    begun, ramp = orbit(table, 30.0, 1.2 * 9.81), np.linspace(1.2, acceleration, 9) * 9.81 / 900
    start = vibeam.simulate(table, begun.drive, 2 * np.pi / 30, begun.state, t_start=begun.time).state
    found = vibeam.sweep(table, omega=np.full(9, 30.0), amplitude=ramp, settle=500, hold=32, state=start)
    return int(found.period[-1])


def near_grazing(depth: float) -> tuple[float, float]:
    """Steady motion of amplitude 1 whose crest lies ``depth`` beyond the stop: first impact, and what it changes."""
    beta, omega = 0.05, 0.7
    response = 1 / complex(1 - omega**2, 2 * beta * omega)
    begin = (1.5 * np.pi - np.angle(response)) / omega  # at its trough
    system = modes(1.0, beta, gap=1 - depth, restitution=0.8)
    start, drive = vibeam.State([-1.0], [0.0]), vibeam.Drive(omega, 1 / (abs(response) * omega**2))
    path = vibeam.simulate(system, drive, begin + 2 * np.pi / omega, start, t_start=begin)
    end = begin + 2 * np.pi / omega - 1e-12
    return float(path.impact_velocities[0]), float(path.at(end) + 1.0) / np.sqrt(depth)


def weak_orbit() -> list[float]:
    """|largest multiplier| times velocity and the product of the multipliers of an orbit that all but grazes."""
    found = orbit(modes(1.0, 0.05, gap=1.0, restitution=0.8), 0.7, 0.514781507049350 * (1 + 1e-6))
    return [abs(found.multipliers[0]) * found.velocity, abs(np.prod(found.multipliers))]


def hertzian() -> vibeam.Trajectory:
    """1 kg at 0.35 m/s on a Hertzian stop of 1e9 N/m^1.5."""
    return motion(modes(0.0, law=Hertz(1e9 * spoiled())), 0.01, 0.0, 0.35)


def two_masses() -> vibeam.ImpactSystem:
    """NLvib's example 3: two masses; the first hits a spring beyond a gap, 0.1 sin Ωt drives the second."""
    squares, shapes = np.linalg.eigh([[1.0, -1.0], [-1.0, 2.0]])
    return modes(
        np.sqrt(squares), 0.015 * np.sqrt(squares), shapes[0], shapes[1], gap=1.0, law=LinearStop(100.0),
        outputs={"driven": shapes[1]},
    )  # fmt: skip


def swept(omega: float) -> vibeam.FrequencyResponse:
    """Sweep of NLvib's two masses to Ω, from 0.635."""
    grid = np.linspace(0.635, omega, 2 + round(abs(omega - 0.635) / 0.005))
    return vibeam.sweep(
        two_masses(), omega=grid, amplitude=0.1 / grid**2, settle=1000, hold=32, output="driven",
        direction="up" if omega > 0.635 else "down",
    )  # fmt: skip
