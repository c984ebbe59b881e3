"""File of steps: records of one computation, appended as they are made, each sealed, so that a kill loses none before.

A file begins with a line that says what it is of; a record is a line with the number of its step and its length, the
arrays, and a SHA-256 of that line, of them and of the file's first line.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from vibeam.exchange.whole_files import LENGTH, closing, open_own, read_at, seal_of, write_at
from vibeam.store.blocks import Values, packed, unpacked
from vibeam.store.errors import ROOM, StoreError, reason, writing

RECORD = re.compile(rb"step (\d{10}) (\d{14})\n")
FIRST = re.compile(rb"vibeam steps \d+:")  # of any layout: what another version has computed is not ours to cut off
LONGEST = 10_000  # bytes of the first line
HEAD = len("step  \n") + 24


@dataclass
class StepFile:
    """File at ``path`` of steps ``of`` one thing: ``places`` of the whole ones by number, and where they ``end``.

    ``foreign``: its first line, where that is of something else; ``damaged``: number of records that are not whole.
    """

    path: Path
    of: bytes
    places: dict[int, tuple[int, int]] = field(default_factory=dict)
    end: int = 0
    damaged: int = 0
    foreign: bytes = b""

    def read(self, number: int) -> Values | None:
        """Values of a step; None where it is not there, or was damaged meanwhile."""
        with suppress(OSError, KeyError), open(open_own(self.path), "rb") as file:
            content = self._content(file.fileno(), number, *self.places[number])
            return None if content is None else unpacked(content)
        return None

    def _content(self, handle: int, number: int, start: int, length: int) -> bytes | None:
        whole = read_at(handle, length + LENGTH, start)
        content, said = whole[:length], whole[length:]
        return content if said == seal_of([_head(number, length), content], self.of.decode()) else None

    def append(self, said: Path, number: int, values: Values, sync: bool = True) -> None:
        """Write a step behind what is there; StoreError, naming ``said``, where it fails.

        With ``sync`` all that was written is on disk when this returns; else it outlives the process, not the machine.
        """
        content = packed(values)
        head = _head(number, len(content))
        record = b"".join((head, content, seal_of([head, content], self.of.decode())))
        first = b"" if self.end else self.of
        with writing(said, ROOM), closing(open_own(self.path, os.O_RDWR | os.O_CREAT)) as handle:
            os.ftruncate(handle, self.end)
            write_at(handle, self.end, first + record)
            if sync:
                os.fsync(handle)
        start = self.end + len(first)
        self.places[number], self.end = (start + HEAD, len(content)), start + len(record)


def _head(number: int, length: int) -> bytes:
    return b"step %010d %014d\n" % (number, length)


def scanned(path: Path, of: bytes) -> StepFile:
    """The file at ``path`` with its whole records, empty where there is none; StoreError where it cannot be read."""
    found = StepFile(path, of)
    try:
        with open(open_own(path), "rb") as file:
            size, handle, line = os.fstat(file.fileno()).st_size, file.fileno(), file.readline(LONGEST)
            if line != of:
                found.foreign = line if FIRST.match(line) and line.endswith(b"\n") else b""
                found.damaged = int(size > 0)
                return found
            found.end = len(of)
            while (head := RECORD.fullmatch(read_at(handle, HEAD, found.end))) is not None:
                number, length, start = int(head[1]), int(head[2]), found.end + HEAD
                if start + length + LENGTH > size:
                    break
                whole = found._content(handle, number, start, length) is not None
                found.damaged += not whole
                if whole:
                    found.places[number] = start, length
                found.end = start + length + LENGTH
            found.damaged += found.end < size
    except FileNotFoundError:
        pass
    except OSError as fault:
        raise StoreError(f"{path}: cannot be read ({reason(fault)}): make it readable") from None
    return found
