"""Reader of macOS's dynamic libraries (Mach-O), as far as that system's loader reads them.

Segments, the fixups of both kinds (opcodes, chains), exports, needed libraries, the lowest system and the pages'
digests of the signature: so that libraries linked for it can be judged, and mapped, without it. ``Unreadable`` where
that loader would refuse, or where something stands in the file that is not known here.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from hashlib import sha256
from itertools import pairwise

from mach_o_fixups import Binding, Unreadable, bindings, chained, demand, exported, rebases, text

PROCESSORS = {0x01000007: "x86_64", 0x0100000C: "arm64"}
PAGE = {"x86_64": 0x1000, "arm64": 0x4000}  # bytes
DYLIB, MACOS = 6, 1  # kinds of file and of system
SEGMENT, SYMBOLS, DYNAMIC_SYMBOLS, NEEDED, OWN_NAME, UUID = 0x19, 0x2, 0xB, 0xC, 0xD, 0x1B
SIGNATURE, BUILT_FOR, OPCODES, CHAINS, EXPORTS = 0x1D, 0x32, 0x80000022, 0x80000034, 0x80000033
NOT_READ = {0x26: "function starts", 0x29: "data in code", 0x2A: "version of the sources"}
READ, WRITE, EXECUTE = 1, 2, 4
AD_HOC, LINKER_SIGNED = 0x2, 0x20000


@dataclass(frozen=True)
class Segment:
    """Bytes of the file and where in memory they are mapped."""

    name: str
    address: int
    size: int
    at: int  # in the file
    filled: int  # bytes in the file
    protection: int


@dataclass
class MachO:
    """A library of macOS."""

    content: bytes
    processor: str
    commands: list[tuple[int, bytes]]
    segments: list[Segment] = field(default_factory=list)
    exports: dict[str, int] = field(default_factory=dict)  # name: address
    bindings: list[Binding] = field(default_factory=list)
    rebased: dict[int, int] = field(default_factory=dict)  # address: the address that it holds, before sliding

    def of(self, command: int) -> list[bytes]:
        """Load commands of a kind, without their first eight bytes."""
        return [body for kind, body in self.commands if kind == command]

    def one(self, command: int) -> bytes:
        """The only command of that kind."""
        found = self.of(command)
        demand(len(found) == 1, f"{len(found)} load commands {command:#x}")
        return found[0]

    @property
    def needed(self) -> list[str]:
        """Names of the libraries that it needs."""
        return [text(body, struct.unpack_from("<I", body)[0] - 8) for body in self.of(NEEDED)]

    @property
    def name(self) -> str:
        """Its own name."""
        body = self.one(OWN_NAME)
        return text(body, struct.unpack_from("<I", body)[0] - 8)

    @property
    def lowest(self) -> str:
        """The lowest macOS that loads it."""
        system, lowest = struct.unpack_from("<2I", self.one(BUILT_FOR))
        demand(system == MACOS, f"built for system {system}, not macOS")
        return f"{lowest >> 16}.{lowest >> 8 & 255}"

    def segment_at(self, address: int, length: int = 8) -> Segment:
        """The segment which has these bytes, filled from the file."""
        for each in self.segments:
            if each.address <= address and address + length <= each.address + each.filled:
                return each
        raise Unreadable(f"{address:#x} is in no segment")

    def value(self, address: int) -> int:
        """The 8 bytes at an address, as they stand in the file."""
        place = self.segment_at(address)
        return int(struct.unpack_from("<Q", self.content, place.at + address - place.address)[0])

    def symbols(self) -> tuple[set[str], set[str]]:
        """Names in the table of symbols: those defined here for others, and those wanted of others."""
        at, count, names, size = struct.unpack_from("<4I", self.one(SYMBOLS))
        first_own, own, first_wanted, wanted = struct.unpack_from("<4I", self.one(DYNAMIC_SYMBOLS), 8)
        demand(names + size <= len(self.content), "the table of symbols ends behind the file")
        found: list[set[str]] = []
        for first, number, external in ((first_own, own, 0xF), (first_wanted, wanted, 0x1)):
            demand(first + number <= count, "symbols behind the table's end")
            entries = [struct.unpack_from("<IBBHQ", self.content, at + 16 * i) for i in range(first, first + number)]
            demand(all(each[1] & 0xF == external for each in entries), "a symbol of another kind than its part")
            found.append({text(self.content, names + each[0]) for each in entries})
        return found[0], found[1]


def read(content: bytes) -> MachO:
    """The library with these bytes; Unreadable."""
    magic, processor, _, kind, count, size, flags = struct.unpack_from("<7I", content)
    demand(magic == 0xFEEDFACF, "no Mach-O file of 64 bits")
    demand(processor in PROCESSORS, f"for processor {processor:#x}")
    demand(kind == DYLIB, f"a file of kind {kind}, no library")
    demand(flags & 0x85 == 0x85, f"flags {flags:#x}: undefined names, or names without their library")
    found, at = MachO(content, PROCESSORS[processor], []), 32
    for _ in range(count):
        command, length = struct.unpack_from("<2I", content, at)
        demand(length >= 8 and length % 8 == 0 and at + length <= 32 + size, f"a load command of {length} bytes")
        found.commands.append((command, content[at + 8 : at + length]))
        at += length
    demand(at == 32 + size, "load commands of another length than stated")
    known = {SEGMENT, SYMBOLS, DYNAMIC_SYMBOLS, NEEDED, OWN_NAME, UUID, SIGNATURE, BUILT_FOR, OPCODES, CHAINS, EXPORTS}
    strange = {command for command, _ in found.commands} - known - set(NOT_READ)
    demand(not strange, f"load commands that are not known: {sorted(map(hex, strange))}")
    found.segments = [_segment(body) for body in found.of(SEGMENT)]
    _check_segments(found)
    (_read_chains if found.of(CHAINS) else _read_opcodes)(found)
    return found


def _segment(body: bytes) -> Segment:
    name, address, size, at, filled, most, protection = struct.unpack_from("<16s4Q2I", body)
    demand(protection & ~most == 0, "a protection beyond the most that is allowed")
    return Segment(name.rstrip(b"\0").decode(), address, size, at, filled, protection)


def _check_segments(found: MachO) -> None:
    """They begin with the file, follow each other in the file and in memory, on pages, and none is written and run."""
    page, segments = PAGE[found.processor], found.segments
    demand(bool(segments) and (segments[0].at, segments[0].address) == (0, 0), "the first segment begins elsewhere")
    demand([each.name for each in segments][:: len(segments) - 1] == ["__TEXT", "__LINKEDIT"], "other ends")
    for each, after in pairwise(segments):
        demand(each.at + each.filled == after.at, f"a hole in the file before {after.name}")
        demand(each.address + each.size <= after.address, f"{each.name} and {after.name} overlap")
    for each in segments:
        demand(each.address % page == 0 and each.at % page == 0, f"{each.name} begins within a page")
        demand(each.filled <= each.size, f"{each.name} has more bytes than memory")
        demand(each.protection & (WRITE | EXECUTE) != WRITE | EXECUTE, f"{each.name} is written and run")
    demand(segments[-1].at + segments[-1].filled == len(found.content), "bytes behind the last segment")


def _read_opcodes(found: MachO) -> None:
    ranges = struct.unpack_from("<10I", found.one(OPCODES))
    parts = (found.content[at : at + size] for at, size in zip(ranges[::2], ranges[1::2], strict=True))
    rebase, bind, weak, lazy, tree = parts
    demand(not weak, "weak symbols")
    begins = [each.address for each in found.segments]
    for address in rebases(begins, rebase):
        demand(address not in found.rebased, f"{address:#x} is slid twice")
        found.rebased[address] = found.value(address)
    found.bindings = [*bindings(begins, bind, lazy=False), *bindings(begins, lazy, lazy=True)]
    found.exports = dict(exported(tree))


def _read_chains(found: MachO) -> None:
    (at, size), (tree, length) = (struct.unpack_from("<2I", found.one(each)) for each in (CHAINS, EXPORTS))
    found.rebased, found.bindings = chained(found.content[at : at + size], found.value)
    found.exports = dict(exported(found.content[tree : tree + length]))


@dataclass(frozen=True)
class Signature:
    """What a signature says of the file."""

    identifier: str
    flags: int
    pages: int


def signature(found: MachO) -> Signature | None:
    """The signature, each page of the file compared with its digest; None where there is none. Unreadable."""
    if not found.of(SIGNATURE):
        return None
    begin, size = struct.unpack_from("<2I", found.one(SIGNATURE))
    demand(begin % 16 == 0 and begin + size == len(found.content), "the signature is not the end of the file")
    whole = found.content[begin:]
    magic, length, parts = struct.unpack_from(">3I", whole)
    demand((magic, parts) == (0xFADE0CC0, 1) and length <= size, "a signature of other parts than one directory")
    slot, at = struct.unpack_from(">2I", whole, 12)
    directory = whole[at:]
    magic, length, _, flags, digests, identifier, special, pages, limit = struct.unpack_from(">9I", directory)
    digest, kind, _, page = struct.unpack_from("4B", directory, 36)
    demand((slot, magic, special) == (0, 0xFADE0C02, 0), "no directory of pages")
    demand((digest, kind) == (32, 2) and limit == begin, "no SHA-256 of all that is before the signature")
    _, executed, executed_size = struct.unpack_from(">QQQ", directory, 56)
    demand((executed, executed_size) == (0, found.segments[0].filled), "another segment is said to be run")
    demand(pages == -(-limit // (1 << page)), f"digests of {pages} pages")
    for i in range(pages):
        content = found.content[i << page : min((i + 1) << page, limit)]
        stated = directory[digests + 32 * i : digests + 32 * (i + 1)]
        demand(sha256(content).digest() == stated, f"page {i} is not what was signed")
    return Signature(text(directory, identifier), flags, pages)
