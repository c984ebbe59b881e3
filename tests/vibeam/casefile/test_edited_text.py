"""Values of a case's text replaced in place."""

import tomllib

import pytest

from vibeam.casefile.toml_writing import with_values

TEXT = """# a rig
[beam]   # its beam
length = "180 mm"   # measured [here], # twice
thickness=1.0e-3
[stop]
gap = 0
[fidelity.beam]
set = { "stop.gap" = 0.1, "drive.gain" = "2" }  # own
[[added_mass]]
mass = 1
[[added_mass]]
mass = 2
position = 3"""


def test_the_value_alone_is_replaced():
    found = with_values(TEXT, {"beam.length": '"0.2 m"', "stop.gap": "1e-4", "added_mass.1.mass": "2.5"})
    expected = (
        TEXT.replace('"180 mm"', '"0.2 m"').replace("gap = 0\n", "gap = 1e-4\n").replace("mass = 2", "mass = 2.5")
    )
    assert found == expected


def test_a_value_in_an_inline_table_is_replaced():
    found = with_values(TEXT, {'fidelity.beam.set."stop.gap"': "0.25"})
    assert found == TEXT.replace('"stop.gap" = 0.1', '"stop.gap" = 0.25')


def test_a_key_that_is_not_there_goes_below_the_head_of_its_table_or_into_a_new_one():
    found = with_values(TEXT, {"beam.width": '"2 cm"', "clamp.stiffness": "1e3"})
    assert '[beam]   # its beam\nwidth = "2 cm"\nlength' in found
    tables = tomllib.loads(found)
    assert tables.pop("clamp") == {"stiffness": 1e3}
    assert tables["beam"].pop("width") == "2 cm"
    assert tables == tomllib.loads(TEXT)


def test_a_key_that_is_not_there_in_an_inline_table_is_refused():
    with pytest.raises(ValueError, match="is not in the file"):
        with_values(TEXT, {'fidelity.beam.set."stop.restitution"': "0.25"})
