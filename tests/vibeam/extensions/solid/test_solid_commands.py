"""What studies and runs make of a fidelity that flies a solid: the finest, its remarks, maps, a record, a limit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from tests.vibeam.extensions.solid.test_solid_case import TABLES, case
from vibeam.case.fineness import alike, finest, plain
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam.maps.run import run_map
from vibeam.report.run_report import run_report
from vibeam_models.scene import line_of


def with_fidelities(**tables: Any) -> vibeam.Case:
    return vibeam.Case.of(TABLES, {f"fidelity.{name}": table for name, table in tables.items()})


def test_a_solid_of_several_modes_is_finer_than_any_beam() -> None:
    one = {"model": "solid", "reduction": "static_mode"}
    fine = {"model": "solid", "reduction": "modal", "modes": 3, "set": {"solid.across": 3}}
    made = with_fidelities(one=one, fine=fine, other={"reduction": "modal", "modes": 3, "set": {"stop.gap": 1e-4}})
    modes = {"beam": 12, "solid": 3, "one": 1, "fine": 3}
    assert finest(made, modes) == "solid"  # the first of several
    assert finest(made, {"beam": 12, "one": 1}) == "beam"
    # How a body is meshed is no other rig, a gap of one's own is.
    assert alike(made, made.fidelities, "beam") == ["beam", "solid", "one", "fine"]
    assert plain(made) == ["beam", "solid", "one", "fine"]
    assert line_of(made.scene_of("solid")) is None
    assert line_of(made.scene_of("beam")) is made.scene


def test_a_run_compares_the_beam_with_the_solid_and_says_what_it_assumes() -> None:
    result = vibeam.run(case())
    assert result.finest == {"beam": "solid", "solid": "solid"}
    said = [*run_report(result).notes]
    assert [each for each in said if each.startswith("Poisson's ratio 0.3, of steel by E = 210 GPa, is assumed")]


def test_a_case_of_solids_alone_is_a_solid() -> None:
    made = vibeam.Case.of(TABLES | {"fidelity": {"it": TABLES["fidelity"]["solid"]}})
    assert type(made.scene) is SolidScene
    table = vibeam.modes(made, 3)
    assert [row.frequency for row in table.rows] == pytest.approx(made.system("it").omega / (2 * np.pi), rel=1e-9)
    with pytest.raises(ValueError, match="closed forms are of a beam, and this is a solid"):
        vibeam.derive(made)


def test_a_map_says_how_many_bodies_it_makes(tmp_path: Path) -> None:
    axes = [{"key": "beam.thickness", "values": [2.9e-3, 3.1e-3]}, {"key": "sweep.frequency", "values": [14.0, 15.0]}]
    said: list[str] = []
    small = case(sweep__settle=2, sweep__hold=1)
    run_map(small.with_keys({"map.thick": {"axes": axes}}), "thick", tmp_path / "a.h5", tell=said.append)
    assert [each.partition(": ")[0] for each in said] == ["solid"]
    assert "solid: 2 bodies over beam.thickness, each meshed, factored and reduced: " in said[0]
    gaps = [{"key": "stop.gap", "values": [0.0, 1e-4]}, axes[1]]
    run_map(small.with_keys({"map.gaps": {"axes": gaps}}), "gaps", tmp_path / "b.h5", tell=said.append)
    assert len(said) == 1


def test_a_record_goes_through_a_solid() -> None:
    pulse = {"shape": "half_sine", "acceleration": -20.0, "duration": 5e-3}
    tables = {key: value for key, value in TABLES.items() if key != "sweep"} | {"drive": pulse}
    made = vibeam.Case.of(tables | {"record": {"duration": 0.02}})
    result = vibeam.run(made)
    assert result.finest == {"beam": "solid", "solid": "solid"}
