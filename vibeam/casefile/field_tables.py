"""Entries that hold a table: of values by name, of dotted keys, or of a model."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema
from pydantic_core.core_schema import ValidationInfo

from vibeam.casefile.field_lists import Several
from vibeam.casefile.fields import Entry, EntryInUnits
from vibeam.casefile.toml import key_parts
from vibeam.casefile.toml_writing import name_of
from vibeam.casefile.unit_systems import UnitSystem
from vibeam.exchange.faults import as_shown_in_message


@dataclass(frozen=True)
class Options(Entry):
    """A table of names and plain values, whose meaning is another's: a solver's options."""

    def parse(self, value: Any) -> dict[str, str | float]:
        """As ``Entry.parse``."""
        if not isinstance(value, dict):
            raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")
        wrong = [name for name, each in value.items() if not _is_plain(each)]
        if wrong:
            raise ValueError(f"{', '.join(wrong)}: must be a finite number or text in quotes")
        return dict(value)

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return "table { name = value, … }"

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "object", "additionalProperties": {"type": ["number", "string", "boolean"]}}


def _is_plain(value: Any) -> bool:
    try:
        return isinstance(value, str) or (isinstance(value, int | float) and math.isfinite(value))
    except OverflowError:  # a whole number beyond the range of doubles
        return False


@dataclass(frozen=True)
class TableOr(EntryInUnits):
    """A table of its own (a model), or a list instead."""

    table: type[BaseModel]
    several: Several

    def read(self, value: Any, units: UnitSystem | None) -> Any:
        """As ``Entry.read``, of the list alone: the table is read by its model."""
        if not isinstance(value, list):
            raise ValueError(
                f"must be {{ {', '.join(self._names())} }} or a {self.describe()}, not {as_shown_in_message(value)}"
            )
        return self.several.read(value, units)

    def _names(self) -> list[str]:
        return [field.alias or name for name, field in self.table.model_fields.items()]

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return self.several.describe()

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``, of the list alone."""
        return self.several.schema()

    def canonical(self, value: Any) -> Any:
        """As ``Entry.canonical``."""
        return value.model_dump(by_alias=True) if isinstance(value, BaseModel) else value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        def either(value: Any, inner: Any, info: ValidationInfo) -> Any:
            return inner(value) if isinstance(value, dict) else self._validated(value, info)

        written = core_schema.plain_serializer_function_ser_schema(self.canonical)
        inner = handler.generate_schema(self.table)
        return core_schema.with_info_wrap_validator_function(either, inner, serialization=written)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        inner: Any = core
        return {"anyOf": [handler(inner["schema"]), self.schema()]}


@dataclass(frozen=True)
class Settings(Entry):
    """A table of dotted keys with values as in a case, or another ``value``; nested tables mean the same."""

    value: str = "value"

    def parse(self, value: Any) -> dict[str, Any]:
        """As ``Entry.parse``: keys are flat, values as written."""
        if not isinstance(value, dict):
            raise ValueError(f"must be {self.describe()}, not {as_shown_in_message(value)}")
        found = dict(flat(value))
        if not found:
            raise ValueError("sets nothing: name a key, or leave it away")
        return found

    def describe(self) -> str:
        """As ``Entry.describe``."""
        return f'table {{ "stop.gap" = {self.value}, … }}'

    def schema(self) -> dict[str, Any]:
        """As ``Entry.schema``."""
        return {"type": "object", "minProperties": 1}


def flat(tables: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted keys and their values; a key in quotes that holds dots is the path that it spells."""
    for name, value in tables.items():
        key = above + _spelt(name)
        if isinstance(value, Mapping):
            yield from flat(value, f"{key}.")
        else:
            yield key, value


def _spelt(name: str) -> str:
    try:
        key_parts(name)
    except (ValueError, RecursionError):
        return name_of(name)
    return name
