"""Counts that files of meshes declare, looked at before meshio takes memory, or turns, for them.

Counts of numbers that follow need none: np.fromfile takes no memory for what is not there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import prod
from struct import unpack_from

import numpy as np

from vibeam.exchange.files import shown, whole

MOST = 5_000_000  # nodes, or cells, of which a mesh of a million nodes has fewer
NODES = dict(enumerate((2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13), 1))  # of Gmsh's elements


def require_counts(content: bytes, name: str) -> None:
    """ValueError where a file of the format that meshio calls ``name`` says that it has more than is read."""
    for count in {"gmsh": _gmsh, "vtk": _vtk, "vtu": _vtu, "medit": _medit}[name](content):
        if count > MOST:
            raise ValueError(f"it says {count}, and a mesh may have {MOST} nodes or cells at most")


def _numbers(words: bytes) -> list[int]:
    """The whole numbers among words, in digits of ASCII alone."""
    return [whole(each.decode("latin1")) for each in words.split() if not each[:1].isalpha()]


def _medit(content: bytes) -> Iterator[int]:
    for count in re.findall(rb"(?m)^[ \t]*[A-Za-z]+\s+([^\sA-Za-z\"']\S*)", content):
        yield from _numbers(count)


def _vtu(content: bytes) -> Iterator[int]:
    if b"faceoffsets" in content:
        raise ValueError("it has polyhedra")
    yield 0


def _vtk(content: bytes) -> Iterator[int]:
    """Counts, and the nodes of a grid, which are as many as the product of those along its axes."""
    found = re.findall(rb"(?mi)^[ \t]*((?:POINT|CELL)S?(?:_\w+)?|[XYZ]_COORDINATES|DIMENSIONS)[ \t]([^\r\n]*)", content)
    along = [count for name, line in found if b"COORD" in name.upper() for count in _numbers(line)]
    for name, line in found:
        yield prod(_numbers(line)[: 3 if name.upper() == b"DIMENSIONS" else 1])
    yield prod(along)


def _gmsh(content: bytes) -> Iterator[int]:
    head = re.search(rb"\$MeshFormat\s+([24])(?:(?<=2)\.[0-2]|(?<=4)\.1)? ([01]) 8\s", content)
    if head is None:
        raise ValueError("it is none of Gmsh's versions 2 and 4.1")
    for name, body in re.findall(rb"(?s)\$(Nodes|Elements)\r?\n(.*?)\$End\1", content):
        if head[2] == b"0":
            if wrong := re.search(rb"\S*[^\s0-9.eE+-]\S*", body):
                raise ValueError(f"{shown(wrong[0].decode('latin1'))} is no number")
            large = 9 if name == b"Nodes" else 7  # digits, since nodes have coordinates beside their numbers
            yield from map(int, re.findall(rb"(?<![\w.])[0-9]{%d,}(?![\w.])" % large, body))
        elif head[1] == b"2":
            yield from _numbers(body.partition(b"\n")[0])
        else:
            yield from _blocks(body, name == b"Nodes")


def _blocks(body: bytes, nodes: bool) -> Iterator[int]:
    """Counts in the blocks of a binary section of version 4.1, and the highest number of a node in each."""
    at, counts = 32, unpack_from("<QQ", body)
    yield max(counts)
    for _ in range(counts[0]):
        *_, kind, count = unpack_from("<iiiQ", body, at)
        yield count
        if nodes:
            yield int(np.frombuffer(body, "<u8", count, at + 20).max(initial=0))
        at += 20 + 8 * count * (4 if nodes else 1 + NODES.get(kind, 0))
