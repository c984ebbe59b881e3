"""Entry point of ``vibeam``: its commands in the groups of its help, and the names that commands had before.

Results go to stdout, everything else to stderr. Exit code 0: success, 1: a check was missed, 2: a fault in
the case, an argument or a file, 130: stopped, 141: the reader of stdout has gone.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from os import getcwd
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from vibeam.cli.commands import case_files, checks, maps, measured, modes, pages, runs, studies
from vibeam.cli.errors import UsageError, mistakes
from vibeam.cli.streams import put, say, standard_streams
from vibeam.cli.verbosity import with_verbosity
from vibeam_models.phases import phases_told

GROUPS: dict[str, tuple[Callable[..., None], ...]] = {
    "How much model": (runs.run, studies.verdict, maps.map),
    "Measurements": (checks.check, measured.fit, studies.uncertainty),
    "From geometry": (studies.derive, modes.modes),
    "Results": (pages.report, pages.explore, studies.study),
    "Case files": (case_files.new, case_files.keys, case_files.doctor),
}

KEYS = "; --within is --accuracy, its other options are keys (vibeam keys modes_needed)"
#: what commands of earlier versions are now, what of their options is to be said, and the version that drops them
EARLIER = {
    "reduce": ("verdict --only modes", KEYS, "0.3"),
    "limit": ("verdict --only modes", KEYS, "0.3"),
    "influence": ("verdict --only effects", "", "0.3"),
    "cost": ("verdict --only solvers", "", "0.3"),
    "identify": ("fit", "", "0.3"),
    "record": ("check --record", "", "0.3"),
    "stability": ("map --picture stability", "; --points N,M stands for --frequencies M", "0.3"),
    "new --rig": ("new --from", "", "0.3"),
}


class Commands(TyperGroup):
    """Commands in groups, each with its whole line of help; the earlier names of some are known too."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command of the first word, by the name that it has now."""
        if args[-1:] == ["--from"]:
            args = [*args, "list"]
        if args[:1] == ["new"] and any(each.partition("=")[0] == "--rig" for each in args):
            args = [
                "new --rig",
                *(each.replace("--rig", "--from", 1) if each[:5] == "--rig" else each for each in args[1:]),
            ]
        if args and args[0] in EARLIER:
            now, options, until = EARLIER[args[0]]
            say(f"vibeam {args[0]} is now: vibeam {now}{options} (version {until} drops the old name)")
            args = [*now.removesuffix(" --from").split(), *args[1:]]
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands, a section a group."""
        for title, commands in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(each.__name__, _line(each)) for each in commands])


def _line(command: Callable[..., None]) -> str:
    """First line of a command's help."""
    return (command.__doc__ or "").strip().partition("\n")[0]


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


def _tell_phase(said: str) -> None:
    from vibeam.cli.progress import stderr

    stderr().print(said)


for group in GROUPS.values():
    for each in group:
        if each is not studies.study:
            app.command()(with_verbosity(phases_told(_tell_phase)(mistakes()(each))))
app.add_typer(studies.registered, name="study")
