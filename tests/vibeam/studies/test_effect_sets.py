"""Which effects a case has, the case without some of them by hand, and the search for the smallest set."""

from __future__ import annotations

import itertools
from math import inf, isinf

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
    PLATFORM,
    QUICK,
    SHAKER,
    TORSION,
    by_name,
    case_of,
)
from stand_in import RIG, SDOF, same

import vibeam
from vibeam.casefile.documentation import reference_table
from vibeam.casefile.fields import TEXT
from vibeam.casefile.read import parse
from vibeam.casefile.tables.declared import key, table
from vibeam.report.effects import details, lines
from vibeam.studies.effect_sets import effects_of, smallest, subsets
from vibeam.studies.effects import influence
from vibeam.studies.variants import ensembles

pytestmark = pytest.mark.usefixtures("undrawn")


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
    told = table("Told", "Effect: in words alone.", {"ghost": key(TEXT, "effect: in words alone", "boo", None)})
    meant = table("Meant", "Haunts the beam.", {"ghost": key(TEXT, "haunts the beam", "boo", None, effect=True)})
    assert not told.KEYS["ghost"].effect
    assert meant.KEYS["ghost"].effect
    assert meant.KEYS["ghost"].description == "effect: haunts the beam"


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
