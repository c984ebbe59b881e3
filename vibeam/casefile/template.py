"""The commented template of a case, read off its declaration: every key once, with what it means."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import wrap
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from vibeam.casefile.documentation import meaning_of
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
