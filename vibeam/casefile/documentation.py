"""Reference of the keys of a case file, read off its declaration: tables for readers, a JSON schema."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from inspect import cleandoc
from typing import Any

from vibeam.casefile.kinds import KINDS
from vibeam.casefile.synonyms import suggest_key
from vibeam.casefile.tables.cases import case_table
from vibeam.casefile.tables.declared import Field, Later, Table
from vibeam.casefile.toml_writing import to_toml
from vibeam.exchange.faults import as_shown_in_message, suggestion

_WITH = re.compile(r" with \[\w+\]$")  # what marks a table in the reference that is another beside [sdof], say

NAMED = ("fidelity", "reference", "expect", "measured", "show", "output", "map")  # tables by name

SEVERAL = ("[[", *(f"[{name}." for name in NAMED))  # headings of tables of which there are several


@dataclass(frozen=True)
class TableRow:
    """One table of a case: its heading, the number of its keys, what it is."""

    table: str
    keys: int
    meaning: str


@dataclass(frozen=True)
class KeyLine:
    """One key by its dotted name, its default, and its meaning with what it may hold."""

    key: str
    default: str
    meaning: str


@dataclass(frozen=True)
class KeyRow:
    """One key: its table as headed in a case, what it holds (unit and range), default ("" where there is none)."""

    table: str
    key: str
    unit: str
    default: str
    required: bool
    meaning: str


def reference_table() -> list[KeyRow]:
    """Every key of a case, in the order of the template; those of other kinds, [sdof] say, after them, marked so."""
    rows = list(_rows(case_table("beam"), ""))
    marked = list(rows)
    for name in KINDS:
        others = [row for row in _rows(KINDS[name].declaration(), "") if row not in rows]
        marked += [row if row.table.startswith(f"[{name}") else _marked(row, name) for row in others]
    return marked


def _marked(row: KeyRow, kind: str) -> KeyRow:
    return replace(row, table=f"{row.table} with [{kind}]")


def tables_of() -> list[TableRow]:
    """The tables of a case, each with its meaning in a few words; those of studies together, at the end."""
    counts = Counter(_place(row.table)[:1] for row in reference_table())
    top, meanings = "above all tables", {"": "title, source, units; what is uncertain"}
    declared = {name: field for kind in KINDS.values() for name, field in kind.declaration().KEYS.items()}
    for name, table in ((name, field.table) for name, field in declared.items()):
        words = " ".join((table.__doc__ or "").split()).removeprefix("Effect: ").rstrip(".") if table else ""
        sentence = re.split("[;.] |, one table| in place", words[:1].lower() + words[1:])[0]
        few = sentence if len(sentence) < 54 else re.split(": |, | through | by its voltage", sentence)[0]
        meanings |= {name: few.rstrip(",")} if table else {}
    plans = [name for name, meaning in meanings.items() if meaning.startswith("plan of vibeam")]
    rows = [
        TableRow(_header("", name, declared[name]) if name else top, counts[(name,) if name else ()], meaning)
        for name, meaning in meanings.items()
        if name not in plans
    ]
    commands = f"plan of a study: {', '.join(f'[{name}]' for name in plans)}"
    return [*rows, TableRow("[STUDY]", sum(counts[(name,)] for name in plans), commands)]


def lines_of(rows: Iterable[KeyRow], whole: bool = True) -> list[KeyLine]:
    """A line for each of these keys, its meaning ``whole`` or up to the first semicolon.

    Not for those of another kind of case, of which there are some without.
    """
    found = list(rows)
    own = [row for row in found if not _WITH.search(row.table)] or found
    return [
        KeyLine(
            ".".join((*_place(row.table), row.key)),
            "required" if row.required else row.default,
            f"{row.meaning if whole else row.meaning.partition('; ')[0]} [{row.unit}]",
        )
        for row in own
    ]


def rows_of(name: str) -> list[KeyRow]:
    """The keys of one table (``"stop"``), or one key (``"stop.gap"``), as ``reference_table`` has them.

    A key without its table (``"gap"``) is found in every one. The name or index of one of several tables may be said
    or left away: ``"fidelity.beam.modes"``. ValueError, with what was meant, for a name that is none.
    """
    rows = {row: (*_place(row.table), row.key) for row in reference_table()}
    wanted = _without_name(tuple(name.strip("[] ").split(".")), rows)
    found = [row for row, path in rows.items() if path[: len(wanted)] == wanted]
    found = found or [row for row, path in rows.items() if path[-1:] == wanted]
    if not found:
        raise ValueError(f"unknown key {as_shown_in_message(name)}; {_meant(wanted, set(rows.values()))}")
    return found


def _place(heading: str) -> tuple[str, ...]:
    """The names in a heading: ``[sweep] frequency`` is sweep and frequency, ``[show.NAME] with [sdof]`` show alone."""
    names = _WITH.sub("", heading).replace("[", "").replace("]", "").split()
    return tuple(name.removesuffix(".NAME") for name in names)


def _without_name(wanted: tuple[str, ...], rows: Mapping[KeyRow, tuple[str, ...]]) -> tuple[str, ...]:
    """``wanted`` without what a case calls one of several tables, where it is said."""
    keys = [path[1] for row, path in rows.items() if path[0] == wanted[0] and row.table.startswith(SEVERAL)]
    named = keys and len(wanted) > 1 and wanted[1] not in keys
    return wanted[:1] + wanted[2:] if named and (len(wanted) > 2 or not suggestion(wanted[1], keys)) else wanted


def _meant(wanted: tuple[str, ...], paths: Collection[tuple[str, ...]]) -> str:
    """Suggestion for an unknown name: the known ones of the last table that it names."""
    depth = 0
    while any(path[: depth + 1] == wanted[: depth + 1] for path in paths):
        depth += 1
    known = sorted({path[depth] for path in paths if path[:depth] == wanted[:depth] and len(path) > depth})
    return suggest_key(wanted[depth], known) if known else f"{'.'.join(wanted[:depth])} holds a value, no keys"


def _rows(kind: type[Table], table: str) -> Iterator[KeyRow]:
    yield from (_row(table, name, field) for name, field in kind.KEYS.items() if field.entry)
    for name, field in kind.KEYS.items():
        if field.table:
            yield from _rows(field.table, _header(table, name, field))


def _header(above: str, name: str, field: Field) -> str:
    if above:
        return f"{above} {name}"
    if not field.many:
        return f"[{name}]"
    return f"[{name}.NAME]" if name in NAMED else f"[[{name}]]"


def _row(table: str, name: str, field: Field) -> KeyRow:
    kind = field.entry.describe() if field.entry else ""
    kind = f"table | {kind}" if field.table else kind
    return KeyRow(table, name, kind, default_of(field), field.required, field.description)


def default_of(field: Field) -> str:
    """The default as a case writes it; empty where there is none, or an empty one."""
    if field.entry is None or field.default in (..., None, "", (), {}):
        return ""
    return to_toml(field.entry.canonical(field.default))


DEFINED = "#/$defs/"
DIALECT = "https://json-schema.org/draft/2020-12/schema"
TITLE = "A case of vibeam"


def case_schema() -> dict[str, Any]:
    """The schema: one of the kinds of case, each of whose tables is a definition, those of effects within it."""
    tables: dict[str, Any] = {}
    kinds = [_referred(kind.declaration(), tables) for kind in KINDS.values()]
    for case in (tables[kind["$ref"].removeprefix(DEFINED)] for kind in kinds):
        _allow_unnamed(case["properties"])
        _allow_records(case)
    for keys in (table["properties"] for table in tables.values()):
        keys |= {"fidelity": keys["fidelities"]} if "fidelities" in keys else {}
    return {"$schema": DIALECT, "title": TITLE, "anyOf": kinds, "$defs": dict(sorted(tables.items()))}


def _referred(kind: type[Table], tables: dict[str, Any]) -> dict[str, Any]:
    """Reference to the schema of a table, which joins ``tables``, as do those that it refers to."""
    made, name = _table(kind, tables), kind.__name__
    while tables.setdefault(name, made) != made:
        name += "_"
    return {"$ref": DEFINED + name}


def _table(kind: type[Table], tables: dict[str, Any]) -> dict[str, Any]:
    required = [name for name, field in kind.KEYS.items() if field.required]
    return {
        "additionalProperties": False,
        "description": cleandoc(kind.__doc__ or ""),
        "properties": {name: _key(name, field, tables) for name, field in kind.KEYS.items()},
        **({"required": required} if required else {}),
        "title": kind.__name__,
        "type": "object",
    }


def _key(name: str, field: Field, tables: dict[str, Any]) -> dict[str, Any]:
    """Schema of a key: what is said of it, and what it holds."""
    said: dict[str, Any] = {"description": field.description} if field.description else {}
    said |= {} if field.example is None else {"examples": [field.example]}
    said |= {"title": name.replace("_", " ").title()} if field.many or not field.table else {}
    if (field.entry or field.many is tuple) and field.default not in (..., None, {}):
        said["default"] = field.default
    if field.default is None and not field.entry and not isinstance(field.kind, Later):
        return {**_sorted(said), **_sorted(_held(field, tables))}
    return {**_sorted(_held(field, tables) | said)}


def _held(field: Field, tables: dict[str, Any]) -> dict[str, Any]:
    """Schema of a value, of a table, of several, or of a table or a value."""
    if field.entry:
        value = field.entry.schema()
        return {"anyOf": [_table(field.table, tables), value]} if field.table else value
    one = (_table if isinstance(field.kind, Later) else _referred)(field.table, tables)
    if field.many is None:
        return one
    return {"type": "array", "items": one} if field.many is tuple else {"type": "object", "additionalProperties": one}


def _sorted(value: Any, own: bool = False) -> Any:
    """The schema in the order of the alphabet, the keys of tables in their own."""
    if isinstance(value, Mapping):
        return {name: _sorted(value[name], name == "properties") for name in (value if own else sorted(value))}
    return [_sorted(each) for each in value] if isinstance(value, list | tuple) else value


def _allow_records(case: dict[str, Any]) -> None:
    """Require a sweep and what drives it, or a record."""
    case["required"].remove("drive")
    case["anyOf"] = [{"required": ["sweep", "drive"]}, {"required": ["record"]}]


def _allow_unnamed(keys: dict[str, Any]) -> None:
    """Allow [map] with the keys of a map, beside [map.NAME]."""
    named = keys["map"]
    own = {key: named[key] for key in ("description", "title") if key in named}
    either = {key: value for key, value in named.items() if key not in own}
    keys["map"] = own | {"anyOf": [either, {"$ref": named["additionalProperties"]["$ref"]}]}
