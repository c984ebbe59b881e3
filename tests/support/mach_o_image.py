"""Libraries of macOS as images that a host program under Linux maps and runs (``mach_o_image.h``).

The image is the memory as macOS would fill it, with lists of what its loader does: slide, bind, protect.
"""

from __future__ import annotations

import struct
from pathlib import Path

import mach_o
from mach_o_fixups import demand

HEADER = Path(__file__).with_name("mach_o_image.h")
LONGEST = 48  # bytes of a name, with a zero behind


def written(path: Path, folder: Path) -> Path:
    """The image of a library, in a file beside others of ``folder``; Unreadable."""
    content = image(mach_o.read(path.read_bytes()))
    found = folder / f"{path.stem}.image"
    found.write_bytes(content)
    return found


def image(library: mach_o.MachO) -> bytes:
    """Numbers of all, then bytes, protected ranges, slid places, bindings and exports."""
    end = max(each.address + each.size for each in library.segments)
    memory = bytearray(end)
    for each in library.segments:
        memory[each.address : each.address + each.filled] = library.content[each.at : each.at + each.filled]
    for address, target in library.rebased.items():
        struct.pack_into("<Q", memory, address, target)
    parts = [struct.pack("<3q", each.address, each.size, each.protection) for each in library.segments]
    parts += [struct.pack("<q", address) for address in library.rebased]
    parts += [struct.pack(f"<2q{LONGEST}s", each.address, each.addend, _name(each.name)) for each in library.bindings]
    parts += [struct.pack(f"<q{LONGEST}s", address, _name(name)) for name, address in library.exports.items()]
    sizes = (library.segments, library.rebased, library.bindings, library.exports)
    return b"".join((struct.pack("<5q", end, *map(len, sizes)), bytes(memory), *parts))


def _name(name: str) -> bytes:
    demand(len(name) < LONGEST, f"{name} is too long")
    return name.encode()
