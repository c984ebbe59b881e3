"""The effects that a case names, found by the schema's own words: a table's "Effect: …", a key's "effect: …"."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from vibeam.casefile.fidelity_changes import SHARED
from vibeam.casefile.validation import fields_of, is_repeated, keys_of, table_of

MARK = "effect:"


def effects_of(declared: BaseModel) -> tuple[str, ...]:
    """The dotted keys of the effects in a declared case, in its order; of several tables of a kind each by its index.

    What is as if it were absent (None, or its default) is not named.
    """
    return tuple(name for field in _physics(declared) for name in _named(declared, field))


def is_effect(field: FieldInfo) -> bool:
    """Whether a key or table is declared as an effect: it may be absent, and its meaning begins with the word."""
    table = table_of(field)
    meaning = (field.description if table is None else table.__doc__) or ""
    return meaning.lower().startswith(MARK) and not field.is_required()


def companions(model: type[BaseModel], name: str) -> tuple[str, ...]:
    """Optional keys beside an effect that is a key, no effects themselves: they may have no meaning without it."""
    table, _, key = name.partition(".")
    inner = table_of(fields_of(model)[table])
    if inner is None or key not in keys_of(inner):
        return ()
    beside = {f"{table}.{other}": field for other, field in fields_of(inner).items() if other != key}
    return tuple(other for other, field in beside.items() if not (field.is_required() or is_effect(field)))


def _physics(declared: BaseModel) -> list[str]:
    return [name for name in keys_of(type(declared)) if name not in SHARED]


def _named(declared: BaseModel, name: str) -> Iterator[str]:
    field, value = fields_of(type(declared))[name], getattr(declared, name)
    if not is_effect(field):
        yield from (f"{name}.{key}" for key in _keys(value))
    elif is_repeated(field):
        yield from ([name] if len(value) == 1 else [f"{name}.{index}" for index in range(len(value))])
    elif value is not None:
        yield name


def _keys(table: object) -> Iterator[str]:
    """The effects among a table's own keys."""
    if isinstance(table, BaseModel):
        for key, field in fields_of(type(table)).items():
            if is_effect(field) and getattr(table, key) != field.default:
                yield key
