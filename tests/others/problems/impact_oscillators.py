"""Oscillators and shaken balls that strike a stop: Siconos, COCO, Budd and Dux, Nordmark, Luck and Mehta, Holmes."""

from __future__ import annotations

from functools import partial

import numpy as np

import vibeam
from tests.others.problem import EXACT, Problem
from tests.others.systems import (
    bounces,
    cam_follower,
    coco,
    impact_three_ways,
    impacts,
    modes,
    near_grazing,
    orbit,
    oscillator,
    shaken,
    weak_orbit,
)
from vibeam.periodic.bifurcation_functions import Kind

SICONOS = "Siconos, siconos-tutorials b6c9bfd, examples/mechanics/"
EXACT_FLIGHT = "flights in closed form, no step"
BY_HAND = "closed form"
CLOSED = "closed form of any number of modes, flown beside it"
BUDD_DUX = "Budd & Dux, Phil. Trans. R. Soc. Lond. A 347 (1994) 365–389"
LUCK_MEHTA = "Luck & Mehta, Phys. Rev. E 48 (1993) 3988"
NORDMARK = "Nordmark, J. Sound Vib. 145 (1991) 279–297"

pressed = partial(
    Problem, problem="oscillator pressed on its stop, e = 0.9", method="event-driven: LSODAR with 1e-14",
    source=SICONOS + "BouncingBallEventDriven/LinearOscillatorED.ref", where="systems.oscillator",
)  # fmt: skip
pressed(
    quantity="times of impacts 1 to 4, s, and velocities before them, m/s",
    theirs=("0.004966983943888618", "0.01490088290077536", "0.02483470526778414", "0.03476844253492885",
            "316.2587864392096", "284.6329077952903", "256.1696170157566", "230.5526553141767"),
    ours=lambda: impacts(oscillator(), [0, 1, 2, 3]), within=1e-12, why="1e-14, grown over four flights",
    adds=EXACT_FLIGHT,
)  # fmt: skip
pressed(
    quantity="velocity of the free mode beside it at these impacts, m/s", adds=EXACT_FLIGHT,
    theirs=("-0.3162277644955124", "0.3162277502213272", "-0.3162277167386608", "0.3162276577795877"),
    ours=lambda: oscillator().velocity_at(oscillator().impact_times[[0, 1, 2, 3]], "across"),
    within=1e-12, why="as above",
)  # fmt: skip
pressed(
    quantity="time from which it rests, s", theirs=("0.8702795134611794",), right=0.8702796077157977,
    reason="It takes a slow mass for still after 220 impacts, 9.4e-8 s early: 40 digits by tests/independent/events.py",
    ours=lambda: oscillator().rests[0, 0], within=1e-11, why="the tail's remainder, 3e-15 s, and round-off",
    adds="the accumulation of impacts completed to its end, with bounds of what is left",
)  # fmt: skip

follower = partial(
    Problem, problem="Siconos' cam follower, whose cam its plugin leaves out", where="systems.cam_follower",
    source=SICONOS + "CamFollower/CamFollower-Rheonomous.ref", method="Moreau's time steps of 0.1 ms",
    adds=EXACT_FLIGHT,
)  # fmt: skip
follower(
    quantity="times of impacts 1 to 5, s", theirs=("0.0468", "0.1386", "0.2304", "0.3222", "0.4140"),
    ours=lambda: cam_follower().impact_times[:5], within=1.4e-3, why="a step late, at the end of a step",
)  # fmt: skip
follower(
    quantity="velocities before them, m/s downwards",
    theirs=("13.69860822424177", "10.95888717858685", "8.767106659951823", "7.013686423900424", "5.610946453598157"),
    ours=lambda: cam_follower().impact_velocities[:5], within=2e-6, why="its steps, on the crest of the speed",
)  # fmt: skip

start = partial(
    Problem, problem="COCO's impact oscillator", where="systems.coco",
    source="COCO, po/examples/impact/demo.m; Dankowicz & Schilder, Recipes for Continuation (SIAM 2013), example 15.2",
    method="ode45 near the orbit; then collocation, 10 intervals of degree 4",
)  # fmt: skip
start(
    quantity="phase at the impact of the orbit that its demo starts from, and velocity after it",
    theirs=("0.076", "-1.36"), ours=lambda: np.multiply(impact_three_ways(coco(), 1.0)[0], [1.0, -0.8]),
    within=0.003, why="two digits and a half",
    adds="closed form, mapping and flight agree to eight decimals: 0.07595216, 1.69573294 before it",
)  # fmt: skip
start(
    quantity="state of the orbit at phase −π", theirs=("-0.98", "-0.29"), ours=lambda: coco_at_minus_pi(),
    within=0.02, why="two digits", adds="the orbit's history in closed form",
)  # fmt: skip

budd_dux = partial(
    Problem, problem="Budd and Dux' oscillator, x'' + x = cos ωt, r = 0.8", adds=CLOSED, where="systems.orbit"
)
budd_dux(
    quantity="number of motions with one impact in two periods, ω = 3.7: σ = 0, 0.2, −0.06, 0.4",
    source="F. Dux, FelixDux/impact-oscillator f418819, apps/imposc/test/parametric/one_n_params_test.exs",
    theirs=("1", "2", "0", "0"), ours=lambda: [with_one_impact(sigma) for sigma in (0.0, 0.2, -0.06, 0.4)],
    within=0.0, why="whole numbers", method="formulas of the ellipse of velocities, in tests of his program",
)  # fmt: skip
budd_dux(
    quantity="resonances ω = 2n, σ = 0: velocity of the motion with one impact in n periods, n = 1, 2, 3",
    source=BUDD_DUX, theirs=("6.66666666667", "2.66666666667", "1.71428571429"), formula="4n/((4n² − 1)(1 − r))",
    ours=lambda: [orbit(modes(1.0, restitution=0.8), 2.0 * n, 1.0, n).velocity for n in (1, 2, 3)],
    within=3e-12, why="twelve digits of the formula", method=BY_HAND,
)  # fmt: skip
budd_dux(
    quantity="their multipliers, both: real part and what is left of an imaginary one", source=BUDD_DUX,
    theirs=("0.8",) * 6, formula="r, of trace 2r, determinant r²", ours=lambda: doubled_multipliers(),
    within=1e-7, why="the root of round-off: they are double", method=BY_HAND,
)  # fmt: skip

table = partial(Problem, problem="ball on a shaken table", method=BY_HAND, where="systems.shaken, systems.bounces")
table(
    quantity="acceleration over g from which period n exists: e = 0.5, n = 1, 2; e = 0.8, n = 1, 2",
    source=LUCK_MEHTA + "; Holmes, J. Sound Vib. 84 (1982) 173–189", formula="Γ_n = πn(1 − e)/(1 + e)",
    theirs=("1.0471975511966", "2.0943951023932", "0.349065850398866", "0.698131700797732"),
    ours=lambda: [shaken(e, n, Kind.FOLD) for e in (0.5, 0.8) for n in (1, 2)],
    within=EXACT, why="round-off", adds="boundaries as roots, for any number of modes",
)  # fmt: skip
table(
    quantity="and at which it doubles, the table's height counted", source=LUCK_MEHTA,
    formula="√(Γ_n² + (2(1 + e²)/(1 + e)²)²)",
    theirs=("1.52682370051906", "2.37087721026694", "1.07083646824791", "1.22972828115552"),
    ours=lambda: [shaken(e, n, Kind.DOUBLING) for e in (0.5, 0.8) for n in (1, 2)],
    within=EXACT, why="round-off", adds="boundaries as roots, for any number of modes",
)  # fmt: skip
table(
    quantity="and at which it doubles, the table's height left out: e = 0.5, n = 1",
    source="Holmes, J. Sound Vib. 84 (1982) 173–189", formula="√(Γ_n² + 1)", theirs=("1.448",), right=1.52682370051906,
    reason="The ball's flight is taken from the same height at all phases; Luck and Mehta count it, and 1.50 is flown "
    "with period 1",
    ours=lambda: shaken(0.5, 1, Kind.DOUBLING), within=EXACT, why="round-off", adds="the table's height",
)  # fmt: skip
table(
    quantity="periods after which the motion repeats at 1.50 and at 1.54, e = 0.5", source=LUCK_MEHTA,
    formula="before and beyond the doubling", theirs=("1", "2"), ours=lambda: [bounces(1.50), bounces(1.54)],
    within=0.0, why="whole numbers", adds="flown, 500 periods and 32",
)  # fmt: skip

root = partial(
    Problem, problem="Nordmark's oscillator near grazing, β = 0.05, ω = 0.7, R = 0.8", source=NORDMARK,
    method=BY_HAND, where="systems.near_grazing, systems.weak_orbit", adds="flown, and as orbits, at any depth",
)  # fmt: skip
root(
    quantity="velocity where the crest lies δ = 1e-4, 1e-6 beyond the stop", formula="ω √(2δ − δ²)",
    theirs=("0.00989924744614458", "0.000989949246173762"),
    ours=lambda: [near_grazing(depth)[0] for depth in (1e-4, 1e-6)], within=1e-9, why="round-off of the gap over δ",
)  # fmt: skip
root(
    quantity="what that impact changes half a period later, over √δ", formula="(1 + R) √2 ω e^{−βT/2} sin(ω_D T/2)/ω_D",
    theirs=("1.3879777327219",), ours=lambda: near_grazing(1e-8)[1],
    within=1e-3, why="the next order, √δ over the motion's size",
)  # fmt: skip
root(
    quantity="an orbit that all but grazes: multiplier times velocity, product of both multipliers",
    formula="(1 + R) ω² e^{−βT} sin(ω_D T)/ω_D, R² e^{−2βT}", theirs=("0.250297306442566", "0.260830370696095"),
    ours=weak_orbit, within=1e-4, why="v = 5e-6: the next order",
)  # fmt: skip


def with_one_impact(sigma: float) -> int:
    """Motions with one impact in two periods at ω = 3.7 in which no other impact intervenes."""
    found = vibeam.orbits(modes(1.0, gap=sigma, restitution=0.8), vibeam.Drive(3.7, 3.7**-2), 2)
    return sum(each.admissible for each in found)


def doubled_multipliers() -> list[float]:
    """Real part and size of the imaginary part, added, of the multipliers at the resonances ω = 2, 4, 6."""
    found = [orbit(modes(1.0, restitution=0.8), 2.0 * n, 1.0, n).multipliers for n in (1, 2, 3)]
    return [each.real + abs(each.imag) for each in np.concatenate(found)]


def coco_at_minus_pi() -> list[float]:
    """Displacement and velocity of COCO's orbit where the phase of its force cos ωt is −π: sin ωt is −1."""
    path = orbit(coco(), 1.0, 1.0).path()
    time = path.t_start + (1.5 * np.pi - path.t_start) % (2 * np.pi)
    return [float(path.at(time)), float(path.velocity_at(time, "contact"))]
