"""The JSON schema of case files, for the editors that complete and check TOML by one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic.json_schema import models_json_schema

from vibeam.casefile.kinds import KINDS
from vibeam.casefile.tables.table import NOTES

DIALECT = "https://json-schema.org/draft/2020-12/schema"

TITLE = "A case of vibeam"


def case_schema() -> dict[str, Any]:
    """The schema: one of the kinds of case, each of whose tables is a definition, those of effects within it."""
    models = [kind.declaration() for kind in KINDS.values()]
    _, declared = models_json_schema([(model, "validation") for model in models])
    kinds = [{"$ref": f"#/$defs/{model.__name__}"} for model in models]
    tables = _plain(declared["$defs"])
    for model in models:
        _allow_unnamed(tables[model.__name__]["properties"])
    for keys in (table.get("properties", {}) for table in tables.values()):
        keys |= {"fidelity": keys["fidelities"]} if "fidelities" in keys else {}
    return {"$schema": DIALECT, "title": TITLE, "anyOf": kinds, "$defs": tables}


def _allow_unnamed(keys: dict[str, Any]) -> None:
    """Allow [map] with the keys of a map, beside [map.NAME]."""
    named = keys["map"]
    own = {key: named[key] for key in ("description", "title") if key in named}
    either = {key: value for key, value in named.items() if key not in own}
    keys["map"] = own | {"anyOf": [either, {"$ref": named["additionalProperties"]["$ref"]}]}


def _plain(value: Any) -> Any:
    """The schema without what TOML cannot say (null) and what is the template's."""
    if isinstance(value, list):
        return [_plain(each) for each in value]
    if not isinstance(value, Mapping):
        return value
    return _single({key: _plain(inner) for key, inner in value.items() if not _left_out(key, inner)})


def _left_out(key: str, value: Any) -> bool:
    """Test whether a part is the template's own, or a default or example that a case could not write."""
    if key in ("default", "examples"):
        return value in (None, [None]) or isinstance(value, Mapping)
    return key in NOTES and not isinstance(value, Mapping)


def _single(schema: dict[str, Any]) -> dict[str, Any]:
    """A choice of one kind and null is that kind: what may be absent is not required, and never null."""
    kinds = schema.get("anyOf", [])
    kept = [kind for kind in kinds if kind != {"type": "null"}]
    if len(kept) == len(kinds):
        return schema
    rest = {key: value for key, value in schema.items() if key != "anyOf"}
    return rest | (kept[0] if len(kept) == 1 else {"anyOf": kept})
