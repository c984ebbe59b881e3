"""Files of Nastran as its manual describes OUTPUT4 and OUTPUT2, written number by number; whether they can be read."""

import struct
from collections.abc import Iterator
from importlib import import_module

import numpy as np
import pytest

TYPES = {"f4": 1, "f8": 2}
LABELS = [""] * 48  # title, subtitle and label of a table


def by_pynastran(module: str) -> pytest.MarkDecorator:
    """Mark of a test that needs a module of pyNastran, which asks for numpy below 2."""
    missing = ""
    try:
        import_module(f"pyNastran.{module}")
    except (ImportError, AttributeError):
        missing = f"pyNastran.{module}, the extra fe, cannot be imported with numpy {np.__version__}"
    return pytest.mark.skipif(bool(missing), reason=missing)


OP2, OP4 = by_pynastran("op2.op2"), by_pynastran("op4.op4")
Strings = list[tuple[int, list[float]]]  # first row from 1, and the numbers below


def strings_of(column: np.ndarray, sparse: bool) -> Strings:
    """What a column holds: of a full one all from the first number that is not 0 to the last, of a sparse one runs."""
    there = np.flatnonzero(column)
    if not len(there):
        return []
    if not sparse:
        return [(int(there[0]) + 1, column[there[0] : there[-1] + 1].tolist())]
    runs = np.split(there, np.flatnonzero(np.diff(there) > 1) + 1)
    return [(int(run[0]) + 1, column[run].tolist()) for run in runs]


def record(content: bytes, order: str) -> bytes:
    """A record of Fortran."""
    return struct.pack(f"{order}i", len(content)) + content + struct.pack(f"{order}i", len(content))


def op4_binary(
    matrices: dict[str, tuple[int, np.ndarray]], *, sparse: bool = False, big: bool = False, kind: str = "f8",
    order: str = "<",
) -> bytes:  # fmt: skip
    """OUTPUT4 in binary of matrices by name, each with its form."""
    found = b""
    for name, (form, matrix) in matrices.items():
        rows, columns = matrix.shape
        head = struct.pack(f"{order}4i", columns, -rows if big else rows, form, TYPES[kind])
        found += record(head + name.ljust(8).encode(), order)
        for index, column in enumerate(matrix.T, 1):
            words = b""
            strings = strings_of(column, sparse)
            for row, numbers in strings:
                data = np.array(numbers, f"{order}{kind}").tobytes()
                length = len(data) // 4
                if sparse:
                    words += struct.pack(f"{order}2i", length + 1, row) if big else b""
                    words += b"" if big else struct.pack(f"{order}i", 65536 * (length + 1) + row)
                words += data
            if strings:
                start = struct.pack(f"{order}3i", index, 0 if sparse else strings[0][0], len(words) // 4)
                found += record(start + words, order)
        last = np.array([1.0], f"{order}{kind}").tobytes()
        found += record(struct.pack(f"{order}3i", columns + 1, 1, len(last) // 4) + last, order)
    return found


def op4_text(
    matrices: dict[str, tuple[int, np.ndarray]], *, sparse: bool = False, big: bool = False, kind: str = "f8",
    exponent: str = "E",
) -> str:  # fmt: skip
    """OUTPUT4 in text; the exponent as Fortran has it (``"E"``, ``"D"``)."""
    found = []
    for name, (form, matrix) in matrices.items():
        rows, columns = matrix.shape
        found.append(f"{columns:8}{-rows if big else rows:8}{form:8}{TYPES[kind]:8}{name:8}1P,3E24.16")
        for index, column in enumerate(matrix.T, 1):
            strings = strings_of(column, sparse)
            words = [len(numbers) * TYPES[kind] for _, numbers in strings]
            if sparse and strings:
                found.append(f"{index:8}{0:8}{sum(words) + (1 + big) * len(words):8}")
            for (row, numbers), length in zip(strings, words, strict=True):
                small = f"{65536 * (length + 1) + row:12}"
                found.append((f"{length + 1:8}{row:8}" if big else small) if sparse else f"{index:8}{row:8}{length:8}")
                fields = [f"{number:24.16E}".replace("E", exponent) for number in numbers]
                found += ["".join(fields[at : at + 3]) for at in range(0, len(fields), 3)]
        found += [f"{columns + 1:8}{1:8}{1:8}", f"{1.0:24.16E}"]
    return "\n".join(found) + "\n"


class Output2:
    """OUTPUT2 in an ``order`` of bytes, block by block."""

    size = 4  # bytes of a word

    def __init__(self, order: str = "<") -> None:
        self.order, self.blocks = order, b""
        self.head()

    @property
    def content(self) -> bytes:
        """The whole file."""
        return self.blocks + record(self.words(0), self.order)

    def words(self, *values: float | str) -> bytes:
        """Words of numbers and of names of eight letters."""
        return b"".join(self._word(value) for value in values)

    def _word(self, value: float | str) -> bytes:
        if isinstance(value, str):
            return value.ljust(2 * self.size).encode()
        return struct.pack(self.order + "if"[isinstance(value, float)], value)

    def _put(self, content: bytes) -> None:
        self.blocks += record(content, self.order)

    def data(self, content: bytes, uncounted: int = 0) -> None:
        """A key and the words after it, of which so many are not counted."""
        self._put(self.words(len(content) // self.size - uncounted))
        self._put(content)

    def head(self, version: str = "NX12") -> None:
        """The label of PARAM, POST, -1."""
        self.data(self.words(11, 25, 26))
        self.data(b"NASTRAN FORT TAPE ID CODE - ")
        self.data(self.words(version))
        self._put(self.words(-1))
        self._put(self.words(0))

    def block(self, name: str, trailer: tuple[int, ...], logical: Iterator[list[tuple[bytes, int]]], kind: int) -> None:
        """Data block of logical records, each of the records that it is made of with their uncounted words."""
        self.data(self.words(name))
        self._put(self.words(-1))
        self.data(self.words(*trailer))
        self._put(self.words(-2))
        for number, parts in enumerate([[(self.words(name), 0)], *logical], 3):
            self.data(self.words(kind if number > 3 else 0))
            for part, uncounted in parts:
                self.data(part, uncounted)
            self._put(self.words(-number))
        self.data(self.words(0))
        self._put(self.words(0))

    def matrix(self, name: str, form: int, matrix: np.ndarray, kind: str = "f8") -> None:
        """A matrix, column by column, in strings."""
        real = self.order + kind
        columns = (
            [(self.words(row) + np.array(numbers, real).tobytes(), 1) for row, numbers in strings_of(column, True)]
            for column in matrix.T
        )
        self.block(name, (101, matrix.shape[1], matrix.shape[0], form, TYPES[kind], 0, 0), columns, 1)

    def table(self, name: str, records: list[bytes]) -> None:
        """A table of logical records, each cut in two where it is long."""
        halves = ([part for part in (each[:400], each[400:]) if part] for each in records)
        self.block(name, (101, 0, 0, 0, 0, 0, 0), ([(part, 0) for part in parts] for parts in halves), 0)

    def modes(
        self, eigenvalues: list[float], shapes: np.ndarray, points: list[tuple[int, int]], *,
        masses: list[float] | None = None, name: str = "OUGV1", approach: int = 2, subcase: int = 1,
    ) -> None:  # fmt: skip
        """Eigenvectors (modes, points, 6) at points with their types, and the table of generalised masses."""
        if masses:
            rows = [
                self.words(number, number, value, value**0.5, value**0.5 / 6.28, mass, value * mass)
                for number, (value, mass) in enumerate(zip(eigenvalues, masses, strict=True), 1)
            ]
            self.table("LAMA", [self.words(21, 6, *[0] * 48, *LABELS), b"".join(rows)])
        records = []
        for number, (value, shape) in enumerate(zip(eigenvalues, shapes, strict=True), 1):
            records.append(
                self.words(10 * approach + 1, 7, 0, subcase, number, value, 0.0, 0, 1, 8, *[0] * 40, *LABELS)
            )
            both = zip(points, shape.tolist(), strict=True)
            records.append(b"".join(self.words(10 * point + 1, kind, *each) for (point, kind), each in both))
        self.table(name, records)
