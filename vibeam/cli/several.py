"""Answers on several cases of one call: all faults first, then one case after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from vibeam.cli.errors import UsageError, fault_of
from vibeam.cli.output import as_object, print_json, print_sheet, put_lines
from vibeam.cli.streams import WRONG, say
from vibeam.cli.verbosity import verbosity

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.report.output import StudySheet


def require_folder(option: str, named: str | None, endings: Sequence[str]) -> None:
    """UsageError where an option of a call with several cases names a file."""
    if named is not None and Path(named).suffix in endings and not Path(named).is_dir():
        raise UsageError(f"{option} {named}: names a folder where there are several cases")


def answers(
    name: str, paths: Sequence[Path], prepare: Callable[[Path], Case],
    answer: Callable[[Case], tuple[StudySheet, list[Path]]], whole: bool = False,
) -> dict[Path, dict[str, Any]]:  # fmt: skip
    """Objects of the answers on cases, in JSON under ``name``; each ``whole``, or a line of it when all are there.

    Exit code 2 where there is none on one of them.
    """
    cases: dict[Path, Case] = {}
    found: dict[Path, dict[str, Any]] = {}
    for path in paths:
        with _noting(found, path):
            cases[path] = prepare(path)
    for path, case in cases.items():
        if not verbosity().quiet:
            say(f"{path}:")
        with _noting(found, path):
            sheet, files = answer(case)
            found[path] = as_object(sheet, files)
            if whole and not verbosity().json:
                print_sheet(replace(sheet, answer=f"{path}: {sheet.answer}"), files)
    if verbosity().json:
        print_json({name: [{"case": path, **found[path]} for path in paths]})
    else:
        put_lines(f"{path}: {_line(path, found[path])}" for path in paths if not whole or "error" in found[path])
    if any("error" in each for each in found.values()):
        raise typer.Exit(WRONG)
    return found


@contextmanager
def _noting(found: dict[Path, dict[str, Any]], path: Path) -> Iterator[None]:
    """Context that tells a user's mistake on stderr and keeps it as what was ``found``, in place of ending all."""
    try:
        yield
    except Exception as error:
        fault = fault_of(error)
        if fault is None:
            raise
        said = fault[0] if str(path) in fault[0] else f"{path}: {fault[0]}"
        say(said)
        found[path] = {"error": said, "faults": getattr(error, "faults", ())}


def _line(path: Path, found: Mapping[str, Any]) -> str:
    """Answer of one case of several, or why there is none."""
    if "error" not in found:
        return str(found["answer"])
    first, _, rest = found["error"].removeprefix(f"{path}: ").partition("\n")
    return f"no answer: {first}" + f" (and {rest.count(chr(10)) + 1} more)" * bool(rest)
