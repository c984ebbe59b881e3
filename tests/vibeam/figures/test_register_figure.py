"""A kind of figure that a program brings itself, asked for in a case file."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from stand_in import SDOF

import vibeam
from vibeam.casefile.read import parse
from vibeam.figures import FIGURES
from vibeam.figures.sheet import Column, Sheet
from vibeam.report.figures import write_shown

SHOW = {"show.it": {"kind": "speeds", "frequency": 1.6}, "sweep.frequency.points": 3}


def sheets(case: Any, fidelity: str, plan: Any) -> list[Sheet]:
    omega = 2 * np.pi * np.array(plan.frequency)
    return [Sheet(fidelity, plan.frequency[0], {"speed": Column(omega * case.scene.amplitude, "q/s", "base velocity")})]


def draw(figure: Any, result: Any, plan: Any, shown: tuple[Sheet, ...]) -> None:
    figure.subplots().plot(shown[0]["speed"], "o")


def test_a_registered_kind_of_figure_is_kept_and_drawn(tmp_path: Path) -> None:
    home = SimpleNamespace(sheets=sheets, draw=draw)
    vibeam.register_figure(vibeam.FigureKind("speeds", home, "velocity of the base", needs=("frequency",)))
    try:
        result = vibeam.run(parse(SDOF, set=SHOW), tmp_path / "a.h5")
        assert [path.name for path in write_shown(result, tmp_path / "a.h5")] == ["a_it.png", "a_it.svg"]
        assert (tmp_path / "a_it.svg").exists()
        assert (
            vibeam.run(parse(SDOF, set=SHOW), tmp_path / "a.h5").shown["it"][0]["speed"]
            == result.shown["it"][0]["speed"]
        )
        with pytest.raises(vibeam.CaseError, match='kind = "speeds" needs it'):
            parse(SDOF, set={"show.it": {"kind": "speeds"}})
    finally:
        FIGURES.remove("speeds")
    with pytest.raises(vibeam.CaseError, match="'speeds' is not one of"):
        parse(SDOF, set=SHOW)
