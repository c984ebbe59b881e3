"""Sources of a case: itself, its file or its tables, wherever a function takes a case."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from os import PathLike
from typing import Any, Concatenate, ParamSpec, TypeVar

from vibeam.system.public_names import handed_in

P = ParamSpec("P")
Given = TypeVar("Given")
Made = TypeVar("Made")
Source = str | PathLike[str] | dict[str, Any]


def of_source(function: Callable[Concatenate[Given, P], Made]) -> Callable[Concatenate[Given | Source, P], Made]:
    """The function of a case, which loads its first argument where that is a file or tables: see ``vibeam.load``."""

    @wraps(function)
    def loading(case: Given | Source, *given: P.args, **named: P.kwargs) -> Made:
        found: Any = handed_in("load")(case) if isinstance(case, str | PathLike | dict) else case
        return function(found, *given, **named)

    return loading  # type: ignore[return-value]  # the case may be given by its name, too
