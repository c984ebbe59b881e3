"""Linking of one object file to a library: by LLVM's linkers, against stand-ins of the system's own libraries.

A stand-in has the names that the kernels may call and nothing else, so that a library links to the same bytes on every
machine, whatever system that has, and a call of anything else is refused. WebAssembly is linked in ``webassembly``.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from vibeam.flight.ahead_of_time.emit import MACOS, TARGETS, Target, object_code
from vibeam.flight.engine.loading import LINUX, system_of

LINKERS = {LINUX: "ld.lld", "windows": "lld-link", "macos": "ld64.lld"}  # by system
PACKAGE = "apt install lld, or another system's LLVM package"
MATHEMATICS = ("cos", "cosh", "exp", "expm1", "fmod", "hypot", "ldexp", "pow", "sin", "sinh")
LIBM, LIBC, UCRT, SYSTEM = "libm.so.6", "libc.so.6", "ucrtbase.dll", "/usr/lib/libSystem.B.dylib"
CALLED = {  # all that the kernels may call of a system, by its library
    LIBM: (*MATHEMATICS, "sincos"),
    LIBC: ("memcpy", "memset"),
    UCRT: (*MATHEMATICS, "memcpy", "memset"),
    SYSTEM: (*MATHEMATICS, "memcpy", "memset", "bzero", "__bzero", "__sincos_stret", r"\01dyld_stub_binder"),
}


def linker(name: str) -> str:
    """The linker's path, by its name or that with LLVM's version; RuntimeError with the cure where there is none."""
    names = (name, *(f"{name}-{version}" for version in range(30, 13, -1)))
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        raise RuntimeError(f"{name} is not installed: {PACKAGE}")
    return found


def linker_version(levels: Sequence[str]) -> str:
    """Version of the linker of the first of these levels, in its own words; RuntimeError where one is missing."""
    found = [linker(LINKERS[system_of(level)]) for level in levels]
    return subprocess.run([found[0], "--version"], capture_output=True, text=True, check=True).stdout.strip()


def linked(content: bytes, level: str, exported: Sequence[str]) -> bytes:
    """The shared library of one object file, which exports these functions; RuntimeError without the linker."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "kernels.o").write_bytes(content)
        return LINKED[system_of(level)](folder, TARGETS[level], exported).read_bytes()


def _for_linux(folder: Path, target: Target, exported: Sequence[str]) -> Path:
    """ELF: everything that is not hidden is exported; names of the system's functions are without versions."""

    def link(out: str, *given: str) -> None:
        words = ["-m", target.emulation, "-shared", "-s", "--build-id=none", "-z", "noexecstack"]
        _run(folder, "ld.lld", *words, *given, "-o", out)

    for name in (LIBM, LIBC):
        (folder / "system.o").write_bytes(_stand_in(name, target))
        link(name, "system.o", "-soname", name)
    link("kernels.so", "kernels.o", "-z", "defs", "--as-needed", LIBM, LIBC)
    return folder / "kernels.so"


def _for_windows(folder: Path, target: Target, exported: Sequence[str]) -> Path:
    """PE: linked against the import library of a stand-in; ``/brepro`` puts a digest where a time would stand."""

    def link(out: str, given: str, names: Sequence[str], *further: str) -> None:
        words = ["/dll", "/noentry", "/nodefaultlib", "/brepro", f"/machine:{target.emulation}", *further]
        _run(folder, "lld-link", *words, given, f"/out:{out}", *(f"/export:{name}" for name in names))

    (folder / "system.o").write_bytes(_stand_in(UCRT, target))
    link(UCRT, "system.o", CALLED[UCRT], "/implib:system.lib")
    link("kernels.dll", "kernels.o", exported, "/implib:own.lib", "system.lib")
    return folder / "kernels.dll"


def _for_macos(folder: Path, target: Target, exported: Sequence[str]) -> Path:
    """Mach-O, for arm64 with the signature without a name that this system asks for."""

    def link(out: str, given: str, name: str, *further: str) -> None:
        words = ["-dylib", "-arch", target.emulation, "-platform_version", "macos", MACOS, MACOS, "-install_name", name]
        _run(folder, "ld64.lld", *words, *further, given, "-o", out)

    (folder / "system.o").write_bytes(_stand_in(SYSTEM, target))
    link("system.dylib", "system.o", SYSTEM)
    names = [word for name in exported for word in ("-exported_symbol", f"_{name}")]
    link("kernels.dylib", "kernels.o", "@rpath/kernels.dylib", "-dead_strip", *names, "system.dylib")
    return folder / "kernels.dylib"


LINKED: dict[str, Callable[[Path, Target, Sequence[str]], Path]] = {
    LINUX: _for_linux, "windows": _for_windows, "macos": _for_macos,
}  # fmt: skip


def _stand_in(library: str, target: Target) -> bytes:
    """Object code of functions that do nothing, for the linker to know a library's names by."""
    return object_code("\n".join(f'define void @"{name}"() {{ ret void }}' for name in CALLED[library]), target)


def _run(folder: Path, name: str, *words: str) -> None:
    subprocess.run([linker(name), *words], cwd=folder, check=True)
