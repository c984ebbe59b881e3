"""Kernels compiled ahead of time: they are those of the sources, give numba's bits, and are chosen with a reason."""

from __future__ import annotations

import json
import logging
import lzma
import os
import resource
import shutil
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import vibeam
from vibeam.flight.ahead_of_time.__main__ import build
from vibeam.flight.disturbance.tangent import TangentMaps
from vibeam.flight.engine import browser, entries, loading
from vibeam.flight.engine.entries import ENTRIES, EntryPoint, march, move, poses_at, tabulate
from vibeam.flight.engine.loading import (
    FOLDER,
    KernelsUnavailable,
    LibraryUnavailable,
    file_of,
    manifest,
    write_manifest,
)
from vibeam.flight.engine.loading import KEPT as LIBRARY_LEVELS
from vibeam.flight.kernels import layout
from vibeam.flight.kernels.sources import digest, sources_of
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution, TableRestitution, ViscousRestitution

ROOT = Path(__file__).parents[3]

HERE = loading.level_of_processor()

needs_library = pytest.mark.skipif(HERE is None, reason="no library for this machine")

BY_NUMBA = os.environ.get(entries.VARIABLE) == "numba"

DRIVE = vibeam.Drive(95.0, 2e-4)

TWO = vibeam.ImpactSystem.from_modes([47.7, 635.0], 0.017, contact=[2.12, 0.31], load=[0.46, 0.09], gap=0.0)

COUPLED = np.array([[1.6, -0.5], [-0.5, 21.6]])

SYSTEMS = {
    "one mode": vibeam.ImpactSystem.from_modes([50.0], 0.017, contact=[2.0], load=[0.5], restitution=0.9),
    "two modes": replace(TWO, restitution=0.72),
    "nine modes": vibeam.ImpactSystem.from_modes(
        47.7 * np.arange(1, 10) ** 2, 0.01, contact=2.0 / np.arange(1, 10), load=0.5 / np.arange(1, 10), restitution=0.6
    ),
    "chatter": replace(TWO, restitution=0.3, gap=-1e-5),
    "Hertz": replace(TWO, law=HuntCrossley(1e8)),
    "Hunt–Crossley": replace(TWO, law=HuntCrossley(1e8, 0.4)),
    "linear stop": replace(TWO, law=LinearStop(1e5, 3.0)),
    "two stops": replace(TWO, restitution=0.8, second_gap=1e-4),
    "coupled damping": replace(TWO, restitution=0.7, coupling=COUPLED),
    "plastic": replace(TWO, law=PlasticRestitution(0.8, 0.01)),
    "viscous": replace(TWO, law=ViscousRestitution(0.1, 0.2)),
    "table": replace(TWO, law=TableRestitution((1e-3, 1e-1), (0.9, 0.6))),
}


@pytest.mark.parametrize("library", sorted({each.library for each in ENTRIES}))
def test_libraries_are_made_from_the_kernels_as_they_are(library: str) -> None:
    about = manifest()["libraries"][library]
    entries = [each for each in ENTRIES if each.library == library]
    assert {digest(sources_of(each.module)) for each in entries} == {about["sources"]}, f"run {loading.BUILD}"
    assert set(about["entries"]) == {each.name for each in entries}
    assert set(about["levels"]) == {*LIBRARY_LEVELS} | ({loading.WASM} if library in browser.LIBRARIES else set())
    for level, expected in about["levels"].items():
        packed = file_of(library, level).read_bytes()
        assert sha256(packed).hexdigest() == expected
        if level == loading.WASM:
            continue
        content = lzma.decompress(packed)
        assert len(content) < loading.MOST
        assert content[:5] == b"\x7fELF\x02"
        assert int.from_bytes(content[18:20], "little") == (183 if level == "aarch64" else 62)  # e_machine


def test_libraries_are_small() -> None:
    assert sum(file.stat().st_size for file in FOLDER.glob("*/*z")) < 3e6


def taken(entry: EntryPoint, level: str | None = None) -> Callable[..., Any]:
    """The function of a library."""
    return loading.function_of(entry.library, entry.module, entry.name, level)


def use(monkeypatch: pytest.MonkeyPatch, function: Callable[[EntryPoint], Callable[..., Any]]) -> None:
    """Let every entry point be what ``function`` gives for it."""
    for entry in ENTRIES:
        monkeypatch.setitem(vars(entry), "function", function(entry))


def motion(system: vibeam.ImpactSystem) -> list[np.ndarray[Any, Any]]:
    """Numbers of everything that the kernels compute: a motion, its poses, its certificate, points of a sweep."""
    path = vibeam.simulate(system, DRIVE, 1.0, certify=True)
    assert path.certificate
    swept = vibeam.sweep(system, omega=[90.0, 97.0], amplitude=2e-4, settle=30, hold=10)
    found = [path.segments.trace, path.modes_at(np.linspace(0, path.t_end, 50)), swept.amplitude, swept.reach]
    tangent = TangentMaps(system, DRIVE, path.segments, path.state).product()
    return [*found, swept.mode_energy, swept.impact_velocities, path.certificate.pieces, tangent]


def both(system: vibeam.ImpactSystem, monkeypatch: pytest.MonkeyPatch, one: Any, other: Any) -> Any:
    """The same motion by two sets of functions."""
    found = []
    for function in (one, other):
        use(monkeypatch, function)
        found.append(motion(system))
    assert len(found[0][0]) > 10
    return zip(*found, strict=True)


@needs_library
@pytest.mark.skipif(
    not BY_NUMBA, reason=f"numba compiles for minutes: {entries.VARIABLE}=numba python -m pytest {__file__}"
)
@pytest.mark.parametrize("name", SYSTEMS)
def test_library_and_numba_give_the_same_bits(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def numba(entry: EntryPoint) -> Callable[..., Any]:
        return entries.compiled(entry.module, entry.name)

    for a, b in both(SYSTEMS[name], monkeypatch, taken, numba):
        np.testing.assert_array_equal(a, b)


@needs_library
@pytest.mark.skipif(BY_NUMBA, reason="both are numba's then")
def test_library_and_numba_give_the_same_bits_of_time_stepping(monkeypatch: pytest.MonkeyPatch) -> None:
    """Time stepping takes a second to compile, all kernels minutes: they run by name."""

    def stepped() -> list[np.ndarray[Any, Any]]:
        swept = vibeam.sweep(TWO, omega=[90.0, 97.0], amplitude=2e-4, settle=4, hold=3, solver="moreau")
        return [swept.amplitude, swept.impact_velocity]

    monkeypatch.setitem(vars(march), "function", taken(march))
    by_library = stepped()
    monkeypatch.setitem(vars(march), "function", entries.compiled(march.module, march.name))
    for a, b in zip(by_library, stepped(), strict=True):
        assert a.any()
        np.testing.assert_array_equal(a, b)


@needs_library
@pytest.mark.parametrize("name", SYSTEMS)
def test_v2_agrees_with_v3(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without fused products, within the round-off of twenty impacts; chaos would have it grow, and is not chosen."""
    if HERE != "x86-64-v3":
        pytest.skip("needs a processor of that level")
    system = SYSTEMS[name]

    def early(level: str) -> Any:
        use(monkeypatch, lambda entry: taken(entry, level))
        return vibeam.simulate(system, DRIVE, 0.6).impact_times[:6]

    np.testing.assert_allclose(early("x86-64-v2"), early("x86-64-v3"), rtol=1e-12)


BLOCKED = "import sys\nsys.modules.update(numba=None, llvmlite=None)  # as if they were not installed\n"

EVERYTHING = """
import numpy as np, vibeam
from dataclasses import replace
from vibeam_models.laws.compliant import HuntCrossley, LinearStop
from vibeam_models.laws.restitution import PlasticRestitution
drive = vibeam.Drive(95.0, 1e-4)
plain = vibeam.ImpactSystem.from_modes([47.7, 635.0], 0.017, contact=[2.12, 0.31], load=[0.46, 0.09], restitution=0.72)
assert vibeam.simulate(plain, drive, 1.0, certify=True).certificate.complete
assert vibeam.orbits(plain, drive)
for change in (
    {"law": HuntCrossley(1e8)}, {"law": LinearStop(1e5, 3.0)}, {"law": PlasticRestitution(0.8, 0.01)},
    {"second_gap": 1e-3}, {"coupling": np.array([[1.6, -0.5], [-0.5, 21.6]])},
):
    path = vibeam.simulate(replace(plain, **change), drive, 1.0, certify=True)
    assert len(path.impact_times) > 5 and path.certificate, change
for solver in ("flight", "orbit", "moreau", "direct"):
    vibeam.sweep(plain, omega=[95.0], amplitude=1e-4, settle=5, hold=5, solver=solver)
"""

COMMANDS = """
from vibeam.cli.main import main
sys.argv = ["vibeam", *{words!r}]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
"""


def without_numba(code: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run ``code`` in a fresh interpreter in which numba cannot be imported."""
    places = {"PYTHONPATH": os.pathsep.join(str(ROOT / part) for part in ("", "models", "reductions"))}
    kept = {name: value for name, value in os.environ.items() if name != entries.VARIABLE}
    command = [sys.executable, "-c", BLOCKED + code]
    return subprocess.run(
        command, env=kept | places | {"MPLBACKEND": "agg"} | environment, cwd=folder, capture_output=True, text=True
    )


@needs_library
def test_everything_works_without_numba(tmp_path: Path) -> None:
    done = without_numba(EVERYTHING, tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@needs_library
@pytest.mark.parametrize("command", ["run", pytest.param("map", marks=pytest.mark.slow)])
def test_commands_work_without_numba(command: str, tmp_path: Path) -> None:
    few = ("sweep.frequency.points=2", "sweep.settle=5", "sweep.hold=2") if command == "run" else ()
    words = [command, str(ROOT / "cases/sdof_nominal.toml"), "--out", "a/"]
    words += [word for each in few for word in ("--set", each)]
    words += [] if command == "run" else ["--picture", "stability"]
    done = without_numba(COMMANDS.format(words=words), tmp_path)
    assert done.returncode == 0, done.stderr
    assert "numba" not in done.stderr


def test_neither_library_nor_numba_is_one_message_with_the_cure(tmp_path: Path) -> None:
    stale = "import pathlib, vibeam.flight.engine.loading as load\nload.level_of_processor = lambda: None\n"
    words = ["run", str(ROOT / "cases/sdof_nominal.toml"), "--out", str(tmp_path / "a.h5")]
    done = without_numba(
        stale + COMMANDS.format(words=words).replace("assert not end.code, end.code", "raise"), tmp_path
    )
    assert done.returncode == 2
    assert "no compiled kernels for this machine" in done.stderr
    assert "pip install 'vibeam[jit]'" in done.stderr
    assert "Traceback" not in done.stderr


def copied(folder: Path) -> Path:
    """The libraries in a folder of their own."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    return folder


@needs_library
def test_stale_missing_and_damaged_libraries_are_named(tmp_path: Path) -> None:
    def refused(folder: Path, entry: EntryPoint = move) -> str:
        with pytest.raises(LibraryUnavailable) as raised:
            loading.function_of(entry.library, entry.module, entry.name, HERE, folder)
        return str(raised.value)

    assert "no compiled kernels for" in refused(tmp_path)
    folder = copied(tmp_path / "a")
    assert "no compiled kernels for" in refused(folder, EntryPoint("flight", move.module, "another"))
    assert HERE is not None
    path = file_of("flight", HERE, folder)
    path.write_bytes(lzma.compress(b"something else"))
    assert "damaged" in refused(folder)
    path.unlink()
    assert "cannot be read" in refused(folder)
    folder = copied(tmp_path / "b")
    about = json.loads((folder / "manifest.json").read_text())
    about["libraries"]["flight"]["sources"] = "0"
    write_manifest(folder, about["made_with"], about["libraries"])
    assert "older than their sources" in refused(folder)


@needs_library
def test_a_library_with_another_digest_is_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = copied(tmp_path / "a")
    assert HERE is not None
    file_of("flight", HERE, folder).write_bytes(lzma.compress(bytes(10**7)))
    for name in ("decompress", "LZMADecompressor"):
        monkeypatch.setattr(lzma, name, lambda *given: pytest.fail("it was unpacked"))
    with pytest.raises(LibraryUnavailable, match="are damaged: install vibeam again"):
        loading.function_of("flight", move.module, move.name, HERE, folder)


def _other_kind(content: str) -> str:
    return content.replace("f8:2", "f8:3", 1)


@pytest.mark.parametrize("change", [
    lambda content: content[:-40], lambda content: "", lambda content: "[]", lambda content: "[" * 9999,
    _other_kind, lambda content: content.replace("libraries", "librarys"), lambda content: "\xff" + content,
])  # fmt: skip
def test_a_damaged_manifest_is_named_and_numba_steps_in(
    change: Callable[[str], str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    folder = copied(tmp_path / "a")
    place = folder / "manifest.json"
    place.write_text(change(place.read_text()), encoding="latin-1")
    monkeypatch.delenv(entries.VARIABLE, raising=False)
    monkeypatch.setattr(entries, "function_of", lambda *given: loading.function_of(*given, folder=folder))
    monkeypatch.setattr(loading, "level_of_processor", lambda: "x86-64-v3")
    with caplog.at_level(logging.WARNING, logger="vibeam"):
        assert hasattr(entries.chosen(move.library, move.module, move.name), "signatures")
    said = [each.getMessage() for each in caplog.records]
    assert len(said) == 1
    assert said[0].startswith(f"the list of compiled kernels, {place}, is damaged (")
    assert said[0].endswith("install vibeam again: numba compiles the kernels")
    assert entries.origin() == "numba"


@needs_library
def test_a_limit_on_the_size_of_files_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loading, "_opened", loading._opened.__wrapped__)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(LibraryUnavailable, match=r"loaded \(files may not have their \d+ kB: raise ulimit -f\)$"):
            loading.function_of(move.library, move.module, move.name)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_numba_steps_in_with_one_line_that_says_why(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.delenv(entries.VARIABLE, raising=False)
    monkeypatch.setattr(loading, "level_of_processor", lambda: None)
    entries._tell.cache_clear()
    with caplog.at_level(logging.WARNING, logger="vibeam"):
        for each in (move, poses_at):
            assert hasattr(entries.chosen(each.library, each.module, each.name), "signatures")
    assert [each.getMessage() for each in caplog.records] == [
        "there are no compiled kernels for this machine: numba compiles the kernels"
    ]
    monkeypatch.setenv(entries.VARIABLE, "library")
    with pytest.raises(KernelsUnavailable, match="VIBEAM_KERNELS=library: there are no"):
        entries.chosen(move.library, move.module, move.name)


def test_a_wrong_variable_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(entries.VARIABLE, "fast")
    with pytest.raises(KernelsUnavailable, match=r"VIBEAM_KERNELS: 'fast' is none of numba, library, x86-64-v3"):
        entries.chosen(move.library, move.module, move.name)


def test_the_level_of_web_pages_is_refused_with_the_others_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(entries.VARIABLE, "wasm")
    said = (
        "VIBEAM_KERNELS: the kernels for wasm run in web pages .*, not here: leave it out, or choose one of x86-64-v3"
    )
    with pytest.raises(KernelsUnavailable, match=said):
        entries.chosen(move.library, move.module, move.name)


FLAGS = "processor : 0\nflags\t\t: fpu {}\nbugs : none\n"


@pytest.mark.parametrize(("missing", "level"), [
    ((), "x86-64-v3"), (("avx2",), "x86-64-v2"), (("fma", "bmi1"), "x86-64-v2"), (("sse4_2",), None),
])  # fmt: skip
def test_the_level_is_that_of_the_processors_flags(
    missing: tuple[str, ...], level: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    monkeypatch.setattr("sys.platform", "linux")
    path = tmp_path / "cpuinfo"
    path.write_text(FLAGS.format(" ".join(sorted(loading.V3 - set(missing)))))
    assert loading.level_of_processor(path) == level
    assert loading.level_of_processor(tmp_path / "none") is None


@pytest.mark.parametrize(("system", "machine", "level"), [
    ("linux", "aarch64", "aarch64"), ("linux", "riscv64", None), ("darwin", "x86_64", "macos-x86-64-v2"),
    ("darwin", "arm64", "macos-arm64"), ("win32", "AMD64", None), ("win32", "ARM64", None), ("freebsd", "x86_64", None),
])  # fmt: skip
def test_other_machines(system: str, machine: str, level: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platform.machine", lambda: machine)
    monkeypatch.setattr("sys.platform", system)
    assert loading.level_of_processor() == level


@needs_library
def test_libraries_load_from_a_folder_where_memory_has_no_files(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: Any, **__: Any) -> int:
        raise OSError("memfd_create: not permitted")

    monkeypatch.setattr(os, "memfd_create", refused)
    loading._opened.cache_clear()
    assert callable(taken(tabulate))
    monkeypatch.setattr("tempfile.mkstemp", refused)
    loading._opened.cache_clear()
    with pytest.raises(LibraryUnavailable, match="cannot be loaded"):
        taken(tabulate)


def tables(rate: float) -> tuple[Any, Any, Any]:
    """What ``tabulate`` works on, for one mode of that damping."""
    pairs, levels, table = (
        np.zeros((layout.PAIR_ROWS, 1)),
        np.zeros((layout.LEVEL_ROWS, layout.LEVELS)),
        np.zeros((layout.TABLE_ROWS, layout.LEVELS, 1)),
    )
    pairs[:3, 0] = 1.0, rate, rate * rate - 1.0
    levels[0] = np.ldexp(1.0, -np.arange(layout.LEVELS))
    return pairs, levels, table


@needs_library
def test_arrays_of_another_type_or_layout_are_refused() -> None:
    function = taken(tabulate)
    pairs, levels, table = tables(0.1)
    frozen = table.copy()
    frozen.flags.writeable = False
    for wrong in (table.astype(np.float32), table[..., 0], np.moveaxis(table, 0, 1), frozen, None, 1.0):
        with pytest.raises((TypeError, ValueError)):
            function(pairs, levels, wrong)
    assert function(pairs, levels, table) is None
    assert table[0, 0, 0] == pytest.approx(
        np.exp(-0.1) * (np.cos(np.sqrt(0.99)) + 0.1 * np.sinc(np.sqrt(0.99) / np.pi))
    )


@needs_library
def test_every_call_works_on_the_arrays_that_it_is_given() -> None:
    """Slots are kept from call to call: of the same arrays, of some others, in any thread."""
    function, expected = taken(tabulate), []
    for rate in (0.1, 0.2, 0.3):
        given = tables(rate)
        function(*given)
        expected.append(given[2])
    assert len({float(each[0, 0, 0]) for each in expected}) == 3
    pairs, levels, _ = tables(0.1)
    for rate, truth in zip((0.1, 0.2, 0.3), expected, strict=True):
        pairs[:3, 0], out = (1.0, rate, rate * rate - 1.0), np.zeros((layout.TABLE_ROWS, layout.LEVELS, 1))
        for _ in range(2):
            out[:] = 0.0
            function(pairs, levels, out)
            np.testing.assert_array_equal(out, truth)

    def work(index: int) -> None:
        given = tables((0.1, 0.2, 0.3)[index % 3])
        for _ in range(200):
            given[2][:] = 0.0
            function(*given)
            agree.append(bool(np.all(given[2] == expected[index % 3])))

    agree: list[bool] = []
    threads = [threading.Thread(target=work, args=(index,)) for index in range(6)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert len(agree) == 1200
    assert all(agree)


@needs_library
def test_large_arrays_are_not_kept_alive() -> None:
    function = taken(march)
    samples = np.zeros((100_000, 2, 1))
    gone = weakref.ref(samples)
    function(
        np.ones((7, 1)),
        np.ones(4),
        np.zeros(1),
        np.zeros((2, 1)),
        samples,
        np.zeros(0),
        np.zeros((0, 2)),
        np.zeros(2, np.int64),
    )
    del samples
    assert gone() is None


@pytest.mark.slow
def test_making_them_again_gives_the_same_bytes(tmp_path: Path) -> None:
    build(tmp_path)
    again = {file.relative_to(tmp_path): file.read_bytes() for file in tmp_path.rglob("*") if file.is_file()}
    natives = len(LIBRARY_LEVELS) * len({each.library for each in ENTRIES})
    assert len(again) == 1 + natives + len(browser.LIBRARIES)
    for path, content in again.items():
        assert content == (FOLDER / path).read_bytes(), path


def test_every_entry_point_of_the_kernels_is_listed() -> None:
    folder = ROOT / "vibeam" / "flight"
    files = [path for path in folder.rglob("*.py") if "\n@entry\n" in path.read_text(encoding="utf-8")]
    found = {"vibeam.flight." + ".".join(path.relative_to(folder).with_suffix("").parts) for path in files}
    assert found == {each.module for each in ENTRIES}
