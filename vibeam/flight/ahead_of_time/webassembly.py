"""Library for web pages: a WebAssembly module, linked with a mathematical library of its own.

Its only import is memory, ``env.memory``, which all libraries of a page share: each has its own place in it
(``engine.browser``). Sines and powers come from musl, as wasi-libc builds it, so no digit depends on the browser.
"""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from vibeam.flight.ahead_of_time.emit import TARGETS
from vibeam.flight.ahead_of_time.linking import linker
from vibeam.flight.engine.browser import FIRST, SLOT, place_of
from vibeam.flight.engine.loading import WASM

LINKER = "wasm-ld"
ARCHIVES = {  # package, where it has the archive; the highest version where there are several
    "wasi-libc": ("wasi-libc", "usr/lib/wasm32-wasi/libc.a"),
    "builtins": ("libclang-rt-14-dev-wasm32", "usr/lib/llvm-*/lib/clang/*/lib/wasi/libclang_rt.builtins-wasm32.a"),
}


def archive(name: str, root: Path = Path("/")) -> Path:
    """The path of one of ``ARCHIVES``; RuntimeError with the cure where it is not installed."""
    package, place = ARCHIVES[name]
    found = sorted(root.glob(place))
    if not found:
        raise RuntimeError(f"{root / place} is not there: apt install {package}")
    return found[-1]


def archive_versions() -> dict[str, str]:
    """Provenance of what is linked with: the SHA-256 of each archive; RuntimeError where something is missing."""
    linker(LINKER)
    return {name: f"sha256 {sha256(archive(name).read_bytes()).hexdigest()}" for name in ARCHIVES}


def linked_module(content: bytes, library: str, exported: Sequence[str]) -> bytes:
    """The WebAssembly module of one object file."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "kernels.o").write_bytes(content)
        command = [
            linker(LINKER), "-m", TARGETS[WASM].emulation, "--no-entry", "--import-memory", "--strip-all",
            "--gc-sections", "-O2", "--compress-relocations", f"--initial-memory={FIRST}",
            f"--global-base={place_of(library)}", "-z", f"stack-size={SLOT // 2}",
            *(f"--export={library}_{name}" for name in exported), "kernels.o", *map(str, map(archive, ARCHIVES)),
            "-o", "kernels.wasm",
        ]  # fmt: skip
        subprocess.run(command, cwd=folder, check=True)
        return (folder / "kernels.wasm").read_bytes()
