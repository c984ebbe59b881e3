"""Recorder of computed points: into a branch's response, into the file, and to a progress callback."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields
from threading import Lock
from time import monotonic
from typing import TYPE_CHECKING

from vibeam.run.store.branch import Branch, StoredBranch
from vibeam.system.response import FrequencyResponse

if TYPE_CHECKING:
    from vibeam.run.store.store import Store
    from vibeam.system.state import State


WRITE_EVERY = 0.2  # seconds: a write costs as much as many points, and a killed run loses no more than this

Progress = Callable[[int, int], None]


class Recorder:
    """Adds points to a branch's response, and writes them to the file every ``WRITE_EVERY`` seconds."""

    def __init__(self, branch: Branch, kept: StoredBranch, store: Store | None) -> None:
        self._branch, self._response, self._store = branch, kept.response, store
        self._after = kept.after
        self._done = self._written = kept.done
        self._states: list[State] = []
        self._due = monotonic() + WRITE_EVERY

    def add(self, block: FrequencyResponse, states: Sequence[State]) -> None:
        """Add the points of ``block``, and the states after the last of them."""
        points = slice(self._done, self._done + len(block))
        for field in fields(FrequencyResponse):
            if field.name != "frequency":  # keep the grid's own value, to the last bit
                getattr(self._response, field.name)[points] = getattr(block, field.name)
        self._done = points.stop
        for point, state in enumerate(states, points.stop - len(states)):
            self._after.displacement[point], self._after.velocity[point] = state.displacement, state.velocity
        if len(states) < len(block):
            self._states.clear()  # states in between are unknown
        self._states += states
        if monotonic() >= self._due:
            self.write()

    def write(self) -> None:
        """Write all points not written yet."""
        if self._store and self._done > self._written:
            block = _part(self._response, slice(self._written, self._done))
            self._store.write(self._branch, self._written, block, self._states)
        self._states.clear()
        self._written, self._due = self._done, monotonic() + WRITE_EVERY


def _part(response: FrequencyResponse, points: slice) -> FrequencyResponse:
    return FrequencyResponse(**{field.name: getattr(response, field.name)[points] for field in fields(response)})


class Count:
    """Counter of the points done of all fidelities, with a progress callback."""

    def __init__(self, branches: Iterable[StoredBranch], progress: Progress) -> None:
        kept = list(branches)
        self._lock = Lock()
        self._progress = progress
        self.done = sum(part.done for part in kept)
        self.total = sum(len(part.response) for part in kept)
        self._progress(self.done, self.total)

    def add(self, points: int) -> None:
        """Count further points."""
        with self._lock:
            self.done += points
            self._progress(self.done, self.total)
