"""Libraries of compiled kernels: their manifest, the level that this machine's processor takes, and loading one.

A library is checked against the kernels' sources and opened by ctypes: under Linux unpacked into memory, else where it
lies. What stands in the folder ``flight/libraries`` beside ``manifest.json`` is written by
``vibeam.flight.ahead_of_time``.
"""

from __future__ import annotations

import ctypes
import errno
import json
import lzma
import os
import platform
import struct
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any

from vibeam.flight.engine.call import Call
from vibeam.flight.kernels.sources import digest, sources_of

FOLDER = Path(__file__).parents[1] / "libraries"
NAME = "manifest.json"
LINUX, WINDOWS, MACOS = "linux", "windows", "macos"
KEPT = ("x86-64-v3", "x86-64-v2", "aarch64")  # levels of processors under Linux
LEVELS = (*KEPT, "windows-x86-64-v3", "windows-x86-64-v2", "macos-arm64", "macos-x86-64-v2")
WASM = "wasm"  # of web pages: see ``browser``
SUFFIXES = {LINUX: "xz", WINDOWS: "dll", MACOS: "dylib"}  # the last two are loaded where they lie
V2 = {"cx16", "lahf_lm", "popcnt", "pni", "sse4_1", "sse4_2", "ssse3"}
V3 = V2 | {"abm", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe", "xsave"}
ASKED = ("tables", "processor")  # the library for Windows, and its function, that stores the processor's registers
REGISTERS = (  # what each flag is, by register and bit, of those that it stores
    {"pni": 0, "ssse3": 9, "fma": 12, "cx16": 13, "sse4_1": 19, "sse4_2": 20, "movbe": 22, "popcnt": 23, "f16c": 29},
    {"bmi1": 3, "avx2": 5, "bmi2": 8},
    {"lahf_lm": 0, "abm": 5},
)
VECTORS = {"avx": 28, "xsave": 27}  # of the first register, where the system keeps the wide registers too
FIRST = 16384  # bytes of /proc/cpuinfo in which the first processor's flags stand
BUILD = "python -m vibeam.flight.ahead_of_time"
MOST = 1 << 24  # bytes of a library
_NUMBER = count()


class LibraryUnavailable(Exception):
    """Why there is no library for this machine."""


class KernelsUnavailable(RuntimeError):
    """Neither a library for this machine nor numba, or a wrong VIBEAM_KERNELS; with the cure."""


def system_of(level: str) -> str:
    """The operating system of a level of processors."""
    system = level.partition("-")[0]
    return system if system in SUFFIXES else LINUX


def file_of(library: str, level: str, folder: Path = FOLDER) -> Path:
    """The library as it is kept: compressed for Linux, and for browsers as they unpack it."""
    return folder / level / f"{library}.{'gz' if level == WASM else SUFFIXES[system_of(level)]}"


@cache
def manifest(folder: Path = FOLDER) -> dict[str, Any]:
    """{library: {sources, entries {name: {arguments, results, names}}, levels {level: SHA-256 of its file}}}.

    And ``made_with``. LibraryUnavailable for a damaged one.
    ``arguments``: ``f8:2`` an array of doubles with two axes, ``i8:1`` one of int64, ``d`` and ``q`` numbers, a list a
    tuple of these. ``results``: numbers. ``names``: of the arguments; a list has a tuple's name, its class, its fields.
    """
    path = folder / NAME
    if not path.exists():
        return {"libraries": {}}
    try:
        found: dict[str, Any] = json.loads(path.read_bytes())
        if found.pop("sha256") == _digest(found):
            return found
        fault = "its digest does not fit"
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        fault = f"{type(error).__name__}: {error}"
    raise LibraryUnavailable(f"the list of compiled kernels, {path}, is damaged ({fault}): install vibeam again")


def write_manifest(folder: Path, made_with: dict[str, str], libraries: dict[str, Any]) -> None:
    """Write the manifest, with a digest of itself."""
    whole = {"made_with": made_with, "libraries": dict(sorted(libraries.items()))}
    (folder / NAME).write_text(json.dumps(whole | {"sha256": _digest(whole)}, indent=1) + "\n", encoding="utf-8")


def _digest(whole: dict[str, Any]) -> str:
    return sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


def level_of_processor(cpuinfo: Path = Path("/proc/cpuinfo")) -> str | None:
    """The highest level that runs here (see ``LEVELS``); None where none does."""
    machine = platform.machine()
    if struct.calcsize("P") != 8 or sys.byteorder != "little":
        return None
    if sys.platform == "darwin":
        return {"arm64": "macos-arm64", "x86_64": "macos-x86-64-v2"}.get(machine)
    if sys.platform == "win32" and machine == "AMD64":
        level = _level_of(_flags_of_windows())
        return level and f"{WINDOWS}-{level}"
    if sys.platform != "linux":
        return None
    return _level_of(_flags(cpuinfo)) if machine == "x86_64" else "aarch64" if machine == "aarch64" else None


def _level_of(flags: set[str]) -> str | None:
    return "x86-64-v3" if flags >= V3 else "x86-64-v2" if flags >= V2 else None


@cache
def _flags_of_windows() -> set[str]:
    """The processor's flags by its own instruction, in a library of the lower level; none where it cannot be had."""
    level, (library, name) = f"{WINDOWS}-x86-64-v2", ASKED
    found = (ctypes.c_uint64 * 4)()
    try:
        processor = getattr(_opened(file_of(library, level), manifest()["libraries"][library]["levels"][level]), name)
    except (LibraryUnavailable, KeyError):
        return set()
    processor.argtypes = (ctypes.c_void_p,)
    processor(ctypes.addressof(found))
    return flags_in(*found)


def flags_in(basic: int, further: int, extended: int, kept: int) -> set[str]:
    """Flags by their names under Linux, of what ``processor`` stores: three registers and what the system keeps."""
    registers = (basic, further, extended)
    found = {name for bits, value in zip(REGISTERS, registers, strict=True) for name in bits if value >> bits[name] & 1}
    vectors = {name for name, bit in VECTORS.items() if basic >> bit & 1 and kept & 6 == 6}
    return found | vectors if "avx" in vectors else found - {"avx2", "fma", "f16c"}


def _flags(cpuinfo: Path) -> set[str]:
    try:
        with cpuinfo.open(encoding="utf-8") as file:
            lines = file.read(FIRST).splitlines()
    except OSError:
        return set()
    return next((set(line.partition(":")[2].split()) for line in lines if line.startswith("flags")), set())


def function_of(library: str, module: str, name: str, level: str | None = None, folder: Path = FOLDER) -> Call:
    """A function of a library; LibraryUnavailable as ``level_of`` and where it cannot be loaded."""
    found, about = level_of(library, module, name, level, folder), manifest(folder)["libraries"][library]
    opened = _opened(file_of(library, found, folder), about["levels"][found])
    function = getattr(opened, f"{library}_{name}")
    function.argtypes, function.restype = (ctypes.c_void_p,), ctypes.c_int32
    entry = about["entries"][name]
    return Call(function, f"{library}.{name}", entry["arguments"], entry["results"])


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
    packed, faults = _packed(path, expected), list[str]()
    if path.suffix != ".xz":
        return _opened_where_it_lies(path)
    content = lzma.LZMADecompressor().decompress(packed, MOST)
    for place in (_in_memory, _in_folder):
        try:
            with place(content) as name:
                return ctypes.CDLL(name)
        except (AttributeError, OSError) as fault:  # AttributeError: a system without files in memory
            large = isinstance(fault, OSError) and fault.errno == errno.EFBIG
            faults.append(f"files may not have their {len(content) >> 10} kB: raise ulimit -f" if large else str(fault))
    raise LibraryUnavailable(f"the compiled kernels cannot be loaded ({'; '.join(dict.fromkeys(faults))})")


def _opened_where_it_lies(path: Path) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(str(path.resolve()))
    except OSError as fault:
        raise LibraryUnavailable(f"the compiled kernels cannot be loaded ({fault})") from None


def packed_of(library: str, level: str, folder: Path = FOLDER) -> bytes:
    """The compressed library; LibraryUnavailable where it cannot be read or is damaged."""
    return _packed(file_of(library, level, folder), manifest(folder)["libraries"][library]["levels"][level])


def _packed(path: Path, expected: str) -> bytes:
    try:
        packed = path.read_bytes()
    except OSError as fault:
        raise LibraryUnavailable(f"the compiled kernels cannot be read ({fault})") from None
    if sha256(packed).hexdigest() != expected:
        raise LibraryUnavailable(f"the compiled kernels in {path} are damaged: install vibeam again")
    return packed


@contextmanager
def _in_memory(content: bytes) -> Iterator[str]:
    """The name of a file in memory, while it is opened.

    The loader knows what it has open by name: each is spelled differently, since the number may be used again.
    """
    if sys.platform != "linux":
        raise OSError(errno.ENOSYS, "no files in memory")
    with open(os.memfd_create("vibeam", os.MFD_CLOEXEC), "wb") as file:
        file.write(content)
        file.flush()
        yield f"/proc/self/fd/{'./' * next(_NUMBER)}{file.fileno()}"


@contextmanager
def _in_folder(content: bytes) -> Iterator[str]:
    """The name of a file in a temporary folder, while it is opened."""
    number, name = tempfile.mkstemp(prefix="vibeam-", suffix=".so")
    try:
        with open(number, "wb") as file:
            file.write(content)
        yield name
    finally:
        os.unlink(name)
