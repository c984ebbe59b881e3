"""Validation of a case's tables by the declaration: the model, or every fault by its key."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from vibeam.casefile.field_tables import TableOr
from vibeam.casefile.fields import Entry
from vibeam.casefile.kinds import KINDS, kind_of
from vibeam.casefile.quantities import SI, UNIT_SYSTEMS, UnitSystem
from vibeam.casefile.synonyms import meant, suggest_key
from vibeam.casefile.tables.cases import AnyCase
from vibeam.casefile.tables.effects import EffectTable
from vibeam.casefile.tables.table import note
from vibeam.casefile.toml_writing import name_of, to_fill_in, to_toml
from vibeam.exchange.faults import KNOWN, Complaint, KeyPath, as_shown_in_message, suggestion
from vibeam_models.effects import tables as effect_tables


def declaration(tables: dict[str, Any]) -> type[AnyCase]:
    """Declaration of the kind of case that the tables are."""
    made: type[AnyCase] = kind_of(tables).declaration()
    return made


def read(tables: dict[str, Any]) -> AnyCase:
    """The case; pydantic's ValidationError if a key by itself is wrong."""
    return declaration(tables).model_validate(tables, context=units_of(tables.get("units")))


def units_of(said: Any) -> UnitSystem | None:
    """Units of a case's numbers without one by what it says of them: None where it says nothing, SI if it is wrong."""
    return None if said is None else UNIT_SYSTEMS.get(str(said), SI)


def complaints(error: ValidationError, model: type[BaseModel]) -> tuple[list[Complaint], set[KeyPath]]:
    """Complaints about single keys, and the keys meant by misspelt ones, which are then not missing as well."""
    faults = error.errors(include_url=False, include_context=False)
    unknown = [fault["loc"] for fault in faults if fault["type"] == "extra_forbidden"]
    replaced = {(*loc[:-1], near) for loc in unknown for near in _near(model, loc)}
    wrong = [fault for fault in faults if fault["type"] != "missing" or fault["loc"] not in replaced]
    listed: dict[str, KeyPath] = {}
    return [(fault["loc"], _once(_message(fault, model), fault["loc"], listed)) for fault in wrong], replaced


def _once(message: str, loc: KeyPath, listed: dict[str, KeyPath]) -> str:
    """The message without its list of known keys where one before it has that; ``listed``: who has which."""
    said, known, names = message.partition(KNOWN)
    first = listed.setdefault(names, loc) if known else loc
    return message if first == loc else f"{said}known here: see {first[-1]}"


def _near(model: type[BaseModel], loc: KeyPath) -> list[str]:
    """Keys that may be meant by what is at ``loc``."""
    name, known = str(loc[-1]), keys_of(model_at(model, loc[:-1]))
    spelt = suggestion(name, known)
    return meant(name, known) or ([spelt] if spelt else [])


def _message(fault: Any, model: type[BaseModel]) -> str:
    loc: KeyPath = fault["loc"]
    if fault["type"] == "entry":
        return str(fault["msg"])
    if fault["type"] == "extra_forbidden":
        return _unknown(loc, model)
    if fault["type"] == "missing":
        return _missing(loc, model, fault["input"])
    wanted = "a list of tables" if fault["type"].startswith("tuple") else "a table"
    return f"must be {wanted}, {_header(loc, model)}, not {as_shown_in_message(fault['input'])}"


def _unknown(loc: KeyPath, model: type[BaseModel]) -> str:
    name = str(loc[-1])
    own = next((kind for kind in KINDS if kind != "beam" and kind in keys_of(model)), None)
    if len(loc) == 1 and own and name in (*KINDS, "mass", "sensor", *effect_tables()):
        keep = "one of the two" if name in KINDS and name != "beam" else f"[{own}], or the beam's tables"
        return f"[{name}] and [{own}] do not go together: keep {keep}"
    return f"unknown key; {suggest_key(name, keys_of(model_at(model, loc[:-1])))}"


def _missing(loc: KeyPath, model: type[BaseModel], beside: dict[str, Any]) -> str:
    field = fields_of(model_at(model, loc[:-1]))[str(loc[-1])]
    if table_of(field) and not field.examples:
        return f"the table is missing: add {_header(loc, model)}"
    example = "modal" if loc[-1] == "reduction" and "modes" in beside else (field.examples or [None])[0]
    return f"missing ({field.description}): write {loc[-1]} = {to_fill_in(example)}"


def _header(loc: KeyPath, model: type[BaseModel]) -> str:
    keys = loc[:-1] if isinstance(loc[-1], int) else loc
    name = ".".join(name_of(str(part)) for part in keys if isinstance(part, str))
    field = fields_of(model_at(model, keys[:-1])).get(str(keys[-1]))
    if field is None or not is_repeated(field):
        return f"[{name}]"
    return f"[[{name}]]" if is_list(field) else f"[{name}.NAME]"


def fields_of(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """The fields of a table by the name they have in a case."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def keys_of(model: type[BaseModel] | None) -> list[str]:
    """The keys that a table may have."""
    return list(fields_of(model)) if model else []


#: what every fidelity takes from its case, beside the rig
SHARED = ("units", "sweep", "record")


def physics_keys(model: type[BaseModel]) -> list[str]:
    """The keys and tables of a case that describe the rig: those that a fidelity may change."""
    return [name for name, field in fields_of(model).items() if note(field, "physics") is not False]


def entry_of(field: FieldInfo) -> Entry | None:
    """Entry that reads the field; None for a table."""
    return next((part for part in field.metadata if isinstance(part, Entry)), None)


def table_of(field: FieldInfo) -> type[BaseModel] | None:
    """The table that the field holds, one or (by name, or in a list) several; None for a value."""
    entry = entry_of(field)
    if entry:
        return entry.table if isinstance(entry, TableOr) else None
    effect = _effect_of(field)
    if effect:
        return effect.table
    return next(
        (part for part in _parts(field.annotation) if isinstance(part, type) and issubclass(part, BaseModel)), None
    )


def _parts(annotation: Any) -> Iterator[Any]:
    """An annotation and all that it is made of, as in ``dict[str, Table] | None``."""
    yield annotation
    for inner in get_args(annotation):
        yield from _parts(inner)


def _effect_of(field: FieldInfo) -> EffectTable | None:
    return next((part for part in field.metadata if isinstance(part, EffectTable)), None)


def is_repeated(field: FieldInfo) -> bool:
    """Test whether the field holds several tables."""
    return not entry_of(field) and _container(field) is not None


def _container(field: FieldInfo) -> Any:
    """``dict`` or ``tuple``, where the field is one of tables, or may be absent; None for a single one."""
    kinds = (get_origin(each) for each in (field.annotation, *get_args(field.annotation)))
    return next((kind for kind in kinds if kind in (dict, tuple)), None)


def is_list(field: FieldInfo) -> bool:
    """Test whether the field holds a list of tables."""
    return is_repeated(field) and _container(field) is tuple


def lists_of(model: type[BaseModel]) -> list[str]:
    """The keys of a table that hold lists of tables."""
    return [name for name, field in fields_of(model).items() if is_list(field)]


def model_at(model: type[BaseModel], loc: KeyPath) -> type[BaseModel]:
    """The table's declaration at a place in a case."""
    path = list(loc)
    while path:
        field = fields_of(model)[str(path.pop(0))]
        model = table_of(field) or model
        if path and is_repeated(field):
            path.pop(0)
    return model


def example_of(field: FieldInfo) -> str:
    """The field's example as it is written in a case."""
    return to_toml((field.examples or [None])[0])


def readable_case(model: type[AnyCase], tables: Any) -> SimpleNamespace:
    """``readable_part`` of a whole case, and its ``kind``."""
    return SimpleNamespace(kind=model.kind, **vars(readable_part(model, tables, units_of(tables.get("units")))))


def readable_part(model: type[BaseModel], tables: Any, units: UnitSystem | None) -> SimpleNamespace:
    """Readable values of a table, for rules between keys; None where a value is missing or faulty."""
    found = tables if isinstance(tables, dict) else {}
    fields = model.model_fields.items()
    return SimpleNamespace(**{name: _known(field, found.get(field.alias or name), units) for name, field in fields})


def _known(field: FieldInfo, value: Any, units: UnitSystem | None) -> Any:
    if value is None and _effect_of(field):
        return field.default
    entry, table = entry_of(field), table_of(field)
    if table and (isinstance(value, dict) or not entry):
        return _tables(field, table, value, units)
    if value is None or not entry:
        return None if field.is_required() else field.default
    try:
        return entry.read(value, units)
    except ValueError:
        return None


def _tables(field: FieldInfo, table: type[BaseModel], value: Any, units: UnitSystem | None) -> Any:
    if not is_repeated(field):
        return None if value is None and not field.is_required() else readable_part(table, value, units)
    if _container(field) is dict:
        items = value.items() if isinstance(value, dict) else ()
        return {name: readable_part(table, inner, units) for name, inner in items}
    return [readable_part(table, inner, units) for inner in value] if isinstance(value, list) else []
