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


_OPTIONS: dict[str, Any] = {
    "json": typer.Option("--json", help="Print one JSON object in place of text."),
    "quiet": typer.Option("--quiet", "-q", help="Print the answer alone, and no progress."),
    "verbose": typer.Option("--verbose", "-v", help="Print all tables, columns and remarks."),
    "yes": typer.Option("--yes", help="Take 2 GiB of memory or more, which is refused without."),
}


def with_verbosity(command: Callable[..., None], tell: Callable[[str], None]) -> Callable[..., None]:
    """Command with the options ``--json``, ``-q``, ``-v``, ``--yes``; ``tell``: of what it takes of measured files."""
    own = inspect.signature(command, eval_str=True)
    name = command.__name__

    @wraps(command)
    def call(**given: Any) -> None:
        from vibeam.exchange.curves.record import taken_told
        from vibeam_models.memory import large_memory

        asked = {key: given.pop(key) for key in _OPTIONS}
        confirmed = large_memory() if asked.pop("yes") else nullcontext()
        token = _CURRENT.set(Verbosity(name, **asked))
        try:
            with confirmed, taken_told(tell):
                command(**given)
        finally:
            _CURRENT.reset(token)

    added = [parameter(key, Annotated[bool, each], False) for key, each in _OPTIONS.items()]
    return taking(call, [*own.parameters.values(), *added])


def parameter(name: str, annotation: Any, default: Any = None) -> inspect.Parameter:
    """Parameter of a command, an option by its annotation."""
    return inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=default, annotation=annotation)


def taking(command: Callable[..., None], parameters: list[inspect.Parameter]) -> Callable[..., None]:
    """The command, of which typer reads that it has these parameters."""
    command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    command.__annotations__ = {each.name: each.annotation for each in parameters}
    return command
