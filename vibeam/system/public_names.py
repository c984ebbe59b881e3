"""Public names of a package, listed once in its stub and loaded when first used; those that a room below calls."""

from __future__ import annotations

import sys
from importlib import import_module
from os.path import exists

TYPE_CHECKING = False  # typing itself is not loaded before the command's first line
if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import ModuleType
    from typing import Any
else:
    ModuleType = type(sys)

_HANDED_IN: dict[str, str] = {}


class Namespace(ModuleType):
    """Package with public names, which stand before modules of the same names; ``dir()`` shows them alone."""

    _homes: dict[str, str]

    def __getattr__(self, name: str) -> object:
        if name not in self._homes:
            from vibeam_models.extensions import no_such_name

            raise AttributeError(no_such_name(self.__name__, name, self._homes))
        home = self._homes[name]
        found = import_module(f"{home}.{name}") if home == self.__name__ else getattr(import_module(home), name)
        return self.__dict__.setdefault(name, found)

    def __setattr__(self, name: str, value: object) -> None:
        if not isinstance(value, ModuleType) or self._homes.get(name, self.__name__) == self.__name__:
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted(self.__dict__["__all__"])


def namespace(package: str, file: str, *more: str) -> None:
    """Make a package, in its ``__init__.py``, the namespace of the names in the stub beside it, and of ``more``."""
    module, homes = sys.modules[package], homes_of(file)
    module.__dict__.update(_homes=homes, __all__=sorted((*homes, *more)))
    module.__class__ = Namespace


def homes_of(package_file: str) -> dict[str, str]:
    """The module of each name of ``from module import name as name`` in the stub beside a package's ``__init__.py``.

    Of ``from package.room import *`` these are the names in the stub of that room.
    """
    with open(package_file + "i", encoding="utf-8") as stub:
        words = [line.split() for line in stub if line.startswith("from ")]
    found = {line[3]: line[1] for line in words if line[3] != "*"}
    names = (line[1].rpartition(".")[2] for line in words if line[3] == "*")
    for room in filter(exists, (f"{package_file.removesuffix('__init__.py')}{name}/__init__.py" for name in names)):
        found |= homes_of(room)  # extensions need not be there
    return found


def hand_in(places: Mapping[str, str]) -> None:
    """Give the rooms below functions of rooms above, which they know by name: the ``"module:name"`` of each."""
    _HANDED_IN.update(places)


def handed_in(name: str) -> Any:
    """The function ``name`` that the package has handed in."""
    module, _, function = _HANDED_IN[name].partition(":")
    return getattr(import_module(module), function)
