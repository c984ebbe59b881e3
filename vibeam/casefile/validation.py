"""Reading of a case's tables by their declaration: what can be read of them, and every fault by its key."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from vibeam.casefile.fields import Entry
from vibeam.casefile.kinds import KINDS, kind_of
from vibeam.casefile.quantities import SI, UNIT_SYSTEMS, UnitSystem
from vibeam.casefile.synonyms import meant, suggest_key
from vibeam.casefile.tables.cases import AnyCase, case_table
from vibeam.casefile.tables.declared import Field, Table
from vibeam.casefile.toml_writing import name_of, to_fill_in
from vibeam.exchange.faults import KNOWN, Complaint, KeyPath, as_shown_in_message, suggestion
from vibeam_models.effects import tables as effect_tables

MAP = "map"
ALIKE = {  # tables: a spelling that is read, and the key that it is
    **dict.fromkeys((MAP, "show"), ("fidelity", "fidelities")), "measured": ("scatter", "uncertainty"),
}  # fmt: skip


def read(tables: dict[str, Any]) -> tuple[Any, Reading]:
    """The case as far as it can be read, with what was wrong in its reading."""
    reading = Reading(units_of(tables.get("units")))
    return reading.table(declaration(tables), _in_full(tables)), reading


def declaration(tables: Mapping[str, Any]) -> type[AnyCase]:
    """Declaration of the kind of case that the tables are."""
    return case_table(kind_of(tables).name)


def _in_full(tables: dict[str, Any]) -> dict[str, Any]:
    """The tables as they are declared: with what follows from others where a case leaves it out, in one spelling.

    Matrices have the units of the case; a record without a drive is driven by nothing.
    """
    found = {"drive": {}} | tables if "record" in tables else dict(tables)
    if "units" in tables and isinstance(matrices := tables.get("matrices"), dict):
        units = str(tables["units"])
        found["matrices"] = {"units": units if units in UNIT_SYSTEMS else "SI"} | matrices
    if own := unnamed_map(tables):
        found[MAP] = {MAP: own} | {name: each for name, each in tables[MAP].items() if name not in own}
    for kind, (spelt, key) in ALIKE.items():
        if isinstance(named := found.get(kind), dict):
            found[kind] = {name: _called(key, spelt, table) for name, table in named.items()}
    return found


def unnamed_map(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of the map that [map] itself is, whose name is "map" where no other has it.

    No key of a map is a table, so that whatever is one is a map with a name.
    """
    given = tables.get(MAP)
    if not isinstance(given, dict) or MAP in given:
        return {}
    return {key: value for key, value in given.items() if not isinstance(value, dict)}


def _called(key: str, spelt: str, table: Any) -> Any:
    """A table whose key is called so, unless it has that as well."""
    if not isinstance(table, dict) or key in table:
        return table
    return {key if name == spelt else name: value for name, value in table.items()}


def units_of(said: Any) -> UnitSystem | None:
    """Units of a case's numbers without one by what it says of them: None where it says nothing, SI if it is wrong."""
    return None if said is None else UNIT_SYSTEMS.get(str(said), SI)


@dataclass(frozen=True)
class Reading:
    """Reading of tables, in which numbers without a unit are in ``units``.

    ``complaints`` are about single keys; ``excused``: keys that misspelt ones stand for, which are not missing as well;
    ``listed``: lists of known keys in messages, each with the key whose message has it.
    """

    units: UnitSystem | None
    complaints: list[Complaint] = field(default_factory=list)
    excused: set[KeyPath] = field(default_factory=set)
    listed: dict[str, KeyPath] = field(default_factory=dict)

    def table(self, kind: type[Table], said: Mapping[str, Any], at: KeyPath = ()) -> Any:
        """The table at a place; what stands in it for a value that cannot be read says ``Field.unread``."""
        unknown = [name for name in said if name not in kind.KEYS]
        self.excused.update((*at, near) for name in unknown for near in _near(name, kind))
        found = {}
        for name, key in kind.KEYS.items():
            path = (*at, name)
            if name in said:
                found[key.attribute] = self._value(key, said[name], path)
            elif key.required and path not in self.excused:
                self._complain(path, _missing(path, key, said))
        for name in unknown:
            self._complain((*at, name), _unknown(name, kind, at))
        return kind(**found)

    def _value(self, key: Field, value: Any, at: KeyPath) -> Any:
        if not isinstance(key.kind, Entry) or (key.table and isinstance(value, dict)):
            return self._tables(key, value, at)
        try:
            return key.kind.read(value, self.units)
        except ValueError as error:
            self._complain(at, str(error))
            return None

    def _tables(self, key: Field, value: Any, at: KeyPath) -> Any:
        """The table of a key, or several by name or in a list."""
        kind: Any = list if key.many is tuple else dict
        if not isinstance(value, kind):
            wanted = "a list of tables" if key.many is tuple else "a table"
            self._complain(at, f"must be {wanted}, {_header(at, key)}, not {as_shown_in_message(value)}")
            return key.unread
        if key.many is None:
            return self.table(key.table, value, at)
        one, items = replace(key, many=None), value.items() if key.many is dict else enumerate(value)
        found = {name: self._tables(one, each, (*at, name)) for name, each in items}
        return found if key.many is dict else tuple(found.values())

    def _complain(self, at: KeyPath, message: str) -> None:
        """Add a complaint, without its list of known keys where one before it has that."""
        said, known, names = message.partition(KNOWN)
        first = self.listed.setdefault(names, at) if known else at
        self.complaints.append((at, message if first == at else f"{said}known here: see {first[-1]}"))


def _near(name: str, kind: type[Table]) -> list[str]:
    """Keys that may be meant by an unknown one."""
    spelt = suggestion(name, kind.KEYS)
    return meant(name, kind.KEYS) or ([spelt] if spelt else [])


def _unknown(name: str, kind: type[Table], at: KeyPath) -> str:
    own = next((each for each in KINDS if each != "beam" and each in kind.KEYS), None)
    if not at and own and name in (*KINDS, "mass", "sensor", *effect_tables()):
        keep = "one of the two" if name in KINDS and name != "beam" else f"[{own}], or the beam's tables"
        return f"[{name}] and [{own}] do not go together: keep {keep}"
    return f"unknown key; {suggest_key(name, kind.KEYS)}"


def _missing(at: KeyPath, key: Field, beside: Mapping[str, Any]) -> str:
    if key.table and key.example is None:
        return f"the table is missing: add {_header(at, key)}"
    example = "modal" if at[-1] == "reduction" and "modes" in beside else key.example
    return f"missing ({key.description}): write {at[-1]} = {to_fill_in(example)}"


def _header(at: KeyPath, key: Field) -> str:
    """Heading of the table at a place, or of those there."""
    name = ".".join(name_of(each) for each in at if isinstance(each, str))
    if key.many is tuple or isinstance(at[-1], int):
        return f"[[{name}]]"
    return f"[{name}]" if key.many is None else f"[{name}.NAME]"


#: what every fidelity takes from its case, beside the rig
SHARED = ("units", "sweep", "record")


def physics_keys(kind: type[Table]) -> list[str]:
    """The keys and tables of a case that describe the rig: those that a fidelity may change."""
    return [name for name, key in kind.KEYS.items() if key.physics]
