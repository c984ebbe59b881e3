"""Progress of a long computation: told to the caller's function, or shown as a bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import ParamSpec

from vibeam.system.public_names import handed_in

Told = ParamSpec("Told")


@contextmanager
def telling(progress: Callable[Told, None] | bool | None, doing: str) -> Iterator[Callable[Told, None]]:
    """Function that is told how far ``doing`` something is: ``progress`` itself; True: a bar; None, False: nothing."""
    if not (callable(progress) or progress is None or isinstance(progress, bool)):
        raise ValueError(f"progress: {progress!r} must be True, a bar, or a function that is told, or None")
    if progress is True:
        with handed_in("bar")(doing) as bar:
            yield bar
    else:
        yield progress or (lambda *told, **more: None)
