"""What effects change: the case without them by hand, closed forms, effects that do nothing, effects that cancel, sets
that make no sense, and the smallest set by an ordinary run.
"""

from __future__ import annotations

import csv
import itertools
import json
from dataclasses import replace
from math import inf, isfinite, isinf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from stand_in import HELD_AT_CONTACT, RIG, SDOF, same
from typer.testing import CliRunner

import vibeam
from vibeam.casefile.documentation import reference_table
from vibeam.casefile.read import parse
from vibeam.casefile.tables.table import key, table
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.report.effects import answer, bars, details, lines, sheet
from vibeam.report.effects import table as effects_table
from vibeam.report.tables import print_table
from vibeam.runs.comparison.errors import Asked, ResponseComparison
from vibeam.studies.changes import AMPLITUDES, ENDS, KINDS, changes
from vibeam.studies.effect_sets import effects_of, is_effect, smallest, subsets
from vibeam.studies.effects import Effects, influence
from vibeam.studies.recorded_numbers import AskedNumber
from vibeam.studies.variants import Ensemble, ensembles
from vibeam_models.beam import assemble

pytestmark = pytest.mark.usefixtures("undrawn")

CASES = RIG.parent
PEAK = AskedNumber("peak")
BEAM = HELD_AT_CONTACT.split("[fidelity.sdof]")[0]
FIDELITY = '[fidelity.beam]\nreduction = "modal"\nmodes = 4\n'
ADDED = '[[added_mass]]\nmass = "2.4 g"\nposition = "90 mm"\n'
CLAMP = '[clamp]\nstiffness = "50 N m/rad"\n'
GRAVITY = '[gravity]\ndirection = "hanging"\n'
TORSION = '[torsion]\neccentricity = "1 mm"\npolar_inertia = "2.988e-5 kg m^2"\npoissons_ratio = 0.3\n'
PLATFORM = (
    '[platform]\nmass = "5 kg"\nfrequency = "3.25 Hz"\ndamping_ratio = 0.05\ncoupling = "one-way"\n'
    'calibrated_at = "15.5 Hz"\n'
)
SHAKER = '[shaker]\nresistance = "4 ohm"\nforce_factor = "20 N/A"\n'
QUICK: dict[str, Any] = {
    "units": "SI",
    "beam.elements": 8,
    "sweep.frequency": {"from": "14 Hz", "to": "16.4 Hz", "points": 7},
    "sweep.direction": "up",
    "sweep.settle": 150,
    "sweep.hold": 4,
}


def case_of(*tables: str, **settings: Any) -> Any:
    """A quick case of the rig with further tables; settings by key with __ for dots."""
    given = {name.replace("__", "."): value for name, value in settings.items()}
    return parse(BEAM + FIDELITY + "\n".join(tables), RIG, QUICK | given)


def study_of(*tables: str, **settings: Any) -> Effects:
    return influence(case_of(*tables, **settings))


def by_name(study: Effects) -> dict[str, Any]:
    return {row.effect: row for row in study.rows}


# --- which effects there are ------------------------------------------------------------------------------------------


def test_every_effect_that_a_case_names_is_found() -> None:
    every = BEAM.replace('gap = "0 mm"', 'gap = "0 mm"\nposition = "130 mm"') + ADDED + CLAMP + GRAVITY + TORSION
    every = every.replace("elements = 36", "elements = 36\nmassless = true") + PLATFORM + FIDELITY.replace("4", "2")
    declared = parse(every, RIG).keys.declared
    names = {"beam.massless", "mass.rotary_inertia", "mass.rigid_half_width"}
    assert set(effects_of(declared)) == names | {"added_mass", "clamp", "gravity", "torsion", "platform"}
    absent = parse(every, RIG, {"beam.massless": False, "clamp": None}).keys.declared
    assert set(effects_of(absent)) == set(effects_of(declared)) - {"beam.massless", "clamp"}
    twice = parse(BEAM + ADDED + ADDED + FIDELITY, RIG).keys.declared
    assert {"added_mass.0", "added_mass.1"} < set(effects_of(twice))


@pytest.mark.parametrize("place", ["rigs/mems_switch", "rigs/pinned_bar", "rigs/afm_tip", "rigs/elastic_stop"])
def test_what_says_the_rig_is_no_effect_of_it(place: str) -> None:
    """Where the stop is, what it does, and how the ends are held: without these there is another rig, or none."""
    declared = parse((CASES / f"{place}.toml").read_text(encoding="utf-8"), CASES / f"{place}.toml").keys.declared
    assert declared.stop.law is not None
    assert not {"stop.law", "stop.position", "beam.ends"} & set(effects_of(declared))
    told = {(row.table, row.key): row.meaning for row in reference_table()}
    assert not [key for key in ("law", "position") if told["[stop]", key].startswith("effect")]
    assert not told["[beam]", "ends"].startswith("effect")
    assert told["[beam]", "massless"].startswith("effect")


def test_a_key_or_table_is_an_effect_by_its_declaration_not_by_its_words() -> None:
    told = table("Told", "Effect: in words alone.", {"ghost": (Any, key("effect: in words alone", 1, None))})
    meant = table("Meant", "Haunts the beam.", {"ghost": (Any, key("haunts the beam", 1, None, effect=True))})
    assert not is_effect(told.model_fields["ghost"])
    assert is_effect(meant.model_fields["ghost"])
    assert meant.model_fields["ghost"].description == "effect: haunts the beam"


# --- sets of effects --------------------------------------------------------------------------------------------------


def test_a_set_is_the_case_with_the_rest_taken_away_by_hand_to_the_bit() -> None:
    """Three ways to one model: the subset, a fidelity that goes ``without``, keys taken away."""
    case = case_of(ADDED, CLAMP, influence__points=3)
    sets = subsets(case)
    ours = vibeam.run(sets.case({"mass.rotary_inertia", "added_mass"}))["beam"].up
    grid = sets.case(sets.effects).sweep.frequency.tolist()
    np.testing.assert_allclose(grid, [14.0, 15.2, 16.4])
    text = BEAM + FIDELITY + 'without = ["clamp", "mass.rigid_half_width"]\n' + ADDED + CLAMP
    without = vibeam.run(parse(text, RIG, QUICK | {"sweep.frequency": grid}))["beam"].up
    away = {"clamp": None, "mass.rigid_half_width": None, "sweep.frequency": grid}
    by_key = vibeam.run(case_of(ADDED, CLAMP, **{name.replace(".", "__"): value for name, value in away.items()}))
    assert same(ours, without, ("cpu_seconds",))
    assert same(ours, by_key["beam"].up, ("cpu_seconds",))
    whole = vibeam.run(sets.case(sets.effects))["beam"].up
    assert not same(ours, whole, ("cpu_seconds",))
    [found] = ensembles([(sets.case({"mass.rotary_inertia", "added_mass"}), "beam")], [PEAK])
    assert found.response is not None
    assert [place.amplitude for place in found.response.places["up"]] == list(ours.amplitude)


def test_of_several_added_masses_each_is_an_effect() -> None:
    case = case_of(ADDED, ADDED.replace("2.4", "7"), ADDED.replace("2.4", "9"))
    sets = subsets(case)
    left = [mass.mass for mass in sets.case({"added_mass.1"}).scene.effects]
    assert left == [pytest.approx(7e-3)]
    assert sets.case(()).scene.effects == ()


def test_modes_that_an_effect_brings_go_with_it() -> None:
    """Without torsion the two modes of torsion are gone and bending keeps its own two: no change of reduction."""
    sets = subsets(case_of(TORSION, ADDED))
    assert sets.own_modes == {"torsion": 1}
    with_it, without = (sets.case(kept) for kept in (sets.effects, set(sets.effects) - {"torsion"}))
    assert without.fidelities["beam"].modes == 3
    bending = without.system("beam").omega
    whole = with_it.system("beam").omega
    assert all(np.min(np.abs(whole / each - 1)) < 1e-9 for each in bending)


def test_keys_that_mean_nothing_without_an_effect_go_with_it() -> None:
    """The drift with its frequencies, and not the law's own keys, which are the stop's."""
    drift = 'restitution_of = "contact"\ndrift_frequency = ["14 Hz", "17 Hz"]\ndrift = ["0 mm", "0.02 mm"]\n'
    text = BEAM.replace('restitution_of = "contact"\n', drift + 'law = "linear"\nstiffness = "1e6 N/m"\n') + FIDELITY
    sets = subsets(parse(text, RIG, QUICK))
    assert "stop.drift_frequency" in sets.effects
    left, kept = (sets.case(kept).scene.stop for kept in (sets.effects, ()))
    assert left.drift is not None
    assert (kept.drift, kept.law.stiffness) == (None, 1e6)


def test_a_massless_beam_has_the_modes_that_are_left() -> None:
    sets = subsets(case_of(beam__massless=True, fidelity__beam__modes=2))
    assert sets.case({"beam.massless"}).fidelities["beam"].modes == 1
    assert sets.case({"mass.rotary_inertia"}).fidelities["beam"].modes == 2


def test_what_cannot_be_taken_away_is_told_with_its_reason_and_needed() -> None:
    driven = 'voltage = "0.6 V"'
    text = BEAM.replace(driven + '\ngain = "5.16e-4 1/V"', driven) + FIDELITY + PLATFORM + SHAKER
    text = text.replace('calibrated_at = "15.5 Hz"\n', "")
    study = influence(parse(text, RIG, QUICK))
    platform, shaker = (by_name(study)[name] for name in ("platform", "shaker"))
    assert isinf(platform.without.worst)
    assert isinf(shaker.without.worst)
    assert "drives a platform" in platform.without.why
    assert "gain" in shaker.without.why
    assert platform.needed
    assert shaker.needed
    said = "\n".join(details(study))
    assert "platform cannot be left out of the case as it is (" in said
    kept = {row["model"]: row["why"] for row in lines(study) if row["effect"] == "platform"}
    assert "drives a platform" in kept["without"]


def test_a_case_without_effects_says_so() -> None:
    with pytest.raises(ValueError, match="names no effect"):
        influence(parse(BEAM + FIDELITY, RIG, QUICK | {"mass.rotary_inertia": None, "mass.rigid_half_width": None}))
    with pytest.raises(ValueError, match="single degree of freedom"):
        influence(parse(SDOF))


# --- changes ----------------------------------------------------------------------------------------------------------


def ensemble(value: float) -> Ensemble:
    """A motion of which one number is known."""
    return Ensemble("", 1, {PEAK: np.array([[value]])}, np.zeros((1, 1)))


@pytest.mark.parametrize(
    ("ours", "whole", "share"),
    [(1.03, 1.0, 3.0), (0.98, 1.0, 2.0), (nan, 1.0, inf), (1.0, nan, inf), (1.0, 0.0, inf), (0.0, 0.0, 0.0)],
)
def test_a_change_counts_in_units_of_what_is_allowed_and_is_never_dropped(
    ours: float, whole: float, share: float
) -> None:
    *_, found = changes(ensemble(whole), ensemble(ours), ResponseComparison(), {PEAK: 0.01})
    assert found.share == pytest.approx(share)


def test_a_number_that_neither_has_is_no_change() -> None:
    *_, found = changes(ensemble(nan), ensemble(nan), ResponseComparison(), {PEAK: 0.01})
    assert not found.share > 0


def test_of_a_comparison_what_it_may_be_off_at_most_counts() -> None:
    """Two sweeps of one degree of freedom, whose own numbers are those of the comparison."""
    case = case_of(sweep__direction="both")
    ours, whole = (ensembles([(each, "beam")], [PEAK])[0] for each in (case_of(mass__rotary_inertia=None), case))
    study = influence(case)
    [row] = [each for each in study.rows if each.effect == "mass.rotary_inertia"]
    found = row.without.comparison
    assert found is not None
    assert found.scattered is not None
    by_number = {each.number: each for each in row.without.changes}
    assert by_number[AMPLITUDES].size == pytest.approx(found.scattered.most)
    assert by_number[ENDS].size == pytest.approx(max((abs(each.error) + each.open for each in found.ends), default=0))
    assert by_number[KINDS].size == pytest.approx(max((each.width + each.open for each in found.kinds), default=0))
    peaks = [float(each.of(PEAK)[0, 0]) for each in (ours, whole)]
    assert by_number[PEAK].change == pytest.approx(peaks[0] / peaks[1] - 1)
    assert by_number[PEAK].allowed == inf


# --- the search -------------------------------------------------------------------------------------------------------


def test_the_smallest_set_is_smallest_whatever_the_sets_are_worth() -> None:
    random = np.random.default_rng(7)
    for count in (1, 3, 5):
        names = tuple("abcdef"[:count])
        sets = [frozenset(n for n, bit in zip(names, bits, strict=True) if bit)
                for bits in itertools.product((0, 1), repeat=count)]  # fmt: skip
        for _ in range(40):
            worth = {kept: float(random.choice([0.3, 0.9, 1.1, 5.0, inf])) for kept in sets} | {frozenset(names): 0.0}
            found, exact = smallest(names, worth.__getitem__)
            good = [kept for kept in sets if worth[kept] <= 1]
            assert exact
            assert found in good
            assert len(found) == min(map(len, good))
            assert worth[found] == min(worth[kept] for kept in good if len(kept) == len(found))


def test_beyond_six_effects_one_after_another_is_left_out() -> None:
    names = tuple("abcdefg")
    cost = dict(zip(names, (0.1, 0.2, 0.3, 0.35, 5, 6, 7), strict=True))
    found, exact = smallest(names, lambda kept: sum(cost[name] for name in names if name not in kept))
    assert not exact
    assert found == frozenset("efg")
    assert smallest(names, lambda kept: 0.0)[0] == frozenset()
    cancel = {frozenset(names): 0.0, frozenset("cdefg"): 0.0}
    assert smallest(names, lambda kept: cancel.get(kept, 9.0))[0] == frozenset(names)


# --- whole studies ----------------------------------------------------------------------------------------------------


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
    """A shock on the rig: with peaks alone judged, by the same study."""
    quick = {"record.duration": "0.05 s", "record.values": [1.0], "record.certify": False, "beam.elements": 8,
             "expect": None, "show": None, "fidelity.beam.modes": 3}  # fmt: skip
    study = influence(vibeam.load(CASES / "inputs" / "half_sine.toml", quick))
    assert {each.number.quantity for each in study.enough.changes if isfinite(each.allowed)} == {"peak"}
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
    assert all(stem.with_suffix(ending).stat().st_size > 1000 for ending in (".png", ".svg"))
    bare = runner.invoke(app, ["study", "influence", str(file), "--set=mass.rotary_inertia=0.1 kg"])
    assert bare.exit_code == 2


def test_tables_and_plot_show_what_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    """A number that a model lacks is a dash, its reason below, and a full bar."""
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
    widths = [patch.get_width() for patch in bars(shown).axes[0].patches]
    assert max(widths) == pytest.approx(1e3, rel=1e-3)
    assert all(isfinite(width) for width in widths)


def test_a_solid_loses_an_effect_and_keeps_its_modes() -> None:
    """How many modes a solid has is not known before it is meshed: their number is left as it is."""
    own = '[fidelity.solid]\nmodel = "solid"\nreduction = "modal"\nmodes = 4\n'
    found = subsets(parse(BEAM + ADDED + own, RIG, QUICK))
    assert found.fidelity == "solid"
    kept = [name for name in found.effects if not name.startswith("added_mass")]
    assert len(kept) < len(found.effects)
    assert found.case(kept).fidelities["solid"].modes == 4
