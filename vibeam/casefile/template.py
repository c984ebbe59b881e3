"""Template of a beam's case: every key with its meaning, optional ones as comments; or what a first run needs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import groupby
from textwrap import wrap
from typing import Any

from vibeam.casefile.documentation import default_of
from vibeam.casefile.examples import WHOSE, tables
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.tables.declared import Field, Table
from vibeam.casefile.toml_writing import to_toml

COLUMN = 44  # where the comments begin
WIDTH = 120

HEAD = """\
# A case of vibeam: every key with what it means and, in brackets, what it may hold. Quantities are text with a unit, or
# numbers in the units that the case names. What a case can do without is a comment here: take the "# " before the key
# (and its table) away to use it. "effect:" marks what adds to the plain model. One key alone: vibeam keys stop.gap
"""

EXAMPLE = "dtu"  # whose values and fidelities the template has
SHOWN: Mapping[str, Mapping[str, Any]] = {
    "output": {
        "gauge": {"position": "5 mm", "quantity": "strain"},
        "accelerometer": {"position": "132 mm", "quantity": "acceleration"},
    },
    "reference": {"exact": {}},
    "expect": {"two_thirds": {}},
    "measured": {"peak": {}},
    "show": {"motion": {}},
    "map": {"gaps": {}},
    "fidelity": tables(EXAMPLE)["fidelity"],
}  # tables with names, as the template shows them
NEEDED = (
    "beam.length beam.width beam.thickness beam.youngs_modulus beam.density beam.damping_ratio mass.mass mass.position "
    "stop.gap stop.restitution stop.restitution_of sensor.position drive.amplitude sweep.frequency sweep.settle "
    "sweep.hold"
)  # keys that suffice for a first run
FIRST = {"fidelity.sdof": {"reduction": "static_mode"}, "fidelity.beam": {"reduction": "modal", "modes": 8}}


@cache
def _given() -> dict[str, Any]:
    """Values of the example by dotted key, in lists of tables with the index: ``plate.0.start``."""
    return dict(_flat("", tables(EXAMPLE)))


def _flat(above: str, part: Any) -> Iterator[tuple[str, Any]]:
    """Values of tables, and tables that hold values alone, by dotted key."""
    items = part.items() if isinstance(part, dict) else enumerate(part)
    for name, value in items:
        yield above + str(name), value
        if isinstance(value, dict) or (isinstance(value, list) and any(isinstance(each, dict) for each in value)):
            yield from _flat(f"{above}{name}.", value)


def template() -> str:
    """A complete case to start from, the DTU rig, with every key explained; optional parts are comments."""
    return HEAD + "\n".join(_lines()) + "\n"


def short() -> str:
    """The same rig in some 25 lines: what a first run needs."""
    fields_by_table = KINDS["beam"].declaration().KEYS
    lines = [
        "# a cantilever with an attached mass, the DTU rig",
        "# every key: vibeam new; those of one table: vibeam keys stop",
    ]
    known = _given() | {"drive.amplitude": "0.1 mm"} | FIRST
    for table, keys in groupby([*NEEDED.split(), *FIRST], key=lambda key: key.partition(".")[0]):
        fields = fields_by_table[table].table.KEYS
        lines.append(f"[{table}]")
        for path in keys:
            key = path.partition(".")[2]
            line = f"{key} = {to_toml(known[path])}"
            field = fields.get(key, fields.get("reduction"))  # of a fidelity, whatever its name
            lines.append(f"{WHOSE}\n{line}" if key == "restitution_of" else _with_few_words(line, field))
    return "\n".join(lines) + "\n"


def _with_few_words(text: str, field: Any) -> str:
    """A key with its meaning, less what is said of its absence, of other values and of other keys."""
    whole = field.description.removeprefix("effect: ")
    meaning = re.split("; |, instead|, on the|, and the|, whose| on the beam where|, absent|, in \\(", whole)[0]
    line = _commented(text, meaning)
    return line if "\n" not in line and len(line) <= 100 else _commented(text, re.split(": |, ", meaning)[0])


def _lines() -> Iterator[str]:
    fields = KINDS["beam"].declaration().KEYS
    yield from (_line("", name, field) for name, field in fields.items() if field.entry)
    for name, field in fields.items():
        if field.table:
            yield from _section(name, field.table, field)


def _section(name: str, table: type[Table], field: Field) -> Iterator[str]:
    """A table, or each of several that the template shows; commented out if the case does without."""
    there = name in _given() and name not in SHOWN
    aside = "" if field.required or there else "# "
    yield ""
    yield from wrap(" ".join((table.__doc__ or "").split()), WIDTH, initial_indent="# ", subsequent_indent="# ")
    if name in SHOWN or field.many:
        explained: set[str] = set()
        for heading, own in _several(name):
            yield f"{aside}{heading}"
            yield from _named(name, table, own, aside, explained)
    else:
        yield f"{aside}[{name}]"
        yield from (_line(f"{name}.", inner, key, aside) for inner, key in table.KEYS.items())


def _several(name: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Heading and values of each of several tables."""
    if name in SHOWN:
        yield from ((f"[{name}.{title}]", own) for title, own in SHOWN[name].items())
    else:
        yield from ((f"[[{name}]]", own) for own in _given().get(name, [{}]))


def _named(above: str, table: type[Table], own: Mapping[str, Any], aside: str, explained: set[str]) -> Iterator[str]:
    """One of several tables: the first explains every key, those after it show what they have."""
    first = not explained
    for name, field in table.KEYS.items():
        if name in own:
            meaning = "" if name in explained else meaning_of(field)
            yield _commented(f"{aside}{name} = {to_toml(own[name])}", meaning)
        elif first:
            yield _line(f"{above}.", name, field, aside or ("# " if own else ""))
        explained.add(name)


def _line(above: str, name: str, field: Field, aside: str = "") -> str:
    own = _given().get(above + name)
    example = to_toml(field.example) if own is None else to_toml(own)
    written = own is not None or example == default_of(field)
    text = _commented(f"{aside or ('' if written else '# ')}{name} = {example}", meaning_of(field))
    inner = field.table.KEYS.items() if field.table else ()
    within = [f"#   {key}: {meaning_of(each)}" for key, each in inner]
    return "\n".join([*within, text])


def _commented(text: str, meaning: str) -> str:
    """The key with its meaning behind it, or above it where both do not fit a line."""
    line = f"{text.ljust(COLUMN - 2)}  # {meaning}" if meaning else text
    if len(line) <= WIDTH:
        return line
    return "\n".join([*wrap(meaning, WIDTH, initial_indent="# ", subsequent_indent="# "), text])


def meaning_of(field: Field) -> str:
    """Meaning of a key and, in brackets, what it may hold."""
    kind = field.entry.describe() if field.entry and not field.table else ""
    return f"{field.description} [{kind}]" if kind and kind != "text" else field.description
