"""Libraries for macOS, judged and run without that system: what its loader would refuse is refused here.

Small ones are linked on the spot; all of them are judged where VIBEAM_LIBRARIES names a folder with them (see
``test_truth_elsewhere``, which flies on them).
"""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import mach_o
import mach_o_image
import numpy as np
import pytest
from host_programs import PROGRAMS
from hosted_kernels import LIBRARIES
from mach_o_fixups import Unreadable

from vibeam.flight.engine.entries import ENTRIES
from vibeam.flight.engine.loading import file_of, manifest

pytest.importorskip("llvmlite.binding", reason="no numba")
from vibeam.flight.ahead_of_time import emit, linking

MACOS = {"macos-arm64": "arm64", "macos-x86-64-v2": "x86_64"}
LOWEST = "11.0"
SYSTEM = {f"_{name}" for name in linking.CALLED[linking.SYSTEM] if not name.startswith(r"\01")} | {"dyld_stub_binder"}
SMALL = """
@functions = internal constant [2 x ptr] [ptr @cos, ptr @own]
declare double @cos(double) memory(none)
declare double @sin(double) memory(none)
declare void @llvm.memset.p0.i64(ptr, i8, i64, i1)
define double @own(double %x) {
  %y = fadd double %x, 1.0
  ret double %y
}
define i32 @small_entry(ptr %slots) {
  %which = load i64, ptr %slots
  %at = getelementptr [2 x ptr], ptr @functions, i64 0, i64 %which
  %function = load ptr, ptr %at
  %second = getelementptr i64, ptr %slots, i64 1
  %x = load double, ptr %second
  %found = call double %function(double %x)
  %sine = call double @sin(double %x)
  %cosine = call double @cos(double %x)
  %product = fmul double %sine, %cosine
  %sum = fadd double %product, %found
  store double %sum, ptr %second
  %third = getelementptr i64, ptr %slots, i64 2
  %size = load i64, ptr %third
  %address = getelementptr i64, ptr %slots, i64 3
  %to = load ptr, ptr %address
  call void @llvm.memset.p0.i64(ptr %to, i8 0, i64 %size, i1 false)
  ret i32 7
}
"""  # a pointer to another's function and to one's own, sines and cosines at once, a memory of zeros


@cache
def small(level: str) -> bytes:
    """A library with the function ``small_entry``; skipped without the linker."""
    target = emit.TARGETS[level]
    code = emit.object_code(SMALL.replace("define i32", target.support + "\ndefine i32"), target)
    try:
        return linking.linked(code, level, ["small_entry"])
    except RuntimeError as reason:
        pytest.skip(str(reason))


def judge(content: bytes, processor: str, exported: set[str]) -> mach_o.MachO:
    """The library, once everything that can be known of it without its system has been compared."""
    found = mach_o.read(content)
    assert (found.processor, found.lowest) == (processor, LOWEST)
    assert found.needed == [linking.SYSTEM]
    assert len(found.one(mach_o.UUID)) == 16
    assert set(found.exports) == exported
    for address in found.exports.values():
        assert found.segment_at(address).protection == mach_o.READ | mach_o.EXECUTE
    bound = {each.name for each in found.bindings}
    own, wanted = found.symbols()
    assert (own, wanted - {"dyld_stub_binder"}) == (exported, bound - {"dyld_stub_binder"})
    assert bound <= SYSTEM
    assert {each.library for each in found.bindings} <= {1}
    for address in [*found.rebased, *(each.address for each in found.bindings)]:
        assert found.segment_at(address).protection == mach_o.READ | mach_o.WRITE
    for target in found.rebased.values():
        found.segment_at(target, 1)
    signed = mach_o.signature(found)
    if processor == "arm64":
        assert signed is not None
        assert signed.flags == mach_o.AD_HOC | mach_o.LINKER_SIGNED
    return found


libraries = pytest.mark.skipif(
    not all((LIBRARIES / level).exists() for level in MACOS), reason="VIBEAM_LIBRARIES names no libraries for macOS"
)


@libraries
@pytest.mark.parametrize("library", sorted({each.library for each in ENTRIES}))
@pytest.mark.parametrize("level", MACOS)
def test_libraries_for_macos_have_their_entries_and_call_the_system_alone(level: str, library: str) -> None:
    exported = {f"_{library}_{each}" for each in manifest(LIBRARIES)["libraries"][library]["entries"]}
    judge(file_of(library, level, LIBRARIES).read_bytes(), MACOS[level], exported)


@pytest.mark.parametrize("level", MACOS)
def test_a_small_library_is_judged(level: str) -> None:
    found = judge(small(level), MACOS[level], {"_small_entry"})
    assert {"_cos", "___sincos_stret"} <= {each.name for each in found.bindings}
    assert len(found.rebased) >= 1


@pytest.mark.parametrize(("level", "fault", "change"), [
    ("macos-arm64", "page 0 is not what was signed", lambda content: content[:2000] + b"\1" + content[2001:]),
    ("macos-arm64", "bytes behind the last segment", lambda content: content + bytes(8)),
    ("macos-arm64", "a hole in the file|bytes behind", lambda content: content[:-16]),
    ("macos-x86-64-v2", "no Mach-O file of 64 bits", lambda content: b"MZ" + content[2:]),
    ("macos-x86-64-v2", "for processor", lambda content: content[:4] + b"\2" + content[5:]),
    ("macos-x86-64-v2", "undefined names", lambda content: content[:24] + bytes(4) + content[28:]),
    ("macos-x86-64-v2", "written and run", lambda content: content.replace(
        struct.pack("<2I", 5, 5), struct.pack("<2I", 7, 7), 1)),
])  # fmt: skip
def test_a_changed_library_is_refused(level: str, fault: str, change: Callable[[bytes], bytes]) -> None:
    changed = change(small(level))
    with pytest.raises(Unreadable, match=fault):
        mach_o.signature(mach_o.read(changed))


@pytest.mark.parametrize("name", ["macOS, x86-64", "macOS, arm64"])
def test_a_small_library_runs_mapped_as_its_system_would(name: str, tmp_path: Path) -> None:
    program = PROGRAMS[name]
    if program.missing:
        pytest.skip(program.missing)
    (tmp_path / "small.dylib").write_bytes(small(program.level))
    image = mach_o_image.written(tmp_path / "small.dylib", tmp_path)
    command = [*program.compiled(tmp_path), str(image)]
    for which, expected in ((0, np.cos(0.3)), (1, 1.3)):
        slots = struct.pack("=qdq", which, 0.3, 16) + bytes(8)
        given = struct.pack("=4q", 11, 4, 1, 24) + b"small_entry" + slots + struct.pack("=2q", 3, 0) + b"\1" * 24
        done = subprocess.run(command, input=given, capture_output=True, check=True).stdout
        status, _, value = struct.unpack_from("=2qd", done)
        assert (status, done[-24:]) == (7, bytes(16) + b"\1" * 8)
        assert value == pytest.approx(expected + np.sin(0.3) * np.cos(0.3), abs=1e-15)
