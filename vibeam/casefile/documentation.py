"""Reference of the keys of a case file, read off its declaration: tables for readers, a JSON schema, the template."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from textwrap import wrap
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic.json_schema import models_json_schema

from vibeam.casefile.fields import Entry
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.rigs import RIGS, Rig
from vibeam.casefile.tables.cases import case_table
from vibeam.casefile.tables.table import NOTES
from vibeam.casefile.toml_writing import to_toml
from vibeam.casefile.validation import entry_of, example_of, fields_of, is_repeated, table_of
from vibeam.exchange.faults import as_shown_in_message, suggest, suggestion

_WITH = re.compile(r" with \[\w+\]$")  # what marks a table in the reference that is another beside [sdof], say

SEVERAL = (
    "[[",
    "[fidelity.",
    "[reference.",
    "[expect.",
    "[measured.",
    "[show.",
    "[output.",
    "[map.",
)  # headings of tables of which there are several

NAMED = ("fidelity", "reference", "expect", "measured", "show", "output", "map")  # tables by name


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


def rows_of(name: str) -> list[KeyRow]:
    """The keys of one table (``"stop"``), or one key (``"stop.gap"``), as ``reference_table`` has them.

    The name or index of one of several tables may be said or left away: ``"fidelity.beam.modes"``. ValueError, with
    what was meant, for a name that is none.
    """
    rows = {row: (*_place(row.table), row.key) for row in reference_table()}
    wanted = _without_name(tuple(name.strip("[] ").split(".")), rows)
    found = [row for row, path in rows.items() if path[: len(wanted)] == wanted]
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
    return suggest(wanted[depth], known) if known else f"{'.'.join(wanted[:depth])} holds a value, no keys"


def _rows(model: type[BaseModel], table: str) -> Iterator[KeyRow]:
    inner = []
    for name, field in fields_of(model).items():
        if entry_of(field):
            yield _row(table, name, field)
        if table_of(field):
            inner.append((name, field))
    for name, field in inner:
        yield from _rows(table_of(field) or model, _header(table, name, field))


def _header(above: str, name: str, field: FieldInfo) -> str:
    if above:
        return f"{above} {name}"
    if not is_repeated(field):
        return f"[{name}]"
    return f"[{name}.NAME]" if name in NAMED else f"[[{name}]]"


def _row(table: str, name: str, field: FieldInfo) -> KeyRow:
    entry = entry_of(field)
    kind = entry.describe() if entry else ""
    kind = f"table | {kind}" if table_of(field) else kind
    return KeyRow(table, name, kind, _default(entry, field), field.is_required(), field.description or "")


def _default(entry: Entry | None, field: FieldInfo) -> str:
    """The default as a case writes it; empty where there is none, or an empty one."""
    if entry is None or field.is_required() or field.default is None or field.default in ("", (), {}):
        return ""
    return to_toml(entry.canonical(field.default))


def meaning_of(field: FieldInfo) -> str:
    """Meaning of a key and, in brackets, what it may hold."""
    entry = entry_of(field)
    kind = entry.describe() if entry and not table_of(field) else ""
    return f"{field.description} [{kind}]" if kind and kind != "text" else field.description or ""


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


COLUMN = 44  # where the comments begin
WIDTH = 120

HEAD = """\
# A case of vibeam: every key with what it means and, in brackets, what it may hold. Quantities are text with a unit, or
# numbers in the units that the case names. What a case can do without is a comment here: take the "# " before the key
# (and its table) away to use it. "effect:" marks what adds to the plain model. One key alone: vibeam keys stop.gap
"""


def template(rig: str = "cantilever") -> str:
    """A complete case to start from, of one of ``RIGS``, with every key explained; optional parts are comments."""
    return HEAD + "\n".join(_Template(RIGS[rig]).lines()) + "\n"


class _Template:
    def __init__(self, rig: Rig) -> None:
        self.rig = rig

    def lines(self) -> Iterator[str]:
        fields = fields_of(KINDS[self.rig.kind].declaration())
        yield from (self._line("", name, field) for name, field in fields.items() if entry_of(field))
        for name, field in fields.items():
            table = table_of(field)
            if table:
                yield from self._section(name, table, field)

    def _section(self, name: str, table: type[BaseModel], field: FieldInfo) -> Iterator[str]:
        """A table, or one for each name that the template shows; commented out if the case does without."""
        extra: Any = field.json_schema_extra or {}
        written = field.is_required() or extra.get("written", False) or name in self.rig.shown
        aside = "" if written and name not in self.rig.aside else "# "
        yield ""
        yield from wrap(" ".join((table.__doc__ or "").split()), WIDTH, initial_indent="# ", subsequent_indent="# ")
        if name in self.rig.named:
            explained: set[str] = set()
            for title, values in self.rig.named[name].items():
                yield f"{aside}[{name}.{title}]"
                yield from self._named(table, values, aside, explained)
        else:
            yield f"{aside}[[{name}]]" if is_repeated(field) else f"{aside}[{name}]"
            yield from (self._line(f"{name}.", inner, key, aside) for inner, key in fields_of(table).items())

    def _named(self, table: type[BaseModel], values: Any, aside: str, explained: set[str]) -> Iterator[str]:
        """One of several tables: the first explains every key, those after it show what they have."""
        first = not explained
        for name, field in fields_of(table).items():
            if name in values:
                meaning = "" if name in explained else meaning_of(field)
                yield _commented(f"{aside}{name} = {to_toml(values[name])}", meaning)
            elif first:
                yield self._line("", name, field, aside or ("# " if values else ""))
            explained.add(name)

    def _line(self, above: str, name: str, field: FieldInfo, aside: str = "") -> str:
        extra: Any = field.json_schema_extra or {}
        own = self.rig.examples.get(above + name)
        written = own is not None or (extra.get("written", True) and above + name not in self.rig.aside)
        example = example_of(field) if own is None else to_toml(own)
        text = _commented(f"{aside or ('' if written else '# ')}{name} = {example}", meaning_of(field))
        inner = table_of(field)
        within = [f"#   {key}: {meaning_of(each)}" for key, each in fields_of(inner).items()] if inner else []
        return "\n".join([*within, text])


def _commented(text: str, meaning: str) -> str:
    """The key with its meaning behind it, or above it where both do not fit a line."""
    line = f"{text.ljust(COLUMN - 2)}  # {meaning}" if meaning else text
    if len(line) <= WIDTH:
        return line
    return "\n".join([*wrap(meaning, WIDTH, initial_indent="# ", subsequent_indent="# "), text])
