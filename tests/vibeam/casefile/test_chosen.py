"""[chosen_by]: the measured numbers that chose a key, by which a model is calibrated, and those that it predicts."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import Any

import pytest

from vibeam.casefile.number_keys import keys_chosen, value_at
from vibeam.casefile.read import parse
from vibeam.exchange.faults import CaseError

CASES = Path(__file__).parents[3] / "cases"
RIG = """[beam]
length = "180 mm"
width = "20 mm"
thickness = "1 mm"
youngs_modulus = "210 GPa"
density = "7850 kg/m^3"
damping_ratio = 0.017
[mass]
mass = "0.2 kg"
position = "132 mm"
[stop]
gap = "0.1 mm"
restitution = 0.7
[sensor]
position = "100 mm"
[drive]
amplitude = "0.1 mm"
[sweep]
frequency = ["14 Hz", "15 Hz"]
settle = 1
hold = 1
[fidelity.beam]
reduction = "modal"
modes = 2
[fidelity.more]
reduction = "modal"
modes = 8
[fidelity.same]
reduction = "static_mode"
set = { "mass.mass" = "200 g" }
[fidelity.light]
reduction = "static_mode"
set = { "mass.mass" = "150 g" }
[fidelity.bare]
reduction = "modal"
modes = 2
without = ["mass"]
set = { "stop.position" = "132 mm" }
"""


def measured(name: str, fidelity: str, more: str = 'value = "15 Hz"\nsource = "Fig. 3"') -> str:
    return f'[measured.{name}]\nfidelity = "{fidelity}"\nquantity = "peak_frequency"\n{more}\n'


def chose(*tables: str) -> dict[str, tuple[str, ...]]:
    return {name: each.chose for name, each in parse("".join([RIG, *tables])).measured.items()}


def test_a_number_is_calibrated_in_every_model_that_has_the_key_at_the_value_it_chose() -> None:
    """The model with another mass, and the one without, predict the very same number."""
    fidelities = ("beam", "more", "same", "light", "bare")
    found = chose(*(measured(each, each) for each in fidelities), '[chosen_by]\n"mass.mass" = ["beam"]\n')
    kept = ("mass.mass",)
    assert found == {"beam": kept, "more": kept, "same": kept, "light": (), "bare": ()}


def test_a_number_of_another_source_or_size_is_predicted() -> None:
    others = ('value = "15 Hz"\nsource = "Fig. 4"', 'value = "15.1 Hz"\nsource = "Fig. 3"')
    tables = [measured(f"other_{at}", "beam", each) for at, each in enumerate(others)]
    assert chose(measured("own", "beam"), *tables, '[chosen_by]\n"mass.mass" = ["own"]\n') == {
        "own": ("mass.mass",), "other_0": (), "other_1": (),
    }  # fmt: skip


def test_a_fidelity_s_own_value_may_be_chosen_by_its_own_number() -> None:
    tables = (measured("own", "beam"), measured("light", "light"), '[chosen_by]\n"mass.mass" = ["own", "light"]\n')
    assert chose(*tables) == {"own": ("mass.mass",), "light": ("mass.mass",)}


def test_several_numbers_and_keys_and_both_ways_to_write_a_key() -> None:
    numbers = measured("first", "beam"), measured("second", "beam", 'value = "14 Hz"\nsource = "Fig. 5"')
    written = '[chosen_by]\nbeam.width = ["first"]\n"mass.mass" = ["first", "second"]\n'
    assert chose(*numbers, written) == {"first": ("beam.width", "mass.mass"), "second": ("mass.mass",)}


def test_what_chose_a_key_changes_no_number_and_is_written_back() -> None:
    text = RIG + measured("it", "beam")
    case = parse(text + '[chosen_by]\n"mass.mass" = ["it"]\n')
    assert case.key == parse(text).key
    assert parse(case.text).measured == case.measured


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ('"mass.mass" = ["at"]', "no [measured.NAME] called 'at'; known here: it, bare"),
        ('"mass.mas" = ["it"]', "unknown key 'mass.mas'; did you mean 'mass'?"),
        ('"sweep.settle" = ["it"]', "sweep is shared by all fidelities: a measured number chooses beam, mass,"),
        ('"mass.mass" = "it"', "must be a list of names of [measured.NAME], not 'it': write [\"peak\"]"),
        ('"mass.mass" = []', "must be a list of names of [measured.NAME], not an empty list: write [\"peak\"]"),
        ('"mass.mass" = ["bare"]', "measured.bare is of fidelity bare, which has no mass.mass: name a number"),
    ],
)  # fmt: skip
def test_faults_have_line_key_and_cure(line: str, fault: str) -> None:
    text = RIG + measured("it", "beam") + measured("bare", "bare") + "[chosen_by]\n"
    with pytest.raises(CaseError) as caught:
        parse(text + line + "\n", "mine.toml")
    key = line.partition(" = ")[0]
    (told,) = str(caught.value).splitlines()
    assert told.startswith(f"mine.toml:{text.count(chr(10)) + 1}: chosen_by.{key}: {fault}"), told


def test_all_faults_at_once() -> None:
    wrong = '[chosen_by]\n"mass.mass" = ["at", "is"]\n"beam.lenght" = ["it"]\n'
    with pytest.raises(CaseError) as caught:
        parse(RIG + measured("it", "beam") + wrong)
    assert len(caught.value.faults) == 3


def test_a_number_that_chose_a_key_in_one_case_counts_as_predicted_in_none() -> None:
    """A key that a number chose is not to be predicted from it in another case of the folder either."""
    chosen, compared = list[tuple[Any, ...]](), list[tuple[Any, ...]]()
    for file in sorted((CASES / "experiment").glob("*.toml")):
        text = file.read_text(encoding="utf-8")
        if "[measured." not in text:
            continue
        keys = parse(text, file).keys
        declared, changed = keys.declared, keys.changed
        for name, each in declared.measured.items():
            model, datum = changed.get(each.fidelity, declared), (each.value.number, each.source)
            compared.append((f"{file.stem}.{name}", datum, model, keys_chosen(name, declared, changed)))
            named = [key for key, names in (declared.chosen_by or {}).items() if name in names]
            chosen += [(datum, key, value_at(model, key)) for key in named]
    assert len(chosen) > 15
    hidden = [
        (name, key)
        for (name, datum, model, keys), (chooser, key, value) in product(compared, chosen)
        if datum == chooser and key not in keys and value_at(model, key) == value
    ]
    assert not hidden, f"write these into the case's [chosen_by]: {sorted({*hidden})}"
