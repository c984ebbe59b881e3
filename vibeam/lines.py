"""Which line of a TOML text holds which key.

The standard parser keeps no positions. The text has passed it already, so that this scan meets valid TOML only: it
knows just enough of the grammar not to be fooled by strings, comments and nested values.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from typing import Any

KeyPath = tuple[str | int, ...]

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


class _Scan:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.found: dict[KeyPath, int] = {}
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
            self.at = self.past(_STRING if first in "\"'" else _PLAIN)

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
