"""Build hook of the wheels: each holds the libraries of compiled kernels of its own system, and no others.

``VIBEAM_WHEEL``: the wheel wanted, one of ``WHEELS`` or ``pure``; without it that of this machine.
``VIBEAM_LIBRARIES``: the folder of libraries to take, as ``python -m vibeam.flight.ahead_of_time FOLDER --levels all``
makes it; without it those of the checkout. In a source archive there are none: where numba and the linker are there
they are made, else the wheel is pure, and needs numba. A wheel that was asked for by name is made as asked or refused.

``python .ci/build_hook.py`` prints the names of the wheels.
"""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
from hashlib import sha256
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import sys_tags

X86 = ("x86-64-v3", "x86-64-v2")
WHEELS = {  # by the tag of the platform: the levels that it holds
    "manylinux_2_5_x86_64": X86,
    "musllinux_1_2_x86_64": X86,
    "manylinux_2_17_aarch64": ("aarch64",),
    "musllinux_1_2_aarch64": ("aarch64",),
    "win_amd64": ("windows-x86-64-v3", "windows-x86-64-v2"),
    "macosx_11_0_arm64": ("macos-arm64",),
    "macosx_11_0_x86_64": ("macos-x86-64-v2",),
}
PURE, WASM = "pure", "wasm"
LINKERS = {"win": "lld-link", "mac": "ld64.lld"}  # by the tag's beginning; else ld.lld
GROUPS = ("kernels", "points.", "regimes.", "contacts.", "tangents.")  # modules of each have other sources
PLACE = "vibeam/flight/libraries"
MAKE = "python -m vibeam.flight.ahead_of_time"
SUFFIXES = {"windows": "dll", "macos": "dylib", WASM: "gz"}


class Unavailable(Exception):
    """Why a folder's libraries cannot be taken, or none can be made."""


class LibrariesHook(BuildHookInterface):
    """The hook."""

    def dependencies(self) -> list[str]:
        """What making libraries takes, where they will be made."""
        try:
            wheel = wanted()
            if wheel in WHEELS and not os.environ.get("VIBEAM_LIBRARIES") and not self._kept(wheel):
                linker_of(wheel)
                core = self.metadata.core
                return [*core.dependencies, *core.optional_dependencies["jit"]]
        except Unavailable:
            pass
        return []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Give the wheel its libraries, their manifest and its tag; without any it is pure and needs numba."""
        if version == "editable":
            return
        self.place = TemporaryDirectory(prefix="vibeam-")
        asked = bool(os.environ.get("VIBEAM_WHEEL") or os.environ.get("VIBEAM_LIBRARIES"))
        try:
            wheel = wanted()
            if wheel != PURE:
                build_data["force_include"] |= self._held(wheel)
                build_data |= {"pure_python": False, "tag": f"py3-none-{wheel}"}
                return
        except Unavailable as fault:
            if asked:
                self.place.cleanup()
                self.app.abort(str(fault))
            self.app.display_warning(f"{fault}: this wheel holds no compiled kernels, and needs numba")
        build_data["dependencies"] += self.metadata.core.optional_dependencies["jit"]

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Leave nothing behind."""
        if version != "editable":
            self.place.cleanup()

    def _kept(self, wheel: str) -> bool:
        """Whether the checkout keeps a wheel's libraries."""
        try:
            return bool(taken(Path(self.root) / PLACE, wheel, Path(self.root)))
        except Unavailable:
            return False

    def _held(self, wheel: str) -> dict[str, str]:
        """{file: its place in the wheel} of its libraries, made where there are none, and of their manifest."""
        root, folder = Path(self.root), Path(os.environ.get("VIBEAM_LIBRARIES") or Path(self.root) / PLACE)
        if not os.environ.get("VIBEAM_LIBRARIES") and not self._kept(wheel):
            folder = Path(self.place.name) / "made"
            self.app.display_info(f"compiling the kernels for {wheel}: minutes (VIBEAM_WHEEL=pure leaves them out)")
            made(folder, wheel, root)
        files = taken(folder, wheel, root)
        own = Path(self.place.name) / "manifest.json"
        own.write_text(manifest_of(folder, wheel), encoding="utf-8")
        return {str(own): f"{PLACE}/manifest.json"} | {str(folder / each): f"{PLACE}/{each}" for each in files}


def wanted() -> str:
    """The wheel wanted; Unavailable for a name that is none, and where no wheel is for this machine."""
    asked = os.environ.get("VIBEAM_WHEEL")
    if asked:
        if asked not in (*WHEELS, PURE):
            raise Unavailable(f"VIBEAM_WHEEL: {asked!r} is none of {', '.join((*WHEELS, PURE))}")
        return asked
    for each in sys_tags():
        if each.platform in WHEELS:
            return each.platform
    raise Unavailable(f"there are no compiled kernels for {sys.platform} on {platform.machine()}")


def taken(folder: Path, wheel: str, root: Path) -> list[str]:
    """Names of a wheel's libraries in a folder; Unavailable where one is missing, damaged or stale."""
    if not (folder / "manifest.json").exists():
        raise Unavailable(f"{folder} has no libraries of kernels ({MAKE} {folder} --levels all makes them)")
    libraries = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["libraries"]
    faults, files, sources = [], [], sources_in(root)
    for library, about in libraries.items():
        if about["sources"] not in sources:
            faults.append(f"{library} is older than its sources")
        for level in (*WHEELS[wheel], *((WASM,) if WASM in about["levels"] else ())):
            name = f"{level}/{library}.{SUFFIXES.get(level.partition('-')[0], 'xz')}"
            files.append(name)
            if level not in about["levels"] or not (folder / name).exists():
                faults.append(f"{name} is not there")
            elif sha256((folder / name).read_bytes()).hexdigest() != about["levels"][level]:
                faults.append(f"{name} is damaged")
    if faults:
        raise Unavailable(f"{folder}: {', '.join(faults)} ({MAKE} makes libraries anew)")
    return sorted(files)


def manifest_of(folder: Path, wheel: str) -> str:
    """The manifest of a wheel's libraries alone, with the digest of itself that ``engine.loading`` asks for."""
    whole = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
    del whole["sha256"]
    for about in whole["libraries"].values():
        about["levels"] = {name: of for name, of in about["levels"].items() if name in (*WHEELS[wheel], WASM)}
    digest = sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()
    return json.dumps(whole | {"sha256": digest}, indent=1) + "\n"


def sources_in(root: Path) -> set[str]:
    """Digests of the kernels' sources, one for each set of files that libraries are compiled from."""
    described = spec_from_file_location("kernel_sources", root / "vibeam/flight/kernels/sources.py")
    assert described is not None
    assert described.loader is not None
    module = module_from_spec(described)
    described.loader.exec_module(module)
    return {module.digest(module.sources_of(f"vibeam.flight.{group}")) for group in GROUPS}


def linker_of(wheel: str) -> str:
    """The linker of a wheel's system; Unavailable where it is not installed, or the processor runs no such kernels."""
    if platform.machine() not in ("x86_64", "AMD64"):
        raise Unavailable(f"kernels are compiled on x86-64, not on {platform.machine()}")
    name = LINKERS.get(wheel[:3], "ld.lld")
    found = any(map(shutil.which, (name, *(f"{name}-{version}" for version in range(30, 13, -1)))))
    if not found:
        raise Unavailable(f"{name}, LLVM's linker, is not installed to make them by")
    return name


def made(folder: Path, wheel: str, root: Path) -> None:
    """Make a wheel's libraries, those of pages where there is wasi-libc; Unavailable without numba or the linker."""
    linker_of(wheel)
    if find_spec("numba") is None:
        raise Unavailable("numba is not installed to compile them by")
    paths = (root, root / "models", root / "reductions", os.environ.get("PYTHONPATH"))  # pip's, of what it installed
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, filter(None, paths)))}
    asked = "from vibeam.flight.ahead_of_time.webassembly import archive_versions as a; a()"
    pages = subprocess.run([sys.executable, "-c", asked], cwd=root, env=environment, capture_output=True)
    levels = [*WHEELS[wheel], *((WASM,) if pages.returncode == 0 else ())]
    command = [sys.executable, "-m", "vibeam.flight.ahead_of_time", str(folder), "--levels", *levels]
    done = subprocess.run(command, cwd=root, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise Unavailable(f"the kernels could not be compiled: {(done.stderr or done.stdout).strip()[-500:]}")


if __name__ == "__main__":
    print("\n".join(WHEELS))
