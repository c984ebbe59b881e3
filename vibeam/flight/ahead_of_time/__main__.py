"""``python -m vibeam.flight.ahead_of_time [FOLDER] [--only GROUP] [--levels all]``: make libraries anew.

In place those that the repository keeps, of Linux and web pages; elsewhere also those of other systems, for wheels.
All of them, or those of one group of ``scenes.SCENES`` alone: the others stay as they are.

Needs numba (extra ``jit``), LLVM's linkers (Debian's package ``lld``), and wasi-libc for ``wasm``, the level of web
pages. Each group of entry points is compiled in a process of its own, since numba reads its settings when it is
imported, for x86-64-v3; what numba has optimised is emitted for every level.
"""

from __future__ import annotations

import gzip
import json
import lzma
import os
import shutil
import subprocess
import sys
from argparse import SUPPRESS, ArgumentParser
from collections.abc import Sequence
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from vibeam.flight.ahead_of_time.emit import TARGETS, emitted
from vibeam.flight.ahead_of_time.linking import linked, linker_version
from vibeam.flight.ahead_of_time.scenes import SCENES
from vibeam.flight.ahead_of_time.webassembly import archive_versions, linked_module
from vibeam.flight.ahead_of_time.wrapper import Compiled, compiled
from vibeam.flight.engine.browser import LIBRARIES
from vibeam.flight.engine.entries import ENTRIES
from vibeam.flight.engine.loading import ASKED, FOLDER, KEPT, LINUX, WASM, file_of, manifest, system_of, write_manifest
from vibeam.flight.kernels.sources import digest, sources_of

GROUPS = ("points", "contacts", "regimes", "flight", "tangents", "tangent_maps", "moreau")  # the longest first

IN_PLACE = (*KEPT, WASM)
SETTINGS = {
    "VIBEAM_KERNELS": "numba",
    "NUMBA_CPU_NAME": "x86-64-v3",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_DISABLE_INTEL_SVML": "1",
}


def build(folder: Path, groups: Sequence[str] = GROUPS, levels: Sequence[str] = IN_PLACE) -> None:
    """Make these libraries and their manifest in ``folder``; CalledProcessError, and no change, where a group fails."""
    made_with = {"numba": version("numba"), "llvmlite": version("llvmlite"), "linker": linker_version(levels)}
    made_with |= archive_versions() if WASM in levels else {}
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as cache, TemporaryDirectory() as fresh:
        environment = os.environ | SETTINGS | {"NUMBA_CACHE_DIR": cache}  # what numba has cached has no LLVM module
        for process in [_begun(group, fresh, levels, environment) for group in groups]:
            if process.wait():
                raise subprocess.CalledProcessError(process.returncode, process.args)
        about: dict[str, Any] = {} if set(groups) == set(GROUPS) else dict(manifest(folder)["libraries"])
        for part in [Path(fresh) / f"{group}.json" for group in groups]:
            about |= json.loads(part.read_text(encoding="utf-8"))
            part.unlink()
        shutil.copytree(fresh, folder, dirs_exist_ok=True)
    write_manifest(folder, made_with, about)


def _begun(group: str, folder: str, levels: Sequence[str], environment: dict[str, str]) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "vibeam.flight.ahead_of_time", folder, "--group", group, "--levels", *levels]
    return subprocess.Popen(command, env=environment)


def build_group(group: str, folder: Path, levels: Sequence[str]) -> None:
    """Compile a group's entry points, write their libraries into ``folder`` and what they are into ``GROUP.json``."""
    libraries, scenes = SCENES[group]
    entries = [each for each in ENTRIES if each.library in libraries]
    sources = {each.library: digest(sources_of(each.module)) for each in entries}  # before they are compiled
    for scene in scenes:
        scene()
    parts = {library: [compiled(each) for each in entries if each.library == library] for library in libraries}
    about = {library: _about(sources[library], parts[library]) for library in libraries}
    for level in filter(levels.__contains__, TARGETS):  # WASM last: after it LLVM gives other bytes for x86-64
        for library in libraries:
            if level != WASM or library in LIBRARIES:
                about[library]["levels"][level] = _written(library, parts[library], level, folder)
    (folder / f"{group}.json").write_text(json.dumps(about), encoding="utf-8")


def _about(sources: str, parts: Sequence[Compiled]) -> dict[str, Any]:
    """A library's part of the manifest, without its levels."""
    entries = {
        part.entry.name: {"arguments": part.arguments, "results": part.results, "names": part.names} for part in parts
    }
    return {"sources": sources, "entries": entries, "levels": {}}


def _written(library: str, parts: Sequence[Compiled], level: str, folder: Path) -> str:
    """Write a library for a level; the SHA-256 of its file."""
    path, packed = file_of(library, level, folder), _packed(library, parts, level)
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(packed)
    return sha256(packed).hexdigest()


def _packed(library: str, parts: Sequence[Compiled], level: str) -> bytes:
    """The library for a level as it is kept; what pages do not call is left out of theirs."""
    if level != WASM:
        exported = [f"{library}_{part.entry.name}" for part in parts]
        exported += ASKED[1:] if (library, system_of(level)) == (ASKED[0], "windows") else ()
        content = linked(emitted(library, parts, level), level, exported)
        return lzma.compress(content, preset=9 | lzma.PRESET_EXTREME) if system_of(level) == LINUX else content
    called = [part for part in parts if part.entry.name in LIBRARIES[library]]
    content = linked_module(emitted(library, called, level), library, [part.entry.name for part in called])
    return gzip.compress(content, compresslevel=9, mtime=0)


def main() -> None:
    """The command."""
    asked = ArgumentParser(prog="python -m vibeam.flight.ahead_of_time", description="Make the compiled kernels anew.")
    asked.add_argument("folder", nargs="?", type=Path, default=FOLDER, help="where to (in place)")
    asked.add_argument("--only", choices=GROUPS, help="the libraries of one group alone")
    asked.add_argument("--levels", nargs="+", choices=(*TARGETS, "all"), default=IN_PLACE, help="levels of processors")
    asked.add_argument("--group", choices=GROUPS, help=SUPPRESS)  # in the process of its own that ``build`` begins
    given, begun = asked.parse_args(), perf_counter()
    folder, levels = given.folder, tuple(TARGETS) if "all" in given.levels else tuple(given.levels)
    if given.group:
        build_group(given.group, folder, levels)
        return
    if folder == FOLDER and not set(levels) <= set(IN_PLACE):
        sys.exit("the repository keeps the libraries of Linux and of web pages: name a folder for the others")
    try:
        build(folder, [given.only] if given.only else GROUPS, levels)
    except RuntimeError as missing:
        sys.exit(str(missing))
    size = sum(file.stat().st_size for file in folder.glob("*/*") if file.suffix != ".py")
    print(f"{folder}: {size / 1e6:.2f} MB, {perf_counter() - begun:.0f} s")


if __name__ == "__main__":
    main()
