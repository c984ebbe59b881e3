"""The contact dictionary against the programs' own equations, integrated in mpmath, and the book's stored section."""

from __future__ import annotations

import json
from functools import cache
from math import exp
from typing import Any

import pytest

import vibeam
from tests.others import dictionary_book
from tests.others.dictionary_book import ITS_OWN, MASS, RESULTS, SHOWN, SPEED, SPEEDS, TIME, requests, worst
from tests.others.program_contacts import FORCES, IMPACT_MATERIAL, ProgramContact, impact
from vibeam.extensions.dictionary.terms import FORMS

ROUND_OFF = 1e-11  # of the integrations, 2e-12 at most
LASTING = 2e-9  # of contact times, which the dictionary integrates to 1e-9
CRITICAL = 1.0  # a damping ratio


@cache
def terms(restitution: float) -> dict[str, Any]:
    return vibeam.contact_terms(restitution, mass=MASS, contact_time=TIME, speed=SPEED)


@pytest.mark.parametrize("form", FORMS)
def test_a_form_has_its_restitution_and_lasts_as_long_by_the_program_s_own_equation(form: str) -> None:
    for wanted in (0.3, 0.9):
        parameters = terms(wanted)[form].parameters
        found = impact(FORCES[form], parameters, MASS, SPEED)
        assert found.restitution == pytest.approx(wanted, abs=ROUND_OFF)
        assert found.duration == pytest.approx(TIME, rel=LASTING)
        assert vibeam.restitution_in(form, mass=MASS, speed=SPEED, **parameters) == pytest.approx(wanted, abs=1e-14)


@pytest.mark.parametrize("form", FORMS)
def test_at_other_speeds_it_is_what_the_equation_gives(form: str) -> None:
    term = terms(SHOWN)[form]
    for speed, said in ((0.01, term.slow), (10.0, term.fast)):
        assert said == pytest.approx(impact(FORCES[form], term.parameters, MASS, speed).restitution, abs=ROUND_OFF)
        assert said == pytest.approx(vibeam.restitution_in(form, mass=MASS, speed=speed, **term.parameters), abs=1e-15)


@pytest.mark.parametrize("form", ITS_OWN)
def test_the_program_s_own_formula_gives_what_the_dictionary_says_of_it(form: str) -> None:
    key, formula = ITS_OWN[form]
    term = terms(SHOWN)[form]
    own = {**term.parameters, key: formula(SHOWN)}
    assert term.own == pytest.approx(impact(FORCES[form], own, MASS, SPEED).restitution, abs=ROUND_OFF)


@pytest.mark.parametrize("wanted", [0.02, 0.1, exp(-2), 0.2, 0.5, 0.999, 1.0])
def test_there_and_back(wanted: float) -> None:
    for name, term in terms(wanted).items():
        if not term.parameters:
            assert not term.least < wanted <= term.most
            continue
        back = vibeam.restitution_in(name, mass=MASS, speed=SPEED, **term.parameters)
        assert back == pytest.approx(wanted, abs=1e-12), name


def test_a_damper_that_lets_go_never_keeps_less_than_its_least() -> None:
    """Chrono with restitution → 0, which it takes as machine epsilon; LAMMPS' polynomial at 0 and at 1."""
    given = terms(0.5)
    floor = impact(FORCES["chrono"], {**given["chrono"].parameters, "restitution": 2.0**-52}, MASS, SPEED).restitution
    assert given["chrono"].least < floor < given["chrono"].least + 1e-3
    for e, end in ((1e-12, "least"), (1.0, "most")):
        tsuji = impact(FORCES["lammps tsuji"], {**given["lammps tsuji"].parameters, "e": e}, MASS, SPEED)
        assert tsuji.restitution == pytest.approx(getattr(given["lammps tsuji"], end), abs=1e-9)


def test_critical_damping_of_a_limited_damper_lies_between_its_neighbours() -> None:
    below, at, above = (
        vibeam.restitution_in("elastogap", mass=MASS, c=1e6, d=2 * zeta * (1e6 * MASS) ** 0.5)
        for zeta in (CRITICAL - 1e-5, CRITICAL, CRITICAL + 1e-5)
    )
    assert at == pytest.approx((below + above) / 2, abs=1e-9)
    assert below > at > above


def test_a_stiffness_says_the_contact_time() -> None:
    stiff = terms(SHOWN)["linear"].parameters["stiffness"]
    found = vibeam.contact_terms(SHOWN, mass=MASS, stiffness=stiff, speed=SPEED)
    for name, term in terms(SHOWN).items():
        assert dict(found[name].parameters) == pytest.approx(dict(term.parameters), rel=1e-8)


@pytest.mark.parametrize("off", [1.001, 0.999])
def test_a_wrong_damping_is_seen(off: float) -> None:
    for form, key in (("linear", "damping"), ("hertzdamp", "xiNorm"), ("jankowski", "xi"), ("elastogap", "d")):
        wrong = dict(terms(SHOWN)[form].parameters)
        wrong[key] *= off
        assert abs(impact(FORCES[form], wrong, MASS, SPEED).restitution - SHOWN) > 1e4 * ROUND_OFF


def test_an_integrated_impact_is_the_closed_one() -> None:
    """An elastic Hertzian impact lasts 2.943275 d/v (Johnson 1985, eq. 11.24, as in tests/models/test_hertz.py)."""
    stiff = 1e8
    found = impact(ProgramContact(lambda p, m, v0, d, u: p["k"] * d**1.5), {"k": stiff}, MASS, SPEED)
    depth = (2.5 * MASS * SPEED**2 / 2 / stiff) ** 0.4
    assert found.restitution == pytest.approx(1, abs=1e-12)
    assert found.duration * SPEED / depth == pytest.approx(2.943275, abs=1e-6)


def test_two_stiffnesses_lose_the_area_of_their_loop() -> None:
    """Of OpenSees' wiki: R² = (1 − ε)/(1 + ε) at the speed of design, with E = ε K δ², an energy of K δ² (1 + ε)/2."""
    given = dictionary_book.wiki_of_impact_material(SHOWN)
    loss = (1 - SHOWN**2) / 2.5
    secant = (given["K1"] - given["K2"]) / (loss / 0.1 + loss / 0.9)
    depth = -given["Delta_y"] / 0.1
    designed = (secant * depth**2 * (1 + loss) / MASS) ** 0.5
    found = impact(IMPACT_MATERIAL, given, MASS, designed)
    assert found.restitution**2 == pytest.approx((1 - loss) / (1 + loss), abs=1e-9)
    assert impact(IMPACT_MATERIAL, given, MASS, 1e-3 * designed).restitution == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"restitution": 0.0}, "restitution"),
        ({"restitution": 1.1}, "restitution"),
        ({"mass": -1.0}, "mass"),
        ({"contact_time": None}, "give one of the two"),
        ({"stiffness": 1e6}, "give one of the two"),
        ({"speed": 0.0}, "speed"),
    ],
)
def test_numbers_out_of_range_are_refused(wrong: dict[str, Any], said: str) -> None:
    usual = {"restitution": 0.5, "mass": 1.0, "contact_time": 1e-3}
    with pytest.raises(ValueError, match=said):
        vibeam.contact_terms(**usual | wrong)


def test_unknown_forms_and_parameters_are_refused() -> None:
    with pytest.raises(ValueError, match="there are linear, hunt-crossley, mujoco"):
        vibeam.restitution_in("ode", kp=1.0)
    with pytest.raises(ValueError, match="its parameters are timeconst, dampratio"):
        vibeam.restitution_in("mujoco", zeta=1.0)
    with pytest.raises(ValueError, match="dampratio is missing"):
        vibeam.restitution_in("mujoco", timeconst=1.0)


@pytest.fixture(scope="module")
def stored() -> dict[str, Any]:
    return dict(json.loads(RESULTS.read_text(encoding="utf-8")))


def test_the_stored_section_is_of_this_dictionary(stored: dict[str, Any]) -> None:
    rows = {(row["form"], row["wanted"]): row for row in stored["forms"]}
    assert {form for form, _ in rows} == set(FORMS)
    for (form, wanted), row in rows.items():
        made = terms(wanted)[form]
        assert dict(made.parameters) == pytest.approx(row["parameters"], rel=1e-8), form
        assert made.program == row["program"]
        if row["parameters"]:
            assert worst(row) < ROUND_OFF
            assert row["contact_time"] == pytest.approx(TIME, rel=LASTING)
            assert row["said"] == pytest.approx([
                vibeam.restitution_in(form, mass=MASS, speed=v, **made.parameters) for v in SPEEDS
            ], abs=1e-12)  # fmt: skip


def test_programs_were_asked_what_the_dictionary_says_and_agree(stored: dict[str, Any]) -> None:
    """By finer steps to 2e-4; but for LAMMPS' tsuji, whose release lacks a factor that its later source has."""
    asked, rows = requests(), stored["programs"]["rows"]
    key = lambda row: (row["form"], row.get("note", ""), row.get("steps", 0), row["speed"])  # noqa: E731
    found = {key(row): row for row in rows}
    assert set(found) == set(map(key, asked))
    for each in asked:
        row = found[key(each)]
        assert row["parameters"] == pytest.approx(each["parameters"], rel=1e-8)
        if each.get("steps") == 5000 and each["form"] != "lammps tsuji":
            assert row["restitution"] == pytest.approx(SHOWN, abs=2e-4), each["form"]
    old = next(
        row["integrated"][1]
        for row in stored["others"]
        if row["form"] == "lammps tsuji 2025" and row["wanted"] == SHOWN
    )
    assert found["lammps tsuji", "", 5000, SPEED]["restitution"] == pytest.approx(old, abs=4e-4)
    assert found["lammps hertz", "limit_damping", 0, SPEED]["restitution"] == pytest.approx(
        terms(SHOWN)["chrono"].own, abs=2e-4
    )
    ironed = next(
        row["integrated"][1] for row in stored["others"] if row["form"] == "impact material" and row["wanted"] == SHOWN
    )
    assert found["impact material", "wiki's K1, K2, δy", 0, SPEED]["restitution"] == pytest.approx(ironed, abs=2e-4)
    soft = [row["restitution"] for row in rows if row.get("note", "").startswith("solimp as it comes")]
    assert len(soft) == len(SPEEDS)
    assert max(abs(each - SHOWN) for each in soft) < 3e-3


def test_at_least_fifteen_open_threads_of_eight_programs_ask(stored: dict[str, Any]) -> None:
    still = [each for each in stored["threads"] if each["state"] == "open"]
    assert len(still) >= 15
    assert len({each["program"] for each in still}) >= 8
    assert all(2 <= len(each["asks"].split()) <= 6 for each in stored["threads"])
    assert stored["threads"] == list(dictionary_book.THREADS)


def test_the_tables_show_every_form_program_and_thread(stored: dict[str, Any]) -> None:
    shown = dictionary_book.table(stored)
    assert all(f"| {form.program} |" in shown for form in FORMS.values())
    assert all(f"[{each['thread']}](https://github.com/" in shown for each in stored["threads"])
    assert "| nan |" not in shown
