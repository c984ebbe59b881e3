"""Rounds of independent evaluations: in threads of this process or, where they are shared, in steps on disk.

A computation hands over one round after another. Within ``sharing`` each is a long computation of its own, its steps in
``OUT.1-NAME.parts``, and whoever shares says what is done of it before its values are read: all, a part, its price.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from threading import Event, Lock
from typing import TypeVar

from vibeam.flight.engine.threads import run_parallel
from vibeam.store.blocks import Values, discard
from vibeam.store.long_work import LongWork, WorkStep
from vibeam.store.parts import gathered, known_manifest
from vibeam.store.place import Tell, place_of

Told = Callable[[int, int], None]
Item = TypeVar("Item")
MOST = 20_000  # steps of a round, about


@dataclass(frozen=True)
class Sharing:
    """Computation for the file ``path`` whose rounds are shared: ``take`` gets each before its values are read.

    ``code``: digest of what evaluates; ``command``: what ``--part`` stands behind; ``rounds``: handed over so far.
    """

    path: Path
    take: Callable[[LongWork, Told | None], object]
    code: str = ""
    command: str = ""
    rounds: list[LongWork] = field(default_factory=list)

    def discard(self) -> None:
        """Delete the steps of all rounds: what was computed of them is kept elsewhere."""
        for each in self.rounds:
            discard(each.folder)


_SHARED: ContextVar[Sharing | None] = ContextVar("shared", default=None)


@contextmanager
def sharing(shared: Sharing | None) -> Iterator[None]:
    """Context in which rounds are ``shared``; None: in which they are not."""
    token = _SHARED.set(shared)
    try:
        yield
    finally:
        _SHARED.reset(token)


def are_shared() -> bool:
    """Test whether rounds are shared here: then each has all its items, whatever is known of them elsewhere."""
    return _SHARED.get() is not None


def evaluate_each(
    name: str, of: str, items: Sequence[Item], evaluate: Callable[[Item], Values],
    keep: Callable[[Item, Values], object], told: Told | None = None, workers: int | None = None,
) -> None:  # fmt: skip
    """Evaluate every item, and ``keep`` it with its values, from any thread; ``of``: what decides them, the code aside.

    ``told`` hears of items that are done and of their total. Where the round is shared, errors are those of
    ``take_part`` and ``gathered``, and whatever ends a share.
    """
    shared = _SHARED.get()
    if shared is None or not items:
        _evaluate_here(items, evaluate, keep, told, workers)
        return

    def values_of(step: WorkStep) -> Values:
        with sharing(None):
            every = {at: evaluate(items[at]) for at in range(step.first, step.last)}
        return {f"{at} {key}": value for at, values in every.items() for key, value in values.items()}

    path = shared.path.with_name(f"{shared.path.name}.{len(shared.rounds) + 1}-{name}")
    steps, keys = {name: range(0, len(items), -(-len(items) // MOST))}, {name: sha256(of.encode()).hexdigest()}
    for step, values in gathered(handed_over(LongWork(path, keys, steps, values_of, shared.code), told)):
        for at in range(step.first, step.last):
            own = f"{at} "
            keep(items[at], {key.removeprefix(own): each for key, each in values.items() if key.startswith(own)})


def handed_over(work: LongWork, told: Told | None = None, done: bool = False) -> LongWork:
    """A round of those that are shared here, after what is to be done of it; ``done``: nothing is any more."""
    shared = _SHARED.get()
    assert shared is not None
    own = replace(work, command=shared.command)
    shared.rounds.append(own)
    if not done:
        shared.take(own, told)
    return own


def _evaluate_here(
    items: Sequence[Item], evaluate: Callable[[Item], Values], keep: Callable[[Item, Values], object],
    told: Told | None, workers: int | None,
) -> None:  # fmt: skip
    done, lock = 0, Lock()

    def task(item: Item, stop: Event | None = None) -> None:
        nonlocal done
        keep(item, evaluate(item))
        with lock:
            done += 1
            if told is not None:
                told(done, len(items))

    if told is not None:
        told(0, len(items))
    if workers == 1:
        for item in items:
            task(item)
    else:
        run_parallel(task, items, workers)


def set_aside(work: LongWork, tell: Tell) -> None:
    """Give steps of the case as it was, in the place of those of ``work``, a further name."""
    found = known_manifest(work.folder)
    if found is not None and found.keys != work.keys:
        place_of(work.path).keep_aside("holds steps of the case as it was", tell, blocks=True)
