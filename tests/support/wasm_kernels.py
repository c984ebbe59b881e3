"""The kernels of web pages, run by wasmtime: entry points for Python that take the same slots as in a browser.

Arrays are copied into the memory that all libraries share and back again, so that whoever calls notices nothing.
"""

from __future__ import annotations

import ctypes
import gzip
import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import gettempdir

from wasmtime import Config, Engine, Instance, Limits, Memory, MemoryType, Module, Store

from vibeam.flight.engine.browser import FIRST, LIBRARIES
from vibeam.flight.engine.call import NUMBERS, Call, Kind, axes_of, leaves
from vibeam.flight.engine.entries import ENTRIES, EntryPoint
from vibeam.flight.engine.loading import WASM, level_of, manifest, packed_of

PAGE = 65536


class WasmMemory:
    """One memory, and the libraries that have been instantiated in it."""

    def __init__(self) -> None:
        config = Config()
        config.cache = str(cache_settings())
        self.engine = Engine(config)
        self.store = Store(self.engine)
        self.memory = Memory(self.store, MemoryType(Limits(FIRST // PAGE, None)))
        self.instances: dict[str, Instance] = {}
        self.images: list[tuple[str, bytes, bytes]] | None = None  # see ``noted``

    def instance(self, library: str) -> Instance:
        """The library, compiled and instantiated once."""
        if library not in self.instances:
            module = Module(self.engine, self.module_bytes(library))
            assert [(each.module, each.name) for each in module.imports] == [("env", "memory")]
            self.instances[library] = Instance(self.store, module, [self.memory])
        return self.instances[library]

    def module_bytes(self, library: str) -> bytes:
        """The library as its file has it."""
        return gzip.decompress(packed_of(library, WASM))

    def image(self, end: int) -> bytes:
        """The page's bytes up to ``end``, where calls are noted."""
        return b"" if self.images is None else ctypes.string_at(self.address(end) + FIRST, end - FIRST)

    def address(self, end: int) -> int:
        """Address of the memory's first byte, once it has ``end`` bytes."""
        missing = end - self.memory.data_len(self.store)
        if missing > 0:
            self.memory.grow(self.store, -(-missing // PAGE))
        return ctypes.addressof(self.memory.data_ptr(self.store).contents)


def cache_settings() -> Path:
    """The file that tells wasmtime where to keep what it has compiled: for the processes of a run, and the next run."""
    folder = Path(gettempdir()) / f"vibeam-wasmtime-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    settings, own = folder / "cache.toml", folder / f"cache-{os.getpid()}.toml"
    own.write_text(f'[cache]\ndirectory = "{folder}"\n', encoding="utf-8")
    return own.replace(settings)


@cache
def shared_memory() -> WasmMemory:
    """The memory of this process."""
    return WasmMemory()


def taken(entry: EntryPoint) -> Call:
    """The entry point in WebAssembly; LibraryUnavailable where there is none, or a stale one."""
    level_of(entry.library, entry.module, entry.name, WASM)
    about = manifest()["libraries"][entry.library]["entries"][entry.name]
    arguments, results = about["arguments"], about["results"]
    places = list(arrays(arguments, len(results)))
    size = sum(1 if each in NUMBERS else 1 + axes_of(each) for each in leaves(arguments)) + len(results)
    within, name = shared_memory(), f"{entry.library}_{entry.name}"
    function = within.instance(entry.library).exports(within.store)[name]

    def called(address: int) -> int:
        slots = (ctypes.c_int64 * size).from_address(address)
        found = [(slots[at], 8 * product(slots[at + 1 : at + 1 + axes])) for at, axes in places]
        spans = joined([(begin, begin + length) for begin, length in found if length])
        copies, end = [], -(-(FIRST + 8 * size) // 64) * 64
        for begin, stop in spans:
            copies.append((begin, stop, end))
            end = -(-(end + stop - begin) // 64) * 64
        base, inside = within.address(end), (ctypes.c_int64 * size)(*slots)
        for (at, _), (begin, length) in zip(places, found, strict=True):
            inside[at] = next((begin - b + to for b, s, to in copies if b <= begin < s), 0) if length else 0
        for begin, stop, to in copies:
            ctypes.memmove(base + to, begin, stop - begin)
        ctypes.memmove(base + FIRST, inside, 8 * size)
        before = within.image(end)
        status = function(within.store, FIRST)
        if within.images is not None:
            within.images.append((name, before, within.image(end)))
        for begin, stop, to in copies:
            ctypes.memmove(begin, base + to, stop - begin)
        for at in set(range(size)) - {at for at, _ in places}:
            slots[at] = ctypes.c_int64.from_address(base + FIRST + 8 * at).value
        return status

    return Call(called, f"{entry.library}.{entry.name}", arguments, results)


@contextmanager
def noted() -> Iterator[list[tuple[str, bytes, bytes]]]:
    """The calls made meanwhile: export, the page's bytes before and after it."""
    within, found = shared_memory(), list[tuple[str, bytes, bytes]]()
    within.images = found
    try:
        yield found
    finally:
        within.images = None


def take() -> None:
    """Let WebAssembly be every entry point that a page has, until ``give_back``."""
    for each in ENTRIES:
        if each.name in LIBRARIES.get(each.library, ()):
            vars(each)["function"] = taken(each)


def give_back() -> None:
    """Let the entry points be found anew."""
    for each in ENTRIES:
        vars(each).pop("function", None)


def arrays(arguments: list[Kind], results: int) -> Iterator[tuple[int, int]]:
    """The slot of each array's address, and the array's number of axes (``vibeam.flight.engine.call``)."""
    at = results + sum(kind in NUMBERS for kind in arguments)
    for each in leaves([kind for kind in arguments if kind not in NUMBERS]):
        if each in NUMBERS:
            at += 1
        else:
            yield at, axes_of(each)
            at += 1 + axes_of(each)


def product(lengths: list[int]) -> int:
    """The number of an array's items."""
    found = 1
    for each in lengths:
        found *= each
    return found


def joined(spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The spans of bytes, those that overlap as one: arrays may be views of the same numbers."""
    found: list[tuple[int, int]] = []
    for begin, stop in sorted(spans):
        if found and begin < found[-1][1]:
            found[-1] = (found[-1][0], max(found[-1][1], stop))
        else:
            found.append((begin, stop))
    return found
