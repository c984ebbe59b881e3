"""Template of a case: every key with its meaning, optional ones as comments; or what a first run needs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import groupby
from textwrap import wrap
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from vibeam.casefile.documentation import default_of
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.rigs import RIGS, Rig
from vibeam.casefile.toml_writing import to_toml
from vibeam.casefile.validation import entry_of, example_of, fields_of, is_repeated, table_of

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


def short(name: str = "cantilever") -> str:
    """The same rig in some 25 lines: what a first run needs."""
    rig = RIGS[name]
    tables = fields_of(KINDS[rig.kind].declaration())
    lines = [f"# {rig.meaning}", f"# every key: vibeam new --rig {name}; those of one table: vibeam keys stop"]
    for table, keys in groupby(rig.short.items(), key=lambda item: item[0].partition(".")[0]):
        fields = fields_of(table_of(tables[table]) or BaseModel)
        lines.append(f"[{table}]")
        for path, value in keys:
            key = path.partition(".")[2]
            lines.append(_with_few_words(f"{key} = {to_toml(value)}", fields[key]))
    reduction = fields_of(table_of(tables["fidelity"]) or BaseModel)["reduction"]
    lines.append("[fidelity]")
    lines += [_with_few_words(f"{title} = {to_toml(value)}", reduction) for title, value in rig.first.items()]
    return "\n".join(lines) + "\n"


def _with_few_words(text: str, field: FieldInfo) -> str:
    """A key with its meaning, less what is said of its absence, of other values and of other keys."""
    whole = (field.description or "").removeprefix("effect: ")
    meaning = re.split("; |, instead|, on the|, and the|, whose| on the beam where|, absent|, in \\(", whole)[0]
    line = _commented(text, meaning)
    return line if "\n" not in line and len(line) <= 100 else _commented(text, re.split(": |, ", meaning)[0])


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
        """A table, or each of several that the template shows; commented out if the case does without."""
        there = name in self.rig.values and name not in self.rig.named
        aside = "" if field.is_required() or there else "# "
        yield ""
        yield from wrap(" ".join((table.__doc__ or "").split()), WIDTH, initial_indent="# ", subsequent_indent="# ")
        if name in self.rig.named or is_repeated(field):
            explained: set[str] = set()
            for heading, values in self._several(name):
                yield f"{aside}{heading}"
                yield from self._named(name, table, values, aside, explained)
        else:
            yield f"{aside}[{name}]"
            yield from (self._line(f"{name}.", inner, key, aside) for inner, key in fields_of(table).items())

    def _several(self, name: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Heading and values of each of several tables."""
        if name in self.rig.named:
            yield from ((f"[{name}.{title}]", values) for title, values in self.rig.named[name].items())
        else:
            yield from ((f"[[{name}]]", values) for values in self.rig.values.get(name, [{}]))

    def _named(
        self, above: str, table: type[BaseModel], values: Mapping[str, Any], aside: str, explained: set[str]
    ) -> Iterator[str]:
        """One of several tables: the first explains every key, those after it show what they have."""
        first = not explained
        for name, field in fields_of(table).items():
            if name in values:
                meaning = "" if name in explained else meaning_of(field)
                yield _commented(f"{aside}{name} = {to_toml(values[name])}", meaning)
            elif first:
                yield self._line(f"{above}.", name, field, aside or ("# " if values else ""))
            explained.add(name)

    def _line(self, above: str, name: str, field: FieldInfo, aside: str = "") -> str:
        own = self.rig.values.get(above + name)
        example = example_of(field) if own is None else to_toml(own)
        written = own is not None or example == default_of(entry_of(field), field)
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


def meaning_of(field: FieldInfo) -> str:
    """Meaning of a key and, in brackets, what it may hold."""
    entry = entry_of(field)
    kind = entry.describe() if entry and not table_of(field) else ""
    return f"{field.description} [{kind}]" if kind and kind != "text" else field.description or ""
