"""Numbers that others have published, each beside what vibeam computes: one row a reference.

Where a reference is off, or is of another model, its row says who is right; what is expected is then the right value.
Files are named by repository and commit; numbers are quoted from them, nothing else. The systems stand in
``systems_of_others``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
import systems_of_others
from numpy.typing import ArrayLike
from systems_of_others import (
    bounces,
    boxed,
    chain,
    chatter,
    coco,
    fallen,
    falling_bar,
    grazing,
    hertzian,
    impact_three_ways,
    impacts,
    modes,
    near_grazing,
    orbit,
    oscillator,
    shaken,
    steel_bar,
    weak_orbit,
)

from vibeam.periodic.bifurcation_functions import Kind

SICONOS = "Siconos, siconos-tutorials b6c9bfd, examples/mechanics/"
DRIVEN = SICONOS + "BouncingBallEventDriven/"
COCO = "COCO, po/examples/impact/demo.m; Dankowicz & Schilder, Recipes for Continuation (SIAM 2013), example 15.2, "
FMI = "FMI Reference FMUs 1258711, BouncingBall/"
BUDD_DUX = "Budd & Dux, Phil. Trans. R. Soc. Lond. A 347 (1994) 365–389: x'' + x = cos ωt, stop at σ, r = 0.8"
LUCK_MEHTA = "Luck & Mehta, Phys. Rev. E 48 (1993) 3988: "
HOLMES = "Holmes, J. Sound Vib. 84 (1982) 173–189, of the same: "
NORDMARK = "Nordmark, J. Sound Vib. 145 (1991) 279–297: "
DOYEN = "Doyen, Ern & Piperno, SIAM J. Sci. Comput. 33 (2011) 223–249, bounces of an elastic bar: "
NLVIB = "NLvib 69598c5, EXAMPLES/03_twoDOFoscillator_unilateralSpring; Krack & Gross, Harmonic Balance (Springer 2019)"
EXACT = 1e-12  # round-off


@dataclass(frozen=True)
class Reference:
    """One number, or several, of others: |found − expected| ≤ within · |expected|, ``why`` within is what it is."""

    name: str
    source: str
    found: Callable[[], ArrayLike]
    expected: ArrayLike
    within: float
    why: str


FIRST = [0, 1, 2, 3]
TABLE = [
    Reference(
        "Siconos' ball: impacts 1 to 4 and 44 of 8.5 s", DRIVEN + "BouncingBallED.ref, columns 1 and 3",
        lambda: impacts(fallen(9.81, 0.9, 8.5), [*FIRST, -1]),
        [[0.4515236409857308, 1.264266194760045, 1.995734493156927, 2.654055961714119, 8.491374025642981],
         [4.429446918070019, 3.98650222626301, 3.587852003636701, 3.229066803273018, 0.04772845842674625]],
        1e-10, "its integrator's errors grow to 5e-11 of the last, slow impact; closed form and vibeam agree to 1e-14",
    ),
    Reference(
        "its end: √(2h/g) (1 + e)/(1 − e)", DRIVEN + "BouncingBallED; closed form",
        lambda: fallen(9.81, 0.9, 9.0).rests[0, 0], 8.578949178728887, EXACT, "round-off",
    ),
    Reference(
        "Siconos' ball that starts with an impact", DRIVEN + "BouncingBallED-initialImpact.ref",
        lambda: impacts(fallen(9.81, 0.9, 1.0, 0.0, -1.0), [1, 2, 3]),
        [[0.18348623853211, 0.3486238532110067, 0.4972477064220083], [0.9, 0.81, 0.729]], 1e-12, "as written there",
    ),
    Reference(
        "its end: Siconos rests from 1.834860989700 s on, 1.4e-6 s early, where it takes the ball for still",
        "closed form 2 e v/(g (1 − e)); " + DRIVEN + "BouncingBallED-initialImpact.ref",
        lambda: fallen(9.81, 0.9, 2.0, 0.0, -1.0).rests[0, 0], 1.8348623853211009, EXACT, "round-off",
    ),
    Reference(
        "Siconos' oscillator pressed on its stop: impacts 1 to 4", DRIVEN + "LinearOscillatorED.ref",
        lambda: impacts(oscillator(), FIRST),
        [[0.004966983943888618, 0.01490088290077536, 0.02483470526778414, 0.03476844253492885],
         [316.2587864392096, 284.6329077952903, 256.1696170157566, 230.5526553141774]],
        1e-12, "1e-14 asked of its integrator, grown over four flights",
    ),
    Reference(
        "and the free mode beside it, 0.001 cos ωt at these impacts", DRIVEN + "LinearOscillatorED.ref, column 9",
        lambda: oscillator().velocity_at(oscillator().impact_times[FIRST], "across"),
        [-0.3162277644955124, 0.3162277502213272, -0.3162277167386608, 0.3162276577795877], 1e-12, "as above",
    ),
    Reference(
        "its end: Siconos takes it for still after 220 impacts at 0.8702795134611794 s, 9.4e-8 s early",
        "40 digits by events.py; " + DRIVEN + "LinearOscillatorED.ref",
        lambda: oscillator().rests[0, 0], 0.8702796077157977, 1e-11, "the tail's remainder, 3e-15 s, and round-off",
    ),
    Reference(
        "Siconos' ball with R = 0: impact, and rest", DRIVEN + "BouncingBallED-withRestingContact.ref",
        lambda: [*fallen(9.81, 0.0, 8.5).rests[0], *fallen(9.81, 0.0, 8.5).impact_velocities],
        [0.4515236409857311, 8.5, 4.429446918070021], EXACT, "round-off",
    ),
    Reference(
        "Siconos' ball in a box: impacts 1 to 4, above and below", DRIVEN + "BouncingBallED-TwoContacts.ref",
        lambda: np.abs(impacts(boxed(), FIRST)),
        [[0.0513167019494863, 0.2283187800528825, 0.4665486160195453, 0.7413599657472243],
         [9.486832980505138, 9.359487165438074, 5.10529137268383, 6.832346595423852]],
        1e-12, "its integrator's 1e-13, grown over four flights",
    ),
    Reference(
        "its end: Siconos rests from 6.207236800577394 s on, 4.4e-7 s early", "40 digits, the sum of all flights",
        lambda: boxed().rests[0, 0], 6.207237242086311, EXACT, "round-off",
    ),
    Reference(
        "FMI's ball: impacts 1 to 11", "closed form; " + FMI + "model.c",
        lambda: fallen(9.81, 0.7, 2.51).impact_times[:11],
        [0.4515236409857309, 1.083656738365754, 1.52614990653177, 1.835895124247982, 2.05271677664933,
         2.204491933330273, 2.310734543006934, 2.385104369780596, 2.43716324852216, 2.473604463641254,
         2.499113314224621],
        EXACT, "round-off",
    ),
    Reference(
        "and as its file has them, by steps of 10 ms", FMI + "BouncingBall_out.csv, where v jumps",
        lambda: fallen(9.81, 0.7, 2.51).impact_times[:4],
        [0.455, 1.085, 1.535, 1.855], 0.012, "a step late at every impact: Euler's; from the 5th on it drifts off",
    ),
    Reference(
        "its end, where the FMU stops it below 0.1 m/s at 2.61 s", "closed form",
        lambda: fallen(9.81, 0.7, 3.0).rests[0, 0], 2.558633965585808, EXACT, "round-off",
    ),
    Reference(
        "MATLAB's ballode: bounces 1, 2, 10 and the end of all", "ballode.m: v = 20, g = 9.8, e = 0.9; closed form",
        lambda: [*fallen(9.8, 0.9, 41.0, 0.0, 20.0).impact_times[[0, 1, 9]],
                 fallen(9.8, 0.9, 41.0, 0.0, 20.0).rests[0, 0]],
        [4.0816326530612245, 7.7551020408163265, 26.584553465306122, 40.816326530612245], EXACT, "round-off",
    ),
    Reference(
        "Simulink's ball: first bounce and the end of all", "Simulink, Simulation of a Bouncing Ball: up from 10 m at "
        "15 m/s, κ = 0.8, g = 9.81, where a simulation is stuck from 20 s on; closed form",
        lambda: [fallen(9.81, 0.8, 25.0, 10.0, 15.0).impact_times[0],
                 fallen(9.81, 0.8, 25.0, 10.0, 15.0).rests[0, 0]],
        [3.6211169879494886, 20.357636989404726], EXACT, "round-off",
    ),
    Reference(
        "COCO's orbit as its demo starts it: phase and v⁺", COCO + "x0",
        lambda: np.multiply(impact_three_ways(coco(), 1.0), [1.0, -0.8]), [[0.076, -1.36]] * 3, 0.003, "two digits",
    ),
    Reference(
        "and as it converges: phase and v⁻", COCO + "its two segments; 30 digits by events.py",
        lambda: impact_three_ways(coco(), 1.0), [[0.07595216, 1.69573294]] * 3, 7e-8, "eight decimals",
    ),
    Reference(
        "its multipliers", COCO + "as above", lambda: orbit(coco(), 1.0, 1.0).multipliers,
        [-0.584295 + 0.005600j, -0.584295 - 0.005600j], 1.2e-6, "six decimals",
    ),
    Reference(
        "COCO's grazing curve: A over ω = 0.4, 0.8, 1, 1.2, √1.99", COCO + "run impact2, fig. 15.6; |1 − ω² + 0.1 i ω|",
        lambda: [grazing(omega) for omega in (0.4, 0.8, 1.0, 1.2, np.sqrt(1.99))],
        [0.840951841665146, 0.368781778291715, 0.1, 0.456070170039655, 1.0], EXACT, "round-off",
    ),
    Reference(
        "Budd & Dux' resonances ω = 2n, σ = 0: V = 4n/((4n² − 1)(1 − r)), one impact in n periods", BUDD_DUX,
        lambda: [orbit(modes(1.0, restitution=0.8), 2.0 * n, 1.0, n).velocity for n in (1, 2, 3)],
        [20 / 3, 8 / 3, 12 / 7], EXACT, "round-off",
    ),
    Reference(
        "and their multipliers, both r", BUDD_DUX + "; trace 2r, determinant r²",
        lambda: [orbit(modes(1.0, restitution=0.8), 2.0 * n, 1.0, n).multipliers for n in (1, 2, 3)],
        [[0.8, 0.8]] * 3, 1e-7, "the root of round-off: they are double",
    ),
    Reference(
        "orbits at ω = 2, σ = 0 and ω = 2.8, σ = 0.1, in closed form, mapped and flown", BUDD_DUX,
        lambda: [[speed for _, speed in impact_three_ways(modes(1.0, gap=gap, restitution=0.8), omega)]
                 for omega, gap in ((2.0, 0.0), (2.8, 0.1))],
        [[20 / 3] * 3, [0.106477937315] * 3], 5e-12, "twelve digits",
    ),
    Reference(
        "periodic chatter, ω = 0.3, σ = 0: release where the force turns, impacts 1 and 2, and rest again",
        BUDD_DUX + "; 30 digits by events.py, phases of a sine",
        chatter, [10.4719755119659775, 21.8743695558458, 23.2952436120532807, 27.5745615154391852],
        1e-11, "the tail's remainder and round-off",
    ),
    Reference(
        "a ball on a shaken table: period n exists from πn(1 − e)/(1 + e) on", HOLMES + "and " + LUCK_MEHTA + "Γ_n",
        lambda: [shaken(e, n, Kind.FOLD) for e in (0.5, 0.8) for n in (1, 2)],
        [1.0471975511966, 2.0943951023932, 0.349065850398866, 0.698131700797732], EXACT, "round-off",
    ),
    Reference(
        "and doubles at √(Γ_n² + (2(1 + e²)/(1 + e)²)²)", LUCK_MEHTA + "the table's height counted. Holmes' "
        "√(Γ_n² + 1) leaves it out: 1.448 instead of 1.527 at e = 0.5",
        lambda: [shaken(e, n, Kind.DOUBLING) for e in (0.5, 0.8) for n in (1, 2)],
        [1.52682370051906, 2.37087721026694, 1.07083646824791, 1.22972828115552], EXACT, "round-off",
    ),
    Reference(
        "so flown: period 1 at 1.50, beyond Holmes' 1.448; period 2 at 1.54", LUCK_MEHTA + "e = 0.5",
        lambda: [bounces(1.50), bounces(1.54)], [1, 2], 0.0, "whole numbers",
    ),
    Reference(
        "Nordmark's root law: v = ω √(2δ − δ²) where the crest lies δ beyond the stop", NORDMARK + "β = 0.05, ω = 0.7",
        lambda: [near_grazing(depth)[0] for depth in (1e-4, 1e-6)],
        [0.00989924744614458, 0.000989949246173762], 1e-9, "round-off of the gap over δ",
    ),
    Reference(
        "half a period later the motion is off by −(1 + R) √2 ω e^{−βT/2} sin(ω_D T/2)/ω_D √δ", NORDMARK + "R = 0.8",
        lambda: near_grazing(1e-8)[1], 1.3879777327219, 1e-3, "the next order, √δ over the motion's size",
    ),
    Reference(
        "an orbit that all but grazes: multiplier (1 + R) ω² e^{−βT} sin(ω_D T)/(ω_D v), product R² e^{−2βT}",
        NORDMARK + "as above", weak_orbit, [0.250297306442566, 0.260830370696095], 1e-4, "v = 5e-6: the next order",
    ),
    Reference(
        "an elastic bar that falls: contacts 1 to 5/3 s and 11/3 to 13/3 s, up again at 16/3 s",
        DOYEN + "L = 10, E = 900, ρ = 1, g = 10, h = 5, exact",
        lambda: 2 * falling_bar(160) - falling_bar(80), [1, 5 / 3, 10 - 10 * (1.7 - 5 / 3), 11 / 3, 13 / 3, 5],
        2e-3, "modes stand for the bar, and the first impact takes S⁻¹v²/2 of it: an error like 1/N, extrapolated "
        "from 80 and 160 modes",
    ),
    Reference(
        "Siconos' steel bar: contact lasts 2L/c, and it leaves as fast as it came", SICONOS + "FEM/ImpactingBar; exact",
        lambda: 2 * np.array(steel_bar(160)) - np.array(steel_bar(80)), [2 / np.sqrt(210e9 / 7800), 1.0],
        2e-3, "as above. Siconos with 100 nodes: 3.84e-4 s by steps of 2e-6 s",
    ),
    Reference(
        "Hertz: a contact lasts 2.943275184 (m²/(k²v))^{1/5}, k 4/5 of the force's factor; 3.218065460 with all of it",
        "Landau & Lifshitz, Theory of Elasticity, §9 problem 1, energy k h^{5/2}/2; Johnson, Contact Mechanics, §11.4",
        lambda: hertzian().contacts[0, 1], 9.97197693019616e-4, 1e-11, "steps of the integrated contact",
    ),
    Reference(
        "NLvib's unilateral spring, Ω = 0.635: ½(max − min) of the driven mass", NLVIB + "; shooting by DOP853, 1e-13",
        lambda: chain(0.635).amplitude[-1], 0.6507391707, 1e-9, "of the shooting",
    ),
    Reference(
        "its doubling at Ω = 0.738783025: period before and after", NLVIB + ", beyond doubling; shooting as above",
        lambda: [chain(0.7380).period[-1], chain(0.7396).period[-1]], [1, 2], 0.0, "whole numbers",
    ),
    Reference(
        "its torus: period 1 at 0.62, none of 16 or fewer at 0.6", NLVIB + ", beyond Neimark–Sacker; shooting: "
        "|μ| = 1 between 0.618 and 0.620",
        lambda: [chain(0.62).period[-1], chain(0.6).period[-1]], [1, 0], 0.0, "whole numbers",
    ),
]  # fmt: skip


@pytest.mark.parametrize("reference", TABLE, ids=lambda reference: reference.name)
def test_reference(reference: Reference) -> None:
    np.testing.assert_allclose(reference.found(), reference.expected, rtol=reference.within, err_msg=reference.source)


@pytest.mark.parametrize("reference", TABLE, ids=lambda reference: reference.name)
def test_a_model_that_is_a_little_wrong_is_found(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frequencies and constant forces larger by thirty times what the row lets pass, by 5 % where it counts."""
    monkeypatch.setattr(systems_of_others, "spoiled", 1 + 30 * reference.within if reference.within else 1.05)
    with pytest.raises((AssertionError, ValueError, IndexError)):
        test_reference(reference)
