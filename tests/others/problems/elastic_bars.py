"""Elastic bars that strike with an end: Siconos, code_aster, Doyen's bar."""

from __future__ import annotations

from tests.others.bars import bar_on_wall, extrapolated, falling_bar, steel_bar, two_bars
from tests.others.problem import Problem

ASTER = "code_aster, ehmoussi/code_aster 34161d79, astest/"
LIMIT = "modes and a contact without restitution, extrapolated to infinitely many modes"

Problem(
    problem="steel bar on a rigid floor", quantity="first and last time with a reaction, s",
    source="Siconos, siconos-tutorials b6c9bfd, examples/mechanics/FEM/ImpactingBar/ImpactingBar.ref, columns 1 and 4",
    theirs=("5.040100000000000e-04", "8.860100000000000e-04"),
    ours=lambda: [extrapolated(steel_bar)[0], sum(extrapolated(steel_bar)[:2])],
    within=0.009, why="two of its steps of 2 µs", method="100 linear elements, Moreau's time steps of 2 µs",
    adds=LIMIT, where="bars.steel_bar",
)  # fmt: skip

Problem(
    problem="SDNV100: bar on a rigid wall at 100 m/s",
    quantity="place of the struck end after 20 and 100 µs, of the other after 20 and 40 µs, m; velocity after it, m/s",
    source=ASTER + "sdnv100a.com1", theirs=("-2.0E-3", "-2.E-3", "-2.0E-3", "-4.0E-3", "100.0"),
    ours=lambda: extrapolated(bar_on_wall), within=2e-4, why="what the extrapolation leaves",
    method="characteristics of the wave equation; beside them solid elements, Newmark", adds=LIMIT,
    where="bars.bar_on_wall",
)  # fmt: skip

Problem(
    problem="SDNL111: bar on a clamped bar", quantity="place of the struck end after 0.2, 0.4, 0.6, 0.8 and 1 ms, m",
    source=ASTER + "sdnl111a.comm, V5.02.111", theirs=("-1.E-4", "-2.0E-4", "-1.E-4", "-1.0E-09", "2.0E-4"),
    right=(-1e-4, -1.94968353e-4, -9.49683532e-5, 1.00632937e-5, 2.10063294e-4),
    reason="It takes L/c as 0.2 ms; of E = 200 GPa and 7800 kg/m³ it is 0.1975 ms. Its own run prints −1.937e-4, "
    "−0.956e-4, 0.080e-4 and 2.062e-4",
    ours=lambda: extrapolated(two_bars), within=2e-4, why="what the extrapolation leaves", of_largest=True,
    method="characteristics of the wave equation; beside them 40 modes, central differences of 1 µs", adds=LIMIT,
    where="bars.two_bars",
)  # fmt: skip

Problem(
    problem="Doyen's bar: bounces of an elastic bar",
    quantity="first contact, its end, speed of its centre at 1.7 s, second contact, its end, height at 16/3 s",
    source="Doyen, Ern & Piperno, SIAM J. Sci. Comput. 33 (2011) 223–249: L = 10, E = 900, ρ = 1, g = 10, h = 5",
    formula="t₁ = √(2h/g), contacts of 2L/c", theirs=("1", "1.6666667", "9.6666667", "3.6666667", "4.3333333", "5"),
    ours=lambda: extrapolated(falling_bar), within=2e-3, why="what the extrapolation leaves",
    method="characteristics of the wave equation", adds=LIMIT, where="bars.falling_bar",
)  # fmt: skip
