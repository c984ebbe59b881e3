"""Commands that follow from the declaration of a study: ``verdict``, ``uncertainty``, ``derive``; ``study NAME``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_command_from_info
from typer.models import CommandInfo

from vibeam.cli.errors import UsageError, mistakes
from vibeam.cli.streams import tell
from vibeam.cli.study_command import study_command
from vibeam.cli.verbosity import with_verbosity
from vibeam.report.declaration import STUDIES

verdict = study_command(STUDIES["verdict"])
uncertainty = study_command(STUDIES["uncertainty"])
derive = study_command(STUDIES["derive"])


def of_declared(command: Callable[..., None]) -> Any:
    """Command of the command line, with the options that all have."""
    made = with_verbosity(mistakes()(command), tell)
    info = CommandInfo(command.__name__, callback=made, context_settings={"help_option_names": ["-h", "--help"]})
    return get_command_from_info(info, pretty_exceptions_short=True, rich_markup_mode=None)


class Studies(TyperGroup):
    """Studies that are registered, each a command."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Their names."""
        return list(STUDIES)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Command of a study; a message where there is none of the name."""
        if cmd_name in STUDIES:
            return of_declared(study_command(STUDIES[cmd_name]))
        from vibeam.exchange.faults import suggest

        with mistakes():
            own = "one of your own is known by vibeam --load MODULE study …"
            raise UsageError(f"no study {cmd_name!r}; {suggest(cmd_name, STUDIES)}; {own}")


registered = typer.Typer(cls=Studies, no_args_is_help=True, rich_markup_mode=None)


@registered.callback()
def study() -> None:
    """Run one study by its name, your own too (--load)."""
