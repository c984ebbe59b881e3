"""Public names of a package, listed once in its stub and loaded when first used; those that a room below calls."""

from __future__ import annotations

from importlib import import_module

TYPE_CHECKING = False  # typing itself is not loaded before the command's first line
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

_HANDED_IN: dict[str, Callable[[], Any]] = {}


def homes_of(package_file: str) -> dict[str, str]:
    """The module of each name of ``from module import name as name`` in the stub beside a package's ``__init__.py``."""
    with open(package_file + "i", encoding="utf-8") as stub:
        words = [line.split() for line in stub if line.startswith("from ")]
    return {line[3]: line[1] for line in words}


def from_home(homes: dict[str, str], package: str, name: str) -> object:
    """The object that ``name`` stands for in ``package``; AttributeError where it has no such name."""
    if name not in homes:
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    if homes[name] == package:
        return import_module(f"{package}.{name}")
    return getattr(import_module(homes[name]), name)


def hand_in(name: str, load: Callable[[], Any]) -> None:
    """Give the rooms below a public function of a room above, which they know by ``name``; ``load`` fetches it."""
    _HANDED_IN[name] = load


def handed_in(name: str) -> Any:
    """The public function ``name`` that the package has handed in."""
    return _HANDED_IN[name]()
