"""Options of a long computation: its price, one part of it, what parts have computed gathered; signals end a part."""

from __future__ import annotations

import shlex
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from threading import current_thread, main_thread
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from vibeam.cli.arguments import option
from vibeam.cli.errors import Answered, UsageError
from vibeam.cli.streams import STOPPED

if TYPE_CHECKING:
    from vibeam.report.output import StudySheet
    from vibeam.store.long_work import LongWork, WorkPart
    from vibeam.store.parts import Ending, TakenPart
    from vibeam.store.shares import Sharing, Told

    Asked = WorkPart | Literal["price", "gather"] | None  # a part, the price, the gathering, or all here

TERMINATED = 143  # exit code after SIGTERM, as a shell reports it

PriceOption = Annotated[bool, option("What it takes, after 30 s: core-hours, GB, the line to submit.", "--price")]
PartOption = Annotated[
    str | None, option("Compute this share alone, 3/64 say, wherever OUT's folder is.", "--part", metavar="K/N")
]
GatherOption = Annotated[bool, typer.Option("--gather", help="Make the file of what parts have computed.")]


def part_asked(price: bool, part: str | None, gather: bool, others: Mapping[str, Any] | None = None) -> Asked:
    """Share that the options ask for; UsageError where a part is none, and for options that exclude each other."""
    own = [name for name, given in (("--price", price), ("--part", part), ("--gather", gather)) if given]
    given = [*own, *(name for name, value in (others or {}).items() if value)] if own else []
    if len(given) > 1:
        raise UsageError(f"{' and '.join(given)} exclude each other: give one at a time")
    if part is None:
        return "price" if price else "gather" if gather else None
    from vibeam.store.long_work import WorkPart

    try:
        return WorkPart.read(part)
    except ValueError as wrong:
        raise UsageError(f"--part: {wrong}") from None


def command_typed() -> str:
    """The command as it was typed, without what asks for a price, a part or the gathering."""
    words, kept = iter(sys.argv[1:]), list[str]()
    for word in words:
        if word == "--part":
            next(words, "")
        elif word not in ("--price", "--gather") and not word.startswith("--part="):
            kept.append(word)
    return shlex.join(["vibeam", *kept])


def taken(doing: str, part: WorkPart, take: Callable[[Callable[[int, int], None], Ending], TakenPart]) -> TakenPart:
    """Take a part, with a bar; SIGTERM and Ctrl-C end it with the step in hand, kept, by exit code 143 or 130."""
    from vibeam.cli.progress import Bar, stderr

    with ended_by_signals() as (ending, came), Bar(doing) as bar:
        found = take(bar, ending)
    if came and not found.complete:
        stderr().print(
            f"{doing} --part {part.number}/{part.of}: {found.done} of {found.total} points are kept: "
            "the same command goes on with the rest"
        )
        raise typer.Exit(STOPPED if came[0] == signal.SIGINT else TERMINATED)
    return found


@contextmanager
def in_parts(doing: str, path: Path, asked: Asked, last: bool = False) -> Iterator[Sharing]:
    """Context of a computation for the file ``path`` whose rounds of evaluations are shared as is asked.

    A price or a part ends it with that answer, at the first round of which anything is missing (the ``last``: at it),
    or at its end. Steps are the caller's to discard, once what was computed is written.
    """
    from vibeam.cli.progress import stderr
    from vibeam.runs.keys import digest_of_code
    from vibeam.store.long_work import WorkPart
    from vibeam.store.parts import StepsOnDisk, TakenPart, take_part
    from vibeam.store.shares import Sharing, set_aside, sharing

    command = command_typed()

    def take(work: LongWork, told: Told | None) -> None:
        what = "points" if last else next(iter(work.steps))
        if asked == "price":
            raise Answered(price_sheet(work, command, what))
        if isinstance(asked, WorkPart):
            found = taken(doing, asked, lambda tell, ending: take_part(work, asked, tell=tell, ending=ending))
            if last or found.found < found.total or StepsOnDisk(work).missing():
                raise Answered(part_sheet(doing, asked, found, command, what))
        elif asked is None or len(made.rounds) > 1:
            set_aside(work, stderr().print)
            take_part(work, tell=told)

    made = Sharing(path, take, digest_of_code(studies=True), command)
    try:
        with sharing(made):
            yield made
    except KeyboardInterrupt as stopped:
        kept = "stopped: what was computed is kept: the same command goes on from there"
        raise KeyboardInterrupt(str(stopped) or kept) from None
    if isinstance(asked, WorkPart):
        total = sum(work.size(step) for work in made.rounds for step in work.every)
        raise Answered(part_sheet(doing, asked, TakenPart(total, total, total), command))


def part_sheet(doing: str, part: WorkPart, found: TakenPart, command: str, points: str = "points") -> StudySheet:
    """Sheet of a part that was computed; ``points``: what it computes."""
    from vibeam.report.output import StudySheet

    said = f"Part {part.number}/{part.of} of {doing}: its {found.total} {points} are there, {found.found} were before"
    return StudySheet(
        f"{said}; when all parts are: {command} --gather",
        data={"part": part.number, "of": part.of, "points": found.total, "found": found.found},
    )


@contextmanager
def ended_by_signals() -> Iterator[tuple[Ending, list[int]]]:
    """Context in which SIGTERM, or Ctrl-C once, is a wish to end; with the signals that came."""
    from vibeam.store.parts import Ending

    ending, came = Ending(), list[int]()

    def wish(number: int, frame: object) -> None:
        if number == signal.SIGINT and came:
            raise KeyboardInterrupt
        came.append(number)
        ending.wish()

    if current_thread() is not main_thread():
        yield ending, came
        return
    before = {number: signal.signal(number, wish) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield ending, came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def price_sheet(work: LongWork, command: str, points: str = "points") -> StudySheet:
    """Sheet of the price of a long computation, with the lines that submit it; ``points``: what it computes."""
    from vibeam.report.output import StudySheet
    from vibeam.store.price import price

    found = price(work)
    memory = -(-(found.memory or 10**9) // 10**8) * 200  # MB, twice what was taken
    part = f"{command} --part"
    lines = {
        "slurm": f"sbatch --array=1-{found.parts} --cpus-per-task=1 --mem={memory}M --time={found.minutes_a_part} "
        f"--signal=B:TERM@60 --wrap {shlex.quote(f'exec {part} $SLURM_ARRAY_TASK_ID/{found.parts}')}",
        "parallel": f"seq {found.parts} | parallel -j 100% {shlex.quote(f'{part} {{}}/{found.parts}')}",
        "gather": f"{command} --gather",
    }
    said = "" if found.memory is None else f", {found.memory / 1e6:.0f} MB of memory a process"
    return StudySheet(
        f"{found.core_hours:.2g} core-hours ± {found.error:.0%} for {found.points:.3g} {points}: "
        f"{found.bytes / 1e9:.2g} GB in {found.files} files, as much again when they are gathered{said}.",
        notes=[
            f"submit {found.parts} parts by Slurm: {lines['slurm']}",
            f"or on one machine by GNU parallel: {lines['parallel']}",
            f"then: {lines['gather']}",
        ],
        data={**vars(found), "core_hours": found.core_hours, "parts": found.parts, "lines": lines},
    )
