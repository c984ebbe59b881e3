"""Validation cases of code_aster with one mass and a stop: SDND101, 102, 108, 121 and 122; those not modelled, why."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import acos, pi, sqrt
from pathlib import Path

import numpy as np

import vibeam
from tests.others.problem import Problem, spoiled
from tests.others.systems import certified, modes, motion
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import LinearStop

ASTEST = "code_aster, ehmoussi/code_aster 34161d79, astest/"
CASES = Path(__file__).parents[3] / "cases" / "code_aster"
CENTRAL = "closed form; beside it central differences"
TIMES = [line.split(",") for line in Path(__file__).with_name("sdnd121.csv").read_text("utf-8").splitlines()[1:]]
NOT_MODELLED = (  # name, what it has, why it is no row
    ("SDND100", "Coulomb's friction of a mass that slides", "vibeam has no friction"),
    ("SDND103", "a spring of soil whose force grows with the square, both ways", "no stop, and no such spring"),
    ("SDND104", "Coulomb's friction under an earthquake", "vibeam has no friction"),
    ("SDND105", "a stop that buckles and is crushed", "a stop keeps no memory"),
    ("SDND106", "Coulomb's friction of one of two masses", "vibeam has no friction"),
    ("SDND107", "a generalised Zener element", "no stop; a damper in series with a spring has a state of its own"),
    ("SDND109", "a stop that is damaged (DIS_CHOC_ENDO)", "a stop keeps no memory"),
    ("SDND120", "an anti-seismic device", "a force of the velocity's power and of its own past"),
    ("SDND123", "two masses, a stop on both sides of one, as a nonlinear mode", "its stop is smoothed by 0.5 % of "
     "the gap; the energy printed is below that of a touch"),
    ("SDND124", "a plastic spring", "a stop keeps no memory"),
    ("SDND125", "three masses in a row", "the damping of its contacts is chosen by the program and not printed"),
)  # fmt: skip


def path_of(name: str) -> vibeam.Trajectory:
    """The motion of a case of ``cases/code_aster``, as its one fidelity moves."""
    case = vibeam.load(CASES / f"{name}.toml")
    (fidelity,) = case.fidelities
    own = case.system(fidelity)
    own = replace(own, omega=own.omega * spoiled())
    return certified(own, case.input(fidelity), case.record.duration, case.start(fidelity))


def thrown() -> list[float]:
    """SDND101: force, instants of both peaks, duration and impulse of a contact, second speed at the stop."""
    path = path_of("sdnd101")
    begins, durations, forces = path.contacts.T
    impulse = 2 * forces[0] * durations[0] / pi  # half a turn of a sine
    return [forces[0], *(begins + durations / 2), durations[0], impulse, -path.impact_velocities[1]]


def half_turns() -> list[float]:
    """SDND101 in closed form: in contact half a turn at √((k + K)/m), in flight half a turn at √(k/m)."""
    mass, spring, stop = 100.0, 1e4, 1e6
    pushed, free = sqrt((spring + stop) / mass), sqrt(spring / mass)
    touch = pi / pushed
    return [stop / pushed, touch / 2, touch * 1.5 + pi / free, touch, 2 * stop / pushed**2, -1.0]


def on_surface(damping: float, times: tuple[float, ...]) -> list[float]:
    """SDND108: heights of 1 kg thrown down at 1 m/s, 2 m above a surface of 100 N/m."""
    law = LinearStop(100.0 * spoiled(), damping)
    path = motion(modes(0.0, static=10.0, law=law), 1.2, -2.0, 1.0)
    return [-2.0 - float(path.at(time)) for time in times]


def contacts() -> Array:
    """SDND121: begins and ends of contacts in 4 s, in turn; 156 kg, 2 MN/m, a stop of 10 GN/m at 1 mm, 3 kN at 5 Hz."""
    mass, rate = 156.0, 10 * pi
    system = modes(
        sqrt(2e6 / mass), 0.0, 1 / sqrt(mass), 1 / sqrt(mass), gap=1e-3, law=LinearStop(1e10 * spoiled() ** 2)
    )
    path = certified(system, vibeam.Drive(rate, 3e3 / rate**2), 4.0, vibeam.State([0.0], [0.0]))
    return np.sort(np.concatenate([path.contacts[:, 0], path.contacts[:, 0] + path.contacts[:, 1]]))


def free_frequency(energy: float) -> float:
    """SDND122: frequency of free vibration of 1 kg on 10 N/m with a stop of 50 N/m at 1 cm, with so much energy."""
    system = modes(sqrt(10.0), gap=0.01, law=LinearStop(50.0 * spoiled() ** 2))
    path = motion(system, 5.0, 0.01, sqrt(2 * energy - 10.0 * 0.01**2))
    return float(1 / np.diff(path.contacts[:2, 0])[0])


def by_hand(energy: float, left_out: float = 0.0) -> float:
    """The same in closed form; ``left_out`` is what the formula of sdnd122a.comm leaves out."""
    ratio, size = 50.0 / 10.0, 2 * energy / (10.0 * 0.01**2)
    pushed = acos(1 / sqrt(size * (1 + ratio) - ratio + left_out)) / sqrt(1 + ratio)
    return sqrt(10.0) / (2 * acos(-1 / sqrt(size)) + 2 * pushed)


Problem(
    problem="SDND101: mass thrown on an elastic stop",
    quantity="force, N; instants of both peaks, duration of a contact, s; impulse, N s; second speed, m/s",
    source=ASTEST + "sdnd101a.comm, V5.01.101", theirs=("9950.0", "0.01563", "0.361", "0.03126", "198.05", "-1.0"),
    right=half_turns(), reason="Of the impulse, 2mvK/(k + K) = 198.02, 198.05 is printed; in closed form",
    ours=thrown, within=1e-12, why="round-off", method=CENTRAL + " of 0.5 ms",
    adds="certificate: no other contact", where="cases/code_aster/sdnd101.toml",
)  # fmt: skip
Problem(
    problem="SDND102: shaken mass against a wall",
    quantity="its place after 0.05, 0.156, 0.25, 0.4, 0.5, 0.8, 0.9 and 1 s, m",
    source=ASTEST + "sdnd102a.comm, VALE_CALC of NO2_DX_A",
    theirs=("-3.58082e-4", "-1.22321e-4", "-1.8876e-4", "-1.89772e-4", "-6.84454e-5", "-1.11982e-4", "-1.20103e-4",
            "-1.07178e-4"),
    ours=lambda: path_of("sdnd102_wall").at(np.array([0.05, 0.156, 0.25, 0.4, 0.5, 0.8, 0.9, 1.0]), "sensor"),
    within=6e-3, of_largest=True, why="its steps: the same scheme elsewhere prints its digits to 1e-8 m "
    "(tests/independent/test_code_aster.py)", method="central differences of 0.25 ms",
    adds="certificate: ten contacts and no other", where="cases/code_aster/sdnd102_wall.toml",
)  # fmt: skip

surface = partial(Problem, method="closed form; beside it HHT steps of 1 to 5 ms", where="this module, on_surface")
surface(
    problem="SDND108: mass that falls on an elastic surface", source=ASTEST + "sdnd108a.comm, V5.01.108",
    quantity="heights at 0.54031242374329 s, where it meets it, 0.88545615307643 s, where it leaves, 1 and 1.1 s, m",
    theirs=("-2.00000", "-2.00000", "-1.332162981855", "-0.856394405035"),
    ours=lambda: on_surface(0.0, (0.54031242374329, 0.88545615307643, 1.0, 1.1)),
    within=1e-12, why="twelve digits", adds="flights and contact in closed form",
)  # fmt: skip
surface(
    problem="SDND108: mass that falls on a damped surface", source=ASTEST + "sdnd108b.comm, V5.01.108",
    quantity="heights at 0.54031242374 s, where it meets it, 1 and 1.1 s, m",
    theirs=("-2.00000", "-1.88214079833", "-1.81496422497"), right=(-2.0, -1.85110843259, -1.75180452060),
    reason="It lets the damper pull for the last 58 ms, until 0.92403882542 s; here a stop only pushes, and the mass "
    "leaves at 0.86570 s: closed form",
    ours=lambda: on_surface(5.0, (0.54031242374, 1.0, 1.1)), within=2e-11, why="eleven digits",
    adds="no adhesion",
)  # fmt: skip
Problem(
    problem="SDND121: shoe driven against a stiff stop", quantity="times at which 70 contacts begin and end, s",
    source=ASTEST + "sdnd121a.py, F_linst: 'quasi-analytical, to 1e-9 s'",
    theirs=tuple(np.concatenate(TIMES).tolist()), ours=contacts, within=1.3e-10, of_largest=True, why="nine decimals",
    method="closed forms between contacts, their ends to 1e-9 s",
    adds="in 2 ms of CPU time; certificate", where="this module, contacts",
)  # fmt: skip
ENERGIES = (0.00650108331626, 0.00658129654238, 0.00647656819016)
Problem(
    problem="SDND122: nonlinear mode of a mass with a stop", source=ASTEST + "sdnd122a.comm, b, c: fs at es",
    quantity="frequency of free vibration at 6.501, 6.581 and 6.477 mJ, Hz",
    theirs=("0.6467033", "0.64708839499999993", "0.64658517"), right=tuple(map(by_hand, ENERGIES)),
    reason="Its stop is smoothed over 50 µm, 0.5 % of the gap. The formula beside it has 2ẽ(1 + κ), κ = 5, where "
    "2ẽ(1 + κ) − κ belongs, and gives 0.6462170, 0.6466080 and 0.6460960; by the right one, in closed form",
    ours=lambda: [free_frequency(each) for each in ENERGIES], within=1e-12, why="round-off",
    method="harmonic balance, 200 harmonics, continuation by power series", adds="the corner of the force as it is",
    where="this module, free_frequency",
)  # fmt: skip
