"""Changes of the scene by a fidelity: its own values for physics keys, optional keys and tables that it leaves out.

A fidelity's scene is the case's tables with the changes made in them, judged by the same declaration as the case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from vibeam.casefile.field_tables import flat
from vibeam.casefile.fields import Entry, OneOrSeveral, Several
from vibeam.casefile.overrides import OverrideError, override
from vibeam.casefile.quantities import UnitSystem
from vibeam.casefile.synonyms import suggest_key
from vibeam.casefile.tables.declared import Field, Table
from vibeam.casefile.toml import key_parts
from vibeam.casefile.validation import SHARED, declaration, physics_keys, units_of
from vibeam.exchange.faults import Complaint, KeyPath, as_shown_in_message
from vibeam_models.effects import parts_of

OWN = ("set", "without")
Validate = Callable[[dict[str, Any]], tuple[Any, list[Complaint]]]


@dataclass(frozen=True)
class FidelityCase:
    """Case of one fidelity: ``declared`` with the changes made, ``changes`` {dotted key: value in SI, as written}."""

    declared: Any
    changes: Mapping[str, Any]


def variants(
    tables: dict[str, Any], reported: list[Complaint], validate: Validate
) -> tuple[dict[str, FidelityCase], list[Complaint]]:
    """The variant of every fidelity that changes something, and what is wrong with the changes.

    ``reported``: complaints about the case itself, not repeated; ``validate``: validates other tables of this kind.
    """
    found: dict[str, FidelityCase] = {}
    wrong: list[Complaint] = []
    fidelities = tables.get("fidelity")
    for name, table in fidelities.items() if isinstance(fidelities, dict) else ():
        if isinstance(table, dict) and ("set" in table or "without" in table):
            change = _Change(declaration(tables), name, table)
            own = change.validated(tables, dict(reported), validate, wrong)
            if own is not None:
                found[name] = FidelityCase(own, change.canonical(units_of(own.units)))
    return found, wrong


class _Change:
    """Keys that one fidelity sets and leaves out."""

    def __init__(self, model: type[Table], name: str, table: dict[str, Any]) -> None:
        self.model, self.name, self.table = model, name, table
        settings, left = table.get("set"), table.get("without")
        self.settings = dict(flat(settings)) if isinstance(settings, dict) else {}
        self.left = [each for each in left if isinstance(each, str)] if isinstance(left, list) else []

    def validated(
        self, tables: dict[str, Any], reported: dict[KeyPath, str], validate: Validate, wrong: list[Complaint]
    ) -> Any:
        """The changed case as declared; None where something is wrong, which joins ``wrong``."""
        before = len(wrong)
        wrong += self._key_faults()
        if len(wrong) > before:
            return None
        own, places = self._changed(tables, wrong)
        declared, faults = validate(own)
        wrong += self._placed(faults, places, reported)
        return declared if len(wrong) == before else None

    def canonical(self, units: UnitSystem | None) -> dict[str, Any]:
        """The settings in SI, as the case as TOML has them."""
        return {key: self._in_si(key, value, units) for key, value in self.settings.items()}

    def _in_si(self, key: str, value: Any, units: UnitSystem | None) -> Any:
        entry = _entry(field_at(self.model, key)[0])
        return value if entry is None else entry.canonical(entry.read(value, units))

    def _key_faults(self) -> Iterator[Complaint]:
        for key in self.settings:
            fault = field_at(self.model, key)[1]
            if fault:
                yield self._at(key), fault
        for index, key in enumerate(self.left):
            fault = self._left_fault(key)
            if fault:
                yield ("fidelity", self.name, "without", index), fault

    def _left_fault(self, key: str) -> str | None:
        field, fault = field_at(self.model, key)
        if fault or field is None:
            return fault or f"{as_shown_in_message(key)}: name the whole table, not one of its kind"
        if field.required:
            return f"{key} cannot be left out: every case needs it; set it instead"
        if any(each == key or each.startswith(f"{key}.") for each in self.settings):
            return f"{key} is left out and set at once: keep one of the two"
        return None

    def _at(self, key: str) -> KeyPath:
        """Path of the fidelity's own key in the case, written in quotes or as nested tables."""
        parts = (key,) if key in self.table["set"] else tuple(key_parts(key))
        return ("fidelity", self.name, "set", *parts)

    def _changed(self, tables: dict[str, Any], wrong: list[Complaint]) -> tuple[dict[str, Any], dict[KeyPath, KeyPath]]:
        """The case's tables with the changes, less what is no physics; and where each changed key was written."""
        shared = set(self.model.KEYS) - {*physics_keys(self.model), *SHARED}
        own = {key: value for key, value in tables.items() if key not in shared}
        own["fidelity"] = {self.name: {key: each for key, each in self.table.items() if key not in OWN}}
        for key in self.left:
            own = _less_carried(_less(own, key_parts(key)), key)
        places: dict[KeyPath, KeyPath] = {}
        for key, value in self.settings.items():
            try:
                own, path = override(own, key, value, literal=True)
                places[path] = self._at(key)
            except OverrideError as error:
                wrong.append((self._at(key), str(error)))
        return own, places

    def _placed(
        self, faults: list[Complaint], places: Mapping[KeyPath, KeyPath], reported: Mapping[KeyPath, str]
    ) -> Iterator[Complaint]:
        """Faults of the changed case at the place of the change, less those that the case itself has."""
        for path, message in faults:
            at = next((own for changed, own in places.items() if changed == path[: len(changed)]), None)
            if at is not None:
                yield at, message
            elif reported.get(path) != message and path[:1] != ("fidelity",):
                where = ".".join(map(str, path))
                yield ("fidelity", self.name), f"with what it changes, {where}: {message}"


def field_at(model: type[Table], key: str) -> tuple[Field | None, str | None]:
    """The declaration of a physics key (None: one of several tables), or what is wrong with it."""
    try:
        first, *rest = key_parts(key)
    except (ValueError, RecursionError):
        return None, f"{as_shown_in_message(key)} is not a key such as stop.gap"
    known = physics_keys(model)
    if first in model.KEYS and first not in known:
        return None, f"{first} is shared by all fidelities: a fidelity changes {', '.join(known)} alone"
    if first not in known:
        return None, f"unknown key {as_shown_in_message(key)}; {suggest_key(first, known)}"
    return _within(model.KEYS[first], rest, key)


def entry_at(model: type[Table], key: str) -> tuple[Entry | None, str | None]:
    """The entry of one value of a physics key, or of each of a list; None of a table; or what is wrong with the key."""
    field, fault = field_at(model, key)
    entry = _entry(field)
    return entry.each if isinstance(entry, Several | OneOrSeveral) else entry, fault


def _entry(field: Field | None) -> Entry | None:
    return None if field is None else field.entry


def _within(field: Field, rest: list[str], key: str) -> tuple[Field | None, str | None]:
    """As ``field_at``, from a table on."""
    table = field.table
    if rest and field.many and (rest[0].isdigit() or field.many is dict):
        rest = rest[1:]
        if not rest:
            return None, None
    if not rest:
        return field, None
    if table is None:
        return None, f"{as_shown_in_message(key)} goes beyond a value"
    if rest[0] not in table.KEYS:
        return None, f"unknown key {as_shown_in_message(key)}; {suggest_key(rest[0], table.KEYS)}"
    return _within(table.KEYS[rest[0]], rest[1:], key)


def _less(place: Any, parts: list[str]) -> Any:
    """A table less a key, where it has it; of tables of which there are several, each of them."""
    if isinstance(place, list):
        return [_less(each, parts) for each in place]
    first, *rest = parts
    if not isinstance(place, dict) or first not in place:
        return place
    if rest:
        return place | {first: _less(place[first], rest)}
    return {key: value for key, value in place.items() if key != first}


def _less_carried(tables: dict[str, Any], name: str) -> dict[str, Any]:
    """The tables less what is on a beam that is left out: its parts, entries of lists with ``on`` = its name."""
    left = {key: value for key, value in tables.items() if key not in parts_of(name)}
    lists = {key: value for key, value in left.items() if isinstance(value, list)}
    return left | {key: [each for each in value if not _is_on(each, name)] for key, value in lists.items()}


def _is_on(table: Any, name: str) -> bool:
    return isinstance(table, dict) and table.get("on") == name
