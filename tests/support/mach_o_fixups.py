"""Exports and fixups of macOS's dynamic libraries: what the loader writes into them, as opcodes or as chains."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass


class Unreadable(Exception):
    """Why it is no library that the system would load, or none that is understood here."""


def demand(fits: bool, fault: str) -> None:
    """Unreadable where it does not fit."""
    if not fits:
        raise Unreadable(fault)


@dataclass(frozen=True)
class Binding:
    """A place in memory that becomes the address of a symbol of the needed library with that number, from 1."""

    address: int
    library: int
    name: str
    addend: int


def text(content: bytes, at: int) -> str:
    """The name that begins there and ends with a zero."""
    return content[at : content.index(b"\0", at)].decode()


def _uleb(content: bytes, at: int) -> tuple[int, int]:
    """A number of 7 bits a byte, and where it ends."""
    value = shift = 0
    while True:
        byte = content[at]
        value, shift, at = value | (byte & 127) << shift, shift + 7, at + 1
        if byte < 128:
            return value, at


def exported(trie: bytes, at: int = 0, name: str = "", depth: int = 0) -> Iterator[tuple[str, int]]:
    """Names and addresses below a node of the tree of exports."""
    demand(depth < 200, "the tree of exports has a circle")
    length, at = _uleb(trie, at)
    if length:
        flags, inner = _uleb(trie, at)
        demand(flags == 0, f"{name}: an export of kind {flags}")
        yield name, _uleb(trie, inner)[0]
    at += length
    branches, at = trie[at], at + 1
    for _ in range(branches):
        part = text(trie, at)
        node, at = _uleb(trie, at + len(part) + 1)
        yield from exported(trie, node, name + part, depth + 1)


def rebases(begins: Sequence[int], codes: bytes) -> Iterator[int]:
    """Addresses of the pointers into the library itself, whose segments have these first addresses."""
    at = address = 0
    while at < len(codes):
        code, low = codes[at] & 0xF0, codes[at] & 0xF
        at, count, skipped = at + 1, 0, 0
        if code == 0x00:
            return
        if code == 0x10:
            demand(low == 1, "a rebase that is no pointer")
        elif code == 0x20:
            offset, at = _uleb(codes, at)
            address = begins[low] + offset
        elif code == 0x30:
            offset, at = _uleb(codes, at)
            address += offset
        elif code == 0x40:
            address += 8 * low
        elif code == 0x50:
            count = low
        elif code == 0x60:
            count, at = _uleb(codes, at)
        elif code == 0x70:
            count, (skipped, at) = 1, _uleb(codes, at)
        elif code == 0x80:
            count, at = _uleb(codes, at)
            skipped, at = _uleb(codes, at)
        else:
            raise Unreadable(f"an opcode {code:#x} of rebases")
        for _ in range(count):
            yield address
            address += 8 + skipped


def bindings(begins: Sequence[int], codes: bytes, *, lazy: bool) -> Iterator[Binding]:
    """Pointers to other libraries' symbols; lazy ones, which the system may leave until the first call, as well."""
    at = address = library = addend = 0
    name = ""
    while at < len(codes):
        code, low = codes[at] & 0xF0, codes[at] & 0xF
        at, count, skipped = at + 1, 0, 0
        if code == 0x00 and not lazy:
            return
        if code == 0x10:
            library = low
        elif code == 0x20:
            library, at = _uleb(codes, at)
        elif code == 0x40:
            demand(low == 0, "a weak binding")
            name = text(codes, at)
            at += len(name) + 1
        elif code == 0x50:
            demand(low == 1, "a binding that is no pointer")
        elif code == 0x60:
            addend, at = _uleb(codes, at)
            demand(addend < 64, "a long or negative addend")
        elif code == 0x70:
            offset, at = _uleb(codes, at)
            address = begins[low] + offset
        elif code == 0x80:
            offset, at = _uleb(codes, at)
            address = (address + offset) % (1 << 64)
        elif code == 0x90:
            count = 1
        elif code == 0xA0:
            count, (skipped, at) = 1, _uleb(codes, at)
        elif code == 0xB0:
            count, skipped = 1, 8 * low
        elif code == 0xC0:
            count, at = _uleb(codes, at)
            skipped, at = _uleb(codes, at)
        elif code:
            raise Unreadable(f"an opcode {code:#x} of bindings")
        for _ in range(count):
            yield Binding(address, library, name, addend)
            address = (address + 8 + skipped) % (1 << 64)


def chained(fixups: bytes, value: Callable[[int], int]) -> tuple[dict[int, int], list[Binding]]:
    """Pointers into the library with what they hold before sliding, and those to others' symbols.

    As newer linkers write them: each pointer tells how far the next is. ``value`` gives the 8 bytes at an address.
    """
    version, starts, imports, names, count, form, packed = struct.unpack_from("<7I", fixups)
    demand((version, form, packed) == (0, 1, 0), "chained fixups of another version")
    wanted = struct.unpack_from(f"<{count}I", fixups, imports)
    rebased, bound = dict[int, int](), list[Binding]()
    for address in _chains(fixups, starts):
        step = 1
        while step:
            here = value(address)
            if here >> 63:
                entry = wanted[here & 0xFFFFFF]
                name = text(fixups, names + (entry >> 9))
                bound.append(Binding(address, entry & 255, name, here >> 24 & 255))
            else:
                demand(here >> 36 & 255 == 0, "a pointer with a high byte")
                rebased[address] = here & (1 << 36) - 1
            step = here >> 51 & 0xFFF
            address += 4 * step
    return rebased, bound


def _chains(fixups: bytes, starts: int) -> Iterator[int]:
    """The first address of each page's chain."""
    [number] = struct.unpack_from("<I", fixups, starts)
    for offset in struct.unpack_from(f"<{number}I", fixups, starts + 4):
        if not offset:
            continue
        _, page, kind, first, _, pages = struct.unpack_from("<IHHQIH", fixups, starts + offset)
        demand(kind in (2, 6), f"chains of pointers of kind {kind}")
        for i, begin in enumerate(struct.unpack_from(f"<{pages}H", fixups, starts + offset + 22)):
            if begin != 0xFFFF:
                yield first + i * page + begin
