"""Truth tests of the flight on the kernels for Linux where the C library is musl, on x86-64 and, emulated, on aarch64.

A host of C is linked with musl (apt install musl-tools), which loads the libraries that the repository keeps::

    pytest -m slow tests/vibeam/flight/test_truth_on_musl.py

For aarch64 (apt install qemu-user gcc-aarch64-linux-gnu) MUSL_AARCH64 names a folder with Debian's packages ``musl``
and ``musl-dev`` for it, unpacked by ``dpkg -x``.
"""

from __future__ import annotations

import lzma
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import hosted_kernels
import pytest
from hosted_kernels import SOURCE, Host
from test_truth_in_webassembly import IN_WEBASSEMBLY as TRUTH

from vibeam.flight.ahead_of_time.scenes import SCENES
from vibeam.flight.engine.entries import ENTRIES
from vibeam.flight.engine.loading import FOLDER, KEPT, file_of, level_of_processor

globals().update({name: vars(module)[name] for module, names in TRUTH.items() for name in names})

AARCH64 = Path(os.environ.get("MUSL_AARCH64", "nowhere"))
COMPILER, CROSS_COMPILER, EMULATOR = "musl-gcc", "aarch64-linux-gnu-gcc", "qemu-aarch64"

pytestmark = pytest.mark.slow


class Unpacking(Host):
    """A host that is given libraries as they are unpacked."""

    folder: Path

    def _process(self, library: str) -> subprocess.Popen[bytes]:
        if library not in self._processes:
            path, pipe = self.folder / f"{library}.so", subprocess.PIPE
            path.write_bytes(lzma.decompress(file_of(library, self.level).read_bytes()))
            self._processes[library] = subprocess.Popen([*self.command, str(path)], stdin=pipe, stdout=pipe)
        return self._processes[library]


def here(folder: Path) -> list[str]:
    """The command of a host for this machine."""
    if not shutil.which(COMPILER):
        pytest.skip("no musl")
    subprocess.run([COMPILER, "-O1", "-w", str(SOURCE), "-o", "host"], cwd=folder, check=True)
    return [str(folder / "host")]


def on_aarch64(folder: Path) -> list[str]:
    """The command of a host for aarch64, emulated."""
    if not (shutil.which(CROSS_COMPILER) and shutil.which(EMULATOR) and AARCH64.exists()):
        pytest.skip("no emulator, no cross compiler, or MUSL_AARCH64 names no folder")
    name, loader = "aarch64-linux-musl", "/lib/ld-musl-aarch64.so.1"
    headers, parts, libc = (
        AARCH64 / "usr/include" / name,
        AARCH64 / "usr/lib" / name,
        AARCH64 / "lib" / name / "libc.so",
    )
    (folder / "lib").mkdir()
    shutil.copy(libc, folder / loader[1:])
    words = [
        "-O1",
        "-w",
        "-nostdinc",
        "-isystem",
        str(headers),
        "-nostdlib",
        "-no-pie",
        f"-Wl,--dynamic-linker={loader}",
    ]
    objects = [*(str(parts / each) for each in ("crt1.o", "crti.o", "crtn.o")), str(libc)]
    subprocess.run([CROSS_COMPILER, *words, str(SOURCE), *objects, "-lgcc", "-o", "host"], cwd=folder, check=True)
    return [EMULATOR, "-L", str(folder), str(folder / "host")]


@pytest.fixture(scope="module", params=KEPT)
def host(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Unpacking]:
    folder, level = tmp_path_factory.mktemp("host"), request.param
    if level != "aarch64" and level_of_processor() not in KEPT[: KEPT.index(level) + 1]:
        pytest.skip(f"this processor has not {level}")
    found = Unpacking(level, on_aarch64(folder) if level == "aarch64" else here(folder))
    found.folder = folder
    yield found
    found.end()


@pytest.fixture(autouse=True)
def elsewhere(host: Host, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(hosted_kernels, "LIBRARIES", FOLDER)
    before = sum(host.calls.values())
    with host.hosting():
        yield
    assert sum(host.calls.values()) > before  # the test did fly there


def test_every_function_runs_there(host: Unpacking) -> None:
    assert b"/lib/ld-musl-" in (host.folder / "host").read_bytes()
    before = dict(host.calls)
    for _, scenes in SCENES.values():
        for scene in scenes:
            scene()
    called = {name for name, number in host.calls.items() if number > before.get(name, 0)}
    assert called == {f"{each.library}_{each.name}" for each in ENTRIES}
