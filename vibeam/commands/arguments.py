"""The arguments that several commands take, and what their words become: a case, a place to write to."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibeam.commands.mistakes import Mistake

if TYPE_CHECKING:
    from vibeam.case import Case

RESULTS = (".h5", ".hdf5")

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="The case file (TOML).", show_default=False)]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="A key of the case, in place of the file's. Repeatable."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON in place of tables.")]
ResultsFile = Annotated[
    Path | None, typer.Option("--out", help="The results file (.h5), or the folder for it.", show_default=False)
]
Fresh = Annotated[bool, typer.Option("--fresh", help="Keep nothing of the results file that is there: start over.")]
TableFile = Annotated[Path | None, typer.Option("--out", help="Write the table to this CSV file.", show_default=False)]
StudyFile = Annotated[
    Path | None, typer.Option("--out", help="The CSV file, or the folder for it.", show_default=False)
]


def load(path: Path, settings: list[str] | None) -> Case:
    """The case of the file, with the ``--set`` keys in place of its own."""
    from vibeam.case import load as read

    parts = [text.partition("=") for text in settings or []]
    wrong = [key for key, equals, _ in parts if not (equals and key.strip())]
    if wrong:
        raise Mistake("\n".join(f"--set {key}: write --set key=value" for key in wrong))
    return read(path, {key.strip(): value.strip() for key, _, value in parts})


def results_path(case: Case, out: Path | None) -> Path:
    """``out`` itself, or the case's name in the folder ``out``."""
    return _place(out or Path(), f"{case.path.stem}.h5", RESULTS, "a results file that ends in .h5")


def table_path(case: Case, out: Path | None, kind: str) -> Path:
    """``out`` itself, or the case's name and ``kind`` in the folder ``out``."""
    return _place(out or Path(), f"{case.path.stem}_{kind}.csv", (".csv",), "a file that ends in .csv")


def _place(out: Path, name: str, endings: tuple[str, ...], wanted: str) -> Path:
    if out.is_dir():
        return out / name
    if out.suffix not in endings:
        raise Mistake(f"{out}: --out names {wanted}, or a folder that is there")
    return out
