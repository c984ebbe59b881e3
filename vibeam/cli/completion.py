"""Completion of values by the shell: words of an option, keys of a case, names in the case that a command has.

A completion gives all that there is; typer keeps what begins as the incomplete word does.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable
from pathlib import Path

from typer import Context

from vibeam_models.registry import loaded

Completion = Callable[..., list[str]]


def words(known: str | Iterable[str]) -> Completion:
    """Completion by words, or by those at ``"module:NAME"``, which is imported when the shell asks."""
    return lambda: list(loaded(known))


def names(table: str) -> Completion:
    """Completion by the names in a ``table`` of the case before the option; by none where it cannot be read."""

    def found(ctx: Context) -> list[str]:
        case = next((each for each in map(str, (*ctx.params.values(), *ctx.args)) if each.endswith(".toml")), "")
        try:
            named = tomllib.loads(Path(case).read_text(encoding="utf-8")).get(table)
        except (OSError, ValueError):
            return []
        return list(named) if isinstance(named, dict) else []

    return found


def keys() -> list[str]:
    """Dotted names of keys of a case."""
    from vibeam.casefile.documentation import lines_of, reference_table

    return [line.key for line in lines_of(reference_table())]


#: by the name of an option, or by what its value is called in help
COMPLETED: dict[str, Completion] = {
    "--set": lambda: [f"{key}=" for key in keys()],
    "--key": keys,
    "--over": keys,
    "--fidelity": names("fidelity"),
    "--measured": names("measured"),
    "--picture": words("vibeam.case.grid_keys:PICTURES"),
    "--quantity": words("vibeam.case.grid_keys:READ"),
    "EXAMPLE": words("vibeam.casefile.examples:PLACES"),
}
