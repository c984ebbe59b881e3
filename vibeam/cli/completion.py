"""Completion of words on the command line: case files, their fidelities, keys, rigs, examples."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import typer


def case_files(incomplete: str) -> Iterator[str]:
    """Case files, and folders on the way to them."""
    folder = Path(incomplete[: incomplete.rfind("/") + 1])
    for path in sorted((folder or Path()).iterdir()) if folder.is_dir() else ():
        if path.suffix == ".toml" or (path.is_dir() and not path.name.startswith(".")):
            yield f"{path}/" if path.is_dir() else str(path)


def fidelities(context: typer.Context) -> Iterator[str]:
    """Fidelities of the cases that the command line names."""
    named = [each for each in (context.params.get("case"), *(context.params.get("cases") or ())) if each]
    for case in named:
        with suppress(OSError, ValueError, LookupError, TypeError):
            yield from tomllib.loads(Path(case).read_text(encoding="utf-8"))["fidelity"]


def keys(incomplete: str) -> Iterator[str]:
    """Tables of a case, and the keys of the one that is begun."""
    from vibeam.casefile.documentation import paths

    begun = "." in incomplete
    yield from (path for path in paths() if ("." in path) is begun)


def settings(incomplete: str) -> Iterator[str]:
    """As ``keys``, of tables without a name, with what follows."""
    from vibeam.casefile.documentation import NAMED

    single = (path for path in keys(incomplete) if path.partition(".")[0] not in NAMED)
    yield from (f"{path}=" if "." in path else f"{path}." for path in single)


def rigs() -> Iterator[tuple[str, str]]:
    """Rigs of ``vibeam new``, each with its meaning."""
    from vibeam.casefile.rigs import RIGS

    yield from ((name, rig.meaning) for name, rig in RIGS.items())


def examples() -> Iterator[tuple[str, str]]:
    """Examples of ``vibeam new``, each with its meaning."""
    from vibeam.casefile.examples import meanings

    yield from meanings().items()
