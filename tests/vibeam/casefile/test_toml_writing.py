"""Tables written as TOML: read again they are the same, those of every case and generated ones."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vibeam.casefile.toml_writing import toml_text

CASES = Path(__file__).parents[3] / "cases"

TEXT = st.text(st.characters(codec="utf-8"), max_size=6)
SINGLE = st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | st.booleans() | TEXT
VALUES = st.recursive(
    SINGLE, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3), max_leaves=12
)


@pytest.mark.parametrize("file", sorted(CASES.rglob("*.toml")), ids=lambda file: str(file.relative_to(CASES)))
def test_the_tables_of_a_case_come_back(file: Path) -> None:
    tables = tomllib.loads(file.read_text(encoding="utf-8"))
    assert tomllib.loads(toml_text(tables)) == tables


@settings(deadline=None)
@given(st.dictionaries(TEXT, VALUES, max_size=6))
def test_any_tables_come_back(tables: dict[str, Any]) -> None:
    assert tomllib.loads(toml_text(tables)) == tables


def test_the_layout() -> None:
    long = [{"name": 60 * "x", "place": 60 * "y"}, {}]
    tables = {"beam": {"set": {"a.b": 1e-3}}, "title": "one", "mass": [{"mass": 0.1}], "output": long, "none": []}
    assert (
        toml_text(tables)
        == f"""title = "one"
mass = [
    {{ mass = 0.1 }},
]
none = []

[beam.set]
"a.b" = 0.001

[[output]]
name = "{60 * "x"}"
place = "{60 * "y"}"

[[output]]
"""
    )
