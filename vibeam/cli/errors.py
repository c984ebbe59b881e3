"""Error messages and exit codes of the commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer

from vibeam.cli.streams import STOPPED, WRONG, discard_stdout, reader_gone, say
from vibeam.cli.verbosity import verbosity
from vibeam.exchange.whole_files import STDOUT

if TYPE_CHECKING:
    from vibeam.report.output import StudySheet

Made = TypeVar("Made")
UNMAPPED = ("failed to map segment", "cannot allocate memory", "Cannot allocate memory")  # the loader's words


class UsageError(Exception):
    """Faulty argument: one line for stderr."""


class Answered(Exception):
    """End of a command, by a ``sheet`` of something else than what it computes."""

    def __init__(self, sheet: StudySheet) -> None:
        self.sheet = sheet


@contextmanager
def mistakes() -> Iterator[None]:
    """Context that turns a user's mistakes into a message on stderr and an exit code; a defect keeps its traceback."""
    try:
        yield
    except Answered as answer:
        from vibeam.cli.output import print_sheet

        print_sheet(answer.sheet)
    except BrokenPipeError:
        reader_gone()
    except (Exception, KeyboardInterrupt) as error:
        fault = fault_of(error)
        if fault is None:
            raise
        message, code = fault
        say(message)
        if verbosity().json:
            from vibeam.cli.output import print_json

            faults = [vars(each) for each in getattr(error, "faults", ())]
            print_json({"error": message, "exit_code": code, "faults": faults})
        raise typer.Exit(code) from None


def fault_of(error: BaseException) -> tuple[str, int] | None:
    """Message and exit code of a user's mistake; None for a defect."""
    from vibeam.exchange.faults import CaseError
    from vibeam.flight.engine.loading import KernelsUnavailable
    from vibeam.store.errors import StoreError
    from vibeam_models.extensions import ExtensionError

    if isinstance(error, CaseError | ExtensionError | KernelsUnavailable | StoreError | UsageError):
        return str(error), WRONG
    if isinstance(error, OSError) and not isinstance(error, BrokenPipeError):
        if error.filename == STDOUT:  # what is pending would fail once more at the end
            discard_stdout()
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{(error.strerror or str(error)).lower()}", WRONG
    if isinstance(error, MemoryError):
        return "there is not enough memory: take fewer points, periods, modes or elements", WRONG
    if isinstance(error, ImportError) and any(said in str(error) for said in UNMAPPED):
        return f"there is not enough memory to load what is needed (ulimit -v): {error}", WRONG
    if isinstance(error, KeyboardInterrupt):
        return str(error) or "stopped", STOPPED
    return None


def of_case(case: Path, make: Callable[[], Made]) -> Made:
    """Call ``make``; turn its refusal of the case (for example one without a beam) into a usage error."""
    from vibeam.exchange.faults import CaseError

    try:
        return make()
    except CaseError:
        raise
    except ValueError as refusal:
        raise UsageError(f"{case}: {refusal}") from None
