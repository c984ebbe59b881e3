"""Studies of cases under a record: against closed forms, scipy's linear systems, and runs compared by hand."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.signal import lsim
from typer.testing import CliRunner

import vibeam
from vibeam.case.study_plans import ModesNeededPlan
from vibeam.cli.main import app
from vibeam.report.effects import sheet
from vibeam.report.modes_needed import sheet as modes_sheet
from vibeam.report.transient import by_value
from vibeam.report.transient_answer import enough_at
from vibeam.runs.transient.run import run_record
from vibeam.studies.changes import changes
from vibeam.studies.effects import influence
from vibeam.studies.modes_needed import ModesNeeded
from vibeam.studies.record.modes import record_modes
from vibeam.studies.record.plane import axes_asked, record_map
from vibeam.studies.recorded_numbers import AskedNumber, suits
from vibeam.studies.variants import KNOWN, asked_number, ensembles, usual_numbers

SHOCK, LENGTH = 40.0, 11e-3  # m/s², s: a half-sine
FAR = "50 mm"
MODES = ((30.0, 1.0), (110.0, 0.4), (260.0, 0.1), (500.0, 0.02))  # Hz; mode × sensor, of a base that drives all alike


def modal_case(count: int = 4, gap: str = FAR, **more: Any) -> vibeam.Case:
    """Modes given by their frequencies, under a half-sine of the base."""
    ones = [1.0] * len(MODES)
    tables = {
        "modes": {
            "frequency": [f"{hertz} Hz" for hertz, _ in MODES], "damping_ratio": 0.02, "contact": ones,
            "sensor": [share for _, share in MODES], "base": ones,
        },
        "stop": {"gap": gap, "restitution": 0.7},
        "drive": {"shape": "half_sine", "acceleration": f"{SHOCK} m/s^2", "duration": f"{LENGTH} s"},
        "record": {"duration": "0.1 s"},
        "fidelity": {"few": {"reduction": "modal", "modes": 1}, "many": {"reduction": "modal", "modes": count}},
    }  # fmt: skip
    return vibeam.Case.of(tables, set=more)


@cache
def linear_motion(count: int) -> np.ndarray:
    """Displacement of the sensor without a stop, by scipy's transition matrices over 2 µs steps."""
    times = np.linspace(0.0, 0.1, 50_001)
    base = np.where(times < LENGTH, SHOCK * np.sin(np.pi * times / LENGTH), 0.0)
    total = np.zeros_like(times)
    for hertz, share in MODES[:count]:
        omega = 2 * np.pi * hertz
        total += share * lsim(([-1.0], [1.0, 0.04 * omega, omega**2]), base, times)[1]
    return total


def linear_peak(count: int) -> float:
    return float(np.abs(linear_motion(count)).max())


def test_peaks_over_the_level_are_those_of_the_linear_system() -> None:
    """2 µs between scipy's samples, joined by lines: 1e-5 of the peak at most."""
    found = record_map(modal_case(), {"level": [0.5, 1.0, 3.0]}, fidelities=["many"])
    assert found.means["many"] == pytest.approx(np.array([0.5, 1.0, 3.0]) * linear_peak(4), rel=2e-5)
    assert np.isnan(found.errors["many"]).all()  # one motion, no ensemble


def test_impacts_begin_where_the_free_peak_reaches_the_gap() -> None:
    """One mode: its contact is its sensor."""
    peak = float(linear_motion(1).max())
    found = record_map(modal_case(), {"stop.gap": [0.99 * peak, 1.01 * peak]}, "impacts", ["few"])
    assert found.means["few"][0] >= 1
    assert found.means["few"][1] == 0
    assert np.isnan(record_map(modal_case(), {"stop.gap": [1.01 * peak]}, "first impact", ["few"]).means["few"]).all()


def test_a_map_of_a_case_that_expects_numbers_at_one_level_takes_any_level() -> None:
    expected = {"fidelity": "few", "quantity": "impacts", "at": 1.0, "value": 3, "tolerance": "10 %"}
    case = modal_case().with_keys({"record.values": [1.0], "expect": {"hits": expected}})
    found = record_map(case, {"level": [0.5, 1.0]}, fidelities=["few"])
    bare = record_map(modal_case(), {"level": [0.5, 1.0]}, fidelities=["few"])
    np.testing.assert_array_equal(found.means["few"], bare.means["few"])


def test_a_plane_has_a_row_a_value_of_the_first_key() -> None:
    case = modal_case()
    found = record_map(case, {"stop.gap": [1e-4, 2e-4], "speed": [0.5, 1.0, 2.0]}, "hardest_impact", ["few"])
    assert found.means["few"].shape == (2, 3)
    one = run_record(case.with_keys({"stop.gap": 2e-4, "record.over": "speed", "record.values": [2.0]}), None,
                     lambda *each: None, False, lambda line: None)  # fmt: skip
    assert found.means["few"][1, 2] == one["few"].of("hardest_impact")[0, 0]


def modes_of(case: vibeam.Case, accuracy: float, budget: float = np.inf) -> ModesNeeded:
    return record_modes(case, ModesNeededPlan(accuracy), budget=budget)


def test_modes_suffice_where_scipy_says_so() -> None:
    off = [abs(linear_peak(count) / linear_peak(4) - 1) for count in (1, 2, 3)]
    found = modes_of(modal_case(), off[0] / 2)
    assert [row.modes for row in found.rows] == [1, 2, 3]
    assert [row.worst * off[0] / 2 for row in found.rows] == pytest.approx(off, abs=4e-5)
    enough = next(count for count in (1, 2, 3) if max(off[count - 1 :]) <= off[0] / 2)
    assert found.enough is not None
    assert found.enough.modes == enough > 1
    assert "modes suffice for " in modes_sheet(found).answer
    none = modes_of(modal_case(), 1e-9)
    assert none.enough is None
    assert "of three modes the peak of sensor is " in modes_sheet(none).answer


def test_a_budget_leaves_realisations_out() -> None:
    case = noisy()
    whole, less = (modes_of(case, 0.1, each) for each in (1e6, 1e-6))
    assert (whole.realisations, whole.left_out) == (6, 0)  # two values, three seeds
    assert (less.realisations, less.left_out) == (2, 2)
    assert "2 realisations left out over the budget." in modes_sheet(less).answer
    effects = influence(case, budget=1e-6)
    assert (effects.realisations, effects.left_out) == (2, 0)
    assert "; 2 realisations left out over the budget. " in sheet(effects).answer


def noisy(**more: Any) -> vibeam.Case:
    """Two fidelities under noise, which strike their stop."""
    tables = {
        "beam": {
            "length": "90 mm", "width": "8 mm", "thickness": "0.8 mm", "youngs_modulus": "200 GPa",
            "density": "7800 kg/m^3", "damping_ratio": 0.02, "elements": 6,
        },
        "mass": {"mass": "1.5 g", "position": "85 mm", "rotary_inertia": "1e-7 kg m^2"},
        "gravity": {"direction": "transverse"},
        "stop": {"gap": "0.2 mm", "restitution": 0.6},
        "sensor": {"position": "90 mm"},
        "drive": {"density": "0.02 g^2/Hz", "band": ["20 Hz", "300 Hz"], "seed": 5},
        "record": {"duration": "0.1 s", "realisations": 3, "values": [0.5, 1.0]},
        "fidelity": {"one": {"reduction": "static_mode"}, "two": {"reduction": "modal", "modes": 2}},
    }  # fmt: skip
    return vibeam.Case.of(tables, set=more)


def test_a_variant_on_the_same_realisations_as_itself_changes_nothing() -> None:
    case = noisy()
    one, same = ensembles([(case, "one"), (case, "one")], usual_numbers(case))
    for each in changes(one, same):
        assert (each.change, each.error) == (0.0, 0.0)


def test_a_few_numbers_are_those_that_a_run_reads() -> None:
    """To the last digits: a run reads extremes in 512 bins, which flies to the bins' edges."""
    case = noisy(**{"record.outputs": ["sensor", "contact"]})
    asked = [asked_number(case, each) for each in KNOWN if each not in ("mean", "rms")]
    asked += [asked_number(case, f"{each} of contact_velocity") for each in ("peak", "least", "peak_time")]
    assert suits(asked)
    assert not suits([asked_number(case, "rms")])
    [few] = ensembles([(case, "two")], asked)
    run = run_record(case, None, lambda *each: None, False, lambda line: None)["two"]
    for each in asked:
        whole = run.of(each.quantity, each.signal or None)
        assert few.of(each) == pytest.approx(whole, rel=1e-9, abs=1e-18), each
    [sampled] = ensembles([(case, "two")], [asked_number(case, "rms")])
    assert sampled.of(asked_number(case, "rms")).tolist() == run.of("rms").tolist()


def test_the_cheapest_within_is_named_at_each_value() -> None:
    """Differences by hand: mean over the seeds of the difference of the peaks over the mean peak; s/√3 its error."""
    case = noisy()
    result = run_record(case, None, lambda *each: None, False, lambda line: None)
    assert enough_at(result, 1e9) == [(0.5, "one"), (1.0, "one")]
    for at in range(2):
        ours, theirs = (result[name].of("peak")[at] for name in ("one", "two"))
        peak = result.comparison["one"].difference("peak", "sensor", at)
        assert peak.mean == pytest.approx(np.mean(ours - theirs) / np.mean(theirs), rel=1e-12)
        assert peak.error == pytest.approx(np.std(ours - theirs, ddof=1) / np.sqrt(3) / np.mean(theirs), rel=1e-12)
    assert enough_at(result, 1e-9) == [(0.5, "two"), (1.0, "two")]


def test_a_value_is_judged_by_its_own_differences_alone() -> None:
    """Halfway between the errors of the two values the fidelity suffices at one of them; so it is in the sheet."""
    result = run_record(noisy(), None, lambda *each: None, False, lambda line: None)
    of = result.comparison["one"]
    both = [[of.difference(*key, at) for key in (("peak", "sensor"), ("hardest_impact", ""))] for at in range(2)]
    sizes = [max(abs(each.mean) + 2 * each.error for each in principal) for principal in both]
    accuracy = sum(sizes) / 2
    expected = ["one" if size <= accuracy else "two" for size in sizes]
    assert sorted(expected) == ["one", "two"]
    assert [name for _, name in enough_at(result, accuracy)] == expected
    made = by_value(result, accuracy)
    assert [each["cheapest"] for each in made.data["values"]] == expected
    assert f"one at level {(0.5, 1.0)[expected.index('one')]:g}" in made.answer


def test_what_an_effect_changes_is_what_the_case_without_it_does() -> None:
    case = noisy()
    found = influence(case.with_keys({"influence.tolerance": 0.02}))
    assert {row.effect for row in found.rows} == {"gravity", "mass.rotary_inertia"}
    whole, without = (
        run_record(each, None, lambda *each: None, False, lambda line: None)["two"].of("peak")
        for each in (case, case.with_keys({"gravity": None}))
    )
    own = next(row for row in found.rows if row.effect == "gravity")
    by_hand = [np.mean(two - one) / np.mean(one) for one, two in zip(whole, without, strict=True)]
    assert min(abs(own.without.changes[0].change - each) for each in by_hand) < 1e-12
    assert ("gravity" in found.enough.kept) == next(row.needed for row in found.rows if row.effect == "gravity")
    assert found.exact
    assert found.models == 4


def test_a_peak_that_follows_its_input_has_its_quantiles_and_all_its_variance() -> None:
    """Without contact the peak is proportional to the shock: uniform ± 20 %, of which 90 % lie within ± 18 %."""
    case = modal_case(2, uncertain={"drive.acceleration": "32 m/s^2 … 48 m/s^2", "stop.gap": "± 1 mm"})
    found = vibeam.uncertainty(case, samples=32)
    peak = found.rows[0]
    assert peak.spread.nominal == pytest.approx(linear_peak(2), rel=2e-5)
    assert np.array(peak.spread.quantiles) / peak.spread.nominal == pytest.approx([0.82, 0.9, 1.0, 1.1, 1.18], abs=0.02)
    assert peak.indices.total[:, 0] == pytest.approx([1.0, 0.0], abs=0.3)
    low, high = peak.spread.mean_within
    assert low <= peak.spread.nominal <= high < 1.05 * low
    assert (found.samples, found.replicates, found.motions, found.failed) == (32, 8, 128, 0)


def test_what_cannot_be_asked_is_said() -> None:
    case = modal_case()
    for text, said in (("peek", "no quantity 'peek' of a record"), ("horizon", "no quantity 'horizon'")):
        with pytest.raises(ValueError, match=said):
            asked_number(case, text)
    assert asked_number(case, "peak of sensor_acceleration") == AskedNumber("peak", "sensor_acceleration")
    with pytest.raises(ValueError, match="has no signal 'tip'"):
        record_map(case, {"level": [1.0]}, "peak of tip")
    for given, said in (
        (("stop.gap", None, None), "--from: missing, for stop.gap has no usual range"),
        (("level,speed", None, None), "--over: write a key, or two"),
        (("gap,level", "0 mm", "1 mm"), "--from: 1 values for 2 keys"),
        (("level", "2", "1"), "must ascend"),
    ):
        with pytest.raises(ValueError, match=said):
            axes_asked(case, *given, None)
    with pytest.raises(ValueError, match="the solvers' errors are of steady motions"):
        vibeam.verdict(case, only=["solvers"])
    with pytest.raises(ValueError, match=r"verdict.over, verdict.points: of a \[sweep\]"):
        vibeam.verdict(case, only=["map"], over="drive", points=5)
    with pytest.raises(ValueError, match=r"influence.points: of a \[sweep\]"):
        vibeam.influence(noisy(**{"influence.points": 3}))
    with pytest.raises(ValueError, match="has no effects"):
        vibeam.influence(one_mode())


def one_mode() -> vibeam.Case:
    tables = {
        "sdof": {"natural_frequency": "50 Hz", "damping_ratio": 0.05}, "stop": {"gap": 1e-4, "restitution": 0.7},
        "drive": {"density": 1.0, "band": ["5 Hz", "200 Hz"], "seed": 1},
        "record": {"duration": "0.1 s", "realisations": 2}, "fidelity": {"one": {}},
    }  # fmt: skip
    return vibeam.Case.of(tables)


UNCERTAIN = ("--set", 'uncertain."stop.restitution"="± 0.05"')


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("map", "--over", "level", "--points", "3", "--quantity", "impacts"), 0, "Impacts over level: one up to"),
        (("map", "--over", "level", "--fidelity", "two"), 2, "--fidelity: no fidelity 'two'; known here: one"),
        (("map", "--over", "stop.gapp", "--from", "0", "--to", "1"), 2, "--over: 'stop.gapp' is no key of the case"),
        (("map", "--picture", "stability"), 2, "--picture: is of a map of a [sweep]"),
        (("verdict",), 0, 'Not answered: fidelity one: reduction = "static_mode" says its modes itself'),
        (("verdict", "--only", "map"), 2, "fewer than two fidelities of one rig"),
        (("uncertainty", "--samples", "16", *UNCERTAIN), 0, "Peak of sensor, one: "),
    ],
)  # fmt: skip
def test_the_command_line_takes_a_record(
    words: tuple[str, ...], code: int, said: str, tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.toml").write_text(one_mode().text, encoding="utf-8")
    found = CliRunner().invoke(app, [words[0], "ball.toml", *words[1:]])
    assert found.exit_code == code, found.output
    assert said in " ".join((found.stdout + found.stderr).split())
    if words[0] == "map" and not code:
        assert (tmp_path / "ball_map.png").stat().st_size > 5000
        assert len((tmp_path / "ball_map.csv").read_text().splitlines()) == 4
