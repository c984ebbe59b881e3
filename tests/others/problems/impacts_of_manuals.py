"""Impacts of which verification manuals print numbers: falling masses, struck bars, spheres and a gear at its walls."""

from __future__ import annotations

from math import atan, cos, pi, radians, sin, sqrt

import numpy as np

import vibeam
from tests.others.masses import STILL, flown, masses, one_mass, turned
from tests.others.problem import Problem, spoiled
from tests.others.problems.beams_of_manuals import manual
from vibeam import Contact
from vibeam_models.laws.compliant import HuntCrossley, LinearStop

G = 386.0  # in/s², as the manual has it
FLOW = "no time step: flights and contacts by exact flow"
HERE = "tests/others/problems/impacts_of_manuals.py, "
STEPS = "time steps, beside the closed form"
KRATOS = ", as read by KratosMultiphysics/Kratos, applications/DEMApplication/tests/DEM3D_chung_ooi_tests/"
CHUNG_OOI = "Chung & Ooi, Granular Matter 13 (2011) 643–656, figures of "
TOOTH, SLEEVE, SLOPE = 3.2, 18.1, radians(36)  # mass of the sleeve along its shaft, and of its motion across


def ball() -> vibeam.Trajectory:
    """½ lbf s²/in that falls 1 in onto 1973.92 lbf/in; only the weight is spoiled, or its travel would stay."""
    system = one_mass(0.5, force=0.5 * G, gap=1.0, law=LinearStop(1973.92))
    return flown(system, 0.11, 0.0, 0.0)


def met() -> list[float]:
    """Time of impact, velocity and kinetic energy there."""
    path = ball()
    time = path.contacts[0, 0]
    speed = float(path.velocity_at(time, "x"))
    return [time, speed, 0.25 * speed**2]


def touching(time: float) -> float:
    """Displacement while the ball touches the surface, by hand."""
    rate, late = sqrt(1973.92 / 0.5), time - sqrt(2 / G)
    return 1 + G / rate**2 * (1 - cos(rate * late)) + sqrt(2 * G) / rate * sin(rate * late)


def lowest() -> float:
    """Time at which it turns, by hand."""
    rate = sqrt(1973.92 / 0.5)
    return sqrt(2 / G) + (pi / 2 + atan(G / (sqrt(2 * G) * rate))) / rate


def scale() -> list[float]:
    """How far the pan of a scale, and the block, go after 50 lbf have fallen onto it; the spring is spoiled twice."""
    system = masses(
        [25 / G, 50 / G], [[100.0 * spoiled(), 0.0], [0.0, 0.0]], [-1.0, 1.0], [25.0, 50.0], [0.0, 0.0],
        gap=71.75, restitution=0.0,
    )  # fmt: skip
    path = flown(system, 0.75, [0.25, 0.0], [0.0, 0.0])
    time, pan = turned(path, "0", path.rests[0, 0] + 1e-3, path.t_end - 1e-3)
    return [pan, float(path.at(time, "1"))]


def capped() -> float:
    """Turn of ½ lbf s²/in after 10 lbf s on 200 lbf/in whose force stays 150 lbf from 0.75 in on: a stop that parts."""
    system = one_mass(0.5, force=150.0, gap=-0.75, law=LinearStop(200.0 * spoiled()))
    return turned(flown(system, 0.1, 0.0, -20.0), "x", 0.03, 0.099)[1]


def rod(modes: int, length: float, wave: float, mass: float, gap: float, speed: float, end: float):
    """Motion of an elastic rod, free at both ends, along itself onto a wall; outputs its ends and its middle."""
    number = np.arange(modes)
    near = np.where(number == 0, 1.0, sqrt(2.0)) / sqrt(mass)
    rigid = np.eye(1, modes)[0] / sqrt(mass)
    outputs = {"near": near, "far": near * (-1.0) ** number, "middle": rigid}
    system = vibeam.ImpactSystem.from_modes(
        number * pi * wave / length, 0.0, near, 0.0, gap=gap, restitution=0.0, outputs=outputs
    )
    return vibeam.simulate(system, STILL, end, vibeam.State(0 * near, speed * mass * rigid))


def thrown_rod() -> np.ndarray:
    """When a rod meets the wall, when it leaves it, and its mean velocity then: 80 modes and 160, extrapolated."""
    wave, found = sqrt(spoiled() * 3e7 / 0.73e-3), []
    for modes in (80, 160):
        path = rod(modes, 10.0, wave, 0.73e-2, 0.01, 202.2, 2e-4)
        found.append([path.rests[0, 0], path.rests[-1, 1], float(path.velocity_at(2e-4, "middle"))])
    return 2 * np.array(found[1]) - np.array(found[0])


def stopped_bar() -> np.ndarray:
    """Shortening of a bar when the wave has reached its far end, and the mean stress then: extrapolated likewise."""
    wave, found = sqrt(spoiled() * 30e6 / 0.00073), []
    time = 1e4 / sqrt(30e6 / 0.00073)
    for modes in (80, 160):
        path = rod(modes, 1e4, wave, 7.3, 0.0, 100.0, 1.2 * time)
        found.append(float(path.at(time, "far") - path.at(time, "near")))
    shortened = 2 * found[1] - found[0]
    return np.array([shortened, 30e6 * shortened / 1e4])


def sphere(mass: float, stiffness: float, speed: float) -> list[float]:
    """Largest force in kN and duration in µs of an elastic contact by Hertz' law."""
    system = one_mass(mass, force=0.0, gap=0.0, law=HuntCrossley(spoiled() * stiffness, 0.0))
    path = flown(system, 1e-3, -1e-6, speed)
    return [path.contacts[0, 2] / 1e3, path.contacts[0, 1] * 1e6]


def glass_pair() -> list[float]:
    """Two glass spheres of 10 mm radius, 10 m/s each towards the other."""
    half = 4 / 3 * pi * 0.01**3 * 2800 / 2
    return sphere(half, 4 / 3 * 4.8e10 / (2 * (1 - 0.2**2)) * sqrt(0.005), 20.0)


def on_wall() -> list[float]:
    """Aluminium sphere of 100 mm radius onto a rigid wall at 0.2 m/s."""
    return sphere(4 / 3 * pi * 0.1**3 * 2699, 4 / 3 * 7e10 / (1 - 0.3**2) * sqrt(0.1), 0.2)


def gear(forced: bool = True) -> vibeam.ImpactSystem:
    """Sleeve between the walls of two teeth, R = 0.9, meshed at a third contact, R = 0; outputs ``"0"``, ``"1"``."""
    tooth = spoiled() * TOOTH
    scale = 1 / np.sqrt([tooth, SLEEVE])
    static = np.array([70.0, -0.08 / 0.7 * SLEEVE]) * scale if forced else 0.0
    upper, lower = np.array([sin(SLOPE), cos(SLOPE)]) * scale, np.array([sin(SLOPE), -cos(SLOPE)]) * scale
    along = np.array([1.0, 0.0]) * scale
    return vibeam.ImpactSystem.from_modes(
        [0.0, 0.0], 0.0, upper, 0.0, gap=0.0, restitution=0.9, static=static,
        outputs={"0": along, "1": np.array([0.0, 1.0]) * scale},
        further=(Contact(lower, gap=0.0, restitution=0.9), Contact(along, gap=-0.003, restitution=0.0)),
    )  # fmt: skip


def reset() -> list[float]:
    """Velocities after an impact on the upper wall and impulse there, per velocity along the shaft and across it."""
    columns = []
    for before in ([1.0, 0.0], [0.0, 1.0]):
        path = flown(gear(forced=False), 0.03, [-0.0167, 0.003], before)
        later = path.impact_times[0] + 1e-6
        after = np.array([float(path.velocity_at(later, output)) for output in ("0", "1")])
        impulse = np.hypot(*(after - before) * np.array([TOOTH * spoiled(), SLEEVE]))
        columns.append([*after, impulse])
    return [each for pair in zip(*columns, strict=True) for each in pair]


BALL = "Ball that falls onto an elastic surface"
Problem(
    BALL, "time of impact in s, velocity in in/s, kinetic energy in lbf in", manual("vm65", "Thomson, ex. 4.6-1"),
    ("0.07198", "27.79", "193.0"), met, 2.5e-4, "four digits", STEPS, FLOW, HERE + "ball",
)  # fmt: skip
Problem(
    BALL, "the same three as LS-DYNA's manual has them",
    "Ansys, LS-DYNA Verification Manual, VM-LSDYNA-SOLVE-061: the theory's column", ("0.071982", "27.785", "193.00"),
    met, 3e-5, "five digits", "closed form", FLOW, HERE + "ball",
)  # fmt: skip
Problem(
    BALL, "largest displacement in in", manual("vm65", "Thomson, ex. 4.6-1"), ("1.5506",),
    lambda: turned(ball(), "x", 0.08, 0.109)[1], 1e-4, "five digits", STEPS, FLOW, HERE + "ball",
)  # fmt: skip
Problem(
    BALL, "time of the largest displacement in s", manual("vm65", "Thomson, ex. 4.6-1"), ("0.10037",),
    lambda: turned(ball(), "x", 0.08, 0.109)[0], 1e-12, "root of the velocity", STEPS, FLOW, HERE + "ball",
    right=lowest(), reason="closed form: half the spring's period and what the weight adds; theirs leaves 0.07 ms out",
)  # fmt: skip
Problem(
    BALL, "displacement after 0.1 s and 0.101 s in in", manual("vm81", "Thomson, ex. 4.6-1"), ("1.5505", "1.5502"),
    lambda: ball().at([0.1, 0.101], "x"), 1e-12, "closed form", STEPS, FLOW, HERE + "ball",
    right=(touching(0.1), touching(0.101)), reason="closed form; theirs at 0.101 s is 0.0002 in short",
)  # fmt: skip
Problem(
    "Block that falls onto a spring scale", "largest displacement of the pan, and the block's then, in in",
    manual("vm83", "Beer & Johnston, prob. 14.6"), ("7.7", "79.450"), scale, 6e-4, "two digits", STEPS,
    "impact and rest are events of the flow", HERE + "scale",
)  # fmt: skip
Problem(
    "Mass on a spring whose force is bounded", "largest displacement in in after an impulse",
    manual("vm79", "Thomson, fig. 5.6-1"), ("-1.0417",), capped, 4e-5, "five digits", STEPS, FLOW, HERE + "capped",
)  # fmt: skip
Problem(
    "Elastic rod thrown at a wall", "times of impact and of release in s, and velocity after it in in/s",
    manual("vm265", "Carpenter, Taylor & Katona 1991"), ("0.494e-4", "0.148e-3", "-202.2"), thrown_rod, 1.3e-3,
    "three digits", "explicit time steps, beside the wave's solution", "two numbers of modes, extrapolated",
    HERE + "thrown_rod",
)  # fmt: skip
Problem(
    "Moving bar that is stopped", "shortening in in when the wave has passed, and stress in psi",
    manual("vm85", "Timoshenko, Vibration Problems in Engineering, p. 305"), ("4.9329", "14799"), stopped_bar,
    3e-5, "five digits", "time steps, beside the wave's solution", "two numbers of modes, extrapolated",
    HERE + "stopped_bar",
)  # fmt: skip
Problem(
    "Two glass spheres that collide", "largest force in kN, duration in µs",
    CHUNG_OOI + "test 1" + KRATOS + "test1_data/paper_data", ("10.7039", "40.478"), glass_pair, 5e-3,
    "points of a figure", "discrete elements, beside Hertz' theory", "closed form of the contact", HERE + "sphere",
)  # fmt: skip
Problem(
    "Aluminium sphere on a rigid wall", "largest force in kN, duration in µs",
    CHUNG_OOI + "test 2" + KRATOS + "test2_data/paper_data", ("11.357", "727.5"), on_wall, 8e-3,
    "points of a figure", "discrete elements, beside Hertz' theory", "closed form of the contact", HERE + "sphere",
)  # fmt: skip
Problem(
    "Gearbox meshing of ARCH-COMP", "velocities after an impact on the upper wall along and across, and the impulse, "
    "per velocity along and across before it",
    "ARCH-COMP, gearbox GRBX01-MES01 (Chen, Mitra & Tian 2015): hypro/hypro, examples/arch22/aff/GRBX01_MES01.model",
    ("-0.42329949", "-1.959003686", "-0.346343193", "0.52329949", "7.7486775", "10.6651396"), reset, 1e-8,
    "eight digits", "impact of two rigid bodies, by hand", "the corners of their set of starts all mesh after "
    "0.148–0.150 s with 16.7–17.1 N s, inside the bounds 0.2 s and 20 N s that they prove", HERE + "gear",
)  # fmt: skip
