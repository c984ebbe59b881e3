"""The JSON schema of case files: it takes what a case may be, and refuses what an editor can see to be none."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator

from vibeam.casefile.documentation import case_schema, reference_table
from vibeam.casefile.template import template

CASES = sorted((Path(__file__).parents[3] / "cases").rglob("*.toml"))
SCHEMA = case_schema()
VALIDATOR = Draft202012Validator(SCHEMA)


def case() -> dict[str, Any]:
    return tomllib.loads(template())


def test_it_is_a_schema_that_json_can_hold() -> None:
    Draft202012Validator.check_schema(SCHEMA)
    assert json.loads(json.dumps(SCHEMA, allow_nan=False)) == SCHEMA


def test_every_case_fits_it() -> None:
    faults = {file.stem: [*VALIDATOR.iter_errors(tomllib.loads(file.read_text(encoding="utf-8")))] for file in CASES}
    assert len(faults) > 50
    assert {stem: found for stem, found in faults.items() if found} == {}


def test_the_template_fits_it_with_and_without_what_is_optional() -> None:
    VALIDATOR.validate(case())
    lines = [line.removeprefix("# ") for line in template().splitlines()]
    keys = [line for line in lines if re.match(r"\[\[?[a-z_.]+\]\]?$|[a-z_]+ = ", line)]
    whole = tomllib.loads("\n".join(keys))
    assert {"added_mass", "shaker", "influence"} <= set(whole)
    VALIDATOR.validate(whole)


WRONG = (
    ("beam.length", "long"), ("beam.length", -1), ("beam.length", True), ("beam.lenght", 1), ("beam.elements", 0),
    ("beam.elements", 1.5), ("beam.damping", "none"), ("beam.damping", []), ("stop.restitution", 1.5),
    ("stop.law", "hooke"), ("sweep.frequency", "14 Hz"), ("sweep.frequency.points", "many"),
    ("fidelity.sdof.solver", "ode"), ("fidelity.sdof.set", {}),
    ("fidelity.sdof.without", ["stop.gap", "stop.gap"]), ("expect", {"a": {"fidelity": "sdof"}}),
    ("measured", {"a": {"fidelity": "sdof", "quantity": "peak", "value": "1 mm"}}), ("cost", {"solvers": []}),
    ("sdof", {"natural_frequency": 1}), ("title", None),
)  # fmt: skip


def test_what_is_no_case_does_not_fit() -> None:
    for path, value in WRONG:
        tables = case()
        *above, last = path.split(".")
        place = tables
        for name in above:
            place = place[name]
        place[last] = value
        assert not VALIDATOR.is_valid(tables), (path, value)


def explained_in(part: Any) -> Iterator[tuple[str, str | None]]:
    """Names and descriptions of the keys of all tables, however deep they stand in the schema."""
    if isinstance(part, dict):
        for name, key in part.get("properties", {}).items():
            yield name, key.get("description")
    for inner in part.values() if isinstance(part, dict) else part if isinstance(part, list) else ():
        yield from explained_in(inner)


def test_it_explains_every_key() -> None:
    explained = set(explained_in(SCHEMA))
    assert {(row.key, row.meaning) for row in reference_table()} <= explained
    assert '"written"' not in json.dumps(SCHEMA)


def test_one_of_a_list_fits_it_alone_where_a_case_may_have_it_so() -> None:
    for table, key, value in (("figure", "format", "png"), ("verdict", "only", "modes")):
        for given in (value, [value]):
            VALIDATOR.validate(case() | {table: {key: given}})


def test_a_case_has_a_sweep_and_its_drive_or_a_record() -> None:
    whole = case()
    free = {name: each for name, each in whole.items() if name not in ("sweep", "drive", "reference", "expect")}
    VALIDATOR.validate(free | {"record": {"duration": "1 s"}, "start": {"displacement": "-1 mm"}})
    for wrong in (free, free | {"sweep": whole["sweep"]}, free | {"drive": whole["drive"]}):
        assert not VALIDATOR.is_valid(wrong)
