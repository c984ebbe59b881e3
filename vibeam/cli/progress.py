"""Progress bar on stderr, or in a notebook, over the points of all fidelities, with the remaining time."""

from __future__ import annotations

from contextlib import AbstractContextManager
from html import escape
from textwrap import wrap
from time import monotonic
from typing import TYPE_CHECKING, Any

from rich.console import Console

from vibeam.cli.verbosity import verbosity
from vibeam_models.arguments import counted

if TYPE_CHECKING:
    from rich.progress import Progress

    from vibeam.runs.systems import Overview

BETWEEN = 0.1  # s from one picture of a notebook's bar to the next, at least
WIDE, NARROW = 120, 60  # columns of a terminal from which on there are words and speed, and a bar


def stderr() -> Console:
    """Console on stderr that leaves long lines to the terminal; it is silent with ``-q``."""
    return Console(stderr=True, quiet=verbosity().quiet, soft_wrap=True, highlight=False, markup=False)


def tell_overview(overview: Overview) -> None:
    """Print rig and sweep on stderr, and what is implausible of them, broken between words in a terminal."""
    console = stderr()
    for said in (str(overview), *(f"warning: {each}" for each in overview.warnings())):
        for line in wrap(said, console.width) if console.is_terminal else [said]:
            console.print(line)


class Bar(AbstractContextManager["Bar"]):
    """Context whose value is called with the points done and their total; the first call sets the stored ones.

    A line of text is printed.
    """

    def __init__(self, doing: str = "sweeping", console: Console | None = None) -> None:
        self._console = console or stderr()
        self._doing, self._what = doing, "motions" if doing == "flying" else "points"
        self._progress: Any = None  # rich's, or that of a notebook
        self._began = False

    def __exit__(self, *raised: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    def __call__(self, done: int | str, total: int | None = None) -> None:
        """Show ``done`` of ``total`` points, or a line; callable from any thread."""
        if isinstance(done, str):
            self._console.print(done)
            return
        if not self._began:
            self._began = True
            self._begin(done, total)
        if self._progress is not None:
            self._progress.update(self._progress.task_ids[0], completed=done, total=total)

    def _begin(self, done: int, total: int | None) -> None:
        if done == total:
            self._console.print(f"all {total} {self._what} are there already")
            return
        if done:
            self._console.print(f"continuing: {done} of {total} {self._what} are there")
        if self._console.is_jupyter:
            self._progress = _NotebookBar(self._doing)
        elif self._console.is_terminal:
            self._progress = _bar(self._console, self._doing)
            self._progress.start()


class _NotebookBar:
    """Bar in a notebook: an element of HTML in the cell's output, replaced as it goes on."""

    task_ids = (0,)

    def __init__(self, doing: str) -> None:
        from IPython import display

        self._html, self._doing, self._next = display.HTML, doing, 0.0
        self._place = display.display(self._html(""), display_id=True)

    def update(self, task: int, completed: int, total: int) -> None:
        """Show it, a few times a second at most."""
        if monotonic() >= self._next or completed == total:
            self._next = monotonic() + BETWEEN
            text = f"{escape(self._doing)}: {completed} of {total} points"
            self._place.update(self._html(f'<progress value="{completed}" max="{total}"></progress> {text}'))

    def stop(self) -> None:
        """Take it away."""
        self._place.update(self._html(""))


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

    words, speed, line = [text(f"{doing} on up to {counted(cores(), 'core')}")], [Speed()], [progress.BarColumn()]
    wide, narrow = console.width >= WIDE, console.width >= NARROW
    columns = [*words * wide, *line * narrow, progress.MofNCompleteColumn(), *speed * wide, text("·")]
    times = progress.TimeElapsedColumn(), text("· remaining" if narrow else "·"), progress.TimeRemainingColumn()
    bar = progress.Progress(*columns, *times, console=console, transient=True)
    bar.add_task("points", total=None)
    return bar
