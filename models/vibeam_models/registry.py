"""Registry: declarations by name, each imported where it is first asked for, so that an absent one costs nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from types import TracebackType
from typing import Any, Protocol, TypeVar

from vibeam_models.extensions import OWN, ExtensionError, brought
from vibeam_models.keys import Key


class Named(Protocol):
    """A declaration: it knows its name."""

    @property
    def name(self) -> str:
        """By which it is asked for."""


Declared = TypeVar("Declared", bound=Named)


class Registry(Mapping[str, Declared]):
    """Declarations of one kind ("solver", "reduction"): own ones by name, those of extensions, those a program adds.

    A live view for all who read it. Extensions are looked for where a name is asked for that is not the package's own.
    """

    def __init__(self, kind: str, *own: Declared) -> None:
        self.kind = kind
        self.own = {declaration.name: declaration for declaration in own}
        self._brought: dict[str, Declared] | None = None
        self._foreign = False
        self._added: dict[str, Declared] = {}

    @property
    def brought(self) -> dict[str, Declared]:
        """Declarations of extensions; ExtensionError where two have the same name."""
        if self._brought is None:
            found: dict[str, Declared] = {}
            for point, each in brought(self.kind):
                if each.name in found or each.name in self.own:
                    said = f"extension {point.name!r} of the package {point.package!r}: {self.kind} {each.name!r}"
                    raise ExtensionError(f"{said} is declared already: uninstall one of the two packages")
                found[each.name] = each
                self._foreign |= point.package != OWN
            self._brought = found
        return self._brought

    def add(self, declaration: Declared) -> None:
        """Take a further declaration; ValueError where its name is taken."""
        if declaration.name in self:
            raise ValueError(f"{self.kind} {declaration.name!r} is declared already: choose another name")
        self._added[declaration.name] = declaration

    def remove(self, name: str) -> None:
        """Forget what was added; KeyError for a name that was not."""
        del self._added[name]

    def __getitem__(self, name: str) -> Declared:
        if name in self.own:
            return self.own[name]
        return self.brought[name] if name in self.brought else self._added[name]

    @property
    def extended(self) -> bool:
        """True where a program, or the extension of another package, has added to it."""
        return bool(self.brought and self._foreign) or bool(self._added)

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys([*self.own, *self.brought, *self._added]))

    def __len__(self) -> int:
        return len(list(iter(self)))


@dataclass(frozen=True)
class Home:
    """By which ``name`` a case file has a declaration, and where it is: ``"module:Class"``, or the class.

    What must be known without importing it stands here: ``repeated``, its table is a list of tables; ``on``:
    ``"beam"``, or ``"base"`` for what the beam stands on; ``key``: its declaration where it is one key of a table;
    ``part_of``: table that it goes with, and is left out with.
    """

    name: str
    place: str | type[Any]
    repeated: bool = False
    on: str = "beam"
    key: Key | None = None
    part_of: str = ""

    def load(self) -> Any:
        """The declaration."""
        return loaded(self.place)


def loaded(place: Any) -> Any:
    """The object itself, or that which ``"module:name"``, or ``"module"`` alone, says."""
    if not isinstance(place, str):
        return place
    module, _, name = place.partition(":")
    return getattr(import_module(module), name) if name else import_module(module)


class Registration:
    """An entry added to a registry, which can be taken out again, at the latest where a ``with`` block ends."""

    def __init__(self, registry: Registry[Home], home: Home) -> None:
        self.registry, self.name = registry, home.name
        registry.add(home)

    def remove(self) -> None:
        """Take the entry out; nothing happens where it is out already."""
        if self.name in self.registry:
            self.registry.remove(self.name)

    def __enter__(self) -> Registration:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.remove()
