"""Lines of keys: against texts that could fool a scan, and the parser on generated ones; values replaced in place."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vibeam.casefile.toml import key_lines, key_parts
from vibeam.casefile.toml_writing import name_of, to_toml, with_values

TRAPS = '''title = "x" # [comment]
a.b . "c d" = 1
several = """
[beam]
length = 1 ""\\\\""""
literal = \'\'\'
[x] = 'y\'\'\'\'
list = [
  1, # ] no
  "a]", [2,
   3],
]
empty = ""
quoted = """"q" """
grid = { from = 1, to = { x = [1, {y=2}], 'z.z' = 3 } }
[beam] # here
length = '#'
[fidelity . "x y"]
when = 1979-05-27 07:32:00
[[added_mass]]
mass = 1
  [[added_mass.sub]]
  q = 1
[[added_mass]]
mass = 2
  [added_mass.deep]
  z = 1
[late.table]
x = 1
[late]
'''
WHERE = {
    ("title",): 1,
    ("a", "b", "c d"): 2,
    ("several",): 3,
    ("literal",): 6,
    ("list",): 8,
    ("list", 1): 10,
    ("list", 2, 1): 11,
    ("empty",): 13,
    ("quoted",): 14,
    ("grid", "from"): 15,
    ("grid", "to", "x", 1, "y"): 15,
    ("grid", "to", "z.z"): 15,
    ("beam",): 16,
    ("beam", "length"): 17,
    ("fidelity",): 18,
    ("fidelity", "x y", "when"): 19,
    ("added_mass", 0): 20,
    ("added_mass", 0, "mass"): 21,
    ("added_mass", 0, "sub", 0, "q"): 23,
    ("added_mass", 1): 24,
    ("added_mass", 1, "mass"): 25,
    ("added_mass", 1, "deep", "z"): 27,
    ("late", "table"): 28,
    ("late",): 30,
}


def paths(value, above=()):
    """Every path in a parsed text."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, inner in items:
        yield (*above, name)
        yield from paths(inner, (*above, name))


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_each_key_has_its_line(end):
    found = key_lines(TRAPS.replace("\n", end))
    assert {path: found.get(path) for path in WHERE} == WHERE


def test_nothing_is_found_that_the_parser_does_not_find():
    assert set(key_lines(TRAPS)) == set(paths(tomllib.loads(TRAPS)))


values = st.recursive(
    st.integers(-99, 99) | st.booleans() | st.text(st.characters(codec="utf-8"), max_size=6),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(st.characters(codec="utf-8")), inner, max_size=3)
    ),
    max_leaves=8,
)


@settings(deadline=None)
@given(st.dictionaries(st.text(st.characters(codec="utf-8"), max_size=5), values, max_size=6))
def test_any_text_has_the_lines_at_which_its_keys_were_written(tables):
    text = "".join(f"{name_of(name)} = {to_toml(value)}\n" for name, value in tables.items())
    found = key_lines(text)
    assert set(found) == set(paths(tomllib.loads(text)))
    assert [found[name,] for name in tables] == list(range(1, len(tables) + 1))


@pytest.mark.parametrize(
    ("key", "parts"), [("a", ["a"]), ("a.b-c.0", ["a", "b-c", "0"]), ('a . "b.c"', ["a", "b.c"]), ("'é'", ["é"])]
)
def test_dotted_keys(key, parts):
    assert key_parts(key) == parts


@pytest.mark.parametrize("key", ["", "a.", ".a", "a b", "a\nb", "é", "a = 1\nb", "#", "a = 1 #", "a = {} #"])
def test_what_is_no_dotted_key(key):
    with pytest.raises(ValueError, match=r"."):
        key_parts(key)


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
