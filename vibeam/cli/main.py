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
from vibeam.cli.commands.studies import brought_command
from vibeam.cli.declaration import COMMANDS
from vibeam.cli.errors import UsageError, mistakes
from vibeam.cli.streams import put, standard_streams, tell
from vibeam.cli.verbosity import with_verbosity
from vibeam_models.extensions import absent, entry_points
from vibeam_models.phases import phases_told

GROUPS: dict[str, tuple[Callable[..., None], ...]] = {
    "How much model": (runs.run, studies.verdict, maps.map),
    "Measurements": (checks.check, measured.fit, studies.uncertainty),
    "From geometry": (studies.derive, modes.modes),
    "Results": (pages.report, studies.study),
    "Case files": (case_files.new, case_files.keys, case_files.doctor),
}


class Commands(TyperGroup):
    """Commands in groups, each with its whole line of help."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command of the first word; ``new --from`` without an example lists them."""
        return super().resolve_command(ctx, [*args, "list"] if (args[:1], args[-1:]) == (["new"], ["--from"]) else args)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Command of a name, or that of an extension; a message where the extension that has it is absent."""
        own = super().get_command(ctx, cmd_name)
        with mistakes():
            if own is None or any(cmd_name in each.extension().replaces for each in entry_points()):
                if cmd_name in COMMANDS:
                    return brought_command(COMMANDS[cmd_name])
                if why := absent(f"vibeam {cmd_name}"):
                    raise UsageError(f"{cmd_name}: {why}")
        return own

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands."""
        return list(dict.fromkeys([*super().list_commands(ctx), *COMMANDS]))

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands, a section a group."""
        groups = {title: {each.__name__: begins(each) for each in commands} for title, commands in GROUPS.items()}
        with mistakes():
            for name, each in COMMANDS.items():
                groups.setdefault(each.group, {})[name] = each.meaning
        for title, lines in groups.items():
            with formatter.section(title):
                formatter.write_dl(list(lines.items()))


def begins(command: Callable[..., None]) -> str:
    """First line of the help of a command."""
    return (getdoc(command) or "").partition("\n")[0]


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
