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
from vibeam_models.keys import Key

SHOW = {"show.it": {"kind": "speeds", "frequency": 1.6, "factor": 2.0}, "sweep.frequency.points": 3}
KEYS = {"factor": Key("of speeds: times which they are shown", 2, above=0)}


def sheets(case: Any, fidelity: str, plan: Any) -> list[Sheet]:
    omega = 2 * np.pi * np.array(plan.frequency)
    speed = plan.own["factor"] * omega * case.scene.amplitude
    return [Sheet(fidelity, plan.frequency[0], {"speed": Column(speed, "q/s", "base velocity")})]


def draw(figure: Any, result: Any, plan: Any, shown: tuple[Sheet, ...]) -> None:
    figure.subplots().plot(shown[0]["speed"], "o")


def test_a_registered_kind_of_figure_is_kept_and_drawn(tmp_path: Path) -> None:
    home = SimpleNamespace(sheets=sheets, draw=draw)
    needs = ("frequency", "factor")
    vibeam.register_figure(vibeam.FigureKind("speeds", home, "velocity of the base", needs=needs, keys=KEYS))
    try:
        result = vibeam.run(parse(SDOF, set=SHOW), tmp_path / "a.h5")
        assert [path.name for path in write_shown(result, tmp_path / "a.h5")] == ["a_it.png", "a_it.svg"]
        assert (tmp_path / "a_it.svg").exists()
        assert (
            vibeam.run(parse(SDOF, set=SHOW), tmp_path / "a.h5").shown["it"][0]["speed"]
            == result.shown["it"][0]["speed"]
        )
        assert result.shown["it"][0]["speed"] == pytest.approx(2 * 2 * np.pi * 1.6 * result.case.scene.amplitude)
        with pytest.raises(vibeam.CaseError, match='kind = "speeds" needs it') as missing:
            parse(SDOF, set={"show.it": {"kind": "speeds"}})
        assert [fault.key for fault in missing.value.faults] == ["show.it.factor", "show.it.frequency"]
        with pytest.raises(vibeam.CaseError, match=r'show.it.factor: kind = "portrait" has no use for it'):
            parse(SDOF, set={"show.it": {"kind": "portrait", "frequency": 1.6, "factor": 2}})
    finally:
        FIGURES.remove("speeds")
    with pytest.raises(vibeam.CaseError, match="'speeds' is not one of"):
        parse(SDOF, set=SHOW)
