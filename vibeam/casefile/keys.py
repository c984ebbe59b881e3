"""Keys of a checked case: their values and units, and models of its fidelities at other values, without any text."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from vibeam.case.case import Case
from vibeam.case.fidelity import Fidelity, Model
from vibeam.casefile.fidelity_changes import entry_at
from vibeam.casefile.fields import Count, Quantity
from vibeam.casefile.kinds import KINDS
from vibeam.casefile.number_keys import value_at
from vibeam.casefile.overrides import with_value
from vibeam.casefile.quantities import RATIO, Dimension
from vibeam.casefile.records import record_checks
from vibeam.casefile.scenes import fidelity_scene
from vibeam.casefile.tables.drive import harmonic_checks
from vibeam.casefile.tables.stop import stop_checks
from vibeam.casefile.tables.sweep import fidelity_of, model_named, plan_checks
from vibeam.casefile.tables.table import content
from vibeam.casefile.validation import read as read_tables
from vibeam.exchange.faults import OVERRIDE, CaseError, Complaint, Fault
from vibeam_models.scene import AnyScene


def rig_checks(case: Any, folder: Path) -> Iterator[Complaint]:
    """Every complaint about keys of the rig and its sweep that do not go together; ``case``: as read, or declared."""
    yield from KINDS[case.kind].checks(case, folder)
    yield from stop_checks(case)
    yield from harmonic_checks(case)
    yield from record_checks(case, folder)
    yield from plan_checks(case, folder)


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
        own = {name: read_tables(each)[0] for name, each in changed.items()}
        return cls(read_tables(plain)[0], own, path, read)

    def model(self, fidelity: str) -> KeyedModel:
        """Model of one fidelity."""
        return model_of(self.declared, self.changed, self.path, fidelity)

    def case(self, settings: Mapping[str, Any]) -> Case:
        """The case with keys at other values, SI where they have no unit; CaseError for what it may not have."""
        return self.read(content(self.declared), self.path, settings)

    def alone(self, fidelity: str) -> Case:
        """The case with one fidelity and nothing that is asked of it."""
        said = {"title": self.declared.title, "source": self.declared.source}
        return self.read(said | _plain(self.model(fidelity).tables, fidelity), self.path, {})

    def value(self, key: str) -> Any:
        """Value of a key of the case itself, SI; None where it has none."""
        return value_at(self.declared, key)

    def unit(self, key: str) -> str:
        """SI unit of a key that holds a number, empty of a plain one; ValueError where it holds none."""
        return self._kind(key).unit

    def number(self, key: str, given: str | float) -> float:
        """Number of a key, given with its unit or in SI; ValueError where it is none, or the key holds none."""
        return float(Quantity(self._kind(key)).parse(given))

    def _kind(self, key: str) -> Dimension:
        entry, fault = entry_at(type(self.declared), key)
        if fault or not isinstance(entry, Quantity | Count):
            raise ValueError(f"{key!r} is no key of the case that holds a number: vibeam keys lists them")
        return entry.kind if isinstance(entry, Quantity) else RATIO


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
        return KeyedModel._of_content, (_plain(self.tables, self.name), self.name, self.path)

    @classmethod
    def _of_content(cls, plain: dict[str, Any], name: str, path: Path) -> KeyedModel:
        return cls(read_tables(plain)[0], name, path)

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
                tables = with_value(tables, key, float(value))
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
        return fidelity_scene(self.tables, self.path.parent, self.name)

    @property
    def fidelity(self) -> Fidelity:
        """As ``Model.fidelity``."""
        return fidelity_of(self.name, self._table)

    @property
    def most_modes(self) -> int:
        """As ``Model.most_modes``."""
        return (
            0 if model_named(self._table) else KINDS[self.tables.kind].most_modes_of(self.tables, self.path.parent)[0]
        )


def _plain(tables: Any, fidelity: str) -> dict[str, Any]:
    """Plain data of a fidelity's tables that decide its numbers; what it sets, its rig has."""
    own = tables.fidelity[fidelity].with_(set=None)
    return {"units": "SI"} | content(tables.with_(fidelity={fidelity: own}), "numbers")


def model_of(declared: Any, changed: Mapping[str, Any], path: Path, fidelity: str) -> KeyedModel:
    """Model of a fidelity of a ``declared`` case, of which others than it are ``changed``."""
    own = changed.get(fidelity, declared)
    return KeyedModel(own.with_(fidelity={fidelity: declared.fidelity[fidelity]}), fidelity, path)
