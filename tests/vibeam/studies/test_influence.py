"""What effects change: truths of their own for peaks, ends, ringing and restitution, effects that do nothing, effects
that cancel, sets that make no sense, and the smallest set by an ordinary run.
"""

from __future__ import annotations

import csv
import itertools
import json
from dataclasses import dataclass, replace
from math import inf, isfinite, isinf, isnan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from stand_in import HELD_AT_CONTACT, RIG, SDOF, point, same
from typer.testing import CliRunner
from vibeam.report.influence import answer, bars, details, left_alone, lines, sheet, taken_away
from vibeam.studies.influence.curve import (
    Curve,
    Interest,
    Step,
    ValueRead,
    change,
    ends,
    quantities,
    refined_peak,
    swept,
)
from vibeam.studies.influence.model import observed_ringing
from vibeam.studies.influence.study import InfluenceStudy, influence
from vibeam.studies.influence.subsets import effects_of, is_effect, smallest, subsets

import vibeam
from vibeam.casefile.documentation import reference_table
from vibeam.casefile.read import parse
from vibeam.casefile.tables.table import key, table
from vibeam.cli.main import app
from vibeam.exchange.faults import CaseError
from vibeam.report.tables import print_table
from vibeam.system.impact_system import Drive
from vibeam.system.state import State
from vibeam_models.beam import assemble

pytestmark = pytest.mark.usefixtures("undrawn")

CASES = RIG.parent
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
    "influence.repeats": 1,
}


def case_of(*tables: str, **settings: Any) -> Any:
    """A quick case of the rig with further tables; settings by key with __ for dots."""
    given = {name.replace("__", "."): value for name, value in settings.items()}
    return parse(BEAM + FIDELITY + "\n".join(tables), RIG, QUICK | given)


def study_of(*tables: str, **settings: Any) -> InfluenceStudy:
    return influence(case_of(*tables, **settings))


def by_name(study: InfluenceStudy) -> dict[str, Any]:
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
    own = sets.case({"mass.rotary_inertia", "added_mass"})
    steps = swept(own, "beam", own.system("beam")).branches["up"]
    assert [step.amplitude for step in steps] == list(ours.amplitude)


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
    study = influence(parse(text, RIG, QUICK | {"influence.quantities": ["peak"]}))
    platform, shaker = (by_name(study)[name] for name in ("platform", "shaker"))
    assert isinf(platform.influence)
    assert isinf(shaker.influence)
    assert "drives a platform" in platform.without.why
    assert "gain" in shaker.without.why
    assert platform.needed
    assert shaker.needed
    said = "\n".join(details(study))
    assert "platform cannot be taken away from the case as it is (" in said
    kept = {row["model"]: row["why"] for row in lines(study) if row["effect"] == "platform"}
    assert "drives a platform" in kept["without"]


def test_a_case_without_effects_says_so() -> None:
    with pytest.raises(ValueError, match="names no effect"):
        influence(parse(BEAM + FIDELITY, RIG, QUICK | {"mass.rotary_inertia": None, "mass.rigid_half_width": None}))
    with pytest.raises(ValueError, match="single degree of freedom"):
        influence(parse(SDOF))


# --- quantities -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Drawn(Curve):
    """A curve whose points are a formula: amplitude and period over frequency."""

    law: Any = None

    def on(self, frequencies: Any, state: State | None) -> list[Step]:
        return [Step(self.law(float(f)), State(np.zeros(1), np.zeros(1))) for f in frequencies]


def drawn(law: Any, ways: tuple[str, ...] = ("up", "down")) -> Drawn:
    grid = np.linspace(14, 17, 13)
    empty = Drawn(SimpleNamespace(), "", SimpleNamespace(), {}, law)  # type: ignore[arg-type]
    branches = {way: empty.on(grid if way == "up" else grid[::-1], None) for way in ways}
    return replace(empty, branches=branches)


def test_a_smooth_peak_is_found_between_the_points() -> None:
    law = lambda f: point(f, amplitude=1e-3 / (1 + ((f - 15.3137) / 0.4) ** 2))  # noqa: E731
    found = refined_peak(drawn(law))
    assert found.frequency.number == pytest.approx(15.3137, abs=1e-5)
    assert found.amplitude.number == pytest.approx(1e-3, rel=1e-7)
    assert not found.frequency.why


def test_a_peak_at_a_jump_is_the_last_point_before_it() -> None:
    law = lambda f: point(f, amplitude=1e-4 * f if f < 15.62 else 1e-5)  # noqa: E731
    found = refined_peak(drawn(law))
    assert 15.62 - 0.25 / 16 <= found.frequency.number < 15.62
    assert found.amplitude.number == pytest.approx(1e-4 * found.frequency.number)


def test_a_peak_that_does_not_repeat_is_the_sweep_s_own_and_failed_points_are_none() -> None:
    wild = lambda f: point(f, amplitude=f, period=0)  # noqa: E731
    own = refined_peak(drawn(wild)).amplitude
    assert (own.number, own.why) == (17.0, "the motion at the peak does not repeat")
    broken = lambda f: point(f, amplitude=np.nan, ended=1)  # noqa: E731
    assert isnan(refined_peak(drawn(broken)).amplitude.number)
    assert refined_peak(drawn(broken)).amplitude.why == "no complete point"
    assert ends(drawn(wild))[0].why == "no motion of period 1 with impacts"
    rising = refined_peak(drawn(lambda f: point(f, amplitude=f)))
    assert rising.frequency.number == 17.0
    assert "may lie beyond" in rising.frequency.why


@pytest.mark.parametrize("ways", [("up",), ("down",), ("up", "down")])
def test_ends_of_period_one_are_halved_to(ways: tuple[str, ...]) -> None:
    law = lambda f: point(f, amplitude=f, period=1 if 14.61 < f < 16.377 else 2)  # noqa: E731
    low, high = ends(drawn(law, ways))
    assert low.number == pytest.approx(14.61, abs=0.25 / 2**9 + 1e-12)
    assert high.number == pytest.approx(16.377, abs=0.25 / 2**9 + 1e-12)
    whole = ends(drawn(lambda f: point(f, amplitude=f), ways))
    assert (whole[0].number, whole[1].number) == (14.0, 17.0)
    assert all("end of the sweep" in each.why for each in whole)


def test_peak_ringing_and_apparent_restitution_against_other_ways_to_them() -> None:
    """The peak by closed-form orbits, ringing by the mode's own damped frequency and motion, R by the first mode."""
    case = case_of()
    system = case.system("beam")
    curve = swept(case, "beam", system)
    top = refined_peak(curve)
    near = top.frequency.number + np.linspace(-0.02, 0.02, 21)
    omega = 2 * np.pi * near
    exact = vibeam.sweep(system, omega=omega, amplitude=case.base_amplitude, solver="orbit", output="sensor")
    rise = np.polyfit(near - near[10], exact.amplitude, 2)
    assert top.frequency.number - near[10] == pytest.approx(-rise[1] / (2 * rise[0]), abs=2e-4)
    assert top.amplitude.number == pytest.approx(rise[2] - rise[1] ** 2 / (4 * rise[0]), rel=1e-6)

    found = observed_ringing(curve, top.frequency.number, top.near)  # type: ignore[arg-type]
    damped = system.omega[1] * np.sqrt(1 - system.zeta[1] ** 2) / (2 * np.pi)
    assert found["ringing_frequency"].number == pytest.approx(damped, rel=1e-9)
    drive = Drive(2 * np.pi * top.frequency.number, case.base_amplitude)
    path = vibeam.simulate(system, drive, 300.0 / top.frequency.number)
    assert found["apparent_restitution"].number == pytest.approx(shown_by_first_mode(path), abs=1e-6)
    # mode 2 less its steady response to the drive is a free vibration: its envelope from what it is after the impact
    first, second = path.impact_times[-3:-1]
    x, v = (path.modes_at(np.array([first]))[0] - steady(path, first))[:, 1]
    w, z = system.omega[1], system.zeta[1]
    sigma, ring = z * w, w * np.sqrt(1 - z**2)
    speed = np.hypot(x, (v + sigma * x) / ring) * w * abs(system.output("sensor")[1])
    span = second - first
    mean = speed * -np.expm1(-sigma * span) / (sigma * span)
    assert found["ringing"].number == pytest.approx(mean, rel=0.01)  # which is read from the first sample on


def steady(path: Any, t: float) -> Any:
    """Displacements and velocities (2, n) of the modes driven without a stop, by the complex response."""
    system, big = path.system, path.drive.omega
    response = (
        system.load * big**2 * path.drive.amplitude / (system.omega**2 - big**2 + 2j * system.zeta * system.omega * big)
    )
    turning = response * np.exp(1j * big * t)
    return np.stack([turning.imag, (1j * big * turning).imag])


def shown_by_first_mode(path: Any) -> float:
    """−after/before of the sensor's velocity at an impact, without the free vibrations of the faster modes."""
    system, hit = path.system, path.impact_times[-2]
    after = path.modes_at(np.array([hit]))[0][1]
    jump = (system.contact @ after - path.impact_velocities[-2]) / (system.contact @ system.contact)
    row, forced = system.output("sensor"), steady(path, hit)[1]
    slow = [row[0] * rate[0] + row[1:] @ forced[1:] for rate in (after - jump * system.contact, after)]
    return float(-slow[1] / slow[0])


def test_one_mode_does_not_ring_and_says_so() -> None:
    one = study_of(influence__quantities=["ringing", "apparent_restitution"], fidelity__beam__modes=1)
    ringing, restitution = one.whole.changes
    assert isnan(ringing.value)
    assert "nothing rings" in ringing.why
    assert restitution.value == pytest.approx(0.72, abs=1e-6)
    assert any("nothing rings" in line and "every model" in line for line in details(one))


def test_changes_are_relative_or_absolute_and_never_dropped() -> None:
    relative, absolute = Interest("a", "a", "m", "relative", 0.01), Interest("b", "b", "1", "absolute", 0.1)
    assert change(relative, ValueRead(1.03), ValueRead(1.0)).share == pytest.approx(3)
    assert change(absolute, ValueRead(14.8), ValueRead(15.0)).share == pytest.approx(2)
    gone = change(relative, ValueRead(np.nan, "no peak"), ValueRead(1.0))
    assert (gone.share, gone.why) == (inf, "no peak")
    come = change(relative, ValueRead(1.0), ValueRead(np.nan, "no peak"))
    assert (come.share, come.why) == (inf, "all effects: no peak")
    assert change(relative, ValueRead(np.nan, "x"), ValueRead(np.nan, "x")).share == 0
    assert isinf(change(relative, ValueRead(1.0), ValueRead(0.0)).share)


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
        assert rows[name].influence < 1e-6
        assert not rows[name].needed
    assert (rows["torsion"].modes, rows["torsion"].coordinates) == (1, rows["torsion"].coordinates)
    assert rows["clamp"].coordinates == 1
    assert study.enough.kept == ("mass.rotary_inertia", "mass.rigid_half_width")
    assert study.exact
    order = [row.influence for row in study.rows]
    assert order == sorted(order, reverse=True)
    assert answer(study).startswith(
        "With R = 0.72 at the contact held, the scene needs mass.rotary_inertia and mass.rigid_half_width of its 5 "
        "effects: without mass.rotary_inertia the peak is "
    )
    assert answer(study).endswith("clamp and torsion nothing changes.") or "torsion and clamp" in answer(study)


def scaled(times: int) -> InfluenceStudy:
    """The study of the rig with all lengths 1/n, whose frequencies are all n times as high."""
    mm = {"beam.length": 180, "beam.width": 20, "beam.thickness": 1.034, "mass.position": 132, "sensor.position": 100}
    settings: dict[str, Any] = {key: f"{value / times} mm" for key, value in mm.items()}
    settings |= {"mass.mass": f"{0.2 / times**3} kg", "mass.rotary_inertia": f"{2.988e-5 / times**5} kg m^2"}
    settings |= {"mass.rigid_half_width": None, "drive.gain": f"{5.16e-4 / times} 1/V"}
    settings |= {"sweep.frequency": {"from": f"{14 * times} Hz", "to": f"{16.4 * times} Hz", "points": 7}}
    settings |= {"influence.quantities": ["peak_frequency", "period_one_to"], "influence.frequency_accuracy": 0.01}
    return influence(parse(BEAM + FIDELITY, RIG, QUICK | settings))


def test_an_effect_weighs_the_same_at_any_frequency() -> None:
    slow, fast = scaled(1), scaled(1000)
    (ours,), (theirs,) = slow.rows, fast.rows
    assert 0.3 < ours.influence < 1
    assert theirs.influence == pytest.approx(ours.influence, rel=1e-3)
    assert [row.needed for row in (ours, theirs)] == [False, False]
    assert fast.whole.changes[0].value == pytest.approx(1000 * slow.whole.changes[0].value, rel=1e-6)


def test_effects_that_cancel_are_not_dropped_singly() -> None:
    """Weight stiffens, the clamp softens: its stiffness is solved for, so that the first frequency is the bare one."""
    settings = {"influence__quantities": ["peak_frequency"], "fidelity__beam__modes": 1}
    bare = {"mass__rotary_inertia": None, "mass__rigid_half_width": None}

    def first(case: Any) -> float:
        return float(assemble(case.scene).modes().omega[0])

    target = first(case_of(**bare))
    both = lambda k: case_of(GRAVITY, CLAMP, **bare, clamp__stiffness=10**k)  # noqa: E731
    stiffness = 10 ** brentq(lambda k: first(both(k)) - target, 1, 5)
    study = study_of(GRAVITY, CLAMP, **settings, **bare, clamp__stiffness=stiffness)
    assert all(row.influence > 1 for row in study.rows)
    assert study.bare.worst < 0.3
    assert study.enough.kept == ()
    assert sum("together they cancel" in line for line in details(study)) == 2
    assert "the scene needs none of its 2 effects: without " in answer(study)
    tight = study_of(GRAVITY, CLAMP, **settings, **bare, clamp__stiffness=stiffness,
                     influence__frequency_accuracy=study.bare.changes[0].share * 0.001)  # fmt: skip
    assert set(tight.enough.kept) == {"gravity", "clamp"}


def test_the_needed_set_keeps_its_promise_in_an_ordinary_run() -> None:
    case = case_of(ADDED, CLAMP, influence__quantities=["peak", "peak_frequency"], influence__tolerance=0.08,
                   influence__frequency_accuracy=0.016)  # fmt: skip
    study = influence(case)
    assert 0 < len(study.enough.kept) < 4
    away = {name: None for name in subsets(case).effects if name not in study.enough.kept}
    peaks = []
    for settings in ({}, away):
        fine = QUICK | settings | {"sweep.frequency": {"from": "14 Hz", "to": "16.4 Hz", "points": 241}}
        up = vibeam.run(parse(BEAM + FIDELITY + ADDED + CLAMP, RIG, fine))["beam"].up
        peaks.append((float(up.amplitude.max()), float(up.frequency[np.argmax(up.amplitude)])))
    (whole, at), (ours, there) = peaks
    assert study.whole.changes[0].value == pytest.approx(whole, rel=2e-3)
    assert study.enough.changes[0].amount == pytest.approx(ours / whole - 1, abs=2e-3)
    assert study.enough.changes[1].amount == pytest.approx(there / at - 1, abs=0.011 / 15)
    assert abs(ours / whole - 1) < 0.08
    assert abs(there / at - 1) < 0.016


def test_a_budget_leaves_sets_out_and_claims_no_smallest() -> None:
    """By a clock that counts its looks, at least one a sweep: 32 sets want more than 12."""
    ticks = itertools.count()
    clock = lambda: float(next(ticks))  # noqa: E731
    done: list[tuple[int, int]] = []
    case = case_of(ADDED, CLAMP, TORSION, influence__quantities=["peak"], influence__tolerance=0.002)
    study = influence(case, progress=lambda *counts: done.append(counts), clock=clock, budget=12.0)
    assert (study.exact, study.left_out > 0) == (False, True)
    assert study.seconds <= 12 + 2 * study.left_out + 2  # a look at each of those left out
    assert study.enough.worst <= 1
    assert done[0][0] == 0
    assert all(count <= total for count, total in done)
    note = sheet(study, case).notes[0]
    assert f"{study.left_out} sweeps of sets of effects did not fit into 12 s" in note
    enough = float(note.partition(" --only effects --budget '")[2].partition(" s'")[0])
    ticks = itertools.count()
    assert influence(case, clock=clock, budget=enough).left_out == 0
    with pytest.raises(ValueError, match=r"6 models, all effects and each without one, take about .* and 4 s are"):
        influence(case, clock=clock, budget=4.0)


def test_a_motion_is_read_at_the_frequency_that_the_case_says() -> None:
    study = study_of(influence__frequency="15 Hz", influence__quantities=["apparent_restitution"])
    case = case_of()
    path = vibeam.simulate(case.system("beam"), Drive(2 * np.pi * 15, case.base_amplitude), 20.0)
    assert study.whole.changes[0].value == pytest.approx(shown_by_first_mode(path), abs=1e-6)


def test_a_fidelity_that_goes_without_an_effect_has_it_not() -> None:
    less = '[fidelity.less]\nreduction = "modal"\nmodes = 4\nwithout = ["mass.rigid_half_width"]\n'
    settings = {"influence__quantities": ["peak"], "influence__fidelity": "less"}
    study = study_of(less, **settings)
    assert [row.effect for row in study.rows] == ["mass.rotary_inertia"]
    assert subsets(case_of(less)).fidelity == "beam"


# --- the case's table and the command ---------------------------------------------------------------------------------


def test_the_table_says_what_is_done() -> None:
    case = case_of('[influence]\nquantities = ["ringing"]\ntolerance = "2 %"\nfrequency_accuracy = "3 %"\n')
    (ringing,) = quantities(case.influence)
    assert (ringing.name, ringing.tolerance) == ("ringing", 0.02)
    asked = {"tolerance": 0.05, "quantities": ["peak_frequency", "period_one_to"]}
    assert [each.tolerance for each in quantities(case_of(influence=asked).influence)] == [0.01, 0.01]  # a fifth
    both = quantities(case_of(influence=asked | {"frequency_accuracy": "3 %"}).influence)
    assert [(each.how, each.tolerance) for each in both] == [("relative", 0.03)] * 2
    assert len(quantities(case_of().influence)) == 7
    assert case.key == case_of().key  # it changes no sweep
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
    wrong = runner.invoke(app, ["verdict", str(file), "--only", "effects", *words])
    assert wrong.exit_code == 2
    assert "influence.direction: unknown key" in wrong.stderr
    done = runner.invoke(
        app, ["verdict", str(file), "--only", "effects", *words[:-1], "--out", str(tmp_path), "--json"]
    )
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert {row["effect"] for row in found["study"]["rows"]} == {"mass.rotary_inertia", "mass.rigid_half_width"}
    assert "held, the scene needs " in found["answer"]
    stem = tmp_path / "rig_influence.csv"
    rows = list(csv.DictReader(stem.read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 7 * (3 + 2 * 2)
    assert all(stem.with_suffix(ending).stat().st_size > 1000 for ending in (".png", ".svg"))
    bare = runner.invoke(app, ["verdict", str(file), "--only", "effects", "--set=mass.rotary_inertia=0.1 kg"])
    assert bare.exit_code == 2


def test_tables_and_plot_show_what_is_not_there(capsys: pytest.CaptureFixture[str]) -> None:
    """A quantity that a model lacks is a dash with a star, its reason below, and a full bar."""
    study = study_of(influence__quantities=["peak", "ringing"], fidelity__beam__modes=2)
    row = study.rows[0]
    lost = replace(row.without.changes[1], value=np.nan, amount=np.nan, share=inf, why="no impacts at 15 Hz")
    without = replace(row.without, changes=(row.without.changes[0], lost))
    shown = replace(study, rows=(replace(row, without=without), *study.rows[1:]))
    assert len(taken_away(shown).brief().columns) == 1 + 2 + 2  # coordinates, modes and CPU are details
    rests = [
        replace(each.without, changes=tuple(replace(c, share=0.0) for c in each.without.changes)) for each in study.rows
    ]
    still = [replace(each, without=without) for each, without in zip(study.rows, rests, strict=True)]
    assert taken_away(replace(study, rows=tuple(still))).brief().columns[-1].header == "influence"
    print_table(taken_away(shown))
    print_table(left_alone(shown))
    text = capsys.readouterr().out
    line = next(each for each in text.splitlines() if row.effect in each)
    assert "–*" in line
    assert "∞" in line
    assert any(f"* the ringing: no impacts at 15 Hz (without {row.effect})" in each for each in details(shown))
    edge = replace(study.whole.changes[0], why="the motion at the peak does not repeat")
    doubtful = replace(study, whole=replace(study.whole, changes=(edge, *study.whole.changes[1:])))
    told = [
        sum("try more influence.points" in each for each in sheet(one, case_of()).notes) for one in (study, doubtful)
    ]
    assert told == [0, 1]
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
