"""The command ``vibeam``: its commands in the order of its help.

Results go to stdout, everything else to stderr. Exit code 0: fine, 1: a check was missed, 2: something is wrong with
the case, an argument or a file, 130: stopped, 141: the reader of stdout has gone.
"""

from __future__ import annotations

from typing import Annotated

import typer

from vibeam.commands.check import check
from vibeam.commands.cost import cost
from vibeam.commands.derive import derive
from vibeam.commands.influence import influence
from vibeam.commands.keys import keys
from vibeam.commands.mistakes import mistakes
from vibeam.commands.modes import modes
from vibeam.commands.new import new
from vibeam.commands.run import run
from vibeam.commands.stability import stability
from vibeam.commands.streams import put, standard_streams

app = typer.Typer(
    help="How much model does a vibro-impact beam need?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def main() -> None:
    """The entry point."""
    with standard_streams():
        app()


@app.callback(invoke_without_command=True)
def _version(version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if version:
        from vibeam import __version__

        put(f"vibeam {__version__}")
        raise typer.Exit


for command in (run, check, stability, cost, influence, derive, modes, new, keys):
    app.command()(mistakes()(command))
