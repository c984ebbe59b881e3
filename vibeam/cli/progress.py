"""Progress bar on stderr over the points of all fidelities, with the remaining time."""

from __future__ import annotations

from textwrap import wrap
from types import TracebackType
from typing import TYPE_CHECKING

from rich.console import Console

from vibeam.cli.verbosity import verbosity

if TYPE_CHECKING:
    from rich.progress import Progress

    from vibeam.runs.systems import Overview

WIDE, NARROW = 120, 60  # columns of a terminal from which on there are words and speed, and a bar


def stderr() -> Console:
    """Console on stderr that leaves long lines to the terminal; it is silent with ``-q``."""
    return Console(stderr=True, quiet=verbosity().quiet, soft_wrap=True, highlight=False, markup=False)


def tell_overview(overview: Overview) -> None:
    """Print rig and sweep on stderr, and what is implausible of them, broken between words."""
    console = stderr()
    for said in (str(overview), *(f"warning: {each}" for each in overview.warnings())):
        for line in wrap(said, console.width):
            console.print(line)


class Bar:
    """Context whose value is called with the points done and their total; the first call sets the stored ones."""

    def __init__(self, doing: str = "sweeping", console: Console | None = None) -> None:
        self._console = console or stderr()
        self._doing = doing
        self._progress: Progress | None = None
        self._began = False

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if self._progress is not None:
            self._progress.stop()

    def __call__(self, done: int, total: int) -> None:
        """Show ``done`` of ``total`` points; callable from any thread."""
        if not self._began:
            self._began = True
            self._begin(done, total)
        if self._progress is not None:
            self._progress.update(self._progress.task_ids[0], completed=done, total=total)

    def _begin(self, done: int, total: int) -> None:
        if done == total:
            self._console.print(f"all {total} points are there already")
            return
        if done:
            self._console.print(f"continuing: {done} of {total} points are there")
        if self._console.is_terminal:
            self._progress = _bar(self._console, self._doing)
            self._progress.start()


def _bar(console: Console, doing: str) -> Progress:
    """Bar of a terminal's width: a narrow one has no room for words and speed, a very narrow one none for the bar."""
    from rich import progress
    from rich.text import Text

    from vibeam.runs.parallel import cores

    text = progress.TextColumn

    class Speed(progress.ProgressColumn):
        """Points a second."""

        def render(self, task: progress.Task) -> Text:
            return Text(f"points · {float(f'{task.speed:.3g}'):g} points/s" if task.speed else "points")

    words, speed, line = [text(f"{doing} on up to {_cores(cores())}")], [Speed()], [progress.BarColumn()]
    wide, narrow = console.width >= WIDE, console.width >= NARROW
    columns = [*words * wide, *line * narrow, progress.MofNCompleteColumn(), *speed * wide, text("·")]
    times = progress.TimeElapsedColumn(), text("· remaining" if narrow else "·"), progress.TimeRemainingColumn()
    bar = progress.Progress(*columns, *times, console=console, transient=True)
    bar.add_task("points", total=None)
    return bar


def _cores(count: int) -> str:
    return "1 core" if count == 1 else f"{count} cores"
