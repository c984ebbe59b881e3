"""Linking by LLVM's ``ld.lld``, against stand-ins of the system's libraries: the same bytes on every machine."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

from vibeam.flight.ahead_of_time.emit import TARGETS, stand_ins

LINKER = "ld.lld"

SYSTEM = {  # all that the kernels may call of the system, by its library
    "libm.so.6": ("cos", "cosh", "exp", "expm1", "fmod", "hypot", "ldexp", "pow", "sin", "sincos", "sinh"),
    "libc.so.6": ("memcpy", "memset"),
}


def linker() -> str:
    """The linker's path; RuntimeError with the cure where there is none."""
    found = shutil.which(LINKER)
    if found is None:
        raise RuntimeError(f"{LINKER} is not installed: apt install lld, or another system's LLVM package")
    return found


def version() -> str:
    """What the linker says of itself."""
    return subprocess.run([linker(), "--version"], capture_output=True, text=True, check=True).stdout.strip()


def linked(content: bytes, level: str) -> bytes:
    """The shared library of one object file."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "kernels.o").write_bytes(content)
        for name, symbols in SYSTEM.items():
            (folder / "system.o").write_bytes(stand_ins(symbols, level))
            _link(level, folder, name, "system.o", "-soname", name)
        _link(level, folder, "kernels.so", "kernels.o", "-z", "defs", "--as-needed", *SYSTEM)
        return (folder / "kernels.so").read_bytes()


def _link(level: str, folder: Path, out: str, *given: str) -> None:
    command = [linker(), "-m", TARGETS[level].emulation, "-shared", "-s", "--build-id=none", "-z", "noexecstack"]
    subprocess.run([*command, *given, "-o", out], cwd=folder, check=True)
