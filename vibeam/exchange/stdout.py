"""Standard output: what cannot be written there names it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

STDOUT = "stdout"  # in place of a file's name


@contextmanager
def naming_stdout() -> Iterator[None]:
    """Context of what is printed on stdout: an OSError names that, as it names a file."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, STDOUT) from None
