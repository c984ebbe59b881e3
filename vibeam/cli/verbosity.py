"""Form of a command's answer, which every command takes as options: JSON, the answer alone, or all that is known."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from contextlib import nullcontext
from contextvars import ContextVar
from dataclasses import dataclass
from functools import wraps
from typing import Annotated, Any

import typer

from vibeam_models.memory import large_memory


@dataclass(frozen=True)
class Verbosity:
    """Form of the answer of ``command``: as ``json``; ``quiet``: its first sentence; ``verbose``: all tables."""

    command: str = ""
    json: bool = False
    quiet: bool = False
    verbose: bool = False


_USUAL = Verbosity()
_CURRENT: ContextVar[Verbosity] = ContextVar("verbosity", default=_USUAL)


def verbosity() -> Verbosity:
    """Form that the running command was asked for."""
    return _CURRENT.get()


_OPTIONS = {
    "json": ("--json", "Print one JSON object in place of text."),
    "quiet": ("--quiet,-q", "Print the answer alone, and no progress."),
    "verbose": ("--verbose,-v", "Print all tables, columns and remarks."),
    "yes": ("--yes", "Take 2 GiB of memory or more, which is refused without."),
}


def with_verbosity(command: Callable[..., None]) -> Callable[..., None]:
    """Command with the options ``--json``, ``-q``, ``-v`` and ``--yes`` behind its own."""
    own = inspect.signature(command, eval_str=True)
    name = command.__name__

    @wraps(command)
    def call(**given: Any) -> None:
        asked = {key: given.pop(key) for key in _OPTIONS}
        confirmed = large_memory() if asked.pop("yes") else nullcontext()
        token = _CURRENT.set(Verbosity(name, **asked))
        try:
            with confirmed:
                command(**given)
        finally:
            _CURRENT.reset(token)

    added = [
        inspect.Parameter(
            key,
            inspect.Parameter.KEYWORD_ONLY,
            default=False,
            annotation=Annotated[bool, typer.Option(*names.split(","), help=said)],
        )
        for key, (names, said) in _OPTIONS.items()
    ]
    call.__signature__ = own.replace(parameters=[*own.parameters.values(), *added])  # type: ignore[attr-defined]
    call.__annotations__ = {each.name: each.annotation for each in call.__signature__.parameters.values()}  # type: ignore[attr-defined]
    return call
