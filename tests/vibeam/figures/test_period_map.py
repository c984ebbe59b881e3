"""The map of periods: classes of motions, and the values at which its rows stand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from stand_in import SDOF, curve

from vibeam.casefile.read import parse
from vibeam.figures.kinds.period_map import classes_of as classes
from vibeam.figures.kinds.period_map import rows_at
from vibeam.figures.motion_classes import Class
from vibeam.report.figures import figure
from vibeam.runs.result import Result
from vibeam.system.response import Branches, Ended

GRID = np.array([14.0, 15.0, 16.0, 17.0, 18.0])
TWO = {
    "fidelity.soft": {"set": {"stop.restitution": 0.5}},
    "fidelity.hard": {"set": {"stop.restitution": 0.7}},
    "show.map": {"kind": "period_map", "fidelities": ["soft", "hard"]},
}


def test_classes_of_motions() -> None:
    branch = curve(GRID, 1.0, [-1, 1, 2, 5, 0])
    wanted = [Class.NO_IMPACT, Class.PERIOD_ONE, Class.PERIOD_TWO, Class.PERIOD_MORE, Class.NOT_PERIODIC]
    assert classes(branch).tolist() == wanted
    assert classes(replace(branch, rest=np.ones(5))).tolist() == [Class.NO_IMPACT] * 5  # it never leaves the stop
    failed = replace(branch, ended=np.full(5, Ended.NO_ORBIT.code))
    assert classes(failed).tolist() == [Class.FAILED] * 5


def test_rows_stand_at_the_one_number_that_differs() -> None:
    case = parse(SDOF, set=TWO)
    key, values = rows_at(case, ("soft", "hard"))
    assert key == "stop.restitution"
    assert values == pytest.approx([0.5, 0.7])
    assert rows_at(case, ("hard", "soft")) == ("", None)  # not ascending
    assert rows_at(case, ("sdof", "soft")) == ("", None)  # one sets nothing
    both = parse(SDOF, set=TWO | {"fidelity.hard": {"set": {"stop.restitution": 0.7, "stop.gap": 1e-4}}})
    assert rows_at(both, ("soft", "hard")) == ("", None)


def test_what_the_map_draws() -> None:
    """A cell a point, in the order of the frequencies whichever way they were swept."""
    case = parse(SDOF, set=TWO)
    grid = GRID[:3]
    up, down = curve(grid, 1.0, [1, 2, 0]), curve(grid[::-1], 1.0, [0, 1, 1])
    other = Branches(curve(grid, 1.0, [1, 1, 1]), curve(grid[::-1], 1.0, [1, 1, 1]))
    result = Result(case, {"sdof": other, "soft": Branches(up, down), "hard": other})
    panels = figure(result, case.shows["map"]).axes
    cells = [np.asarray(panel.collections[0].get_array()).reshape(2, 3).tolist() for panel in panels]
    assert cells == [[[1, 2, 4], [1, 1, 1]], [[1, 1, 4], [1, 1, 1]]]
    assert panels[0].get_ylabel().startswith("stop.restitution")
