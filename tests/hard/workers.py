"""Numbers given one by one to a process that can be ended: one that takes too long, or crashes, is an answer too."""

from __future__ import annotations

import multiprocessing as mp
import signal
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection
from typing import Any

from progress import IDLE, Idleness
from report import cpu_seconds

Stage = Callable[[str], None]  # called by a task as it goes on, so that one that is ended has said what it was at

Task = Callable[[int, Stage], Any]

GLANCE = 1.0  # seconds after which it is looked whether a process that says nothing works


class Lost(Exception):
    """A number without an answer; the message says why, and at what."""


def answers(task: Task, numbers: Iterable[int], seconds: float) -> Iterator[tuple[int, Any, float]]:
    """Each number with what ``task`` returns, or the exception that it raised, or Lost; and the CPU seconds it took.

    ``seconds``: of CPU time a number may take.
    """
    worker = None
    try:
        for number in numbers:
            worker = worker or _Worker(task, seconds)
            answer, taken = worker.ask(number)
            if isinstance(answer, Lost):
                worker = None
            yield number, answer, taken
    finally:
        if worker is not None:
            worker.end()


class _Worker:
    def __init__(self, task: Task, seconds: float) -> None:
        context = mp.get_context("fork")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=_work, args=(task, seconds, other, self.pipe), daemon=True)
        self.process.start()
        other.close()
        self.seconds = seconds

    def ask(self, number: int) -> tuple[Any, float]:
        """The answer and its CPU seconds; after Lost the process is gone."""
        self.pipe.send(number)
        stage, idleness = "start", Idleness(self.process.pid or 0)
        try:
            while self.pipe.poll(GLANCE) or not idleness.lasts():
                kind, value = self.pipe.recv() if self.pipe.poll() else ("stage", stage)
                if kind != "stage":
                    return value, kind
                stage = value
        except EOFError:
            return Lost(f"{self._why()}, in {stage}"), self.seconds
        self.end()
        return Lost(f"waits for {IDLE:g} s without working, in {stage}"), 0.0

    def _why(self) -> str:
        self.process.join()
        code = self.process.exitcode or 0
        if code == -signal.SIGPROF:
            return f"no answer within {self.seconds:g} s of CPU time"
        return f"the process ended with {signal.Signals(-code).name if code < 0 else code}"

    def end(self) -> None:
        self.process.kill()
        self.process.join()


def _work(task: Task, seconds: float, pipe: Connection, parents: Connection) -> None:
    parents.close()  # else the pipe never ends where the parent is gone
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # ends the process wherever it is, compiled loops included
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    while True:
        try:
            number = pipe.recv()
        except EOFError:
            return
        signal.setitimer(signal.ITIMER_PROF, seconds)
        begun = cpu_seconds()
        try:
            answer = task(number, lambda stage: pipe.send(("stage", stage)))
        except Exception as error:
            answer = error
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        try:
            pipe.send((cpu_seconds() - begun, answer))
        except BrokenPipeError:
            return
