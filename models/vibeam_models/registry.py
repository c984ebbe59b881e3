"""A registry: declarations by name, the package's own first, and those that a program adds to them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol, TypeVar


class Named(Protocol):
    """A declaration: it knows its name."""

    @property
    def name(self) -> str:
        """By which it is asked for."""
        ...


Declared = TypeVar("Declared", bound=Named)


class Registry(Mapping[str, Declared]):
    """Declarations of one kind ("solver", "reduction"), by name; a live view for all who read it."""

    def __init__(self, kind: str, *own: Declared) -> None:
        self.kind = kind
        self._own = {declaration.name: declaration for declaration in own}
        self._added: dict[str, Declared] = {}

    def add(self, declaration: Declared) -> None:
        """Take a further declaration; ValueError where its name is taken."""
        if declaration.name in self:
            raise ValueError(f"{self.kind} {declaration.name!r} is declared already: choose another name")
        self._added[declaration.name] = declaration

    def remove(self, name: str) -> None:
        """Forget what was added; KeyError for a name that was not."""
        del self._added[name]

    def __getitem__(self, name: str) -> Declared:
        return self._own[name] if name in self._own else self._added[name]

    @property
    def extended(self) -> bool:
        """True where a program has added to it."""
        return bool(self._added)

    def __iter__(self) -> Iterator[str]:
        yield from self._own
        yield from self._added

    def __len__(self) -> int:
        return len(self._own) + len(self._added)
