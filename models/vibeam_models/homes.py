"""Entries of a registry, imported where they are first asked for, so that an absent one costs nothing."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from types import TracebackType
from typing import Any

from vibeam_models.keys import Key
from vibeam_models.registry import Registry


@dataclass(frozen=True)
class Home:
    """By which ``name`` a case file has a declaration, and where it is: ``"module:Class"``, or the class.

    What must be known without importing it stands here: ``repeated``, its table is a list of tables; ``on``:
    ``"beam"``, or ``"base"`` for what the beam stands on; ``key``: its declaration where it is one key of a table.
    """

    name: str
    place: str | type[Any]
    repeated: bool = False
    on: str = "beam"
    key: Key | None = None

    def load(self) -> Any:
        """The declaration."""
        return loaded(self.place)


def loaded(place: Any) -> Any:
    """The object itself, or that which ``"module:name"`` says."""
    if not isinstance(place, str):
        return place
    module, name = place.split(":")
    return getattr(import_module(module), name)


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
