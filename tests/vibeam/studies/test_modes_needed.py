"""The number of modes that a case needs: sweeps of fewer modes beside all modes, within a budget, for every case."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from observed import NEUTRAL
from scipy.io import mmwrite

import vibeam
from vibeam.report.modes_needed import answer, first_answer, sheet
from vibeam.studies.modes_needed import ModesTried, modes_needed
from vibeam_models.beam import structure_of

CASES = NEUTRAL.parent
FEW = {"beam.elements": 8, "sweep.frequency.points": 13, "sweep.direction": "up"}


def neutral(**own: Any) -> Any:
    return vibeam.load(NEUTRAL, set=FEW | own)


def test_errors_are_those_of_runs_beside_all_modes() -> None:
    case = neutral(**{"fidelity.all": {"reduction": "full"}})
    found = modes_needed(case)
    assert (found.modes, found.size, found.frequencies) == (16, 16, 13)
    result = vibeam.run(case, show=False)
    rows = {row.modes: row.comparison for row in found.rows}
    every, two = (result[name].up.amplitude for name in ("all", "two_modes"))
    largest = max(abs(two / every - 1))
    assert rows[2] is not None
    assert rows[2].amplitude_error == pytest.approx(largest, rel=1e-9)
    single = max(abs(result["sdof"].up.amplitude / every - 1))
    assert found.single is not None
    assert found.single.comparison is not None
    assert found.single.comparison.amplitude_error == pytest.approx(single, rel=1e-9)
    assert found.enough is not None
    assert found.enough.modes == 2
    assert answer(found).startswith("Two modes suffice for 5 %: amplitudes within ")
    assert "One degree of freedom is 10" in answer(found)


def test_the_first_answer_is_a_quick_look() -> None:
    assert first_answer(neutral()).startswith("At 7 frequencies two modes suffice for 5 %: amplitudes within 1")
    assert first_answer(vibeam.load(CASES / "sdof_nominal.toml")) == ""


def test_a_finer_accuracy_needs_more_modes_and_says_what_fewer_miss() -> None:
    rough, fine = modes_needed(neutral()), modes_needed(neutral(), accuracy="0.5 %")
    assert rough.enough is not None
    assert fine.enough is not None
    assert rough.enough.modes < fine.enough.modes
    assert [row.suffices(fine.asked) for row in fine.rows][:2] == [False, False]


def test_a_mesh_that_is_too_coarse_lets_no_number_suffice() -> None:
    """One element for the whole beam: its modes are far from those of a finer one."""
    coarse = {"beam.elements": 1, "stop.restitution_of": "contact", "fidelity.beam.modes": 2}
    found = modes_needed(neutral(**coarse), accuracy="1 %")
    said = answer(found)
    assert found.own.suffices(found.asked) is False
    assert said.startswith("No number of modes suffices for 1 %: all four modes are ")
    assert said.partition(". ")[0].endswith("refine the mesh (beam.elements)")


@pytest.mark.parametrize("stop", [{"restitution": 0.7}, {"law": "linear", "stiffness": "1e6 N/m", "damping": 20.0}])
def test_matrices_of_a_cantilever_get_an_answer(tmp_path: Path, stop: dict[str, Any]) -> None:
    """Some 70 coordinates, in SI: where all modes take too long, as many as fit stand for them."""
    structure = structure_of(vibeam.load(NEUTRAL, {"beam.elements": 40}).scene)
    for name, matrix in {"mass": structure.M, "stiffness": structure.K}.items():
        mmwrite(tmp_path / f"{name}.mtx", matrix)
    case = vibeam.Case.of({
        "matrices": {"mass": str(tmp_path / "mass.mtx"), "stiffness": str(tmp_path / "stiffness.mtx"), "units": "SI",
                     "damping_ratio": 0.01, "contact": int(np.argmax(np.abs(structure.contact))) + 1,
                     "base": "all"},
        "stop": {"gap": "0.4 mm", **stop}, "drive": {"acceleration": "5 m/s^2"}, "units": "SI",
        "sweep": {"frequency": {"from": "15 Hz", "to": "30 Hz", "points": 7}, "settle": 40, "hold": 10},
        "fidelity": {"three": {"reduction": "modal", "modes": 3}},
    })  # fmt: skip
    found = modes_needed(case, budget=2.0, frequencies=7)
    assert found.size == structure.size
    assert found.modes <= found.size
    assert found.rows
    assert "suffice" in answer(found)


def test_measured_modes_have_no_further_ones() -> None:
    found = modes_needed(vibeam.load(CASES / "matrices" / "dtu_modes.toml", {"sweep.frequency.points": 9}))
    assert found.size == 2
    assert "What further modes would change is not known: the case gives only these modes." in answer(found)


@pytest.mark.parametrize("name", ["tube", "two_stops", "afm_tip", "elastic_stop"])
def test_every_rig_gets_an_answer_within_the_budget(name: str) -> None:
    case = vibeam.load(CASES / "rigs" / f"{name}.toml", {"sweep.settle": 20, "sweep.hold": 4})
    found = modes_needed(case, budget=0.5, frequencies=7)
    said = answer(found)
    assert found.rows
    assert any(word in said for word in ("suffice", "known to suffice", "within 5 % of"))
    assert sheet(found).rows


def test_what_does_not_fit_into_the_budget_is_named() -> None:
    with pytest.raises(ValueError, match=r"the sweep of 8 modes does not fit into the budget of 1e-06 s"):
        modes_needed(neutral(), budget=1e-6)


def test_a_case_of_one_degree_of_freedom_has_no_modes_to_count() -> None:
    with pytest.raises(ValueError, match="no modes to count"):
        modes_needed(vibeam.load(CASES / "sdof_nominal.toml"))


def test_the_sheet_has_a_row_for_each_model_and_a_figure() -> None:
    found = modes_needed(neutral())
    made = sheet(found)
    assert [row["modes"] for row in made.rows][:3] == [1, 1, 2]
    assert made.data["enough"] == 2
    assert [each.ending for each in made.pictures] == ["", "_times"]
    assert [len(each.draw().axes) for each in made.pictures] == [1, 1]


def test_a_picture_without_fewer_modes_names_what_is_not_compared() -> None:
    """Every sweep but that of all modes may be too dear for the budget."""
    found = replace(modes_needed(neutral()), rows=(ModesTried(modes=1, why="too dear"),), single=None)
    responses, times = (each.draw() for each in sheet(found).pictures)
    responses.canvas.draw()
    assert times.legends[0].get_title().get_text() == "not compared: one mode"
