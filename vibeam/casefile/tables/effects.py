"""The tables of effects, made of their declarations, and what these say together with the rest of a case."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from types import SimpleNamespace
from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter
from pydantic_core import CoreSchema, core_schema
from pydantic_core.core_schema import ValidationInfo

from vibeam.casefile.tables.table import Table, declared_key, plan_keys, table
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.effects import EFFECTS, keys_in, tables
from vibeam_models.registry import Home
from vibeam_models.scene import Effect

EFFECT = "Effect: "


@dataclass(frozen=True)
class EffectTable:
    """The table of an effect, or the list of its tables: declared where a case first names it.

    ``own``: its home is the table itself, or a dataclass that declares its keys, which is no effect's.
    """

    home: Home
    own: bool = False

    @property
    def table(self) -> type[Table]:
        """One table."""
        found: Any = self.home.load()
        return found if issubclass(found, Table) else effect_table(found, "" if self.own else EFFECT)

    def read(self, value: Any, info: ValidationInfo) -> Any:
        """The value as the table, or as a tuple of them; pydantic's ValidationError."""
        kind: Any = tuple[self.table, ...] if self.home.repeated else self.table  # type: ignore[name-defined]
        return TypeAdapter(kind).validate_python(value, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        one = handler(self.table.__pydantic_core_schema__)
        return {"type": "array", "items": one} if self.home.repeated else one


@lru_cache(maxsize=64)
def effect_table(effect: type[Any], said: str = EFFECT) -> type[Table]:
    """The table that an effect, or another dataclass of keys, declares; ``said`` before its meaning."""
    meaning = effect.__doc__ or ""
    doc = f"{said}{meaning[:1].lower()}{meaning[1:]}" if said else meaning
    made: type[Table] = table(f"{effect.__name__}Table", doc, plan_keys(effect))
    return made


def effect_tables(on: str) -> dict[str, Any]:
    """The tables of the effects on the beam, or on its base, as fields of a case."""
    homes = sorted((name, home) for name, home in tables().items() if home.on == on)
    return {name: _optional(home) for name, home in homes}


def _optional(home: Home) -> tuple[Any, Any]:
    kind = tuple[Any, ...] if home.repeated else Any
    return Annotated[kind, EffectTable(home)], Field(() if home.repeated else None, json_schema_extra={"effect": True})


def with_effects(name: str, model: type[Table]) -> Any:
    """A table of every case with the effects that are keys of it."""
    keys = {
        each: declared_key(declared, False if declared.flag else None, effect=each != "ends")  # which is the rig itself
        for each, declared in keys_in(name).items()
    }
    return table(model.__name__, model.__doc__ or "", model, keys)


def effects_in(case: Any) -> Iterator[tuple[KeyPath, type[Effect], Any]]:
    """Path of each effect of a beam's case, its declaration, and the values of the table."""
    for name, home in EFFECTS.items():
        above, _, key = name.rpartition(".")
        place = getattr(case, above, None) if above else case
        found = getattr(place, key, None)
        if home.repeated:
            yield from (((name, index), home.load(), each) for index, each in enumerate(found or ()))
        elif found is not None and found is not False:
            yield ((above,), home.load(), place) if above else ((name,), home.load(), found)


def effect_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the effects that a beam's case names; an effect that is absent is None there."""
    for path, effect, values in effects_in(case):
        for name, message in effect.faults(values, case):
            yield (*path, name) if name else path, message


def effects_of_scene(case: Any) -> tuple[Effect, ...]:
    """The effects that a checked case names, as declared."""
    return tuple(
        effect(**{each.name: getattr(values, each.name) for each in fields(effect)})
        for _, effect, values in effects_in(case)
    )


def platform_output(case: SimpleNamespace, path: KeyPath, output: str | None) -> Iterator[Complaint]:
    """A complaint where the motion of a platform is asked for that is not there, or is prescribed."""
    if output == "platform" and (case.platform is None or case.platform.coupling == "one-way"):
        yield path, 'the platform has no motion of its own: add [platform] with coupling = "two-way"'
