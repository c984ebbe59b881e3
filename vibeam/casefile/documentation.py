"""The case file's own documentation, read off its declaration: the table of all keys and the commented template."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from textwrap import wrap
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from vibeam.case.faults import as_shown_in_message, suggest, suggestion
from vibeam.casefile.fields import Entry
from vibeam.casefile.inline import to_toml
from vibeam.casefile.tables.cases import beam_case, sdof_case
from vibeam.casefile.validation import entry_of, example_of, fields_of, is_repeated, table_of

COLUMN = 44  # where the template's comments begin

WIDTH = 120

WITH_SDOF = " with [sdof]"  # what marks a table in the reference that is another beside [sdof]

SEVERAL = (
    "[[",
    "[fidelity.",
    "[reference.",
    "[expect.",
    "[measured.",
    "[show.",
)  # headings of tables of which there are several

# What the template shows of the tables that have names.
NAMED: dict[str, dict[str, dict[str, Any]]] = {
    "fidelity": {
        "sdof": {"reduction": "static_mode"},
        "two_modes": {"reduction": "modal", "modes": 2},
        "beam": {"reduction": "modal", "modes": 8},
        "point_mass": {
            "reduction": "static_mode",
            "set": {"stop.restitution": 0.7},
            "without": ["mass.rotary_inertia"],
            "label": "point mass",
        },
    },
    "reference": {"exact": {}},
    "expect": {"two_thirds": {}},
    "measured": {"peak": {}},
    "show": {"motion": {}},
}


HEAD = """\
# A case of vibeam: every key with what it means and, in brackets, what it may hold. Quantities are text with a unit, or
# plain numbers in SI units (frequencies in Hz). What a case can do without is a comment here: take the "# " before the
# key (and its table) away to use it. "effect:" marks what adds to the plain model. One key alone: vibeam keys stop.gap
"""


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
    """Every key of a case, in the order of the template; those of a case with [sdof] after them, marked so."""
    rows = list(_rows(beam_case(), ""))
    others = [row for row in _rows(sdof_case(), "") if row not in rows]
    return rows + [row if row.table == "[sdof]" else replace(row, table=f"{row.table}{WITH_SDOF}") for row in others]


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
    names = heading.removesuffix(WITH_SDOF).replace("[", "").replace("]", "").split()
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


def template() -> str:
    """A complete case to start from, the DTU rig, with every key explained; optional parts are comments."""
    return HEAD + "\n".join(_template()) + "\n"


def _template() -> Iterator[str]:
    fields = fields_of(beam_case())
    yield from (_line(name, field) for name, field in fields.items() if entry_of(field))
    for name, field in fields.items():
        table = table_of(field)
        if table:
            yield from _section(name, table, field)


def _section(name: str, table: type[BaseModel], field: FieldInfo) -> Iterator[str]:
    """A table, or one for each name that the template shows; commented out if the case does without."""
    extra: Any = field.json_schema_extra or {}
    aside = "" if field.is_required() or extra.get("written", False) else "# "
    yield ""
    yield from wrap(" ".join((table.__doc__ or "").split()), WIDTH, initial_indent="# ", subsequent_indent="# ")
    if not is_repeated(field):
        yield f"{aside}[{name}]"
        yield from (_line(inner, key, aside) for inner, key in fields_of(table).items())
    elif name not in NAMED:
        yield f"{aside}[[{name}]]"
        yield from (_line(inner, key, aside) for inner, key in fields_of(table).items())
    else:
        explained: set[str] = set()
        for title, values in NAMED[name].items():
            yield f"{aside}[{name}.{title}]"
            yield from _named(table, values, aside, explained)


def _named(table: type[BaseModel], values: dict[str, Any], aside: str, explained: set[str]) -> Iterator[str]:
    """One of several tables: the first explains every key, those after it show what they have."""
    first = not explained
    for name, field in fields_of(table).items():
        if name in values:
            meaning = "" if name in explained else _meaning(field)
            yield _commented(f"{aside}{name} = {to_toml(values[name])}", meaning)
        elif first:
            yield _line(name, field, aside or ("# " if values else ""))
        explained.add(name)


def _line(name: str, field: FieldInfo, aside: str = "") -> str:
    extra: Any = field.json_schema_extra or {}
    aside = aside or ("" if extra.get("written", True) else "# ")
    text = _commented(f"{aside}{name} = {example_of(field)}", _meaning(field))
    inner = table_of(field)
    within = [f"#   {key}: {_meaning(each)}" for key, each in fields_of(inner).items()] if inner else []
    return "\n".join([*within, text])


def _commented(text: str, meaning: str) -> str:
    """The key with its meaning behind it, or above it where both do not fit a line."""
    line = f"{text.ljust(COLUMN - 2)}  # {meaning}" if meaning else text
    if len(line) <= WIDTH:
        return line
    return "\n".join([*wrap(meaning, WIDTH, initial_indent="# ", subsequent_indent="# "), text])


def _meaning(field: FieldInfo) -> str:
    entry = entry_of(field)
    kind = entry.describe() if entry and not table_of(field) else ""
    return f"{field.description} [{kind}]" if kind and kind != "text" else field.description or ""
