"""Effects named by a case: tables and keys that are declared as effects."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from vibeam.casefile.tables.table import note
from vibeam.casefile.validation import fields_of, is_repeated, physics_keys


def effects_of(declared: BaseModel) -> tuple[str, ...]:
    """Dotted keys of the effects in a declared case, in its order; of several tables of a kind each by its index.

    Effects at their neutral value (None, or the default) are left out.
    """
    return tuple(name for field in physics_keys(type(declared)) for name in _named(declared, field))


def is_effect(field: FieldInfo) -> bool:
    """Test whether a key or table is declared as an effect."""
    return bool(note(field, "effect"))


def companions(declared: BaseModel, name: str) -> tuple[str, ...]:
    """Keys of a declared case that are meaningless without an effect: beside it, or tables that are on it."""
    table, _, key = name.partition(".")
    carried = () if key else tuple(_on(declared, name))
    if carried:
        return carried
    inner = getattr(declared, table, None)
    if not (key and isinstance(inner, BaseModel)):
        return ()
    beside = [other for other, field in fields_of(type(inner)).items() if note(field, "of") == key]
    return tuple(f"{table}.{each}" for each in beside if getattr(inner, each) is not None)


def _on(declared: BaseModel, name: str) -> Iterator[str]:
    """Effects, tables of which there are several, with ``on`` = ``name``: that beam carries them."""
    for field in physics_keys(type(declared)):
        if is_repeated(fields_of(type(declared))[field]):
            carried = [getattr(each, "on", None) == name for each in _tables(getattr(declared, field))]
            yield from (effect for effect, is_on in zip(_named(declared, field), carried, strict=False) if is_on)


def _tables(value: object) -> tuple[object, ...]:
    return value if isinstance(value, tuple) else ()


def _named(declared: BaseModel, name: str) -> Iterator[str]:
    field, value = fields_of(type(declared))[name], getattr(declared, name)
    if not is_effect(field):
        yield from (f"{name}.{key}" for key in _keys(value))
    elif is_repeated(field):
        yield from ([name] if len(value) == 1 else [f"{name}.{index}" for index in range(len(value))])
    elif value is not None:
        yield name


def _keys(table: object) -> Iterator[str]:
    """Effects among a table's own keys."""
    if isinstance(table, BaseModel):
        for key, field in fields_of(type(table)).items():
            if is_effect(field) and getattr(table, key) != field.default:
                yield key
