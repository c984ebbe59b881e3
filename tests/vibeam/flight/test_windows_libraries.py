"""The processor's level under Windows: a function of the libraries tells its flags, and loading takes them.

The function is run here as Windows calls it; and by wine, in the libraries that VIBEAM_LIBRARIES names.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from host_programs import NATIVE, PROGRAMS, missing

from vibeam.flight.engine import loading
from vibeam.flight.engine.entries import tabulate
from vibeam.flight.engine.loading import V2, V3

llvm = pytest.importorskip("llvmlite.binding", reason="no numba")
from vibeam.flight.ahead_of_time import __main__ as making  # noqa: E402
from vibeam.flight.ahead_of_time import emit  # noqa: E402
from vibeam.flight.ahead_of_time.wrapper import Compiled  # noqa: E402

WINDOWS = [name for name in PROGRAMS if name.startswith("Windows")]
ASKED = """
declare win64cc i32 @processor(ptr)
define i32 @asked(ptr %to) {
  %found = call win64cc i32 @processor(ptr %to)
  ret i32 %found
}
"""
KERNEL = "define i32 @kernel(ptr %results, ptr %fault) {\n  ret i32 0\n}"
here = pytest.mark.skipif(not NATIVE, reason="another processor, or another system than Linux")


@pytest.fixture
def asked() -> Iterator[Callable[[int], int]]:
    """``processor`` of the libraries for Windows."""
    target = emit.TARGETS["x86-64-v2"]
    machine = emit._machine(target)
    engine = llvm.create_mcjit_compiler(emit._parsed(emit.OF_WINDOWS + ASKED, machine, target), machine)
    engine.finalize_object()
    yield ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p)(engine.get_function_address("asked"))
    engine.close()


def level_there(processor: Callable[[int], int], monkeypatch: pytest.MonkeyPatch) -> str | None:
    """The level that loading takes under Windows, where its library has this function."""
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setattr("platform.machine", lambda: "AMD64")
    levels = {"libraries": {"tables": {"levels": {"windows-x86-64-v2": "digest"}}}}
    monkeypatch.setattr(loading, "manifest", lambda: levels)
    monkeypatch.setattr(loading, "_opened", lambda path, digest: SimpleNamespace(processor=Function(processor)))
    monkeypatch.setattr(loading, "_flags_of_windows", loading._flags_of_windows.__wrapped__)
    return loading.level_of_processor()


class Function:
    """A function of a library as ctypes has it."""

    argtypes: tuple[type, ...] = ()

    def __init__(self, work: Callable[[int], int]) -> None:
        self.work = work

    def __call__(self, address: int) -> int:
        assert self.argtypes == (ctypes.c_void_p,)
        return self.work(address)


@here
def test_the_flags_are_those_that_linux_names(asked: Callable[[int], int]) -> None:
    found = (ctypes.c_uint64 * 4)()
    assert asked(ctypes.addressof(found)) == 0
    assert loading.flags_in(*found) == loading._flags(Path("/proc/cpuinfo")) & V3


@here
def test_loading_takes_the_level_of_this_processor(
    asked: Callable[[int], int], monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = loading.level_of_processor()
    assert level_there(asked, monkeypatch) == f"windows-{expected}"


def bits(flags: set[str]) -> list[int]:
    """What ``processor`` stores for these flags."""
    registers = [sum(1 << bit for name, bit in each.items() if name in flags) for each in loading.REGISTERS]
    registers[0] += sum(1 << bit for name, bit in loading.VECTORS.items() if name in flags)
    return [*registers, 7 if "xsave" in flags else 0]


@pytest.mark.parametrize(("flags", "level"), [
    (V3, "windows-x86-64-v3"), (V3 - {"bmi2"}, "windows-x86-64-v2"), (V3 - {"xsave"}, "windows-x86-64-v2"),
    (V2, "windows-x86-64-v2"), (V2 - {"popcnt"}, None),
])  # fmt: skip
def test_loading_takes_the_highest_level_that_the_flags_allow(
    flags: set[str], level: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stored(address: int) -> int:
        ctypes.memmove(address, (ctypes.c_uint64 * 4)(*bits(flags)), 32)
        return 0

    assert level_there(stored, monkeypatch) == level


def test_a_system_that_keeps_no_wide_registers_has_the_lower_level(monkeypatch: pytest.MonkeyPatch) -> None:
    def stored(address: int) -> int:
        ctypes.memmove(address, (ctypes.c_uint64 * 4)(*bits(V3)[:3], 3), 32)
        return 0

    assert level_there(stored, monkeypatch) == "windows-x86-64-v2"


@pytest.mark.parametrize(("library", "level", "exported"), [
    ("tables", "windows-x86-64-v2", True), ("tables", "windows-x86-64-v3", True),
    ("moreau", "windows-x86-64-v2", False), ("tables", "macos-arm64", False),
])  # fmt: skip
def test_the_tables_for_windows_export_the_function(library: str, level: str, exported: bool) -> None:
    part = Compiled(tabulate, KERNEL, "kernel", [], ["d"], [])
    try:
        content = making._packed(library, [part], level)
    except RuntimeError as reason:
        pytest.skip(str(reason))
    assert (b"\0processor\0" in content) == exported
    assert f"{library}_tabulate\0".encode() in content


@pytest.mark.slow
@here
@pytest.mark.parametrize("name", WINDOWS)
def test_wine_tells_the_flags_that_linux_names(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if reason := missing(name):
        pytest.skip(reason)
    expected, host = loading.level_of_processor(), PROGRAMS[name].begun(tmp_path)

    def processor(address: int) -> int:
        status, registers, _ = host.called(*loading.ASKED, bytes(32), b"", b"")
        ctypes.memmove(address, registers, 32)
        return status

    assert level_there(processor, monkeypatch) == f"windows-{expected}"
    host.end()
