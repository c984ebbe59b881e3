"""Declaration of tables: a key, and the class of a table, whose instances are frozen records of what was read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from types import SimpleNamespace
from typing import Any, ClassVar, TypeVar

from vibeam.casefile.field_tables import TableOr
from vibeam.casefile.fields import Entry

AnyTable = TypeVar("AnyTable", bound="Table")


@dataclass(frozen=True)
class Later:
    """A table that is declared where a case first names it."""

    declare: Callable[[], Any]


@dataclass(frozen=True, eq=False)
class Field:
    """A key: its meaning, an example for the template, its default (``...``: required).

    ``kind``: the entry that reads its value, or the table that it holds, or ``many`` of them, by name or in a list.
    ``effect``: it declares an optional effect; ``of``: the effect in the same table without which it means nothing.
    ``physics``: part of the rig, which a fidelity may change; ``numbers``: part of what the sweeps compute; ``plain``:
    meaning and example where the case is nondimensional. ``attribute``: its name in what was read.
    """

    kind: Any
    meaning: str = ""
    example: Any = None
    default: Any = ...
    _: KW_ONLY
    many: type[dict[str, Any]] | type[tuple[Any, ...]] | None = None
    effect: bool = False
    of: str = ""
    plain: tuple[str, Any] | None = None
    physics: bool = True
    numbers: bool = True
    attribute: str = ""

    @property
    def required(self) -> bool:
        """Test whether a table must have it."""
        return self.default is ...

    @property
    def description(self) -> str:
        """Meaning as the reference of keys has it."""
        return f"effect: {self.meaning}" if self.effect and self.meaning else self.meaning

    @property
    def entry(self) -> Entry | None:
        """Entry that reads its value; None of a table."""
        return self.kind if isinstance(self.kind, Entry) else None

    @property
    def table(self) -> Any:
        """The table that it holds, one or several; None for a value."""
        if isinstance(self.kind, Entry):
            return self.kind.table if isinstance(self.kind, TableOr) else None
        return self.kind.declare() if isinstance(self.kind, Later) else self.kind

    @property
    def unread(self) -> Any:
        """Stand-in for what could not be read: None, for a table one that says nothing, for several none."""
        if self.entry:
            return None
        return self.table() if self.many is None else self.many()

    @property
    def absent(self) -> Any:
        """Value of the key where a table does not have it."""
        return self.unread if self.required else self.default


def key(kind: Any, meaning: str = "", example: Any = None, default: Any = ..., **notes: Any) -> Any:
    """A ``Field`` where a table declares it; in what was read it is a value."""
    return Field(kind, meaning, example, default, **notes)


class Table(SimpleNamespace):
    """Base class of all tables: ``KEYS`` has the declaration of each key by the name that a case calls it.

    A field ``from_`` is the key ``from``. Keys that are not given have their defaults, required ones None.
    """

    KEYS: ClassVar[Mapping[str, Field]] = {}

    def __init_subclass__(cls) -> None:
        if "KEYS" not in vars(cls):
            cls.KEYS = {**cls.KEYS, **_named(vars(cls))}

    def __init__(self, **values: Any) -> None:
        absent = {each.attribute: each.absent for each in self.KEYS.values() if each.attribute not in values}
        super().__init__(**absent, **values)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen")

    def with_(self: AnyTable, **values: Any) -> AnyTable:
        """The table with other values."""
        return type(self)(**vars(self) | values)


def table(name: str, meaning: str | None, *parts: type[Table] | Mapping[str, Field], **own: Any) -> type[Table]:
    """A table made of parts, tables or fields by key, whose keys stand in the order of the parts.

    ``own``: further attributes of the class.
    """
    keys: dict[str, Field] = {}
    for part in parts:
        keys |= part.KEYS if isinstance(part, type) else _named(part)
    bases = tuple(part for part in parts if isinstance(part, type)) or (Table,)
    return type(name, bases, {"__doc__": meaning, "KEYS": keys} | own)


def _named(said: Mapping[str, Any]) -> dict[str, Field]:
    """Fields by the names of their keys."""
    found = {name: each for name, each in said.items() if isinstance(each, Field)}
    return {name.rstrip("_"): replace(each, attribute=name) for name, each in found.items()}
