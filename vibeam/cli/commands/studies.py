"""Commands that follow from a declaration: ``verdict``, ``uncertainty``, ``derive``, ``study NAME``, of extensions."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperGroup
from typer.main import get_command_from_info
from typer.models import CommandInfo

from vibeam.cli.errors import UsageError, mistakes
from vibeam.cli.streams import tell
from vibeam.cli.study_command import study_command
from vibeam.cli.verbosity import with_verbosity
from vibeam.report.declaration import STUDIES, StudyDeclaration
from vibeam_models.phases import phases_told
from vibeam_models.registry import loaded

if TYPE_CHECKING:
    from vibeam.cli.declaration import Command

verdict = study_command(STUDIES["verdict"])
uncertainty = study_command(STUDIES["uncertainty"])
derive = study_command(STUDIES["derive"])


def of_declared(command: Callable[..., None]) -> Any:
    """Command of the command line, with the options that all have."""
    made = with_verbosity(phases_told(tell)(mistakes()(command)), tell)
    info = CommandInfo(command.__name__, callback=made, context_settings={"help_option_names": ["-h", "--help"]})
    return get_command_from_info(info, pretty_exceptions_short=True, rich_markup_mode=None)


def brought_command(command: Command) -> Any:
    """Command of an extension."""
    made = loaded(command.home)
    return of_declared(study_command(made) if isinstance(made, StudyDeclaration) else made)


class Studies(TyperGroup):
    """Studies that are registered, each a command."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Their names."""
        return list(STUDIES)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Command of a study; a message where there is none of the name."""
        from vibeam.exchange.faults import suggest

        with mistakes():
            if cmd_name in STUDIES:
                return of_declared(study_command(STUDIES[cmd_name]))
            own = "one of your own is known by vibeam --load MODULE study …"
            raise UsageError(f"no study {cmd_name!r}; {suggest(cmd_name, STUDIES)}; {own}")


registered = typer.Typer(cls=Studies, no_args_is_help=True, rich_markup_mode=None)


@registered.callback()
def study() -> None:
    """Run one study by its name, your own too (--load)."""
