"""Entry point of ``vibeam``: its commands in the order of its help.

Results go to stdout, everything else to stderr. Exit code 0: success, 1: a check was missed, 2: a fault in
the case, an argument or a file, 130: stopped, 141: the reader of stdout has gone.
"""

from __future__ import annotations

import sys
from importlib import import_module
from os import getcwd
from typing import Annotated

import typer

from vibeam.cli.commands import case_files, maps, measured, modes, runs, studies
from vibeam.cli.errors import UsageError, mistakes
from vibeam.cli.streams import put, standard_streams


def import_extension(name: str) -> None:
    """Import the module ``name``, from the current folder too; UsageError where it is not found."""
    if getcwd() not in sys.path:
        sys.path.insert(0, getcwd())
    try:
        import_module(name)
    except ModuleNotFoundError as missing:
        if missing.name != name.partition(".")[0] and missing.name != name:
            raise
        raise UsageError(
            f"--load {name}: no such module; it is looked for in {getcwd()} and among those installed"
        ) from None


app = typer.Typer(
    help="How much model does a vibro-impact beam need?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: rich takes longer to import than all else
)


def main() -> None:
    """The entry point."""
    with standard_streams():
        app()


Modules = Annotated[
    list[str] | None,
    typer.Option("--load", metavar="MODULE", help="A Python module to import first: what it registers is known."),
]


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False, load: Modules = None
) -> None:
    for module in load or []:
        with mistakes():
            import_extension(module)
    if version:
        from vibeam import __version__

        put(f"vibeam {__version__}")
        raise typer.Exit


for command in (
    runs.run, runs.check, maps.stability, maps.verdict, maps.map, studies.cost, studies.limit, studies.influence,
    studies.uncertainty, measured.fit, modes.derive, modes.modes, studies.reduce, runs.report, studies.study,
    measured.identify, runs.record, case_files.new, case_files.keys, case_files.doctor,
):  # fmt: skip
    app.command()(mistakes()(command))
