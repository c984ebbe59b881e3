"""Standard streams of the command: any encoding, closed readers, no control characters."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

from vibeam.exchange.faults import printable
from vibeam.exchange.whole_files import naming_stdout

MISSED, WRONG, STOPPED = 1, 2, 130  # exit codes
CLOSED = 141  # exit code of a command whose reader has gone, as a shell reports it


@contextmanager
def standard_streams() -> Iterator[None]:
    """Let stdout and stderr take any text, with escapes where needed; exit silently where stdout's reader has gone."""
    for name in ("stdout", "stderr"):
        _open(name)
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        reader_gone()
    except OSError as error:  # of stdout only: errors elsewhere are reported already
        discard_stdout()
        say(f"stdout: {(error.strerror or str(error)).lower()}")
        raise SystemExit(WRONG) from None


def _open(name: str) -> None:
    stream = getattr(sys, name)
    if stream is None:  # closed by the caller
        setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    elif isinstance(stream, io.TextIOWrapper):
        stream.reconfigure(errors="backslashreplace")


def reader_gone() -> NoReturn:
    """Exit because nobody reads stdout (``vibeam keys | head``)."""
    discard_stdout()
    raise SystemExit(CLOSED) from None


def discard_stdout() -> None:
    """Redirect pending output to nowhere: the interpreter flushes once more at its end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def say(text: str) -> None:
    """Print lines on stderr, control characters as escapes."""
    print("\n".join(map(printable, text.split("\n"))), file=sys.stderr)


def put(text: str) -> None:
    """Print lines on stdout, control characters as escapes."""
    with naming_stdout():
        print("\n".join(map(printable, text.split("\n"))))


def tell(said: str) -> None:
    """Print a line on stderr, unless the command is quiet."""
    from vibeam.cli.progress import stderr

    stderr().print(said)


def put_json(text: str) -> None:
    """Print JSON on stdout; what the stream cannot take, and control characters, as JSON's own escapes."""
    unicode = (sys.stdout.encoding or "utf-8").lower().startswith("utf")
    plain = (each == "\n" or (each.isprintable() and (unicode or each.isascii())) for each in text)
    with naming_stdout():
        print("".join(each if kept else json.dumps(each)[1:-1] for each, kept in zip(text, plain, strict=True)))
