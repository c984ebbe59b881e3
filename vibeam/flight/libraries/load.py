"""Loading a library: checked against the kernels' sources, unpacked into memory, opened by ctypes."""

from __future__ import annotations

import ctypes
import errno
import lzma
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from itertools import count
from pathlib import Path

from vibeam.flight.kernels.sources import digest
from vibeam.flight.libraries.call import Call
from vibeam.flight.libraries.errors import LibraryUnavailable
from vibeam.flight.libraries.manifest import FOLDER, file_of, manifest
from vibeam.flight.libraries.processor import level as level_of_processor
from vibeam.flight.libraries.sources import sources_of

BUILD = "python -m vibeam.flight.ahead_of_time"
MOST = 1 << 24  # bytes of a library
_NUMBER = count()


def function_of(library: str, module: str, name: str, level: str | None = None, folder: Path = FOLDER) -> Call:
    """A function of a library; LibraryUnavailable as ``level_of`` and where it cannot be loaded."""
    found, about = level_of(library, module, name, level, folder), manifest(folder)["libraries"][library]
    opened = _opened(file_of(library, found, folder), about["levels"][found])
    function = getattr(opened, f"{library}_{name}")
    function.argtypes, function.restype = (ctypes.c_void_p,), ctypes.c_int32
    return Call(function, f"{library}.{name}", **about["entries"][name])


def level_of(library: str, module: str, name: str, level: str | None = None, folder: Path = FOLDER) -> str:
    """The level whose library has the function, None: this processor's; LibraryUnavailable where none has."""
    found = level or level_of_processor()
    if found is None:
        raise LibraryUnavailable("there are no compiled kernels for this machine")
    about = manifest(folder)["libraries"].get(library, {"entries": {}, "levels": {}})
    if name not in about["entries"] or found not in about["levels"]:
        raise LibraryUnavailable(f"there are no compiled kernels for {found} ({BUILD} makes them)")
    if about["sources"] != digest(sources_of(module)):
        raise LibraryUnavailable(f"the compiled kernels are older than their sources ({BUILD} renews them)")
    return found


@cache
def _opened(path: Path, expected: str) -> ctypes.CDLL:
    """The library in a compressed file with this SHA-256; LibraryUnavailable where it cannot be had."""
    try:
        packed = path.read_bytes()
    except OSError as fault:
        raise LibraryUnavailable(f"the compiled kernels cannot be read ({fault})") from None
    if sha256(packed).hexdigest() != expected:
        raise LibraryUnavailable(f"the compiled kernels in {path} are damaged: install vibeam again")
    content = lzma.LZMADecompressor().decompress(packed, MOST)
    faults = list[str]()
    for place in (_in_memory, _in_folder):
        try:
            with place(content) as name:
                return ctypes.CDLL(name)
        except (AttributeError, OSError) as fault:  # AttributeError: a system without files in memory
            large = isinstance(fault, OSError) and fault.errno == errno.EFBIG
            faults.append(f"files may not have their {len(content) >> 10} kB: raise ulimit -f" if large else str(fault))
    raise LibraryUnavailable(f"the compiled kernels cannot be loaded ({'; '.join(dict.fromkeys(faults))})")


@contextmanager
def _in_memory(content: bytes) -> Iterator[str]:
    """The name of a file in memory, while it is opened.

    The loader knows what it has open by name: each is spelled differently, since the number may be used again.
    """
    number = os.memfd_create("vibeam", os.MFD_CLOEXEC)
    try:
        _write(number, content)
        yield f"/proc/self/fd/{'./' * next(_NUMBER)}{number}"
    finally:
        os.close(number)


@contextmanager
def _in_folder(content: bytes) -> Iterator[str]:
    """The name of a file in a temporary folder, while it is opened."""
    number, name = tempfile.mkstemp(prefix="vibeam-", suffix=".so")
    try:
        _write(number, content)
        os.close(number)
        yield name
    finally:
        os.unlink(name)


def _write(number: int, content: bytes) -> None:
    with open(number, "wb", closefd=False) as file:
        file.write(content)
