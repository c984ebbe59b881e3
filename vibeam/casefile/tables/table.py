"""Base of the tables of the case file, declaration of a key, entries that several tables share."""

from __future__ import annotations

from math import inf
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, create_model
from pydantic.fields import FieldInfo

from vibeam.casefile import quantities as units
from vibeam.casefile.field_lists import Several
from vibeam.casefile.fields import NOT_NEGATIVE, POSITIVE, Count, Entry, Flag, Quantity, Range, Word
from vibeam_models.keys import Key

Plain = tuple[str, Any]  # meaning and example of a key where the case is nondimensional


NOTES = ("written", "effect", "of", "plain", "physics", "numbers")  # what ``key`` says beyond pydantic's field


def key(
    meaning: str,
    example: Any = None,
    default: Any = ...,
    *,
    written: bool = True,
    effect: bool = False,
    of: str = "",
    plain: Plain | None = None,
    physics: bool = True,
    numbers: bool = True,
) -> Any:
    """A key: what it means, an example for the template (there as a comment unless ``written``), its default.

    ``effect``: it declares an optional effect; ``of``: the effect in the same table without which it means nothing.
    ``physics``: part of the rig, which a fidelity may change; ``numbers``: part of what the sweeps compute.
    """
    extra: Any = dict(zip(NOTES, (written, effect, of, plain, physics, numbers), strict=True))
    examples = None if example is None else [example]
    return Field(default, description=_said(meaning, effect), examples=examples, json_schema_extra=extra)


def _said(meaning: str, effect: bool) -> str:
    return f"effect: {meaning}" if effect else meaning


def note(field: FieldInfo, name: str) -> Any:
    """Note of a field by ``key``, one of ``NOTES``; None for a field without."""
    extra = field.json_schema_extra
    return extra.get(name) if isinstance(extra, dict) else None


class Table(BaseModel):
    """Base class of all tables: frozen, without unknown keys."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


def table(name: str, meaning: str, *parts: type[Table] | dict[str, Any]) -> Any:
    """A table made of parts, whose keys stand in the order of the parts: tables, or {key: (annotation, ``key``)}."""
    made = [part if isinstance(part, type) else create_model(f"{name}Part", __base__=Table, **part) for part in parts]
    joined: Any = create_model(name, __base__=tuple(reversed(made)))
    joined.__doc__ = meaning
    return joined


def declared_entry(declared: Key) -> Entry:
    """Entry that reads a declared key."""
    if declared.flag:
        return Flag()
    if declared.words:
        return Word(declared.words)
    low = declared.least if declared.above is None else declared.above
    bounds = (-inf if low is None else low, inf if declared.most is None else declared.most, declared.above is None)
    one = Quantity(units.dimension(declared.unit), Range(*bounds))
    return Several(one, ascending=declared.ascending) if declared.several else one


def declared_key(declared: Key, default: Any = ..., of: str = "", effect: bool = False) -> tuple[Any, Any]:
    """The annotation and the ``key`` of a declaration's key."""
    entry, plain = declared_entry(declared), plainly(declared)[:2]
    notes: Any = {
        "written": declared.written, "effect": effect or declared.effect, "of": of or declared.of, "plain": plain,
    }  # fmt: skip
    field = key(declared.meaning, declared.example, default, **notes)
    return Annotated[Any, entry], field


def plainly(declared: Key) -> tuple[str, Any, str]:
    """A declaration's meaning and example, and its meaning where it is missing, without a unit."""
    if declared.plain is None:
        return declared.meaning, declared_entry(declared).parse(declared.example), declared.missing
    return declared.plain


def nondimensional(model: type[Table], name: str, meaning: str) -> Any:
    """The keys of a table that mean something without units, without their units."""
    fields = {each: field for each, field in model.model_fields.items() if note(field, "plain")}
    return table(name, meaning, {each: _plain(field) for each, field in fields.items()})


def _plain(field: FieldInfo) -> tuple[Any, Any]:
    entry = next(part for part in field.metadata if isinstance(part, Entry))
    (meaning, example), default = note(field, "plain"), ... if field.is_required() else field.default
    notes = {each: note(field, each) for each in ("written", "effect", "of")}
    return Annotated[Any, entry.nondimensional()], key(meaning, example, default, **notes)


def less(model: type[Table], name: str, meaning: str, *keys: str) -> Any:
    """The keys of a table without some of them."""
    fields = {each: field for each, field in model.model_fields.items() if each not in keys}
    return table(name, meaning, {each: _same(field) for each, field in fields.items()})


def _same(field: FieldInfo) -> tuple[Any, Any]:
    entry = next(part for part in field.metadata if isinstance(part, Entry))
    default: Any = ... if field.is_required() else field.default
    more: Any = field.json_schema_extra
    same = Field(default, description=field.description, examples=field.examples, json_schema_extra=more)
    return Annotated[Any, entry], same


DIRECTIONS = ("up", "down", "both")

QUANTITIES = ("amplitude", "reach", "maximum", "minimum", "impact_velocity", "impacts_per_period", "period")

EXTENTS = ("peak", "peak_frequency", "period_one_from", "period_one_to")  # of a whole branch

OF_INFLUENCE = (*EXTENTS, "ringing", "ringing_frequency", "apparent_restitution")

OUTPUTS = ("sensor", "contact", "tip", "platform")

ACCURATE = ("amplitude", "reach", "maximum", "minimum", "impact_velocity")  # what an accuracy can be asked of

FORMATS = ("png", "svg", "pdf")  # of figures

MOVING_FORMATS = ("gif", "mp4", "pvd")  # of an animation

MOST_ELEMENTS = 2000

MOST_POINTS = 1_000_000


Length = Place = Quantity(units.LENGTH, POSITIVE)

Ratio = Quantity(units.RATIO, NOT_NEGATIVE)

Unity = Quantity(units.RATIO, Range(0, 1))

Within = Quantity(units.RATIO, Range(1e-4, 1))

Frequency = Quantity(units.FREQUENCY, POSITIVE)

Periods = Count(0, MOST_POINTS)
