"""Kernels for another system, run by a host program of it: entry points that take the same slots as here.

A process a library, spoken to by a pipe; arrays are copied to its memory and back, so that whoever calls notices
nothing. The libraries stand in the folder that VIBEAM_LIBRARIES names
(``python -m vibeam.flight.ahead_of_time`` makes them).
"""

from __future__ import annotations

import ctypes
import os
import struct
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock

from wasm_kernels import arrays, joined, product

from vibeam.flight.engine.call import NUMBERS, Call, axes_of, leaves
from vibeam.flight.engine.entries import ENTRIES, EntryPoint
from vibeam.flight.engine.loading import file_of, level_of, manifest

SOURCE = Path(__file__).with_name("kernel_host.c")
LIBRARIES = Path(os.environ.get("VIBEAM_LIBRARIES", "nowhere"))


@dataclass
class Host:
    """Processes of a host program, ``command``, for the libraries of a ``level``."""

    level: str
    command: Sequence[str]
    environment: dict[str, str] = field(default_factory=dict)
    opened: Callable[[Path], Path] = Path  # the file that the host program opens, of a library's
    calls: dict[str, int] = field(default_factory=dict)  # by the function's name
    _processes: dict[str, subprocess.Popen[bytes]] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock)

    def called(self, library: str, name: str, slots: bytes, places: bytes, memory: bytes) -> tuple[int, bytes, bytes]:
        """Status, slots and memory after a call; AssertionError where the host ends."""
        with self._lock:
            process = self._process(library)
            assert process.stdin
            assert process.stdout
            sizes = struct.pack("=4q", len(name), len(slots) // 8, len(places) // 16, len(memory))
            process.stdin.write(b"".join((sizes, name.encode(), slots, places, memory)))
            process.stdin.flush()
            found = process.stdout.read(8 + len(slots) + len(memory))
            assert len(found) == 8 + len(slots) + len(memory), f"{self.level}: {name}: the host has ended"
            self.calls[name] = self.calls.get(name, 0) + 1
        return int.from_bytes(found[:8], "little"), found[8 : 8 + len(slots)], found[8 + len(slots) :]

    def _process(self, library: str) -> subprocess.Popen[bytes]:
        if library not in self._processes:
            words = [*self.command, str(self.opened(file_of(library, self.level, LIBRARIES)))]
            pipe = subprocess.PIPE
            self._processes[library] = subprocess.Popen(
                words, stdin=pipe, stdout=pipe, env=os.environ | self.environment
            )
        return self._processes[library]

    def end(self) -> None:
        """End the processes."""
        for process in self._processes.values():
            process.communicate(timeout=60)
        self._processes.clear()

    def taken(self, entry: EntryPoint) -> Call:
        """The entry point as the host has it; LibraryUnavailable where there is none, or a stale one."""
        level_of(entry.library, entry.module, entry.name, self.level, LIBRARIES)
        about = manifest(LIBRARIES)["libraries"][entry.library]["entries"][entry.name]
        arguments, results = about["arguments"], about["results"]
        at = list(arrays(arguments, len(results)))
        size = sum(1 if each in NUMBERS else 1 + axes_of(each) for each in leaves(arguments)) + len(results)
        name = f"{entry.library}_{entry.name}"

        def called(address: int) -> int:
            slots = (ctypes.c_int64 * size).from_address(address)
            found = [(slot, slots[slot], 8 * product(slots[slot + 1 : slot + 1 + axes])) for slot, axes in at]
            spans, places, end = joined([(begin, begin + length) for _, begin, length in found if length]), b"", 0
            starts = []
            for begin, stop in spans:
                starts.append(end)
                end += -(-(stop - begin) // 64) * 64
            for slot, begin, length in found:
                for (b, s), start in zip(spans, starts, strict=True):
                    if length and b <= begin < s:
                        places += struct.pack("=2q", slot, start + begin - b)
            memory = bytearray(end)
            for (begin, stop), start in zip(spans, starts, strict=True):
                memory[start : start + stop - begin] = ctypes.string_at(begin, stop - begin)
            status, after, memory_after = self.called(entry.library, name, bytes(slots), places, bytes(memory))
            for (begin, stop), start in zip(spans, starts, strict=True):
                ctypes.memmove(begin, memory_after[start : start + stop - begin], stop - begin)
            numbers = struct.unpack(f"={size}q", after)
            for slot in set(range(size)) - {slot for slot, _, _ in found}:
                slots[slot] = numbers[slot]
            return status

        return Call(called, f"{entry.library}.{entry.name}", arguments, results)

    @contextmanager
    def hosting(self) -> Iterator[None]:
        """Let the host have every entry point meanwhile."""
        for each in ENTRIES:
            vars(each)["function"] = self.taken(each)
        try:
            yield
        finally:
            for each in ENTRIES:
                vars(each).pop("function", None)
