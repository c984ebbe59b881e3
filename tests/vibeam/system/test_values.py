"""Equality, hash and short text of the records that hold arrays."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam

CASE = Path(__file__).parents[3] / "cases" / "dtu_neutral.toml"
SHORT = {"sweep.frequency.points": 2, "sweep.settle": 3, "sweep.hold": 2}
DRIVE = vibeam.Drive(95.0, 1e-4)


def system(gap: float = 0.0) -> vibeam.ImpactSystem:
    return vibeam.ImpactSystem.from_modes(
        [47.7, 635.0], 0.017, [2.12, 0.31], [0.46, 0.09], gap=gap, restitution=0.72,
        derivatives={"speed": vibeam.TimeDerivative([1.0, 2.0], 1)}, outputs={"sensor": [1.0, 2.0]},
    )  # fmt: skip


def swept(gap: float = 0.0) -> Any:
    return vibeam.sweep(system(gap), omega=[90.0, 95.0], amplitude=1e-4, direction="both", settle=3, hold=2)


def case(gap: float = 0.0) -> vibeam.Case:
    return vibeam.load(CASE, set=SHORT | {"stop.gap": f"{gap} m"})


def ran(gap: float = 0.0) -> vibeam.Result:
    return vibeam.run(case(gap), show=False)


def mapped(gap: float = 0.0) -> vibeam.GridResponse:
    return vibeam.evaluate(case(gap), "sdof", {"sweep.frequency": [14.0, 15.0]})


RECORDS: dict[str, Callable[[float], Any]] = {
    "system": system, "case": case, "branches": swept, "response": lambda gap: swept(gap).up, "result": ran,
    "orbit": lambda gap: vibeam.orbits(system(gap), DRIVE)[0], "drive": lambda gap: vibeam.Drive(95.0, 1e-4 + gap),
    "contact": lambda gap: vibeam.Contact([1.0, 2.0], gap), "state": lambda gap: vibeam.State([gap, 1.0], [0.0, 1.0]),
    "trajectory": lambda gap: vibeam.simulate(system(gap), DRIVE, 0.5), "grid": mapped,
    "modes": lambda gap: vibeam.modes(case(), 2 + round(1e5 * gap)),
}  # fmt: skip


@pytest.mark.parametrize("kind", RECORDS)
def test_records_are_equal_by_value(kind: str) -> None:
    one, same, other = (RECORDS[kind](gap) for gap in (0.0, 0.0, 1e-5))
    assert one == same
    assert one != other
    assert len({one, same, other}) == 2
    assert one != "another kind"
    for twin in (copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert twin == one
        assert hash(twin) == hash(one)
    assert "\n" not in repr(one) or kind == "result"
    assert len(repr(one)) < 500


def test_every_nan_and_zero_is_one_value_and_cost_is_none() -> None:
    blank = vibeam.FrequencyResponse.empty(np.array([10.0, 11.0]), 1)
    assert blank == vibeam.FrequencyResponse.empty(np.array([10.0, 11.0]), 1)
    assert blank == replace(blank, reach=-blank.reach, cpu_seconds=np.ones(2), period=blank.period.astype(np.int16))
    assert blank != replace(blank, reach=np.array([np.nan, 0.0]))
    assert blank != vibeam.FrequencyResponse.empty(np.array([10.0]), 1)
    zero, other = (replace(blank, reach=np.array([sign * 0.0, 1.0])) for sign in (1, -1))
    assert zero == other
    assert hash(zero) == hash(other)
