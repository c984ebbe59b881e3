"""Functions of a case that take the case's file, or its tables, as well."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from os import PathLike


def loading(function: Callable[..., object], home: str) -> Callable[..., object]:
    """The function, known by its name in the package ``home``, with its first argument loaded where it is no case."""

    @wraps(function)
    def of_file(*given: object, **named: object) -> object:
        if given and isinstance(given[0], str | PathLike | dict):
            from vibeam.casefile.read import load

            given = load(given[0]), *given[1:]
        return function(*given, **named)

    of_file.__module__, of_file.__qualname__ = home, function.__name__
    return of_file
