"""Validation cases of code_aster in which beams strike: SDNL32, SDNL104 and SDNL105."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

import vibeam
from tests.others.problem import Problem, spoiled
from tests.others.systems import STILL, certified, modes
from vibeam_models.arrays import Array
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Round, Tube
from vibeam_models.laws.compliant import LinearStop
from vibeam_models.space import bare_beam

ASTEST = "code_aster, ehmoussi/code_aster 34161d79, astest/"
PINNED_BAR = Path(__file__).parents[3] / "cases" / "rigs" / "pinned_bar.toml"
UNDAMPED = Damping("constant", (0.0,))


def pinned_bar(stiffness: str) -> list[float]:
    """SDNL32: place of the free end after 1, 2 … 12 ms of a pinned bar that turns at 3.8 rad/s when it meets a spring.

    As there: ten elements of Timoshenko's beam, the nine lowest modes of bending (a tenth one stretches the bar), no
    weight.
    """
    case = vibeam.load(PINNED_BAR, set={
        "stop.stiffness": stiffness, "support.0.rotational_stiffness": "1e-6 N m/rad", "fidelity.bar.modes": 9,
        "beam.theory": "timoshenko", "beam.poissons_ratio": 0.0, "beam.elements": 10,
    })  # fmt: skip
    own = case.system("bar")
    system = modes(own.omega, own.zeta, own.contact, 0.0, law=own.law)
    thrown = np.zeros(own.size)
    thrown[0] = 3.8 * 0.783 / own.contact[0]
    path = certified(system, STILL, 0.0125, vibeam.State(0 * thrown, thrown))
    return [-float(path.at(1e-3 * time)) for time in range(1, 13)]


def on_elastic_support(count: int) -> list[float]:
    """SDNL104: place at 0.1315 s and velocity at 0.1566 s of a cantilever's tip that 1000 N press onto a support."""
    beam = Beam(1.0, Round(0.2), 1e10, 1e6, UNDAMPED, elements=10)
    found = bare_beam(beam)[0].modes(count)
    tip = bare_beam(beam)[0].contact @ found.shapes
    system = modes(found.omega, 0.0, tip, 0.0, gap=1e-4, law=LinearStop(1e8), static=1000.0 * tip)
    path = certified(system, STILL, 0.16, vibeam.State(np.zeros(count), np.zeros(count)))
    return [-float(path.at(0.1315)), -float(path.velocity_at(0.1566, "contact"))]


def three_beams() -> Array:
    """SDNL105: place and velocity of the middle of each of three clamped tubes after 1 s; 1 MN press on the first."""
    structure, space = bare_beam(
        Beam(1.0, Tube(0.2, 0.01), 1e10, 1e8, UNDAMPED, ends="clamped-clamped", elements=10), (0.5,)
    )
    found = structure.modes(5)
    row, none, law = space.row(0.5) @ found.shapes, np.zeros(5), LinearStop(1e8 * spoiled())
    middles = {"first": [row, none, none], "second": [none, row, none], "third": [none, none, row]}
    outputs = {name: np.concatenate(parts) for name, parts in middles.items()}
    system = modes(
        np.tile(found.omega, 3), 0.0, outputs["first"] - outputs["second"], 0.0, gap=1e-3, law=law,
        static=1e6 * outputs["first"], outputs=outputs,
        further=[vibeam.Contact(outputs["second"] - outputs["third"], 1e-3, 1.0, law)],
    )  # fmt: skip
    path = certified(system, STILL, 1.0, vibeam.State(np.zeros(15), np.zeros(15)))
    return np.array([[path.at(1.0, name), path.velocity_at(1.0, name)] for name in outputs])


turned = partial(
    Problem, problem="SDNL32: bar on a hinge strikes a spring", source=ASTEST + "sdnl32a.comm, V5.02.032",
    where="cases/rigs/pinned_bar.toml, without weight and shaking", of_largest=True,
    adds="contacts in closed form; certificate",
)  # fmt: skip
turned(
    quantity="place of its end after 1, 2 … 12 ms on 18 kN/m, m (references from elsewhere)",
    method="a program not named",
    theirs=("-2.66E-3", "-4.33E-3", "-4.92E-3", "-4.78E-3", "-3.82E-3", "-2.87E-3", "-2.71E-3", "-3.09E-3", "-3.41E-3",
            "-3.36E-3", "-2.64E-3", "-7.42E-4"),
    ours=lambda: pinned_bar("18 kN/m"), within=7.5e-3, why="three digits; code_aster has −4.95 for their −4.92 too",
)  # fmt: skip
turned(
    quantity="the same as code_aster has it",
    theirs=("-2.6627590257986E-03", "-4.3350345295003E-03", "-4.9527612787073E-03", "-4.781917137288E-03",
            "-3.8242004128586E-03", "-2.8745139069535E-03", "-2.7099551922703E-03", "-3.0877216671158E-03",
            "-3.4066468457724E-03", "-3.3641583511178E-03", "-2.6422009677496E-03", "-7.4273628435305E-04"),
    ours=lambda: pinned_bar("18 kN/m"), within=4e-4, method="ten modes, central differences of 10 µs",
    why="its steps; its ends turn 0.25 % slower than 3.8 rad/s",
)  # fmt: skip
turned(
    quantity="and on 45 kN/m",
    theirs=("-2.2499139338638E-03", "-2.6571933710396E-03", "-1.964446768242E-03", "-1.1558832978157E-03",
            "-1.2253880979324E-04", "-3.6343897589192E-04", "-2.0093063317862E-03", "-2.7406203055975E-03",
            "-1.8936271216016E-03", "-3.5204249459737E-04", "1.7043769266464E-03", "4.9858100660464E-03"),
    ours=lambda: pinned_bar("45 kN/m"), within=4e-4, method="ten modes, central differences of 10 µs",
    why="its steps; its ends turn 0.25 % slower than 3.8 rad/s",
)  # fmt: skip

tip = partial(
    Problem, problem="SDNL104: cantilever on an elastic support", where="this module, on_elastic_support",
    quantity="place at 0.1315 s, m, and velocity at 0.1566 s of its tip, m/s",
    adds="contact in closed form; certificate",
)  # fmt: skip
tip(
    source=ASTEST + "sdnl104c.comm, 'sans modstat'", theirs=("-1.72233853215E-06", "-0.0044840631965"),
    ours=lambda: on_elastic_support(5), within=6e-5, why="its steps", method="five modes, central differences of 10 µs",
)  # fmt: skip
Problem(
    problem="SDNL104: cantilever on an elastic support", quantity="the same without a reduction", where="this module, "
    "on_elastic_support", source=ASTEST + "sdnl104a.comm", theirs=("-1.85356696663E-06", "-0.00463289359505"),
    ours=lambda: on_elastic_support(20), within=8e-3, why="its steps, half a period of the fastest mode long",
    method="ten elements, Newmark's steps of 0.1 ms", adds="all twenty modes of its elements",
)  # fmt: skip
Problem(
    problem="SDNL105: three clamped tubes in a row", where="this module, three_beams", source=ASTEST + "sdnl105a.comm",
    quantity="place, m, and velocity, m/s, of the middle of each after 1 s and six contacts",
    theirs=("0.0164264176874", "0.0254153737301", "0.0111626966324", "0.0441198407461", "0.00588734022575",
            "0.104549304707"),
    ours=three_beams, within=5e-4, why="its steps, and frames of 1e15 Pa that hold its tubes",
    method="modes below 35 Hz, Devogelaere's method to 0.4 ms", adds="both contacts in closed form; certificate",
)  # fmt: skip
