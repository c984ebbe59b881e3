"""The text of a case file: read without surprises, parsed with lines."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from pathlib import Path as File
from typing import Any

from vibeam.faults import CaseError, Fault
from vibeam.lines import KeyPath, key_lines

TOO_DEEP = "is nested too deeply for a case"
LARGEST = 1_000_000  # bytes; a case is a page or two
DEEPEST = 20  # tables and lists within each other
_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{DEEPEST},}}+")
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def read_text(file: File) -> str:
    """The text of a case file; CaseError if there is none to read."""
    try:
        content = _content(file)
    except OSError as error:
        raise _refusal(file, f"cannot be read: {error.strerror}") from None
    if content.startswith(_UTF_16):
        raise _refusal(file, "is UTF-16 text: save it as UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _refusal(file, f"is not text: byte {error.start + 1} is not UTF-8; a case is a TOML file") from None


def parsed(text: str, file: File) -> tuple[dict[str, Any], dict[KeyPath, int]]:
    """The tables of a TOML text, and the line of each key; CaseError if it is no TOML or empty."""
    if len(text) > LARGEST:
        raise _too_large(file, len(text))
    if long := LONG_KEY.search(text):  # the parser's time grows with the square of the parts
        raise CaseError([Fault(str(file), text.count("\n", 0, long.start()) + 1, "", TOO_DEEP)])
    try:
        tables = tomllib.loads(text)
        lines = key_lines(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError([_syntax(file, text, str(error))]) from None
    except RecursionError:
        raise _refusal(file, TOO_DEEP) from None
    except ValueError:  # Python's own limit on the digits of a whole number
        raise _refusal(file, "holds a number of thousands of digits") from None
    if not tables:
        raise _refusal(file, "is empty: a case has [beam] or [sdof], [stop], [drive], [sweep] and [fidelity.NAME]")
    if deep := too_deep(tables):
        raise CaseError([Fault(str(file), lines.get(deep[:1]), str(deep[0]), TOO_DEEP)])
    return tables, lines


def too_deep(value: Any) -> KeyPath:
    """The path to a table or list that lies deeper in a value than any of a case; empty: none does."""
    level: list[tuple[KeyPath, Any]] = [((), value)]
    for _ in range(DEEPEST):
        level = [((*path, key), inner) for path, one in level for key, inner in _items(one)]
        level = [(path, one) for path, one in level if isinstance(one, dict | list)]
    return level[0][0] if level else ()


def _items(value: Any) -> Iterable[tuple[str | int, Any]]:
    return value.items() if isinstance(value, dict) else enumerate(value)


def _content(file: File) -> bytes:
    if file.is_dir():
        raise _refusal(file, "is a directory, not a case file")
    if not file.exists():
        raise _refusal(file, "no such file")
    if not file.is_file():
        raise _refusal(file, "is not a file")
    if file.stat().st_size > LARGEST:
        raise _too_large(file, file.stat().st_size)
    return file.read_bytes()


def _too_large(file: File, size: int) -> CaseError:
    return _refusal(file, f"has {size / 1e6:.1f} MB; a case has at most {LARGEST / 1e6:.0f} MB")


def _refusal(file: File, message: str) -> CaseError:
    return CaseError([Fault(str(file), None, "", message)])


def _syntax(file: File, text: str, message: str) -> Fault:
    at = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", message)
    line = int(at[1]) if at and at[1] else text.count("\n") + 1
    column = f" at column {at[2]}" if at and at[2] else ""
    return Fault(str(file), line, "", f"not TOML{column}: {message[: at.start()] if at else message}")
