"""Arguments common to several commands, and their conversion to a case and to output paths."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from os import sep
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibeam.cli.completion import COMPLETED
from vibeam.cli.errors import UsageError
from vibeam.exchange.whole_files import beside

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.casefile.quantities import Dimension


RESULTS = (".h5", ".hdf5")


def option(said: str, *names: str, **more: Any) -> Any:
    """Option of a command; what it is without it stands in what is ``said``."""
    completion = next((COMPLETED[each] for each in (*names, more.get("metavar")) if each in COMPLETED), None)
    return typer.Option(*names, help=said, show_default=False, autocompletion=completion, **more)


def out_option(said: str) -> Any:
    """Option ``--out`` of a command."""
    return option(said, "--out", "-o", metavar="FILE")


def argument(said: str, metavar: str, **more: Any) -> Any:
    """Argument of a command."""
    return typer.Argument(metavar=metavar, help=said, show_default=False, **more)


CaseFile = Annotated[Path, argument("The case file (TOML).", "CASE")]
CaseFiles = Annotated[list[Path], argument("The case file (TOML), or several.", "CASE...")]

_SAID = "A key of the case, in place of the file's. Repeatable."
Overrides = Annotated[list[str] | None, option(_SAID, "--set", "-s", metavar="KEY=VALUE")]

_FILE = "The results file (.h5), or its folder; new folders are made; absent = the current folder (check: none)."
ResultsFile = Annotated[str | None, out_option(_FILE)]

_ONE = "This one alone. Repeatable; absent = all."
Fidelities = Annotated[list[str] | None, option(_ONE, "--fidelity", metavar="NAME")]

Fresh = Annotated[bool, typer.Option("--fresh", help="Keep nothing of the results file that is there: start over.")]

_TABLE = "The table (.csv), with figures beside it, or of a study its page (.html); or a folder; new ones are made."
TableFile = Annotated[str | None, out_option(_TABLE)]


def number(option: str, text: str, kind: Dimension, positive: bool = False) -> float:
    """Value of an option in SI units; UsageError where it is none, or not above 0 where it must be."""
    from vibeam.casefile.quantities import UnitError, to_si

    try:
        value = to_si(text, kind)
    except UnitError as error:
        raise UsageError(f"{option}: {error}") from None
    if positive and not (isfinite(value) and value > 0):
        raise UsageError(f"{option}: {text} must be above 0")
    return value


def load(path: Path, settings: list[str] | None) -> Case:
    """Load the case of a file, with the ``--set`` keys in place of its own."""
    from vibeam.casefile.read import load as read

    parts = [text.partition("=") for text in settings or []]
    wrong = ["".join(part) for part in parts if not (part[1] and part[0].strip())]
    if wrong:
        raise UsageError("\n".join(f"--set {text}: write --set KEY=VALUE, stop.restitution=0.7 say" for text in wrong))
    return read(path, {key.strip(): value.strip() for key, _, value in parts})


def of_fidelities(case: Case, names: Sequence[str] | None) -> Case:
    """The case with these of its fidelities alone, with all where none is named."""
    from vibeam.runs.run_plan import restricted

    try:
        return restricted(case, names or ())
    except ValueError as unknown:
        raise UsageError(f"--fidelity {unknown}") from None


def results_path(case: Case, out: str | None) -> Path:
    """``out`` itself, or the case's name in the folder ``out``."""
    return output_path(out, f"{case.path.stem}.h5", RESULTS, "a results file")


def table_path(case: Case, out: str | None, kind: str, endings: tuple[str, ...] = (".csv",)) -> Path:
    """``out`` itself, or the case's name and ``kind`` in the folder ``out``."""
    wanted = "a table" if len(endings) == 1 else "a table or page"
    return output_path(out, f"{case.path.stem}_{kind}.csv", endings, wanted)


def output_path(out: str | None, name: str, endings: tuple[str, ...], wanted: str) -> Path:
    """Resolve ``--out`` to a file in an existing folder: ``out``, or ``name`` where ``out`` is a folder.

    A folder exists as one, or ends in a slash, or, being new, has no ending. UsageError for another ending.
    """
    if out is None:
        return beside(Path(name))
    if not out:
        raise UsageError("--out is empty: name a file or a folder")
    path = Path(out)
    if out.endswith(("/", sep)) or path.is_dir() or not (path.suffix or path.exists()):
        return beside(folder(path) / name)
    if path.suffix not in endings:
        or_folder = f"write {path}/ for a new folder" if not path.exists() else "it is no folder either"
        raise UsageError(f"{path}: --out names {wanted} that ends in {' or '.join(endings)}, or a folder: {or_folder}")
    folder(path.parent)
    return path


def folder(path: Path) -> Path:
    """Return the folder, created with its parents where it is missing."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise UsageError(f"{path}: --out needs a folder here, and this is a file or lies below one") from None
    return path


def run_case(case: Case, path: Path | None, show: bool = True, fresh: bool = False, compare: bool = False) -> Any:
    """Result of the case, of one with [record] a ``TransientResult``, stored in ``path``, with a progress bar."""
    from vibeam.cli.progress import Bar, stderr, tell_overview
    from vibeam.runs.run import run

    with Bar("sweeping" if case.record is None else "flying") as bar:
        return run(
            case, out=path, progress=bar, show=show, fresh=fresh, tell=stderr().print, before=tell_overview,
            compare=compare,
        )  # fmt: skip
