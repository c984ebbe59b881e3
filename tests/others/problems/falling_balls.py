"""Balls that fall, bounce and come to rest: Siconos, FMI, MATLAB and its heirs, scipy."""

from __future__ import annotations

from functools import partial

import numpy as np

from tests.others.problem import EXACT, Problem
from tests.others.systems import boxed, fallen, impacts, on_moving_plane

SICONOS = "Siconos, siconos-tutorials b6c9bfd, examples/mechanics/"
DRIVEN = SICONOS + "BouncingBallEventDriven/"
LSODAR = "event-driven: LSODAR, roots to its tolerance"
STEPPED = "Moreau's time steps of 5 ms"
EXACT_FLIGHT = "flights in closed form, no step"
COMPLETED = "the accumulation of impacts completed to its end, with bounds of what is left"
PETSC = "PETSc, petsc 4f687e3f, src/ts/tutorials/"
EULER = "Euler steps of 10 ms"

falling = partial(
    Problem, problem="ball dropped from 1 m, e = 0.9", method=LSODAR, adds=EXACT_FLIGHT, where="systems.fallen"
)
falling(
    quantity="times of impacts 1 to 4 and 44, s", source=DRIVEN + "BouncingBallED.ref, column 1",
    theirs=("0.4515236409857308", "1.264266194760045", "1.995734493156927", "2.654055961714119", "8.491374025642981"),
    ours=lambda: fallen(9.81, 0.9, 8.5).impact_times[[0, 1, 2, 3, -1]],
    within=1e-12, why="errors of its integrator grow to 6e-13 of the 44th",
)  # fmt: skip
falling(
    quantity="velocities before them, m/s downwards", source=DRIVEN + "BouncingBallED.ref, column 3",
    theirs=("4.429446918070019", "3.986502226263010", "3.587852003636701", "3.229066803273018", "0.04772845842674625"),
    ours=lambda: fallen(9.81, 0.9, 8.5).impact_velocities[[0, 1, 2, 3, -1]],
    within=1e-10, why="they grow to 5e-11 of the last, slow impact; closed form and ours agree to 1e-14",
)  # fmt: skip
falling(
    quantity="the same thrown up at 2 m/s, ball of 0.1 m: velocities after impacts 1 to 4, m/s",
    source=SICONOS + "NewtonEuler/BouncingBallNETS.ref, column 3",
    theirs=("4.203720000000002", "3.765447", "3.3652827", "3.06325557"), method=STEPPED + ", in three dimensions",
    ours=lambda: 0.9 * fallen(9.81, 0.9, 4.0, 0.9, 2.0).impact_velocities[:4],
    within=0.012, why="it goes on to the end of the step before it strikes",
)  # fmt: skip

initial = partial(
    Problem, problem="ball that starts with an impact, e = 0.9", source=DRIVEN + "BouncingBallED-initialImpact.ref",
    method=LSODAR, where="systems.fallen",
)  # fmt: skip
initial(
    quantity="times of impacts 2 to 4, s, and velocities before them, m/s", adds=EXACT_FLIGHT,
    theirs=("0.1834862385321100", "0.3486238532110067", "0.4972477064220083",
            "0.8999999999999998", "0.8099999999999765", "0.7289999999999467"),
    ours=lambda: impacts(fallen(9.81, 0.9, 1.0, 0.0, -1.0), [1, 2, 3]),
    within=1e-12, why="errors of its integrator, 1e-13 after three flights",
)  # fmt: skip
initial(
    quantity="time from which it rests, s", adds=COMPLETED,
    theirs=("1.834860989700292",), right=1.8348623853211009,
    reason="It takes a slow ball for still after 141 impacts, 1.4e-6 s early: the sum of all flights is 2ev/(g(1 − e))",
    ours=lambda: fallen(9.81, 0.9, 2.0, 0.0, -1.0).rests[0, 0], within=EXACT, why="round-off",
)  # fmt: skip

Problem(
    problem="ball without restitution", quantity="time and velocity of its impact, and when it still rests",
    source=DRIVEN + "BouncingBallED-withRestingContact.ref",
    theirs=("0.4515236409857311", "4.429446918070021", "8.499999999999929"),
    right=(0.4515236409857310, 4.429446918070020, 8.5),
    reason="Steps of 5 ms are added up there: its last time is 8.5 less round-off",
    ours=lambda: [*fallen(9.81, 0.0, 8.5).impact_times, *fallen(9.81, 0.0, 8.5).impact_velocities,
                  fallen(9.81, 0.0, 8.5).rests[0, 1]],
    within=EXACT, why="round-off", method=LSODAR, adds="rest proved from the first impact on", where="systems.fallen",
)  # fmt: skip

box = partial(
    Problem, problem="ball between floor and ceiling, e = 0.8", source=DRIVEN + "BouncingBallED-TwoContacts.ref",
    method=LSODAR, where="systems.boxed",
)  # fmt: skip
box(
    quantity="times of impacts 1 to 4, above and below, s, and velocities before them, m/s", adds=EXACT_FLIGHT,
    theirs=("0.05131670194948630", "0.2283187800528825", "0.4665486160195453", "0.7413599657472243",
            "9.486832980505138", "9.359487165438074", "5.105291372683830", "6.832346595423852"),
    ours=lambda: np.abs(impacts(boxed(), [0, 1, 2, 3])), within=1e-12, why="errors of its integrator, 1e-13",
)  # fmt: skip
box(
    quantity="time from which it rests, s", adds=COMPLETED,
    theirs=("6.207236800577394",), right=6.207237242086311,
    reason="It takes a slow ball for still after 80 impacts, 4.4e-7 s early: the sum of all flights, in 40 digits",
    ours=lambda: boxed().rests[0, 0], within=EXACT, why="round-off",
)  # fmt: skip

Problem(
    problem="ball on a moving plane", quantity="times of impacts 1 to 6, s",
    source=SICONOS + "BallOnMovingPlane/BallOnMovingPlane.ref, where column 3 jumps",
    theirs=("0.245", "1.355", "2.28", "3.02", "3.685", "4.34"),
    ours=lambda: on_moving_plane().impact_times[:6], method=STEPPED, adds="the drive's phase exact at every impact",
    within=0.02, why="up to a step late, and its plane 7.5 mm behind", where="systems.on_moving_plane",
)  # fmt: skip

fmi = partial(
    Problem, problem="FMI's bouncing ball, e = 0.7", method=EULER, where="systems.fallen",
    source="FMI Reference FMUs, 1258711, BouncingBall/BouncingBall_out.csv",
)  # fmt: skip
fmi(
    quantity="times of impacts 1 to 4, s, between the rows where v jumps", adds=EXACT_FLIGHT,
    theirs=("0.455", "1.085", "1.535", "1.855"), ours=lambda: fallen(9.81, 0.7, 2.51).impact_times[:4],
    within=0.012, why="a step late at every impact: Euler's; from the 5th on it drifts off",
)  # fmt: skip
fmi(
    quantity="time from which it rests, s", adds=COMPLETED, theirs=("2.61",), right=2.558633965585808,
    reason="The FMU stops the ball where it is slower than 0.1 m/s, and is late by its steps; closed form",
    ours=lambda: fallen(9.81, 0.7, 3.0).rests[0, 0], within=EXACT, why="round-off",
)  # fmt: skip
fmi(
    quantity="first impact, time and velocities before and after",
    source="FMIFlux.jl, ThummeTo/FMIFlux.jl 0e7f555, test/time_solution_gradients.jl",
    theirs=("0.451523640985728", "4.429446918069994", "3.1006128426489954"),
    ours=lambda: impacts(fallen(9.81, 0.7, 0.6), [0, 0]).ravel()[[0, 2, 3]] * [1.0, 1.0, 0.7],
    method="Tsit5 with root finding, in Dymola's FMU",
    within=1e-10, why="the ball is put 1e-10 m above the floor; its root is off by 7e-15", adds=EXACT_FLIGHT,
)  # fmt: skip

thrown = partial(Problem, problem="MATLAB's ballode: 20 m/s up, e = 0.9", adds=EXACT_FLIGHT, where="systems.fallen")
thrown(
    quantity="times of bounces 1 to 10, s", source=PETSC + "output/ex40.out",
    theirs=("4.08", "7.76", "11.06", "14.04", "16.71", "19.12", "21.29", "23.25", "25.00", "26.58"),
    ours=lambda: fallen(9.8, 0.9, 27.0, 0.0, 20.0).impact_times[:10],
    method="Rosenbrock–W steps of at most 0.5 s, root of a step",
    within=1.5e-3, why="printed to 0.01 s",
)  # fmt: skip
thrown(
    quantity="the same to sixteen digits",
    source="Solverz, smallbunnies/Solverz d3acc12, integrator/test_callbacks.py of its tests, LEGACY_BOUNCES",
    theirs=("4.081633047365558", "7.755103268847604", "11.061226369910107", "14.03673684129459",
            "16.714695668619328", "19.124858513456523", "21.294005283692695", "23.246237159791765",
            "25.003245923211466", "26.584554164220997"),
    method="Rodas4, event on its interpolant", ours=lambda: fallen(9.8, 0.9, 27.0, 0.0, 20.0).impact_times[:10],
    within=2e-7, why="its steps at their usual tolerance",
)  # fmt: skip

Problem(
    problem="ball put back to 1 m at every bounce", quantity="times of bounces 1, 2 and 3, s",
    source=PETSC + "ex41.c and output/ex41_a.out, Processor[1]", theirs=("4.13", "7.95", "11.49"),
    ours=lambda: put_back(3), within=1.5e-3, why="printed to 0.01 s", method="Rosenbrock–W steps, root of a step",
    adds=EXACT_FLIGHT, where="this module, put_back",
)  # fmt: skip

Problem(
    problem="Simulink's ball: 15 m/s up from 10 m, κ = 0.8", quantity="time beyond which a simulation is stuck, s",
    source="Simulink, Simulation of a Bouncing Ball (help/simulink/slref/simulation-of-a-bouncing-ball.html)",
    theirs=("20",), ours=lambda: fallen(9.81, 0.8, 25.0, 10.0, 15.0).rests[0, 0],
    within=0.02, why="said in words: nonadaptive zero crossing does not get beyond 20 s",
    method="variable step, zero crossings located one by one", adds=COMPLETED, where="systems.fallen",
)  # fmt: skip

Problem(
    problem="scipy's cannonball", quantity="when it hits the ground, s, and its velocity",
    source="scipy, 1.17.1, documentation of solve_ivp, example of events", theirs=("40.", "-1.00000000e+01"),
    ours=lambda: np.multiply(impacts(fallen(0.5, 0.5, 41.0, 0.0, 10.0), [0]).T, [1.0, -1.0]),
    within=1e-8, why="printed to nine digits",
    method="RK45, root of its interpolant by Brent's method", adds="goes on beyond the impact", where="systems.fallen",
)  # fmt: skip


def put_back(count: int) -> list[float]:
    """Times of the bounces of a ball that goes on from 1 m with 0.9 of its speed."""
    times, height, speed = [0.0], 1.0, 20.0
    for _ in range(count):
        path = fallen(9.8, 0.9, 10.0, height, speed)
        times.append(times[-1] + path.impact_times[0])
        speed = 0.9 * path.impact_velocities[0]
    return times[1:]
