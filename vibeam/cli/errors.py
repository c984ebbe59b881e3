"""Error messages and exit codes of the commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import typer

from vibeam.cli.address_space import refusal
from vibeam.cli.streams import STOPPED, WRONG, reader_gone, say

Made = TypeVar("Made")

UNMAPPED = ("failed to map segment", "cannot allocate memory", "Cannot allocate memory")  # the loader's words


class UsageError(Exception):
    """Faulty argument: one line for stderr."""


@contextmanager
def mistakes() -> Iterator[None]:
    """Context that turns a user's mistakes into a message on stderr and an exit code; a defect keeps its traceback."""
    if short := refusal():
        _stop(short, WRONG)
    from vibeam.case.faults import CaseError
    from vibeam.flight.libraries.errors import KernelsUnavailable
    from vibeam.run.store.errors import StoreError

    try:
        yield
    except (CaseError, KernelsUnavailable, StoreError, UsageError) as mistake:
        _stop(str(mistake), WRONG)
    except BrokenPipeError:
        reader_gone()
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _stop(f"{where}{(error.strerror or str(error)).lower()}", WRONG)
    except MemoryError:
        _stop("there is not enough memory: take fewer points, periods, modes or elements", WRONG)
    except ImportError as error:
        if not any(said in str(error) for said in UNMAPPED):
            raise
        _stop(f"there is not enough memory to load what is needed (ulimit -v): {error}", WRONG)
    except KeyboardInterrupt as interrupt:
        _stop(str(interrupt) or "stopped", STOPPED)


def of_case(case: Path, make: Callable[[], Made]) -> Made:
    """Call ``make``; turn its refusal of the case (for example one without a beam) into a usage error."""
    from vibeam.case.faults import CaseError

    try:
        return make()
    except CaseError:
        raise
    except ValueError as refusal:
        raise UsageError(f"{case}: {refusal}") from None


def _stop(message: str, code: int) -> None:
    say(message)
    raise typer.Exit(code) from None
