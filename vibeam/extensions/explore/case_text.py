"""Case as text for its page: TOML with places for the sliders' values, and the commands for what no slider moves."""

from __future__ import annotations

import shlex
import tomllib
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from vibeam.casefile.toml import key_parts, value_spans
from vibeam.system.number_text import shown_in

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.exchange.faults import KeyPath
    from vibeam.extensions.explore.sliders import CaseSliders

Template = list[str | dict[str, Any]]


def template(case: Case, sliders: CaseSliders) -> Template:
    """The case as TOML in parts: text, and {slider, times} where the slider's value (SI) times a number stands."""
    spans, places = value_spans(case.text)[0], []
    for name, slider in sliders.sliders.items():
        for key, times in slider.settings(1.0).items() if name != "frequency" else ():
            places.append((*spans[_path(key, spans)], {"slider": name, "times": times}))
    parts, done = Template(), 0
    for begin, end, mark in sorted(places, key=lambda each: each[0]):
        parts += [case.text[done:begin], mark]
        done = end
    return [*parts, case.text[done:]]


def filled(parts: Template, values: Mapping[str, float]) -> str:
    """TOML of a template at values of the sliders, as the page writes it."""
    return "".join(
        each if isinstance(each, str) else repr(float(values[each["slider"]] * each["times"])) for each in parts
    )


def _path(key: str, spans: Mapping[KeyPath, Any]) -> KeyPath:
    """Path of a key in the text, that of the only entry where it is a list of one."""
    path: KeyPath = tuple(int(part) if part.isdigit() else part for part in key_parts(key))
    return path if path in spans else (*path, 0)


def fixed_keys(case: Case, sliders: CaseSliders) -> list[dict[str, str]]:
    """Rows of what no slider moves: a table with its keys and the command that changes one, and missing sliders."""
    moved = {key for each in sliders.sliders.values() for key in each.settings(1.0)}
    rows = [{"name": name, "key": "", "why": why, "command": ""} for name, why in sliders.fixed.items()]
    tables: dict[str, list[tuple[str, float, str]]] = {}
    for key, value in _numbers(tomllib.loads(case.text)):
        if key not in moved and f"{key}.0" not in moved and (unit := _unit(case, key)) is not None:
            tables.setdefault(key.partition(".")[0], []).append((key, value, unit))
    for table, keys in tables.items():
        key, value, unit = keys[0]
        setting = f"{key}={_written(case, key, value, unit)}"
        command = f"vibeam run {shlex.quote(case.path.name)} --set {shlex.quote(setting)}"
        names = ", ".join(each.partition(".")[2] for each, _, _ in keys)
        rows.append({"name": "", "key": table, "why": names, "command": command})
    return rows


def _written(case: Case, key: str, value: float, unit: str) -> str:
    """Value of a key as TOML, with the prefix that suits it where that is the same number."""
    if not unit:
        return repr(value)
    name, factor = shown_in(unit, value)
    short = f"{value * factor:.12g} {name}"
    try:
        same = case.keys.number(key, short) == value
    except ValueError:
        same = False
    return f'"{short}"' if same else f'"{value!r} {unit}"'


def _unit(case: Case, key: str) -> str | None:
    """SI unit of a key of the rig, empty of a plain number; None of another key."""
    try:
        return case.keys.unit(key)
    except ValueError:
        return None


def _numbers(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, float]]:
    """Keys of tables that hold one number, by their dotted names."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _numbers(value, f"{above}{name}.")
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            for at, each in enumerate(value):
                yield from _numbers(each, f"{above}{name}.{at}.")
        elif isinstance(value, float | int) and not isinstance(value, bool):
            yield f"{above}{name}", value
