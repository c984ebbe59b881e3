"""Balls in a row, several contacts at once: Newton's cradle, tapered chains and columns of Siconos' examples."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

import vibeam
from tests.others.problem import EXACT, Problem, spoiled
from tests.others.systems import STILL
from vibeam_models.arrays import Array
from vibeam_models.laws.compliant import Hertz

SICONOS = "Siconos, siconos-tutorials b6c9bfd, examples/mechanics/"
STEEL, DENSITY, POISSON = 203e9, 7780.0, 0.3
TOUCHING = 1e-15  # m between balls that touch
IMPULSES = "steps of impulse of 1e-6 N s through Hertz' law (LZB model)"


def between(count: int, lower: int, upper: int | None, masses: Array) -> Array:
    """Row on mass-normalised displacements of how far ball ``lower`` has come nearer to ``upper``, or to a wall."""
    row = np.zeros(count)
    row[lower] = 1 / np.sqrt(masses[lower])
    if upper is not None:
        row[upper] = -1 / np.sqrt(masses[upper])
    return row


def cradle(radii: Array, gaps: Sequence[float], end: float) -> tuple[vibeam.Trajectory, Array]:
    """Balls of steel in a row, the first at 1 m/s; its motion, and the balls' velocities at the end. No weight."""
    count = len(radii)
    masses = 4 / 3 * np.pi * radii**3 * DENSITY
    masses[-1] *= spoiled()
    pairs = radii[:-1] * radii[1:] / (radii[:-1] + radii[1:])
    laws = [Hertz(2 / 3 * STEEL / (1 - POISSON**2) * np.sqrt(each)) for each in pairs]
    rows = [between(count, k, k + 1, masses) for k in range(count - 1)]
    system = vibeam.ImpactSystem.from_modes(
        np.zeros(count), 0.0, rows[0], 0.0, gap=gaps[0], law=laws[0],
        further=[vibeam.Contact(*each) for each in zip(rows[1:], gaps[1:], [1.0] * 9, laws[1:], strict=False)],
    )  # fmt: skip
    thrown = np.zeros(count)
    thrown[0] = np.sqrt(masses[0])
    path = vibeam.simulate(system, STILL, end, vibeam.State(np.zeros(count), thrown))
    return path, path.state.velocity / np.sqrt(masses)


def alike() -> Array:
    """Velocities after the impact of ten balls alike."""
    return cradle(np.full(10, 0.01), [0.2] + [TOUCHING] * 8, 0.202)[1]


def tapered() -> Array:
    """Velocities after eight impacts of a chain whose distances are all made of the last pair's radii."""
    radii = 0.01 * 0.95 ** np.arange(1, 11)
    opened = radii[:-1] + radii[1:] - radii[-2] - radii[-1]
    return cradle(radii, [0.2 + opened[0], *opened[1:-1], TOUCHING], 0.2255)[1]


def column() -> vibeam.Trajectory:
    """Ten beads one on the other that fall 5 cm onto a floor; every contact rigid, without loss."""
    rows = [between(10, 0, None, np.ones(10)), *(between(10, k + 1, k, np.ones(10)) for k in range(9))]
    system = vibeam.ImpactSystem.from_modes(
        np.zeros(10), 0.0, rows[0], 0.0, gap=0.05, restitution=1.0, static=9.81 * spoiled() * np.ones(10),
        further=[vibeam.Contact(row, 0.0, 1.0) for row in rows[1:]],
    )  # fmt: skip
    return vibeam.simulate(system, STILL, 0.493, vibeam.State(np.zeros(10), np.zeros(10)))


def two_balls() -> vibeam.Trajectory:
    """Balls of 1 and 2 kg, 1 mm apart, that fall 10 cm onto a floor, e = 0.95 in both contacts."""
    masses = np.array([1.0, 2.0])
    rows = [between(2, 0, None, masses), between(2, 1, 0, masses)]
    system = vibeam.ImpactSystem.from_modes(
        np.zeros(2), 0.0, rows[0], 0.0, gap=0.1, restitution=0.95, static=9.81 * spoiled() * np.sqrt(masses),
        further=[vibeam.Contact(rows[1], 0.001, 0.95)],
    )  # fmt: skip
    return vibeam.simulate(system, STILL, 0.4, vibeam.State(np.zeros(2), np.zeros(2)))


Problem(
    problem="Newton's cradle: one ball strikes nine that touch", quantity="velocities of the ten after it, m/s",
    source=SICONOS + "ChainOfBalls/MonodisperseChainOfBalls-LZBModel.ref",
    theirs=("-7.105929287758861e-02", "-3.018624045788600e-02", "-1.574960308766378e-02", "-8.808055289868551e-03",
            "-5.062343781337067e-03", "-2.936631945849190e-03", "-1.701856524055756e-03", "2.624517363818925e-03",
            "1.469233855937676e-01", "9.859561210066624e-01"),
    right=(-0.071085017087, -0.030273789364, -0.015833397158, -0.008885695173, -0.005126583160, -0.002985978200,
           -0.001737668412, 0.002671954935, 0.147390307223, 0.985865866395),
    reason="Its steps of impulse are of the first order, 5e-4 m/s off: DOP853 at 1e-12 through all contacts",
    ours=alike, within=1e-9, why="DOP853's own error", of_largest=True, method=IMPULSES,
    adds="all contacts integrated together to 1e-12 a step", where="this module, alike",
)  # fmt: skip
Problem(
    problem="tapered chain of ten balls", quantity="velocities of the ten after the eighth impact, m/s",
    source=SICONOS + "ChainOfBalls/TaperedChainOfBalls-LZBModel.ref, whose contacts share the last pair's distance",
    theirs=("7.676269071206830e-02", "8.265237790760398e-02", "8.900113354869617e-02", "9.585636876987272e-02",
            "1.031917952912466e-01", "1.111649028910818e-01", "1.196559111517553e-01", "-3.197645723630399e-03",
            "3.072412347403246e-01", "1.929832773819256e+00"),
    ours=tapered, within=4e-4, why="its steps of impulse, of the first order", of_largest=True, method=IMPULSES,
    adds="seven impacts of pairs and one of three, each integrated to 1e-12 a step", where="this module, tapered",
)  # fmt: skip

beads = partial(
    Problem, problem="column of ten beads on a floor, without loss", where="this module, column",
    source=SICONOS + "ColumnOfBeads/BeadColumnED_NewtonLaw.ref",
    method="event-driven: LSODAR, one complementarity problem of all ten contacts",
    adds="55 impacts in one instant, contact by contact",
)  # fmt: skip
beads(
    quantity="times at which it strikes, s", theirs=("1.009637554692305e-01", "3.028912664076932e-01"),
    ours=lambda: [column().impact_times[0], column().impact_times[60]], within=1e-12, why="its integrator, 1e-13",
)  # fmt: skip
beads(
    quantity="velocity of the first, sixth and last bead after the first strike, and of the first at 0.493 s, m/s",
    theirs=("9.904544411531649e-01", "9.904544411531530e-01", "9.904544411531565e-01", "-8.745122353873587e-01"),
    ours=lambda: [*-column().modes_at(0.1009637554693)[1, [0, 5, 9]], -column().state.velocity[0]],
    within=2e-12, why="read 7e-14 s after it, at 9.81 m/s²",
)  # fmt: skip
Problem(
    problem="two balls, the lower struck from both sides", quantity="first five times of the lower on the floor, s",
    source=SICONOS + "TwoBouncingBalls/TwoBouncingBallTS-MoreauJeanGOSI.ref, where column 3 jumps",
    theirs=("0.143", "0.145", "0.153", "0.202", "0.248"),
    right=(0.14278431229270645, 0.14336910754202962, 0.1475756031584091, 0.18553645357707174, 0.22159926147480125),
    reason="Four impacts follow in 0.9 ms, less than its step of 1 ms: parabolas and both laws of impact, in 30 digits",
    ours=lambda: two_balls().impact_times[two_balls().impact_contacts == 0][:5], within=EXACT, why="round-off",
    method="Moreau's time steps of 1 ms", adds="the order of impacts 0.2 ms apart", where="this module, two_balls",
)  # fmt: skip
