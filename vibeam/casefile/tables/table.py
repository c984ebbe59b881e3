"""Base of the tables of a case file: declaration of a key, what a table may hold, and its content as plain data."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from hashlib import sha256
from math import inf
from types import SimpleNamespace
from typing import Any, TypeVar, cast

from vibeam.casefile import quantities as units
from vibeam.casefile.fields import FLAG, TEXT, Count, Each, Entry, Quantity, Several, Word
from vibeam.casefile.quantities import NOT_NEGATIVE, POSITIVE, Range
from vibeam.casefile.tables.declared import Field, Table, table
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message, suggest
from vibeam_models.keys import Key, defaults_of, keys_of

T = TypeVar("T")


def declared_entry(declared: Key) -> Entry:
    """Entry that reads a declared key."""
    if declared.flag:
        return FLAG
    if declared.text:
        return Each(TEXT, declared.alone) if declared.several else TEXT
    if declared.words or declared.whole:
        bounds = int(declared.least or 0), int(declared.most or 0)
        named: Entry = Word(declared.words) if declared.words else Count(*bounds)
        return Each(named, declared.alone) if declared.several else named
    low = declared.least if declared.above is None else declared.above
    range_ = Range(
        -inf if low is None else low, inf if declared.most is None else declared.most, declared.above is None
    )
    one = Quantity(units.dimension(declared.unit), range_)
    return Several(one, declared.alone, ascending=declared.ascending) if declared.several else one


def declared_key(
    declared: Key, default: Any = ..., of: str = "", effect: bool = False, entry: Entry | None = None
) -> Field:
    """The field of a declaration's key; ``entry``: what reads one of more than a number."""
    plain = declared.plain and (declared.plain[0] or declared.meaning, declared.plain[1])
    notes: Any = {"effect": effect or declared.effect, "of": of or declared.of, "plain": plain}
    reads = entry or declared_entry(declared)
    return Field(reads, declared.meaning, declared.example, default, numbers=declared.numbers, **notes)


def plan_keys(kind: type[Any], **entries: Entry) -> dict[str, Field]:
    """The fields of a plan by key; ``entries``: what reads those of more than numbers."""
    keys, usual = keys_of(kind), defaults_of(kind)
    return {name: declared_key(each, usual.get(name, ...), entry=entries.get(name)) for name, each in keys.items()}


def plan_of(plan: type[T], table: Any, /, **own: Any) -> T:
    """The plan that a table says; ``own``: its fields that are no keys, or are not as the table has them."""
    return plan(**{name: getattr(table, name) for name in keys_of(plan) if name not in own}, **own)


def plan_with(plan: T, settings: Mapping[str, Any]) -> T:
    """The plan with ``settings``, as a case file has them or in SI, None: its own; ValueError names all faults."""
    keys, faults, found = keys_of(type(plan)), list[str](), dict[str, Any]()
    for name, value in settings.items():
        try:
            if name not in keys:
                raise ValueError(f"no such setting; {suggest(name, keys)}")
            if value is not None:
                found[name] = declared_entry(keys[name]).parse(list(value) if isinstance(value, tuple) else value)
        except ValueError as error:
            faults.append(f"{name}: {error}")
    if faults:
        raise ValueError("; ".join(faults))
    return cast("T", replace(cast(Any, plan), **found))


def less(model: type[Table], name: str, meaning: str | None, *keys: str, plain: bool = False) -> type[Table]:
    """The keys of a table without some of them, which are None; ``plain``: and without their units."""
    kept = {each: _plain(field) if plain else field for each, field in model.KEYS.items() if each not in keys}
    return table(name, meaning, KEYS=kept, **dict.fromkeys(keys))


def _plain(field: Field) -> Field:
    """The key without its unit."""
    own, example = field.kind.nondimensional(), field.example
    if field.plain:
        return replace(field, kind=own, meaning=field.plain[0], example=field.plain[1])
    same = own == field.kind or example is None
    return replace(field, kind=own, example=example if same else field.kind.parse(example))


QUANTITIES = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period")
OUTPUTS = ("sensor", "contact", "tip", "platform")

Length = Place = Quantity(units.LENGTH, POSITIVE)
Ratio = Quantity(units.RATIO, NOT_NEGATIVE)
Frequency = Quantity(units.FREQUENCY, POSITIVE)


def content(table: Table, *parts: str, without: Collection[str] = ()) -> dict[str, Any]:
    """Keys of a table that belong to all of ``parts`` (``"physics"``, ``"numbers"``), less those in ``without``."""
    found = {}
    for name, field in table.KEYS.items():
        value = getattr(table, field.attribute)
        none = value is None or (field.effect and value == ())  # a list of tables of which the case names none
        if not none and name not in without and all(getattr(field, part) for part in parts):
            found[name] = _plain_data(value, field, parts)
    return found


def _plain_data(value: Any, field: Field, parts: Collection[str]) -> Any:
    """Plain data of the value of a key, of its table, or of several."""
    if isinstance(value, Table):
        return content(value, *parts)
    if field.entry is not None:
        return _with_lists(field.entry.canonical(value))
    if isinstance(value, Mapping):
        return {name: content(each, *parts) for name, each in value.items()}
    return [content(each, *parts) for each in value]


def _with_lists(value: Any) -> Any:
    """Plain data with lists in place of tuples."""
    if isinstance(value, Mapping):
        return {name: _with_lists(each) for name, each in value.items()}
    return [_with_lists(each) for each in value] if isinstance(value, list | tuple) else value


def digest(*content: Any) -> str:
    """SHA-256, in hexadecimal, of content as JSON with sorted keys."""
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")


def name_checks(case: SimpleNamespace) -> Iterator[Complaint]:
    """Complaints about the names that a case gives."""
    if case.fidelity == {}:
        yield ("fidelity",), "no fidelity: add a table [fidelity.NAME]"
    for kind in ("fidelity", "reference", "expect", "measured", "show", "map"):
        for name in getattr(case, kind):
            if not NAME.fullmatch(name):
                yield (kind, name), f"the name {as_shown_in_message(name)} must be 1 to 64 letters, digits, - or _"
    for group in sorted({"show", "comparison", "models"} & set(case.fidelity)):
        yield ("fidelity", group), f'the name "{group}" is that of a group of the results file: choose another'


def named_fidelity(case: SimpleNamespace, path: KeyPath, name: str | None) -> Iterator[Complaint]:
    """A complaint where a fidelity is named that is not there."""
    if name is not None and name not in case.fidelity:
        yield path, f"no fidelity {not_there(name, case.fidelity)}"


def not_there(name: str, tables: Iterable[str]) -> str:
    """A name that is none of ``tables``, and which of them it may have meant."""
    return f"{as_shown_in_message(name)}; {suggest(name, filter(NAME.fullmatch, tables))}"
