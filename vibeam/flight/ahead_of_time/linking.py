"""Linking of one object file to a library: by LLVM's linkers, against stand-ins of the system's own libraries.

A stand-in has the names that the kernels may call and nothing else, so that a library links to the same bytes on every
machine, whatever system that has, and a call of anything else is refused. WebAssembly is linked in ``webassembly``.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from vibeam.flight.ahead_of_time.emit import MACOS, TARGETS, Target, object_code
from vibeam.flight.engine.loading import LINUX, system_of

PACKAGE = "apt install lld, or another system's LLVM package"
MATHEMATICS = ("cos", "cosh", "exp", "expm1", "fmod", "hypot", "ldexp", "pow", "sin", "sinh")
LIBM, LIBC, UCRT, SYSTEM = "libm.so.6", "libc.so.6", "ucrtbase.dll", "/usr/lib/libSystem.B.dylib"
CALLED = {  # all that the kernels may call of a system, by its library
    LIBM: (*MATHEMATICS, "sincos"),
    LIBC: ("memcpy", "memset"),
    UCRT: (*MATHEMATICS, "memcpy", "memset"),
    SYSTEM: (*MATHEMATICS, "memcpy", "memset", "bzero", "__bzero", "__sincos_stret", r"\01dyld_stub_binder"),
}


class Linker(NamedTuple):
    """A linker, what it makes, and its words: of every call, and then of a stand-in and of the kernels."""

    program: str
    library: str
    stand_ins: tuple[str, ...]
    always: str
    stand_in: str
    kernels: str
    export: str = ""


LINKERS = {
    LINUX: Linker(  # ELF: all that is not hidden is exported; names of the system's functions are without versions
        "ld.lld", "kernels.so", (LIBM, LIBC), "-m {machine} -shared -s --build-id=none -z noexecstack",
        "system.o -soname {name} -o {name}", f"kernels.o -z defs --as-needed {LIBM} {LIBC} -o kernels.so",
    ),
    "windows": Linker(  # PE: by an import library; ``/brepro`` puts a digest where a time would stand
        "lld-link", "kernels.dll", (UCRT,), "/dll /noentry /nodefaultlib /brepro /machine:{machine}",
        "/implib:system.lib system.o /out:{name} {exports}",
        "/implib:own.lib system.lib kernels.o /out:kernels.dll {exports}", "/export:{}",
    ),
    "macos": Linker(  # Mach-O, for arm64 with the signature without a name that this system asks for
        "ld64.lld", "kernels.dylib", (SYSTEM,),
        f"-dylib -arch {{machine}} -platform_version macos {MACOS} {MACOS} -install_name",
        "{name} system.o -o system.dylib",
        "@rpath/kernels.dylib -dead_strip {exports} system.dylib kernels.o -o kernels.dylib", "-exported_symbol _{}",
    ),
}  # fmt: skip


def linker(name: str) -> str:
    """The linker's path, by its name or that with LLVM's version; RuntimeError with the cure where there is none."""
    names = (name, *(f"{name}-{version}" for version in range(30, 13, -1)))
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        raise RuntimeError(f"{name} is not installed: {PACKAGE}")
    return found


def linker_version(levels: Sequence[str]) -> str:
    """Version of the linker of the first of these levels, in its own words; RuntimeError where one is missing."""
    found = [linker(LINKERS[system_of(level)].program) for level in levels]
    return subprocess.run([found[0], "--version"], capture_output=True, text=True, check=True).stdout.strip()


def linked(content: bytes, level: str, exported: Sequence[str]) -> bytes:
    """The shared library of one object file, which exports these functions; RuntimeError without the linker."""
    target, by = TARGETS[level], LINKERS[system_of(level)]
    with TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "kernels.o").write_bytes(content)
        for name in by.stand_ins:
            (folder / "system.o").write_bytes(_stand_in(name, target))
            _run(folder, by, by.stand_in, CALLED[name], machine=target.emulation, name=name)
        _run(folder, by, by.kernels, exported, machine=target.emulation)
        return (folder / by.library).read_bytes()


def _stand_in(library: str, target: Target) -> bytes:
    """Object code of functions that do nothing, for the linker to know a library's names by."""
    return object_code("\n".join(f'define void @"{name}"() {{ ret void }}' for name in CALLED[library]), target)


def _run(folder: Path, by: Linker, words: str, exported: Sequence[str], **named: str) -> None:
    exports = " ".join(by.export.format(name) for name in exported)
    command = [linker(by.program), *f"{by.always} {words}".format(exports=exports, **named).split()]
    subprocess.run(command, cwd=folder, check=True)
