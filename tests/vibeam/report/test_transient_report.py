"""Report of a run under a record: chaos told from a model that is off, near-nothing left out, units shown."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.report.transient import impact_statistics, transient_report
from vibeam.report.transient_answer import FidelityAnswer, answers, is_chaotic, misses, transient_answer
from vibeam.runs.transient.comparison import PairedDifference, TransientComparison

BLADE: dict[str, Any] = {
    "beam": {
        "length": "120 mm", "width": "12 mm", "thickness": "1 mm", "youngs_modulus": "200 GPa",
        "density": "7850 kg/m^3", "damping_ratio": "1 %",
    },
    "stop": {"position": "110 mm", "gap": "0.15 mm", "restitution": 0.7},
    "sensor": {"position": "120 mm"},
    "drive": {"density": "0.02 g^2/Hz", "band": ["20 Hz", "1 kHz"], "seed": 1},
    "record": {"duration": "0.3 s"},
    "fidelity": {
        "exact": {"reduction": "modal", "modes": 3}, "one": {"reduction": "static_mode"},
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def blade() -> Any:
    return vibeam.run(vibeam.Case.of(BLADE))


def parted(result: Any, horizon: float, own: float) -> Any:
    """The same result with other horizons of its fidelity "one"."""
    made = type(result)(result.case, result, periods=result.periods)
    found = replace(result.comparison["one"], horizon=np.array([[horizon]]), own_horizon=np.array([own]))
    made.__dict__["comparison"] = {"one": found}
    return made


@pytest.mark.parametrize(
    ("horizon", "own", "chaotic"),
    [(0.16, 1.0, True), (0.14, 1.0, False), (4.0, 5.0, False), (0.0, 0.1, False), (5.0, 5.0, False)],
)
def test_chaos_is_what_a_model_off_by_one_per_cent_would_show(horizon: float, own: float, chaotic: bool) -> None:
    """ln 5/ln 50 000 = 0.1487 of the own horizon, where that ends before the motion does, of 5 s here."""
    blank = np.zeros((1, 1, 0))
    found = TransientComparison("one", "exact", 1e-3, 5.0, np.array([[horizon]]),
                                np.array([own]), blank, blank, ())  # fmt: skip
    assert is_chaotic(found) is chaotic


def test_the_answer_tells_chaos_from_a_model_that_is_off(blade: Any) -> None:
    assert blade.comparison["one"].own_horizon.tolist() == [0.3]
    itself = "exact itself, under a load larger by 1e-6,"
    assert f"{itself} agrees to the end: the models are off." in transient_answer(blade, 0.05)
    off, chaos = parted(blade, 0.01, 0.2), parted(blade, 0.1, 0.2)
    assert f"{itself} until 200 ms: one is off before that." in transient_answer(off, 0.05)
    assert f"one until 100 ms of 300 ms; {itself} until 200 ms: one parts by chaos." in transient_answer(chaos, 0.05)


def test_of_single_motions_that_part_the_peaks_until_then_count(blade: Any) -> None:
    (found,) = answers(parted(blade, 0.1, 0.2))
    assert {each.quantity for each in found.principal} == {"peak_before"}
    assert found.principal[0].mean == blade.comparison["one"].off_before[0, 0, 0]
    notes = transient_report(parted(blade, 0.1, 0.2)).notes
    assert any("one: single motions part by chaos" in note and "record.realisations" in note for note in notes)
    (usual,) = answers(parted(blade, 0.01, 0.2))
    assert {each.quantity for each in usual.principal} == {"peak", "hardest_impact"}


def test_with_nothing_to_lose_no_share_of_it_is_told() -> None:
    """A level that never reaches the stop loses nothing there: the difference of two zeros is not told."""
    tables = BLADE | {"record": {"duration": "0.05 s", "values": [0.01]}}
    found: Any = vibeam.run(vibeam.Case.of(tables), fidelities=["exact", "one"])
    assert found["exact"].of("lost_at_impacts").tolist() == [[0.0]]
    assert "lost_at_impacts" not in {each.quantity for each in found.comparison["one"].differences}
    assert transient_answer(found, 0.05).startswith("Nothing touches the stop. ")


def test_rates_have_errors_where_the_input_is_random(blade: Any) -> None:
    rate, speed, _ = impact_statistics(blade["exact"], 0, random=True)
    assert rate.mean == pytest.approx(blade["exact"].impacts[0, 0] / 0.3)
    assert 0 < rate.error < rate.mean
    assert speed.effective <= speed.n
    assert np.isnan(impact_statistics(blade["exact"], 0, random=False)[0].error)


def test_values_of_a_key_have_their_unit() -> None:
    tables = BLADE | {"record": {"duration": "0.02 s", "over": "stop.gap", "values": ["0.1 mm", "0.2 mm"]}}
    found: Any = vibeam.run(vibeam.Case.of(tables), fidelities=["exact"])
    table = transient_report(found).tables[0]
    assert list(table.columns[1].cells) == ["0.1 mm", "0.2 mm"]
    data = found.to_xarray()
    assert data["sensor_acceleration_peak"].attrs["units"] == "m s-2"
    assert data["work"].attrs["units"] == "J"


def test_what_too_few_realisations_leave_open_is_no_miss(blade: Any) -> None:
    """4 % ± 3 % is neither within 5 % nor off by more: it is not known; 9 % ± 1 % is off."""
    unsure = PairedDifference("peak", "sensor", 0, 0.04, 0.03, 9)
    off = PairedDifference("hardest_impact", "", 0, 0.09, 0.01, 9)
    some = FidelityAnswer("one", (unsure, off), (unsure, off), False, 1.0)
    assert not some.is_within(0.05)
    said = misses(some, 0.05)
    assert said.startswith(
        "one misses hardest impact +9 % ± 1 %; of it peak sensor +4 % ± 3 % is not known well enough"
    )
    open_ = FidelityAnswer("one", (unsure,), (unsure,), False, 1.0)
    assert misses(open_, 0.05).startswith("of one peak sensor +4 % ± 3 % is not known")
