"""What the commands do that takes time: sweep a case, study it; what happens meanwhile is told on stderr."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from vibeam.commands.mistakes import Made, of_case

if TYPE_CHECKING:
    from vibeam.case import Case
    from vibeam.result import Result


def swept(case: Case, path: Path | None, show: bool = True, fresh: bool = False) -> Result:
    """The case run, kept in ``path``, under a bar."""
    from vibeam.progress import Bar, stderr
    from vibeam.run import run

    with Bar() as bar:
        return run(case, out=path, progress=bar, show=show, fresh=fresh, tell=stderr().print)


def studied(path: Path, case: Case, study: Callable[[Case, Callable[[str], None]], Made]) -> Made:
    """What a study of the case finds."""
    from vibeam.progress import stderr

    return of_case(path, lambda: study(case, stderr().print))
