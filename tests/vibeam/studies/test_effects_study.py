"""What effects change: closed forms, effects that do nothing or cancel, and the smallest set by an ordinary run."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from math import inf, isfinite, isinf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from effect_studies import (
    ADDED,
    BEAM,
    CASES,
    CLAMP,
    FIDELITY,
    GRAVITY,
    PEAK,
    QUICK,
    TORSION,
    by_name,
    case_of,
    study_of,
)
from scipy.optimize import brentq
from stand_in import RIG
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.read import parse
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.report.effects import answer, details, lines, sheet
from vibeam.report.effects import table as effects_table
from vibeam.report.tables import print_table
from vibeam.runs.comparison.errors import Asked
from vibeam.studies.changes import AMPLITUDES, ENDS, KINDS, PRINCIPAL
from vibeam.studies.effect_sets import subsets
from vibeam.studies.effects import Effects, influence
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import ensembles
from vibeam_models.beam import assemble

pytestmark = pytest.mark.usefixtures("undrawn")


def test_effects_that_do_nothing_come_out_as_not_needed() -> None:
    nothing = ADDED.replace("2.4 g", "1e-9 g"), CLAMP.replace("50", "1e15"), TORSION.replace("1 mm", "1e-8 mm")
    study = study_of(*nothing, influence__tolerance=0.002)
    rows = by_name(study)
    for name in ("added_mass", "clamp", "torsion"):
        assert rows[name].without.worst < 1e-6
        assert not rows[name].needed
    assert rows["torsion"].without.modes == study.whole.modes - 1
    assert study.enough.kept == ("mass.rotary_inertia", "mass.rigid_half_width")
    assert study.exact
    order = [row.without.worst for row in study.rows]
    assert order == sorted(order, reverse=True)
    first, second = needed = [row.effect for row in study.rows if row.needed]
    assert answer(study).startswith(
        f"For 0.2 % the scene needs {first} and {second} of its 5 effects: without {first} the model is "
    )
    assert set(needed) == set(study.enough.kept)
    assert "nothing changes. R = 0.72 at the contact is prescribed." in answer(study)


def scaled(times: int) -> Effects:
    """The study of the rig with all lengths 1/n, whose frequencies are all n times as high."""
    mm = {"beam.length": 180, "beam.width": 20, "beam.thickness": 1.034, "mass.position": 132, "sensor.position": 100}
    settings: dict[str, Any] = {key: f"{value / times} mm" for key, value in mm.items()}
    settings |= {"mass.mass": f"{0.2 / times**3} kg", "mass.rotary_inertia": f"{2.988e-5 / times**5} kg m^2"}
    settings |= {"mass.rigid_half_width": None, "drive.gain": f"{5.16e-4 / times} 1/V"}
    settings |= {"sweep.frequency": {"from": f"{14 * times} Hz", "to": f"{16.4 * times} Hz", "points": 7}}
    settings |= {"influence.quantities": ["peak_frequency"]}
    return influence(parse(BEAM + FIDELITY, RIG, QUICK | settings))


def test_an_effect_weighs_the_same_at_any_frequency() -> None:
    slow, fast = scaled(1), scaled(1000)
    (ours,), (theirs,) = slow.rows, fast.rows
    assert theirs.without.worst == pytest.approx(ours.without.worst, rel=1e-3)
    moved = [each.without.change(AskedNumber("peak_frequency")) for each in (ours, theirs)]
    assert moved[1] == pytest.approx(moved[0], rel=1e-2)
    assert 1e-3 < abs(moved[0]) < 1e-2


def first_frequency(case: Any) -> float:
    return float(assemble(case.scene).modes().omega[0])


def cancelling() -> dict[str, Any]:
    """Weight stiffens, the clamp softens: its stiffness is solved for, so that the first frequency is the bare one."""
    bare = {"mass__rotary_inertia": None, "mass__rigid_half_width": None, "fidelity__beam__modes": 1}
    target = first_frequency(case_of(**bare))
    both = lambda k: case_of(GRAVITY, CLAMP, **bare, clamp__stiffness=10**k)  # noqa: E731
    return bare | {"clamp__stiffness": 10 ** brentq(lambda k: first_frequency(both(k)) - target, 1, 5)}


def test_effects_that_cancel_are_not_dropped_singly() -> None:
    settings = cancelling()
    study = study_of(GRAVITY, CLAMP, **settings, influence__tolerance=0.03)
    assert all(row.without.worst > 1 for row in study.rows)
    assert study.enough.worst <= 1
    assert study.enough.kept == ()
    assert sum("together they cancel" in line for line in details(study)) == 2
    assert "the scene needs none of its 2 effects: without " in answer(study)
    tight = study_of(GRAVITY, CLAMP, **settings, influence__tolerance=0.03 * study.enough.worst / 2)
    assert set(tight.enough.kept) == {"gravity", "clamp"}


def test_the_needed_set_keeps_its_promise_in_an_ordinary_run() -> None:
    """Against sweeps of 241 points, that strike once a period: a tolerance at 31 of them holds at the others."""
    grid = {"from": "14 Hz", "to": "16.4 Hz", "points": 31}
    case = case_of(ADDED, CLAMP, influence__tolerance=0.08, sweep__frequency=grid)
    study = influence(case)
    assert 0 < len(study.enough.kept) < 4

    def swept(names: Any) -> np.ndarray:
        fine = QUICK | dict.fromkeys(names) | {"sweep.frequency": {"from": "14 Hz", "to": "16.4 Hz", "points": 241}}
        up = vibeam.run(parse(BEAM + FIDELITY + ADDED + CLAMP, RIG, fine))["beam"].up
        assert set(up.period.tolist()) == {1}
        return np.asarray(up.amplitude)

    whole = swept(())
    off = np.abs(swept(set(subsets(case).effects) - {*study.enough.kept}) / whole - 1).max()
    assert off == pytest.approx(abs(study.enough.change(AMPLITUDES)), rel=0.02)
    assert off <= 0.08
    for row in study.rows:
        lacking = np.abs(swept({row.effect}) / whole - 1).max()
        assert abs(row.without.change(AMPLITUDES)) == pytest.approx(lacking, rel=0.02)


def test_a_quantity_that_the_case_names_decides_too() -> None:
    """A response that stays within 30 % and has no ends, whose peak moves by more than a millionth."""
    wide = {"influence__tolerance": 0.3, "influence__frequency_accuracy": 1e-6}
    assert study_of(**wide).enough.kept == ()
    named = study_of(**wide, influence__quantities=["peak_frequency"])
    assert set(named.enough.kept) == {"mass.rotary_inertia", "mass.rigid_half_width"}
    assert "the peak frequency is " in answer(named)


def test_of_a_sweep_without_contact_the_peak_decides() -> None:
    """A linear motion at one frequency: without an added mass the resonance is elsewhere."""
    case = case_of(ADDED, stop__gap="50 mm", sweep__frequency=["8 Hz"], influence__tolerance=0.001)
    study = influence(case)
    row = by_name(study)["added_mass"]
    bare = case.with_keys({"added_mass": None})
    peaks = [vibeam.run(each, show=False)["beam"].peak.amplitude for each in (bare, case)]
    assert row.without.change(PEAK) == pytest.approx(peaks[0] / peaks[1] - 1, rel=1e-9)
    assert row.without.worst == pytest.approx(abs(peaks[0] / peaks[1] - 1) / 0.001, rel=1e-9)


def test_a_gap_that_grows_by_impacts_is_swept_as_a_run_does() -> None:
    case = case_of(stop__wear="1e-8 m", sweep__settle=40)
    study = influence(case)
    worn, fresh = (vibeam.run(each, show=False)["beam"].up.amplitude for each in (case, case_of(sweep__settle=40)))
    off = fresh / worn - 1
    assert by_name(study)["stop.wear"].without.change(AMPLITUDES) == pytest.approx(off[np.argmax(abs(off))], rel=1e-6)


def test_one_frequency_is_compared_as_well() -> None:
    study = study_of(sweep__frequency=["15 Hz"])
    for row in study.rows:
        assert row.without.change(AMPLITUDES) == pytest.approx(row.without.change(PEAK), rel=1e-6)
        assert row.needed


def test_a_budget_leaves_sets_out_and_claims_no_smallest() -> None:
    done: list[tuple[int, int]] = []
    case = case_of(ADDED, CLAMP, influence__tolerance=0.002)
    study = influence(case, progress=lambda *counts: done.append(counts), budget=0.0)
    assert (study.exact, study.left_out > 0, study.models) == (False, True, 1)
    assert {row.without.why for row in study.rows} == {"left out: over the budget"}
    assert set(study.enough.kept) == {row.effect for row in study.rows}
    assert all(count <= total for count, total in done)
    assert "the scene may need all of its 4 effects" in answer(study)
    assert any("allow more (--budget)" in note for note in sheet(study).notes)
    assert "what changes is not known (left out: over the budget)" in answer(study)
    assert influence(case).left_out == 0


def test_a_sweep_that_takes_too_long_is_left_out_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match="its sweep takes longer than 0 s"):
        ensembles([(case_of(), "beam")], [PEAK], limit=0.0)
    monkeypatch.setattr("vibeam.studies.effects.DEAREST", 0.0)
    monkeypatch.setattr("vibeam.studies.effects.SHORT", 0.0)
    study = study_of()
    assert study.left_out == 3
    assert "may need all of its 2 effects" in answer(study)


def test_a_fidelity_that_goes_without_an_effect_has_it_not() -> None:
    less = '[fidelity.less]\nreduction = "modal"\nmodes = 4\nwithout = ["mass.rigid_half_width"]\n'
    study = study_of(less, influence__fidelity="less")
    assert [row.effect for row in study.rows] == ["mass.rotary_inertia"]
    assert subsets(case_of(less)).fidelity == "beam"


@pytest.mark.parametrize("place", ["contact", "first mode"])
def test_the_other_restitution_may_turn_the_change_of_a_peak(place: str) -> None:
    """By the case that prescribes it: the two studies have one another's numbers."""
    grid = {"stop__restitution_of": place, "mass__rigid_half_width": None}
    other = "first mode" if place == "contact" else "contact"
    [ours], [theirs] = (study_of(**grid | {"stop__restitution_of": each}).rows for each in (place, other))
    assert ours.other_peak == pytest.approx(theirs.without.change(PEAK), rel=1e-9)
    assert ours.turns == (ours.other_peak * ours.without.change(PEAK) < 0)


def test_a_record_has_no_numbers_of_a_sweep() -> None:
    """A shock on the rig: with peaks and the hardest impact judged, by the same study."""
    quick = {"record.duration": "0.05 s", "record.values": [1.0], "record.certify": False, "beam.elements": 8,
             "expect": None, "show": None, "fidelity.beam.modes": 3}  # fmt: skip
    study = influence(vibeam.load(CASES / "inputs" / "half_sine.toml", quick))
    assert {each.number.quantity for each in study.enough.changes if isfinite(each.allowed)} == {*PRINCIPAL}
    assert not {AMPLITUDES, ENDS, KINDS} & {each.number for each in study.enough.changes}
    assert study.other is None
    assert answer(study).startswith("For 1 % the scene needs ")
    assert {row["effect"] for row in lines(study)} == {"", "mass.rotary_inertia", "mass.rigid_half_width"}


def test_a_change_that_its_error_alone_makes_too_large_is_said_to_be_uncertain() -> None:
    study = study_of(influence__tolerance=0.05, sweep__frequency=["15 Hz"])
    row = study.rows[0]
    lost = [
        replace(each, change=0.01, error=0.03) if each.number == AMPLITUDES else each for each in row.without.changes
    ]
    shown = replace(study, rows=(replace(row, without=replace(row.without, changes=tuple(lost)), needed=True),))
    assert f"without {row.effect} the amplitudes may be 7 % off" in answer(shown)


def test_a_record_whose_motions_end_early_without_an_effect_needs_it() -> None:
    """Numbers that a variant has not are no change that could be known: the effect stays, and the sentence says why."""
    study = study_of(sweep__frequency=["15 Hz"])
    row = study.rows[0]
    lost = tuple(replace(each, change=nan, error=nan) for each in row.without.changes)
    gone = replace(row, without=replace(row.without, changes=lost, comparison=None), needed=True)
    assert isinf(gone.without.worst)
    assert f"without {row.effect} no motion runs to its end" in answer(replace(study, rows=(gone,)))


# --- the case's table and the command ---------------------------------------------------------------------------------


def test_the_table_says_what_is_done() -> None:
    plan = '[influence]\nquantities = ["ringing"]\ntolerance = "2 %"\nfrequency_accuracy = "3 %"\npoints = 3\n'
    study = influence(case_of(plan, sweep__settle=20))
    assert study.asked == Asked(0.02, 0.03)
    assert {each.number: each.allowed for each in study.enough.changes if isfinite(each.allowed)} == {
        AMPLITUDES: 0.02, ENDS: 0.03, KINDS: 0.03, AskedNumber("ringing"): 0.02,
    }  # fmt: skip
    np.testing.assert_allclose(subsets(case_of(plan)).whole.sweep.frequency, [14.0, 15.2, 16.4])
    fifth = influence(case_of(influence={"tolerance": 0.05, "points": 3}, sweep__settle=20))
    assert (fifth.asked.amplitude, fifth.asked.frequency) == (0.05, pytest.approx(0.01))
    assert case_of(plan).key == case_of().key  # it changes no sweep
    with pytest.raises(CaseError) as wrong:
        case_of('[influence]\nfidelity = "beem"\nquantities = ["peek"]\npoints = 2\n')
    assert [fault.key for fault in wrong.value.faults] == [
        "influence.fidelity", "influence.quantities", "influence.points",
    ]  # fmt: skip
    assert "did you mean 'beam'?" in str(wrong.value)


def test_the_command_prints_and_writes(tmp_path: Path) -> None:
    file = tmp_path / "rig.toml"
    file.write_text(BEAM + FIDELITY, encoding="utf-8")
    words = [f"--set={name}={value}" for name, value in QUICK.items() if name != "sweep.frequency"]
    words += ["--set=influence.points=3", "--set=influence.direction=up"]
    runner = CliRunner()
    wrong = runner.invoke(app, ["study", "influence", str(file), *words])
    assert wrong.exit_code == 2
    assert "influence.direction: unknown key" in wrong.stderr
    done = runner.invoke(app, ["study", "influence", str(file), *words[:-1], "--out", str(tmp_path), "--json"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert {row["effect"] for row in found["rows"]} == {"mass.rotary_inertia", "mass.rigid_half_width"}
    assert "the scene needs " in found["answer"]
    stem = tmp_path / "rig_influence.csv"
    rows = list(csv.DictReader(stem.read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 5 * (2 * 2 + 1)
    bare = runner.invoke(app, ["study", "influence", str(file), "--set=mass.rotary_inertia=0.1 kg"])
    assert bare.exit_code == 2


def test_tables_show_what_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    """A number that a model lacks is a dash, its reason below."""
    study = study_of(influence__quantities=["ringing"], fidelity__beam__modes=2)
    row = study.rows[0]
    lost = [
        replace(each, change=inf) if each.number == AskedNumber("ringing") else each for each in row.without.changes
    ]
    without = replace(row.without, changes=tuple(lost), remarks=("ringing: no impacts at 15 Hz",))
    shown = replace(study, rows=(replace(row, without=without), *study.rows[1:]))
    print_table(effects_table(shown))
    text = capsys.readouterr().out
    line = next(each for each in text.splitlines() if row.effect in each)
    assert "∞" in line
    assert f"Without {row.effect}, ringing: no impacts at 15 Hz" in list(details(shown))
    assert "the ringing is not there to compare" in answer(shown)


def test_a_solid_loses_an_effect_and_keeps_its_modes() -> None:
    """How many modes a solid has is not known before it is meshed: their number is left as it is."""
    own = '[fidelity.solid]\nmodel = "solid"\nreduction = "modal"\nmodes = 4\n'
    found = subsets(parse(BEAM + ADDED + own, RIG, QUICK))
    assert found.fidelity == "solid"
    kept = [name for name in found.effects if not name.startswith("added_mass")]
    assert len(kept) < len(found.effects)
    assert found.case(kept).fidelities["solid"].modes == 4
