"""The first sentence of a run: what suffices, as far as it is known, in every situation that a case may be in."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import curve, one_mode

import vibeam
from vibeam.casefile.read import parse
from vibeam.report.run_answer import run_answer
from vibeam.runs.estimate.records import Basis, ErrorEstimate, FidelityEstimate
from vibeam.runs.result import Result
from vibeam.system.response import Branches

GRID = np.linspace(14.0, 16.0, 5)
TOP = np.array([1.0, 2.0, 4.0, 2.0, 1.0])
IRREGULAR = np.array([0, 0, 1, 0, 0])
UNKNOWN = ". How far theirs itself is off is not known"


def answer(ours: Any, theirs: Any = TOP, ours_has: str = "", theirs_has: str = "", **how: Any) -> str:
    """Answer of two fidelities, of one mode and of two, the second flown: the rig gives its one mode."""
    accuracy = how.pop("accuracy", 0.05)
    case = parse(one_mode(str(GRID.tolist()), 1, 1, "[fidelity.ours]", ours_has, "[fidelity.theirs]", theirs_has))
    parts = {"ours": curve(GRID, ours, **how), "theirs": curve(GRID, theirs, modes=2, **how)}
    return run_answer(Result(case, {name: Branches(up) for name, up in parts.items()}), accuracy)


@pytest.mark.parametrize(
    ("ours", "said"),
    [
        (0.98 * TOP, "One mode suffices for 5 % (ours, 2 % too low at the peak)."),
        (1.2 * TOP, "Two modes suffice for 5 % (theirs, computed exactly); ours is 20 % too high."),
        (TOP * [1.06, 1, 1, 1, 1], "One mode suffices for 5 % (ours, off by less than 0.01 % at the peak, up to 6 %"),
        (TOP * [1.5, 1, 1, 1, 1.5], "; ours is 31.6 % off (rms), off by less than 0.01 % at the peak."),
        (TOP * [40, 1, 1, 1, 1], "; ours is 900 % too high."),
        (TOP * [2, 1, 1.1, 1, 2], "; ours is 63.4 % off (rms), 10 % too high at the peak."),  # √(2.01/5)
    ],
)  # fmt: skip
def test_what_suffices_is_named_with_what_it_misses(ours: Any, said: str) -> None:
    assert said in answer(ours)


def test_a_model_as_large_as_the_finest_is_no_smaller_one() -> None:
    case = parse(one_mode(str(GRID.tolist()), 1, 1, *(f"[fidelity.{name}]" for name in ("sdof", "beam", "noisy"))))
    sizes = {"sdof": (1.2 * TOP, 1), "beam": (TOP, 2), "noisy": (TOP, 2)}
    said = run_answer(Result(case, {name: Branches(curve(GRID, up, modes=n)) for name, (up, n) in sizes.items()}))
    assert said.startswith("beam suffices for 5 % (computed exactly); sdof is 20 % too high.")


def test_of_many_that_miss_the_first_are_named() -> None:
    """In the order of their sizes; those that are not named may be off by less."""
    off = {"a": 1.6, "b": 1.5, "c": 1.4, "d": 1.3, "top": 1.0}
    case = parse(one_mode(str(GRID.tolist()), 1, 1, *(f"[fidelity.{name}]" for name in off)))
    parts = {name: Branches(curve(GRID, by * TOP, modes=1 + (name == "top"))) for name, by in off.items()}
    said = run_answer(Result(case, parts))
    assert "; a is 60 % too high, b is 50 % too high and 2 more are off as well." in said


def test_the_accuracy_asked_for_decides() -> None:
    assert answer(1.2 * TOP, accuracy=0.25).startswith("One mode suffices for 25 % (ours, 20 % too high at the peak).")


def test_nothing_is_enough_whose_measure_is_not_known() -> None:
    """The finest is no exact solution here: pointwise mapping."""
    said = answer(0.98 * TOP, theirs_has='solver = "mapping"')
    assert said.startswith(f"One mode (ours, 2 % too low at the peak) is within 5 % of theirs{UNKNOWN}.")
    said = answer(1.2 * TOP, theirs_has='solver = "mapping"')
    first = "No other fidelity is known to be within 5 % of theirs: ours is 20 % too high"
    assert said.startswith(f"{first}{UNKNOWN}.")
    assert "suffice" not in said


def test_motions_that_do_not_repeat_are_no_measure() -> None:
    said = answer(0.98 * TOP, period=IRREGULAR)
    assert said.startswith("Two modes suffice for 5 %")
    assert "ours (2 % too low at the peak) repeats beside it at less than half of the points." in said


def test_other_physics_points_that_failed_and_motions_without_impacts_are_said() -> None:
    apart = answer(2 * TOP, ours_has='set = { "stop.restitution" = 0.5 }')
    assert apart.startswith("No two of the 2 fidelities are of the same physics")
    assert "peaks are from 4 (theirs) to 8 (ours)." in apart
    assert answer(TOP, period=-1).startswith("Nothing touches the stop. One mode suffices")
    assert " is held" not in answer(TOP, period=-1)
    assert answer(TOP, ended=3) == "No point was completed."
    assert "suffice" not in answer(TOP, TOP * np.nan)


@pytest.mark.parametrize(
    ("solver", "said"),
    [
        ("flight", "the mode that the case gives, computed exactly"),
        ("mapping", "alone, and how far it is off is not known"),
    ],
)
def test_one_fidelity_alone_says_what_is_known_of_it(solver: str, said: str) -> None:
    case = parse(one_mode(str(GRID.tolist()), 1, 1, f'[fidelity.ours]\nsolver = "{solver}"'))
    found = run_answer(Result(case, {"ours": Branches(curve(GRID, TOP))}))
    assert found.startswith(f"ours (1 mode) is {said}")
    assert "; its peak is 4 at " in found


def test_a_finest_without_limit_is_held_against_the_full_model_where_its_error_is_known() -> None:
    """0.2 % at one of five points; an error that is known at fewer than half of them is not the curve's."""
    case = parse(one_mode(str(GRID.tolist()), 1, 1, "[fidelity.ours]", "", "[fidelity.theirs]", 'solver = "mapping"'))
    parts = {"ours": Branches(curve(GRID, 0.98 * TOP)), "theirs": Branches(curve(GRID, TOP, modes=2))}
    whole = "The full model of 9 modes is up to 0.2 % off theirs (known at 5 of 5 points with impacts)."
    for known, said in ((5, whole), (2, UNKNOWN[2:])):
        basis = np.where(np.arange(5) < known, Basis.ORBIT.code, Basis.ANOTHER.code)
        error = np.where(np.arange(5) < known, [0.002, 0, 0, 0, 0], np.nan)
        result = Result(case, parts)
        found = ErrorEstimate(GRID, *(error,) * 6, correction=np.zeros(5), basis=basis)
        result.estimates["theirs"] = FidelityEstimate(9, {"up": found})
        assert f"within 5 % of theirs. {said}" in run_answer(result)


RIGS = Path(__file__).parents[3] / "cases"
FEW = {"sweep.frequency.points": 9, "sweep.settle": 60, "sweep.hold": 10}


def answer_of(place: str, **changes: Any) -> str:
    case = vibeam.load(RIGS / place, set=FEW | {name.replace("__", "."): value for name, value in changes.items()})
    return run_answer(vibeam.run(case, show=False, compare=True))


def test_each_rig_has_an_answer_of_its_own_and_what_is_held_is_said_once() -> None:
    said = answer_of("lodz/cantilever.toml")
    first, second = "With beam.massless = true: two_masses suffices for 5 % (", " Of the case's own rig: "
    assert said.startswith(first)
    assert said.index("one_mass") < said.index(second) < said.index("static")
    assert said.count("R = 0.7 at the contact is held") == 1
    other = said.partition("with R₁ = 0.7 of mode 1 held ")[2]
    assert [name in other for name in ("one_mass would be ", "static ")] == [True] * 2
    alone = answer_of("lodz/cantilever.toml", fidelity__one_mass=None, fidelity__two_masses=None, expect=None)
    assert "rig" not in alone


@pytest.mark.parametrize("law", [{}, {"stop__law": "linear", "stop__stiffness": "2e5 N/m", "stop__restitution": 0.7}])
def test_given_modes_have_no_reference_beyond_them(law: dict[str, Any]) -> None:
    contact = {"stop__restitution_of": "contact"} if law else {}
    said = answer_of("matrices/dtu_modes.toml", **law, **contact)
    assert re.match(r"One mode is .* (at the peak|\(rms\).*)\. No reference beyond two modes: the case gives", said)
    assert "these modes. " in said
    assert "known" not in said.partition("these modes. ")[0]
    near = answer_of("matrices/dtu_modes.toml", **law, **contact, modes__contact=[2.124, 1e-3])
    assert near.startswith("One mode (one, ")
    assert ") is within 5 % of two. No reference beyond two modes: the case gives only these modes. " in near


@pytest.mark.parametrize("reduction", ["full", "modal"])
def test_the_full_model_alone_is_called_so(reduction: str) -> None:
    one = {"fidelity.static": None, "fidelity.one": None, "fidelity.stiff": None, "expect": None}
    modes = {"fidelity.whole": {"reduction": "modal", "modes": 2}} if reduction == "modal" else {}
    case = vibeam.load(RIGS / "matrices" / "frame.toml", set=FEW | one | modes)
    assert run_answer(vibeam.run(case, show=False, compare=True)).startswith("whole (2 modes) is the full model; its ")


def test_a_full_model_on_a_mesh_is_off_by_that_mesh() -> None:
    """A stop that yields has no limit in closed form: what 12 elements leave is not known."""
    law = {"stop__law": "linear", "stop__stiffness": "2e4 N/m", "stop__restitution_of": "contact"}
    whole = {"fidelity__beam": {"reduction": "full"}, "beam__elements": 12, "reference": None}
    said = answer_of("dtu_neutral.toml", **law, **whole)
    assert "beam, the full model, is off by its mesh is not known (" in said
    assert "suffice" not in said
