"""Host programs for kernels of other systems: how each is compiled and run, and what must be installed for that."""

from __future__ import annotations

import lzma
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mach_o_image
from hosted_kernels import LIBRARIES, SOURCE, Host

NATIVE = sys.platform == "linux" and platform.machine() == "x86_64"


@dataclass(frozen=True)
class Program:
    """A host program for one level of libraries."""

    level: str
    compiler: Sequence[str]
    run_by: Sequence[str] = ()
    opened: Callable[[Path, Path], Path] | None = None  # library, folder: the file to open
    emulated: bool = False

    @property
    def missing(self) -> str | None:
        """Why it cannot be run here."""
        for each in (self.compiler[0], *self.run_by[:1]):
            if not shutil.which(each):
                return f"{each} is not installed"
        return None if self.emulated or NATIVE else "another processor, or another system than Linux"

    def compiled(self, folder: Path, source: Path = SOURCE) -> list[str]:
        """The command that runs it."""
        program = folder / "host.exe"
        subprocess.run([self.compiler[0], "-O1", str(source), *self.compiler[1:], "-o", str(program)], check=True)
        return [*self.run_by, str(program)]

    def begun(self, folder: Path) -> Host:
        """The host, which makes what it needs in ``folder``."""
        environment = {"WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all"}
        opened = partial(self.opened, folder=folder) if self.opened else Path
        return Host(self.level, self.compiled(folder), environment, opened)


def unpacked(path: Path, folder: Path) -> Path:
    """A library of Linux, as its loader takes it."""
    found = folder / f"{path.stem}.so"
    found.write_bytes(lzma.decompress(path.read_bytes()))
    return found


MAPPED = ("-include", str(mach_o_image.HEADER), "-lm")
WINE = ("x86_64-w64-mingw32-gcc",), ("wine",)
CROSS, EMULATOR = "aarch64-linux-gnu-gcc", "qemu-aarch64"
PROGRAMS = {
    "Windows, x86-64-v2": Program("windows-x86-64-v2", *WINE),
    "Windows, x86-64-v3": Program("windows-x86-64-v3", *WINE),
    "macOS, x86-64": Program("macos-x86-64-v2", ("cc", *MAPPED), (), mach_o_image.written),
    "macOS, arm64": Program("macos-arm64", (CROSS, "-static", *MAPPED), (EMULATOR,), mach_o_image.written, True),
    "Linux, aarch64": Program("aarch64", (CROSS,), (EMULATOR, "-L", "/usr/aarch64-linux-gnu"), unpacked, True),
    "musl, x86-64-v2": Program("x86-64-v2", ("musl-gcc",), (), unpacked),
    "musl, x86-64-v3": Program("x86-64-v3", ("musl-gcc",), (), unpacked),
}


def missing(name: str) -> str | None:
    """Why the libraries for that system cannot be tried here."""
    level = PROGRAMS[name].level
    return PROGRAMS[name].missing or (
        None if (LIBRARIES / level).exists() else f"VIBEAM_LIBRARIES names no libraries for {level}"
    )
