"""Expected and measured numbers of a case under a record."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import vibeam

TABLES: dict[str, Any] = {
    "units": "SI",
    "sdof": {"natural_frequency": "2 Hz", "damping_ratio": 0.03},
    "stop": {"gap": 0.01, "restitution": 0.7},
    "drive": {"density": 0.5, "band": ["0.5 Hz", "5 Hz"], "seed": 4},
    "record": {"duration": "4 s", "realisations": 3, "values": [1.0, 2.0]},
    "fidelity": {"events": {"solver": "direct"}, "steps": {"solver": "moreau"}},
}


@pytest.fixture(scope="module")
def result() -> Any:
    return vibeam.run(vibeam.Case.of(TABLES))


def checked(result: Any, **numbers: dict[str, Any]) -> dict[str, Any]:
    """Rows by name, of numbers of the fidelity events."""
    case = vibeam.Case.of(TABLES | {"expect": {name: {"fidelity": "events"} | each for name, each in numbers.items()}})
    made = type(result)(case, result, periods=result.periods, twins=result.twins)
    return {row.reference: row for row in vibeam.check(case, made)}


def test_a_number_is_the_mean_over_the_realisations(result: Any) -> None:
    peaks = result["events"].of("peak")
    found = checked(
        result,
        mean={"quantity": "peak", "value": float(peaks[0].mean()), "tolerance": 1e-12},
        off={"quantity": "peak", "value": 1.01 * float(peaks[0].mean()), "tolerance": "0.5 %"},
        of_one={"quantity": "peak", "seed": 6, "at": 2.0, "value": float(peaks[1, 2]), "tolerance": 1e-12},
        speed={"quantity": "rms", "output": "sensor_velocity", "tolerance": 1e-12,
               "value": float(result["events"].rms[0, :, 1].mean())},
    )  # fmt: skip
    assert {name: row.passed for name, row in found.items()} == {
        "mean": True, "off": False, "of_one": True, "speed": True,
    }  # fmt: skip
    assert found["mean"].notes[0] == f"± {np.std(peaks[0], ddof=1) / np.sqrt(3):.2g} of 3 realisations"


def test_impacts_energies_and_the_horizon_are_numbers(result: Any) -> None:
    own = result["events"]
    found = checked(
        result,
        count={"quantity": "impacts", "seed": 5, "value": int(own.impacts[0, 1]), "tolerance": 1e-9},
        rate={"quantity": "impact_rate", "seed": 5, "value": float(own.impacts[0, 1] / 4), "tolerance": 1e-9},
        left={"quantity": "energy_left", "number": 1, "seed": 5, "value": float(own.left[0, 1, 0]), "tolerance": 1e-9},
        horizon={"quantity": "horizon", "against": "steps", "value": float(result.comparison["steps"].horizon[0].min()),
                 "tolerance": 1e-9},
    )  # fmt: skip
    assert all(row.passed for row in found.values())


def test_a_difference_is_paired(result: Any) -> None:
    of = result.comparison["steps"].difference("peak", "sensor", at=1)
    found = checked(
        result,
        off={
            "fidelity": "steps",
            "against": "events",
            "quantity": "peak",
            "at": 2.0,
            "value": of.mean,
            "tolerance": 1e-12,
        },
    )
    assert found["off"].passed
    assert "of 3 realisations" in found["off"].notes[0]


def test_what_is_not_there_is_missed_with_its_reason(result: Any) -> None:
    found = checked(
        result,
        mode={"quantity": "energy_left", "number": 7, "value": 0.01, "tolerance": "1 %"},
    )
    assert [row.passed for row in found.values()] == [False]
    assert found["mode"].notes == ("there is none",)


def test_measured_numbers_stand_beside_the_models(result: Any) -> None:
    number = {
        "fidelity": "events",
        "quantity": "hardest_impact",
        "value": 0.2,
        "uncertainty": 0.5,
        "source": "a log book",
    }
    case = vibeam.Case.of(TABLES | {"measured": {"hardest": number}})
    made = type(result)(case, result)
    (row,) = vibeam.compare_measured(case, made)
    assert row.model == pytest.approx(float(result["events"].of("hardest_impact")[0].mean()))
    assert row.within is (abs(row.difference) <= 0.5)
