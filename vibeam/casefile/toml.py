"""The text of a case file: read without surprises, parsed with lines."""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from pathlib import Path as File
from typing import Any

from vibeam.exchange.faults import CaseError, Fault, KeyPath

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = re.compile(r"""(?:[ \t]*(?:[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')[ \t]*\.?)+""")

_STRING = re.compile(
    r'''"""(?:[^\\]|\\.)*?"{3,5}(?!")|\'\'\'.*?'{3,5}(?!')|"(?:[^"\\\n]|\\.)*"|'[^'\n]*\'''', re.DOTALL
)

_PLAIN = re.compile(r"[^,\]}\n#]+")


def key_lines(text: str) -> dict[KeyPath, int]:
    """Line (from 1) of every key and table of a valid TOML text.

    Paths are tuples: ``("beam", "length")``, ``("added_mass", 0, "mass")``. A table opened by its content alone has the
    line of its first key.
    """
    return _Scan(text).lines()


def value_spans(text: str) -> tuple[dict[KeyPath, tuple[int, int]], dict[KeyPath, int]]:
    """Begin and end in a valid TOML text of every value that is no table or list; end of every table's header."""
    scan = _Scan(text)
    scan.lines()
    return scan.spans, scan.headers


class _Scan:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.found: dict[KeyPath, int] = {}
        self.spans: dict[KeyPath, tuple[int, int]] = {}
        self.headers: dict[KeyPath, int] = {}
        self.lengths: dict[KeyPath, int] = {}  # of the arrays of tables
        self.starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def lines(self) -> dict[KeyPath, int]:
        table: KeyPath = ()
        while self.skip():
            if self.text[self.at] == "[":
                table = self.header()
            else:
                self.pair(table)
        return self.found

    def skip(self) -> bool:
        """Pass blanks and comments; whether anything is left."""
        self.at = self.past(_BLANK)
        return self.at < len(self.text)

    def past(self, pattern: re.Pattern[str]) -> int:
        found = pattern.match(self.text, self.at)
        return found.end() if found else self.at

    def header(self) -> KeyPath:
        line, brackets = self.line(), 2 if self.text.startswith("[[", self.at) else 1
        self.at += brackets
        parts = self.key()
        self.at += brackets
        table = self.inside(parts[:-1])
        if brackets == 2:
            array = (*table, parts[-1])
            self.lengths[array] = self.lengths.get(array, 0) + 1
        table = self.inside(parts)
        self.note(table, line)
        self.found[table] = line
        self.headers[table] = self.at
        return table

    def inside(self, parts: list[str]) -> KeyPath:
        """The path of a header's key: a name that is an array of tables means its last table."""
        path: KeyPath = ()
        for part in parts:
            path = (*path, part)
            if path in self.lengths:
                path = (*path, self.lengths[path] - 1)
        return path

    def pair(self, table: KeyPath) -> None:
        line = self.line()
        path = (*table, *self.key())
        self.note(path, line)
        self.at += 1  # the equals sign
        self.value(path)

    def value(self, path: KeyPath) -> None:
        self.skip()
        first = self.text[self.at]
        if first == "[":
            self.items(path, "]")
        elif first == "{":
            self.items(path, "}")
        else:
            begin, self.at = self.at, self.past(_STRING if first in "\"'" else _PLAIN)
            self.spans[path] = begin, begin + len(self.text[begin : self.at].rstrip())

    def items(self, path: KeyPath, end: str) -> None:
        """An array's values or an inline table's pairs, with the brackets around them."""
        self.at += 1
        index = 0
        while self.skip() and self.text[self.at] != end:
            if self.text[self.at] == ",":
                self.at += 1
            elif end == "}":
                self.pair(path)
            else:
                self.note((*path, index), self.line())
                self.value((*path, index))
                index += 1
        self.at += 1

    def key(self) -> list[str]:
        start = self.at
        self.at = self.past(_KEY)
        return key_parts(self.text[start : self.at])

    def line(self) -> int:
        return bisect_right(self.starts, self.at)

    def note(self, path: KeyPath, line: int) -> None:
        """Keep the line, for the tables above too where they have none yet."""
        for length in range(1, len(path) + 1):
            self.found.setdefault(path[:length], line)


def key_parts(key: str) -> list[str]:
    """The names of a dotted TOML key, quotes resolved: ``'a."b.c"'`` is ``["a", "b.c"]``; ValueError if it is none."""
    if re.fullmatch(r"[A-Za-z0-9_-]+(?:\.[A-Za-z0-9_-]+)*", key):
        return key.split(".")
    if "\n" in key:
        raise ValueError("a key holds no line break")
    value: Any = tomllib.loads(f'{key} = "here"')
    parts: list[str] = []
    while isinstance(value, dict):
        parts += list(value)[:1]
        value = value[parts[-1]] if len(value) == 1 else None
    if value != "here":
        raise ValueError("this is more than a key")
    return parts


TOO_DEEP = "is nested too deeply for a case"
LARGEST = 1_000_000  # bytes; a case is a page or two
DEEPEST = 20  # tables and lists within each other
_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{DEEPEST},}}+")
_HDF5 = b"\x89HDF\r\n\x1a\n"
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


def parsed(text: str, file: File) -> dict[str, Any]:
    """The tables of a TOML text; CaseError if it is no TOML or empty."""
    if len(text) > LARGEST:
        raise _too_large(file, len(text))
    if long := LONG_KEY.search(text):  # the parser's time grows with the square of the parts
        raise CaseError([Fault(str(file), text.count("\n", 0, long.start()) + 1, "", TOO_DEEP)])
    try:
        tables = tomllib.loads(text)
        deep = too_deep(tables)
        line = key_lines(text).get(deep[:1]) if deep else None
    except tomllib.TOMLDecodeError as error:
        raise CaseError([_syntax(file, text, str(error))]) from None
    except RecursionError:
        raise _refusal(file, TOO_DEEP) from None
    except ValueError:  # Python's own limit on the digits of a whole number
        raise _refusal(file, "holds a number of thousands of digits") from None
    if not tables:
        raise _refusal(file, "is empty: a case has [beam] or [sdof], [stop], [drive], [sweep] and [fidelity.NAME]")
    if deep:
        raise CaseError([Fault(str(file), line, str(deep[0]), TOO_DEEP)])
    return tables


def too_deep(value: Any) -> KeyPath:
    """The path to a table or list that lies deeper in a value than any of a case; empty: none does."""
    level: list[tuple[KeyPath, Any]] = [((), value)]
    for _ in range(DEEPEST):
        level = [
            ((*path, key), inner)
            for path, one in level
            for key, inner in (one.items() if isinstance(one, dict) else enumerate(one))
            if isinstance(inner, dict | list)
        ]
    return level[0][0] if level else ()


def _content(file: File) -> bytes:
    if file.is_dir():
        raise _refusal(file, "is a directory, not a case file")
    if not file.exists():
        raise _refusal(file, "no such file")
    if not file.is_file():
        raise _refusal(file, "is not a file")
    if _begins_as_hdf5(file):
        raise _refusal(file, f"is a results file (HDF5), not a case: vibeam report {file.name} reads it")
    if file.stat().st_size > LARGEST:
        raise _too_large(file, file.stat().st_size)
    return file.read_bytes()


def _begins_as_hdf5(file: File) -> bool:
    with file.open("rb") as opened:
        return opened.read(len(_HDF5)) == _HDF5


def _too_large(file: File, size: int) -> CaseError:
    return _refusal(file, f"has {size / 1e6:.1f} MB; a case has at most {LARGEST / 1e6:.0f} MB")


def _refusal(file: File, message: str) -> CaseError:
    return CaseError([Fault(str(file), None, "", message)])


def _syntax(file: File, text: str, message: str) -> Fault:
    at = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", message)
    line = int(at[1]) if at and at[1] else text.count("\n") + 1
    column = f" at column {at[2]}" if at and at[2] else ""
    return Fault(str(file), line, "", f"not TOML{column}: {message[: at.start()] if at else message}")
