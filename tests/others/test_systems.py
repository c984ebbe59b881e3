"""The systems of the book beyond what others print: closed forms, 30 to 40 digits elsewhere, and orbits three ways."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import ArrayLike

from tests.others.bars import extrapolated, steel_bar
from tests.others.problem import EXACT, spoiled, spoiling
from tests.others.problems.yielding_stops import branch
from tests.others.systems import (
    chatter,
    coco,
    fallen,
    grazing,
    hertzian,
    impact_three_ways,
    modes,
    orbit,
    swept,
)


@dataclass(frozen=True)
class Check:
    """One number, or several: |found − expected| ≤ within · |expected|, ``why`` within is what it is."""

    name: str
    source: str
    found: Callable[[], ArrayLike]
    expected: ArrayLike
    within: float
    why: str


BUDD_DUX = "Budd & Dux, Phil. Trans. R. Soc. Lond. A 347 (1994) 365–389: x'' + x = cos ωt, stop at σ, r = 0.8"
BY_EVENTS = "30 digits by tests/independent/events.py"
NLVIB = "NLvib's example 3 by shooting: DOP853, 1e-13"
CHECKS = [
    Check(
        "Siconos' ball, its end: √(2h/g) (1 + e)/(1 − e)", "closed form",
        lambda: fallen(9.81, 0.9, 9.0).rests[0, 0], 8.578949178728887, EXACT, "round-off",
    ),
    Check(
        "FMI's ball: impacts 1 to 11", "closed form",
        lambda: fallen(9.81, 0.7, 2.51).impact_times[:11],
        [0.4515236409857309, 1.083656738365754, 1.52614990653177, 1.835895124247982, 2.05271677664933,
         2.204491933330273, 2.310734543006934, 2.385104369780596, 2.43716324852216, 2.473604463641254,
         2.499113314224621],
        EXACT, "round-off",
    ),
    Check(
        "MATLAB's ballode: bounces 1, 2, 10 and the end of all", "closed form",
        lambda: [*fallen(9.8, 0.9, 41.0, 0.0, 20.0).impact_times[[0, 1, 9]],
                 fallen(9.8, 0.9, 41.0, 0.0, 20.0).rests[0, 0]],
        [4.0816326530612245, 7.7551020408163265, 26.584553465306122, 40.816326530612245], EXACT, "round-off",
    ),
    Check(
        "Simulink's ball: first bounce and the end of all", "closed form",
        lambda: [fallen(9.81, 0.8, 25.0, 10.0, 15.0).impact_times[0],
                 fallen(9.81, 0.8, 25.0, 10.0, 15.0).rests[0, 0]],
        [3.6211169879494886, 20.357636989404726], EXACT, "round-off",
    ),
    Check(
        "COCO's orbit as it converges, three ways: phase and v⁻", BY_EVENTS,
        lambda: impact_three_ways(coco(), 1.0), [[0.07595216, 1.69573294]] * 3, 7e-8, "eight decimals",
    ),
    Check(
        "its multipliers", BY_EVENTS, lambda: orbit(coco(), 1.0, 1.0).multipliers,
        [-0.584295 + 0.005600j, -0.584295 - 0.005600j], 1.2e-6, "six decimals",
    ),
    Check(
        "COCO's grazing curve: A over ω = 0.4, 0.8, 1, 1.2, √1.99", "|1 − ω² + 0.1 i ω|",
        lambda: [grazing(omega) for omega in (0.4, 0.8, 1.0, 1.2, np.sqrt(1.99))],
        [0.840951841665146, 0.368781778291715, 0.1, 0.456070170039655, 1.0], EXACT, "round-off",
    ),
    Check(
        "orbits at ω = 2, σ = 0 and ω = 2.8, σ = 0.1, in closed form, mapped and flown", BUDD_DUX,
        lambda: [[speed for _, speed in impact_three_ways(modes(1.0, gap=gap, restitution=0.8), omega)]
                 for omega, gap in ((2.0, 0.0), (2.8, 0.1))],
        [[20 / 3] * 3, [0.106477937315] * 3], 5e-12, "twelve digits",
    ),
    Check(
        "periodic chatter, ω = 0.3, σ = 0: release where the force turns, impacts 1 and 2, and rest again",
        BUDD_DUX + "; " + BY_EVENTS + ", phases of a sine",
        chatter, [10.4719755119659775, 21.8743695558458, 23.2952436120532807, 27.5745615154391852],
        1e-11, "the tail's remainder and round-off",
    ),
    Check(
        "Siconos' steel bar: first contact, its duration 2L/c, and it leaves as fast as it came", "closed form",
        lambda: extrapolated(steel_bar, 80), [5e-4, 2 / np.sqrt(210e9 / 7800), 1.0], 2e-3,
        "modes stand for the bar: an error like 1/N, extrapolated",
    ),
    Check(
        "Hertz: a contact lasts 2.943275184 (m²/(k²v))^{1/5}, k 4/5 of the force's factor; 3.218065460 with all of it",
        "Landau & Lifshitz, Theory of Elasticity, §9 problem 1, energy k h^{5/2}/2; Johnson, Contact Mechanics, §11.4",
        lambda: hertzian().contacts[0, 1], 9.97197693019616e-4, 1e-11, "steps of the integrated contact",
    ),
    Check(
        "NLvib's unilateral spring, Ω = 0.635: ½(max − min) of the driven mass", NLVIB,
        lambda: swept(0.635).amplitude[-1], 0.6507391707, 1e-9, "of the shooting",
    ),
    Check(
        "its doubling: Ω, found along the branch", NLVIB, lambda: branch(spoiled()).boundaries[0].value, 0.738783025,
        1e-9, "nine digits",
    ),
    Check(
        "period before and after it", NLVIB, lambda: [swept(0.7380).period[-1], swept(0.7396).period[-1]], [1, 2], 0.0,
        "whole numbers",
    ),
    Check(
        "its torus: period 1 at 0.62, none of 16 or fewer at 0.6", NLVIB + ": |μ| = 1 between 0.618 and 0.620",
        lambda: [swept(0.62).period[-1], swept(0.6).period[-1]], [1, 0], 0.0, "whole numbers",
    ),
]  # fmt: skip
ALL = pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.name)


@ALL
def test_numbers_beside_those_of_elsewhere(check: Check) -> None:
    np.testing.assert_allclose(check.found(), check.expected, rtol=check.within, err_msg=check.source)


@ALL
def test_a_model_that_is_a_little_wrong_is_found(check: Check) -> None:
    """Frequencies and constant forces larger by thirty times what the check lets pass, by 5 % where it counts."""
    wrong = 1 + 30 * check.within if check.within else 1.05
    with spoiling(wrong), pytest.raises((AssertionError, ValueError, IndexError)):
        test_numbers_beside_those_of_elsewhere(check)
