"""Declaration of tables: a key, and the class of a table, whose instances are frozen records of what was read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from inspect import get_annotations
from types import SimpleNamespace
from typing import Any, ClassVar, TypeVar, get_args, get_origin

from vibeam.casefile.field_tables import TableOr
from vibeam.casefile.fields import Entry

AnyTable = TypeVar("AnyTable", bound="Table")
Plain = tuple[str, Any]  # meaning and example of a key where the case is nondimensional


@dataclass(frozen=True)
class Later:
    """A table, in an annotation, that is declared where a case first names it."""

    declare: Callable[[], Any]


@dataclass(frozen=True, eq=False)
class Field:
    """A key of a table: meaning, example for the template, default (``...``: required), and notes as ``key`` has them.

    ``entry`` reads its value; without one it is the table ``held``, or ``many`` of them, by name or in a list.
    ``attribute``: its name in what was read.
    """

    meaning: str = ""
    example: Any = None
    default: Any = ...
    effect: bool = False
    of: str = ""
    plain: Plain | None = None
    physics: bool = True
    numbers: bool = True
    attribute: str = ""
    entry: Entry | None = None
    held: Any = None
    many: Any = None

    def of_kind(self, attribute: str, annotation: Any) -> Field:
        """The field by its annotation, as in ``dict[str, Table] | None`` or ``Annotated[float, Entry]``."""
        parts = list(_parts(annotation))
        if entry := next((part for part in parts if isinstance(part, Entry)), None):
            return replace(self, attribute=attribute, entry=entry)
        held = next(part for part in parts if isinstance(part, Later) or _is_table(part))
        origins: list[Any] = [get_origin(part) for part in parts]
        many = next((kind for kind in origins if kind in (dict, tuple)), None)
        return replace(self, attribute=attribute, held=held, many=many)

    @property
    def required(self) -> bool:
        """Test whether a table must have it."""
        return self.default is ...

    @property
    def description(self) -> str:
        """Meaning as the reference of keys has it."""
        return f"effect: {self.meaning}" if self.effect and self.meaning else self.meaning

    @property
    def table(self) -> Any:
        """The table that it holds, one or several; None for a value."""
        found = self.entry.table if isinstance(self.entry, TableOr) else self.held
        return found.declare() if isinstance(found, Later) else found

    @property
    def unread(self) -> Any:
        """Stand-in for what could not be read: None, for a table one that says nothing, for several none."""
        if self.entry is not None:
            return None
        return self.table() if self.many is None else self.many()

    @property
    def absent(self) -> Any:
        """Value of the key where a table does not have it."""
        return self.unread if self.required else self.default


def _parts(annotation: Any) -> Iterator[Any]:
    yield annotation
    for inner in get_args(annotation):
        yield from _parts(inner)


def _is_table(part: Any) -> bool:
    return isinstance(part, type) and issubclass(part, Table)


class Table(SimpleNamespace):
    """Base class of all tables: ``KEYS`` has the declaration of each key by the name that a case calls it.

    A field ``from_`` is the key ``from``. Keys that are not given have their defaults, required ones None.
    """

    KEYS: ClassVar[Mapping[str, Field]] = {}

    def __init_subclass__(cls) -> None:
        if "KEYS" not in vars(cls):
            said = {name: each for name, each in vars(cls).items() if isinstance(each, Field)}
            known = get_annotations(cls, eval_str=True, locals={}) if said else {}
            cls.KEYS = {**cls.KEYS} | {name.rstrip("_"): each.of_kind(name, known[name]) for name, each in said.items()}

    def __init__(self, **values: Any) -> None:
        absent = {each.attribute: each.absent for each in self.KEYS.values() if each.attribute not in values}
        super().__init__(**absent, **values)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen")

    def with_(self: AnyTable, **values: Any) -> AnyTable:
        """The table with other values."""
        return type(self)(**vars(self) | values)


def table(name: str, meaning: str, *parts: type[Table] | Mapping[str, tuple[Any, Any]], **own: Any) -> Any:
    """A table made of parts, whose keys stand in the order of the parts: tables, or {key: (annotation, ``key``)}.

    ``own``: further attributes of the class.
    """
    keys: dict[str, Field] = {}
    for part in parts:
        keys |= part.KEYS if isinstance(part, type) else {each: _field(each, *said) for each, said in part.items()}
    bases = tuple(part for part in parts if isinstance(part, type)) or (Table,)
    return type(name, bases, {"__doc__": meaning, "KEYS": keys} | own)


def _field(name: str, annotation: Any, said: Any) -> Field:
    return (Field() if said is ... else said).of_kind(name, annotation)
