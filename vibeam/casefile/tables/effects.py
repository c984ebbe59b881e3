"""The tables of effects, made of their declarations, and what these say together with the rest of a case."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from vibeam.casefile.tables.declared import Field, Later, Table, table
from vibeam.casefile.tables.table import declared_key, plan_keys
from vibeam.exchange.faults import Complaint, KeyPath
from vibeam_models.effects import EFFECTS, keys_in, tables
from vibeam_models.registry import Home
from vibeam_models.scene import Effect

EFFECT = "Effect: "


@lru_cache(maxsize=64)
def effect_table(effect: type[Any], said: str = EFFECT) -> type[Table]:
    """The table that an effect, or another dataclass of keys, declares; ``said`` before its meaning."""
    meaning = effect.__doc__ or ""
    doc = f"{said}{meaning[:1].lower()}{meaning[1:]}" if said else meaning
    return table(f"{effect.__name__}Table", doc, plan_keys(effect))


def own_table(home: Home) -> type[Table]:
    """The table at a home, or the one that a dataclass there declares."""
    found: Any = home.load()
    return found if issubclass(found, Table) else effect_table(found, "")


def effect_tables(on: str) -> dict[str, Field]:
    """The tables of the effects on the beam, or on its base, as fields of a case."""
    homes = sorted((name, home) for name, home in tables().items() if home.on == on)
    return {name: _optional(home) for name, home in homes}


def _optional(home: Home) -> Field:
    one, many = Later(lambda: effect_table(home.load())), tuple if home.repeated else None
    return Field(one, default=() if home.repeated else None, many=many, effect=True)


def with_effects(name: str, model: type[Table]) -> Any:
    """A table of every case with the effects that are keys of it."""
    keys = {
        each: declared_key(declared, False if declared.flag else None, effect=each != "ends")  # which is the rig itself
        for each, declared in keys_in(name).items()
    }
    return table(model.__name__, model.__doc__, model, keys)


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
