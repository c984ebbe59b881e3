"""Entry point of ``vibeam``: its commands in the groups of its help.

Results go to stdout, everything else to stderr. Exit code 0: success, 1: a check was missed, 2: a fault in
the case, an argument or a file, 130: stopped, 141: the reader of stdout has gone.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from inspect import getdoc
from os import getcwd
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from vibeam.cli.arguments import option
from vibeam.cli.commands import case_files, checks, maps, measured, modes, pages, runs, studies
from vibeam.cli.errors import UsageError, mistakes
from vibeam.cli.streams import put, standard_streams, tell
from vibeam.cli.verbosity import with_verbosity
from vibeam_models.phases import phases_told

GROUPS: dict[str, tuple[Callable[..., None], ...]] = {
    "How much model": (runs.run, studies.verdict, maps.map),
    "Measurements": (checks.check, measured.fit, studies.uncertainty),
    "From geometry": (studies.derive, modes.modes),
    "Results": (pages.report, pages.explore, studies.study),
    "Case files": (case_files.new, case_files.keys, case_files.doctor),
}


class Commands(TyperGroup):
    """Commands in groups, each with its whole line of help."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command of the first word; ``new --from`` without an example lists them."""
        return super().resolve_command(ctx, [*args, "list"] if (args[:1], args[-1:]) == (["new"], ["--from"]) else args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands, a section a group."""
        for title, commands in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(each.__name__, (getdoc(each) or "").partition("\n")[0]) for each in commands])


def import_extension(name: str) -> None:
    """Import the module ``name``, from the current folder too; UsageError where it is not found."""
    here = getcwd()
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        import_module(name)
    except ModuleNotFoundError as missing:
        if missing.name not in (name.partition(".")[0], name):
            raise
        said = f"no such module; it is looked for in {here} and among those installed"
        raise UsageError(f"--load {name}: {said}") from None


app = typer.Typer(
    help="How much model does a vibro-impact beam need?",
    cls=Commands,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: rich takes longer to import than all else
)


def main() -> None:
    """The entry point."""
    with standard_streams():
        app()


_LOAD = "A Python module to import first: what it registers is known."
Modules = Annotated[list[str] | None, option(_LOAD, "--load", metavar="MODULE")]


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


for group in GROUPS.values():
    for each in group:
        if each is not studies.study:
            app.command()(with_verbosity(phases_told(tell)(mistakes()(each)), tell))
app.add_typer(studies.registered, name="study")
