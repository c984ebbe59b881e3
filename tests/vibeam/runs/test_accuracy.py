"""Accuracy on demand: the cheapest fidelity whose estimate is within, its promise against flights of the full model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stand_in import RIG, SDOF

import vibeam
from tests.benchmarks.accuracy import full_sweep
from vibeam.casefile.read import load, parse
from vibeam.exchange.faults import CaseError
from vibeam.runs.accuracy import accuracy_choice, by_cost
from vibeam.runs.estimate.records import Basis, ErrorEstimate, FidelityEstimate
from vibeam.runs.stored_result import read_result

CASES = Path(__file__).parents[3] / "cases"
POINTS, SEED = 24, 20181005  # places at which the promise is checked, drawn from all of both ways


def case_of(name: str, accuracy: str, points: int | None = None, **settings: Any) -> Any:
    keys = {} if points is None else {"sweep.frequency.points": points}
    return vibeam.load(CASES / f"{name}.toml", set={"accuracy": accuracy} | keys | settings)


def promise(name: str, within: float, points: int | None) -> tuple[str, np.ndarray]:
    """Fidelity chosen, and its errors at those of 24 random places at which something is claimed."""
    result = vibeam.run(case := case_of(name, f"{100 * within} %", points), show=False)
    chosen, truth = result.accuracy.chosen, full_sweep(case)
    known = np.concatenate([branch.known for branch in result.estimates[chosen].branches.values()])
    ours, full = (np.concatenate([each.up.amplitude, each.down.amplitude]) for each in (result[chosen], truth))
    errors = np.where(known, ours / full - 1, np.nan)
    drawn = errors[np.random.default_rng(SEED).permutation(len(errors))[:POINTS]]
    return chosen, np.abs(drawn[np.isfinite(drawn)])


@pytest.mark.parametrize(
    ("name", "within", "fidelity", "least"),
    [
        ("dtu_neutral", 0.01, "beam", 24), ("dtu_neutral", 0.05, "two_modes", 24), ("dtu_neutral", 0.15, "sdof", 24),
        ("dtu_loose", 0.01, "beam", 20), ("dtu_tight", 0.01, "beam", 9),
    ],
)  # fmt: skip
@pytest.mark.parametrize("points", [33, pytest.param(None, marks=pytest.mark.slow)])
def test_the_promise_holds_at_random_points(
    name: str, within: float, fidelity: str, least: int, points: int | None
) -> None:
    chosen, errors = promise(name, within, points)
    assert chosen == fidelity
    assert len(errors) >= least
    assert errors.max() <= within


def test_the_check_of_the_promise_can_fail() -> None:
    """Two modes are 1.6 % off where eight are asked for."""
    case = case_of("dtu_neutral", "5 %", 9)
    result, truth = vibeam.run(case, show=False), full_sweep(case)
    error = np.abs(result["two_modes"].up.amplitude / truth.up.amplitude - 1)
    assert 0.01 < error.max() <= result.accuracy.swept[-1].error < 0.02


def estimate(bounds: list[float], basis: Basis = Basis.NO_ORBIT, modes: int = 64) -> FidelityEstimate:
    """Estimate whose points without a bound are unknown for the reason ``basis``."""
    rows = np.array(bounds)
    codes = np.where(np.isfinite(rows), Basis.ORBIT.code, basis.code)
    names = ("reach", "impact_velocity", "amplitude_bound", "reach_bound", "impact_velocity_bound", "correction")
    values = dict.fromkeys(names, rows) | {"reach_bound": 2 * rows}
    return FidelityEstimate(modes, {"up": ErrorEstimate(np.arange(1.0, 1 + len(rows)), rows, basis=codes, **values)})


NAN = float("nan")
WHOLE = FidelityEstimate(64, {}, whole=True)


@pytest.mark.parametrize(
    ("sdof", "beam", "of", "chosen", "said"),
    [
        ([0.005, 0.009], None, "amplitude", "sdof", "Taken is sdof, 0.9 % off at most (known at 2 of 2 points): the"),
        ([0.005, 0.009], WHOLE, "amplitude", "sdof", "Not swept, since they cost more: beam."),
        ([0.005, 0.009], WHOLE, "reach", "beam", "Refused: sdof, 1.8 % off at most (known at 2 of 2 points)."),
        ([0.005, NAN], WHOLE, "amplitude", "beam", "beam, 0 % off at most (the full model itself): the cheapest"),
        ([NAN, NAN], [0.002, NAN], "amplitude", "beam", "the finest fidelity, within 1 % of the full model (64 modes)"),
        ([0.02, 0.03], [0.002, NAN], "amplitude", "beam", "is known; not known: the motion does not repeat"),
        ([NAN, NAN], [NAN, NAN], "amplitude", "beam", "Taken is beam, error not known: the finest fidelity"),
        ([0.2, 0.3], [0.02, 0.03], "amplitude", "", "the nearest is beam, 3 % off at most (known at 2 of 2"),
        ([0.2, 0.3], [0.02, NAN], "amplitude", "", "No fidelity is within 1 % of the full model (64 modes)"),
        ([0.005, NAN], [0.02, NAN], "amplitude", "", "the nearest is beam, 2 % off at most (known at 1 of 2 points): "),
        ([0.015, 0.01], [0.02, NAN], "amplitude", "", "add a fidelity with more modes, or allow more than 1.5 %."),
    ],
)  # fmt: skip
def test_the_cheapest_is_taken_whose_error_is_known_and_within(
    sdof: list[float], beam: Any, of: str, chosen: str, said: str
) -> None:
    case = case_of("dtu_neutral", "1 %", 2, **{"accuracy_of": [of], "sweep.direction": "up"})
    found = {"sdof": estimate(sdof, Basis.APERIODIC)}
    found |= {"beam": beam if isinstance(beam, FidelityEstimate) else estimate(beam, Basis.APERIODIC)} if beam else {}
    choice = accuracy_choice(case, ["sdof", "beam"], found)
    assert choice.chosen == chosen
    assert said in " ".join(choice.sentences())


def test_a_failed_point_is_not_known() -> None:
    case = case_of("dtu_neutral", "1 %", 2, **{"sweep.direction": "up"})
    (swept,) = accuracy_choice(case, ["sdof"], {"sdof": estimate([0.001, NAN], Basis.FAILED)}).swept
    assert (swept.known, dict(swept.unknown)) == (1, {"the point failed": 1})


def test_fidelities_that_change_the_rig_are_not_asked() -> None:
    case = case_of("dtu_neutral", "1 %", 3)
    other = replace(case.fidelities["beam"], name="soft", changes={"stop.restitution": 0.5})
    several = replace(case, fidelities={"soft": other, **case.fidelities})
    assert by_cost(several, {"soft": 1, "sdof": 1, "two_modes": 2, "beam": 8}) == ["sdof", "two_modes", "beam"]
    with pytest.raises(CaseError, match="accuracy: every fidelity changes the rig"):
        by_cost(replace(case, fidelities={"soft": other}), {"soft": 8})


def test_a_file_goes_on_with_another_accuracy_and_without(tmp_path: Path) -> None:
    out, done = tmp_path / "neutral.h5", []
    first = vibeam.run(case_of("dtu_neutral", "5 %", 25), out, progress=lambda *each: done.append(each), show=False)
    assert list(first) == list(first.estimates) == ["sdof", "two_modes"]
    assert (first.found, first.total, done[-1]) == (0, 100, (100, 100))
    before = out.read_bytes()
    again = vibeam.run(case_of("dtu_neutral", "5 %", 25), out, show=False)
    assert (again.found, again.accuracy, out.read_bytes()) == (100, first.accuracy, before)
    stored = read_result(out, lambda text: parse(text, CASES / "dtu_neutral.toml"))
    assert (list(stored.result), stored.missing, stored.result.accuracy) == (list(first), 0, first.accuracy)
    finer = vibeam.run(case_of("dtu_neutral", "1 %", 25), out, show=False)
    assert (list(finer), finer.found, finer.accuracy.chosen) == (["sdof", "two_modes", "beam"], 100, "beam")
    plain = vibeam.run(vibeam.load(CASES / "dtu_neutral.toml", set={"sweep.frequency.points": 25}), out, show=False)
    assert (plain.found, plain.accuracy) == (150, None)
    coarser = vibeam.run(case_of("dtu_neutral", "15 %", 25), out, show=False)
    assert list(coarser) == ["sdof"]
    assert np.array_equal(coarser["sdof"].up.amplitude, first["sdof"].up.amplitude)


def test_a_run_that_was_stopped_is_read_with_what_is_of_its_case(tmp_path: Path) -> None:
    """First between its choice and the properties of its models, then, with one more fidelity, before its choice."""
    out, case = tmp_path / "neutral.h5", case_of("dtu_neutral", "5 %", 5)

    def stop(done: int, total: int) -> None:
        if done in (total, 21):
            raise ZeroDivisionError

    def stopped(case: Any) -> Any:
        with pytest.raises(ZeroDivisionError):
            vibeam.run(case, out, progress=stop, show=False, tell=[].append)
        return read_result(out, lambda text: case).result

    first = stopped(case)
    assert (first.accuracy.chosen, list(first), first.overview) == ("two_modes", ["sdof", "two_modes"], None)
    more = case_of("dtu_neutral", "5 %", 5, **{"fidelity.one": {"reduction": "modal", "modes": 1}})
    second = stopped(more)
    assert (second.accuracy, second.estimates, list(second)) == (None, {}, ["sdof", "two_modes", "beam", "one"])
    assert vibeam.run(more, out, show=False).accuracy.chosen == "two_modes"


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"accuracy": "0 %"}, "'0 %' is outside [0.0001, 1]"),
        ({"accuracy": "200 %"}, "'200 %' is outside [0.0001, 1]"),
        ({"accuracy": "1 mm"}, "accuracy"),
        ({"accuracy": "1 %", "accuracy_of": ["amplitud"]}, "did you mean 'amplitude'?"),
        ({"accuracy": "1 %", "accuracy_of": ["maximum"]}, "'maximum' is not one of"),
        ({"accuracy_of": ["reach"]}, 'write accuracy = "1 %" beside it'),
        ({"fidelity.sdof.set": {"accuracy": 0.1}}, "accuracy is shared by all fidelities"),
    ],
)
def test_faults_are_told(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError) as error:
        load(RIG, set=settings)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("name", "settings", "said"),
    [
        ("dtu_loose", {"stop.wear": "1e-9 mm"}, r"the error cannot be estimated \(each impact widens the gap"),
        ("dtu_neutral", {"stop.restitution_of": "contact"}, "No fidelity is within.*add a fidelity with more modes"),
    ],
)  # fmt: skip
def test_what_cannot_be_had_is_refused_in_words(name: str, settings: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError, match=said):
        vibeam.run(case_of(name, "1 %", 3, **settings), show=False)


def test_a_rig_of_one_given_mode_is_refused_of_a_finished_file_too(tmp_path: Path) -> None:
    vibeam.run(parse(SDOF), tmp_path / "a.h5", show=False, compare=True)
    for out in (None, tmp_path / "a.h5"):
        with pytest.raises(CaseError, match="given directly has no fuller model"):
            vibeam.run(parse(SDOF, set={"accuracy": "1 %"}), out, show=False)
