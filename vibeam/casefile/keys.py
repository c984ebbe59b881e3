"""Keys of a checked case: their values and units, and models of its fidelities at other values, without any text."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from vibeam.case.fidelity import Model
from vibeam.casefile.checks import rig_checks
from vibeam.casefile.fidelity_changes import field_at
from vibeam.casefile.fields import Count, Entry, OneOrSeveral, Quantity, Several
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.overrides import OverrideError, override
from vibeam.casefile.tables.sweep import fidelity_of
from vibeam.casefile.tables.table import content
from vibeam.casefile.toml import key_parts
from vibeam.casefile.uncertain import value_at
from vibeam.casefile.unit_systems import SI
from vibeam.casefile.validation import SHARED, complaints, entry_of, fields_of, physics_keys
from vibeam.casefile.validation import read as read_tables
from vibeam.exchange.faults import OVERRIDE, CaseError, Complaint, Fault

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.case.fidelity import Fidelity
    from vibeam_models.scene import AnyScene


@dataclass(frozen=True, eq=False)
class CaseKeys:
    """Keys of a case: ``declared`` its checked tables, ``changed`` those of fidelities that change the rig, SI.

    ``read`` makes a case of tables, a path for its files, and settings.
    """

    declared: Any
    changed: Mapping[str, Any]
    path: Path
    read: Callable[[dict[str, Any], Path, Mapping[str, Any]], Case]

    def __reduce__(self) -> tuple[Callable[..., CaseKeys], tuple[Any, ...]]:
        changed = {name: content(tables) for name, tables in self.changed.items()}
        return CaseKeys._of_content, (content(self.declared), changed, self.path, self.read)

    @classmethod
    def _of_content(cls, plain: dict[str, Any], changed: Mapping[str, Any], path: Path, read: Any) -> CaseKeys:
        return cls(read_tables(plain), {name: read_tables(each) for name, each in changed.items()}, path, read)

    def model(self, fidelity: str) -> KeyedModel:
        """Model of one fidelity."""
        own = self.changed.get(fidelity, self.declared)
        named = {fidelity: self.declared.fidelity[fidelity]}
        return KeyedModel(own.model_copy(update={"fidelity": named}), fidelity, self.path)

    def case(self, settings: Mapping[str, Any]) -> Case:
        """The case with keys at other values, SI where they have no unit; CaseError for what it may not have."""
        return self.read(content(self.declared), self.path, settings)

    def value(self, key: str) -> Any:
        """Value of a key of the case itself, SI; None where it has none."""
        return value_at(self.declared, key)

    def unit(self, key: str) -> str:
        """SI unit of a key that holds a number, empty of a plain one; ValueError where it holds none."""
        entry = self._entry(key)
        return entry.kind.unit if isinstance(entry, Quantity) else ""

    def number(self, key: str, given: str | float) -> float:
        """Number of a key, given with its unit or in SI; ValueError where it is none, or the key holds none."""
        entry = self._entry(key)
        return float(Quantity(entry.kind).parse(given) if isinstance(entry, Quantity) else given)

    def _entry(self, key: str) -> Entry:
        field, fault = field_at(type(self.declared), key)
        entry = None if field is None else entry_of(field)
        entry = entry.each if isinstance(entry, OneOrSeveral) else entry
        if fault or entry is None:
            raise ValueError(f"{key!r} is no key of the case that holds a number: vibeam keys lists them")
        return entry


@dataclass(frozen=True, eq=False)
class KeyedModel(Model):
    """Model of the fidelity ``name`` by the checked ``tables`` of its case; files are looked for beside ``path``.

    ``changes``: keys that ``at`` gave other values. It is sent elsewhere as plain data.
    """

    tables: Any
    name: str
    path: Path
    changes: frozenset[str] = frozenset()

    def __reduce__(self) -> tuple[Callable[..., KeyedModel], tuple[dict[str, Any], str, Path]]:
        kept = {*physics_keys(type(self.tables)), *SHARED} - {"measurement"}
        own = {key: each for key, each in content(self.tables).items() if key in kept}
        fidelity = {"fidelity": {self.name: content(self._table, without=("set",))}}
        return KeyedModel._of_content, (own | fidelity, self.name, self.path)

    @classmethod
    def _of_content(cls, plain: dict[str, Any], name: str, path: Path) -> KeyedModel:
        return cls(read_tables(plain), name, path)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, KeyedModel) and self.__reduce__() == other.__reduce__()

    def __hash__(self) -> int:
        return hash((self.path, self.name))

    @property
    def _table(self) -> Any:
        return self.tables.fidelity[self.name]

    def at(self, values: Mapping[str, float]) -> KeyedModel:
        """As ``Model.at``."""
        tables, left = self.tables, self._table.without or ()
        for key, value in values.items():
            if not any(key == each or key.startswith(f"{each}.") for each in left):
                tables = _with(tables, key, float(value))
        return replace(self, tables=tables, changes=self.changes | values.keys())

    def checked(self) -> KeyedModel:
        """As ``Model.checked``."""
        faults = [self._fault(each) for each in rig_checks(self.tables, self.path.parent)]
        if faults:
            raise CaseError(faults)
        return self

    def _fault(self, complaint: Complaint) -> Fault:
        key = ".".join(map(str, complaint[0]))
        return Fault(OVERRIDE if key in self.changes else str(self.path), None, key, complaint[1])

    def value(self, key: str) -> Any:
        """As ``Model.value``."""
        return value_at(self.tables, key)

    def scene(self) -> AnyScene:
        """As ``Model.scene``."""
        return KINDS[self.tables.kind].scene_of(self.tables, self.path.parent)

    @property
    def fidelity(self) -> Fidelity:
        """As ``Model.fidelity``."""
        return fidelity_of(self.name, self._table)

    @property
    def most_modes(self) -> int:
        """As ``Model.most_modes``."""
        return KINDS[self.tables.kind].most_modes_of(self.tables, self.path.parent)[0]


def _with(tables: Any, key: str, value: float) -> Any:
    """Tables with a key at another value; CaseError where that key by itself is wrong."""
    try:
        return _put(tables, key_parts(key), value)
    except LookupError:
        return _read_with(tables, key, value)
    except ValueError as fault:
        raise CaseError([Fault(OVERRIDE, None, key, str(fault))]) from None


def _put(table: Any, path: Sequence[str], value: float) -> Any:
    """A copy of a table with the number at a path changed; LookupError where it has none."""
    if not path:
        return value
    first, *rest = path
    if isinstance(table, Mapping):
        return {**table, first: _put(table[first], rest, value)}
    if isinstance(table, tuple):
        at = int(first) if first.isdigit() else len(table)
        return (*table[:at], _put(table[at], rest, value), *table[at + 1 :])
    field = fields_of(type(table))[first]
    name = first if field.alias is None else f"{first}_"
    entry, inner = entry_of(field), getattr(table, name)
    if rest and inner is None:
        raise LookupError(first)
    if rest:
        return table.model_copy(update={name: _put(inner, rest, value)})
    if entry is None:
        raise LookupError(first)
    given = int(value) if isinstance(entry, Count) and value.is_integer() else value
    alone = isinstance(entry, Several) and isinstance(inner, tuple) and len(inner) == 1
    return table.model_copy(update={name: entry.read([given] if alone else given, SI)})


def _read_with(tables: Any, key: str, value: float) -> Any:
    """Tables with a key that was not there, read anew; CaseError where they cannot be read with it."""
    plain = content(tables)
    try:
        override(plain, key, int(value) if value.is_integer() else value, literal=True)
        return type(tables).model_validate(plain, context=SI)
    except OverrideError as fault:
        raise CaseError([Fault(OVERRIDE, None, key, str(fault))]) from None
    except ValidationError as error:
        wrong = complaints(error, type(tables))[0]
        raise CaseError(Fault(OVERRIDE, None, ".".join(map(str, path)), said) for path, said in wrong) from None
