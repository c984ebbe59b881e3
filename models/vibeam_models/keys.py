"""Declaration of a key of the case file, as plain data beside the dataclass field that it fills."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, field, fields
from typing import Any


@dataclass(frozen=True)
class Key:
    """One key: its SI ``unit`` (empty: a number, ``words``, ``flag`` or ``text``), bounds, meaning, example as written.

    ``whole``: a whole number, from ``least`` to ``most``. ``several``: a list, ``alone``: or one of it; ``ascending``:
    each number above the one before. ``missing``: what the message of a missing key says of it, its ``meaning`` where
    empty.
    ``effect``: it is an effect by itself; ``of``: the key of the same table without which it means nothing.
    ``plain``: (meaning, empty: the same, example, ``missing``) where the case is nondimensional; None: the same without
    the unit. ``numbers``: part of what the sweeps compute.
    """

    meaning: str
    example: Any
    unit: str = ""
    words: tuple[str, ...] = ()
    flag: bool = False
    text: bool = False
    whole: bool = False
    above: float | None = None
    least: float | None = None
    most: float | None = None
    several: bool = False
    alone: bool = False
    ascending: bool = False
    missing: str = ""
    effect: bool = False
    of: str = ""
    plain: tuple[str, Any, str] | None = None
    numbers: bool = True


def quantity(unit: str, meaning: str, example: Any, default: Any = MISSING, **more: Any) -> Any:
    """A dataclass field that holds a number in ``unit``, or a list of them; ``more`` as in ``Key``."""
    return declared(Key(meaning, example, unit, **more), default)


def word(words: tuple[str, ...], meaning: str, example: Any, default: Any = MISSING, **more: Any) -> Any:
    """A dataclass field that holds one of ``words``, or a list of them; ``more`` as in ``Key``."""
    return declared(Key(meaning, example, words=words, **more), default)


def count(least: int, most: int, meaning: str, example: Any, default: Any = MISSING, **more: Any) -> Any:
    """A dataclass field that holds a whole number, or a list of them; ``more`` as in ``Key``."""
    return declared(Key(meaning, example, least=least, most=most, whole=True, **more), default)


def text(meaning: str, example: Any, default: Any = MISSING, **more: Any) -> Any:
    """A dataclass field that holds text; ``more`` as in ``Key``."""
    return declared(Key(meaning, example, text=True, **more), default)


def flag(meaning: str, example: bool, default: Any = MISSING, **more: Any) -> Any:
    """A dataclass field that is true or false; ``more`` as in ``Key``."""
    return declared(Key(meaning, example, flag=True, **more), default)


def declared(key: Key, default: Any = MISSING) -> Any:
    """A dataclass field with its key; without ``default`` every case must write it."""
    if isinstance(default, dict):
        return field(default_factory=default.copy, metadata={"key": key})
    return field(default=default, metadata={"key": key})


def keys_of(kind: type[Any]) -> dict[str, Key]:
    """The keys of a declaration by name, in their order; a field ``from_`` is the key ``from``."""
    return {each.name.rstrip("_"): each.metadata["key"] for each in fields(kind) if "key" in each.metadata}


def defaults_of(kind: type[Any]) -> dict[str, Any]:
    """The defaults of those keys that may be absent."""
    made = {one.name.rstrip("_"): one.default_factory() for one in fields(kind) if one.default_factory is not MISSING}
    return made | {one.name.rstrip("_"): one.default for one in fields(kind) if one.default is not MISSING}
