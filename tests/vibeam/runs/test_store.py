"""The results file: readable by others, resumable after a kill, refused where it does not belong."""

from __future__ import annotations

import errno
import os
import platform
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray
from sealed import edited
from stand_in import point, same

from vibeam.exchange.whole_files import LENGTH
from vibeam.runs.store import file as store_file
from vibeam.runs.store.adaptation import Requirements
from vibeam.runs.store.branches import BranchPlan
from vibeam.runs.store.file import Store, read
from vibeam.runs.store.records import curves_of
from vibeam.store.errors import StoreError
from vibeam.store.hdf5 import fixed
from vibeam.system.curves import MotionCurves
from vibeam.system.quantities import METRES, PLAIN
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State

GRID = np.linspace(14.0, 17.0, 6)
UP = BranchPlan("beam", "up", GRID, 3, "u" * 64)
DOWN = BranchPlan("beam", "down", GRID[::-1].copy(), 3, "d" * 64)
CASE = Requirements('title = "a"\nsettle = 300\n', "a" * 64, "settle = 300\n", (UP, DOWN), "settle = 300\n", "a.toml")
CURVES = curves_of("beam", METRES)
STATE = State(np.array([1 / 3, 1e-300, -0.0]), np.array([np.pi, 2.0, -1e300]), resting=True)


def opened(path: Path, wanted: Requirements, **how: Any) -> AbstractContextManager[Store]:
    return store_file.opened(path, lambda models: wanted, **how)


NONE = MotionCurves.empty(GRID, 1)


def put(store: Store, points: Iterable[int]) -> None:
    for index in points:
        store.write(UP, index, point(GRID[index], 3, amplitude=index + 0.1, mode_energy=0.5), [STATE])


def run_script(script: str, path: Path, **words: Any) -> subprocess.CompletedProcess[str]:
    """A process that runs a script with this module at hand."""
    paths = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "support"), *sys.path]
    code = script.format_map({"path": paths, "file": str(path)} | words)
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)


def written(path: Path, points: int = 2) -> Path:
    with opened(path, CASE) as store:
        put(store, range(store.restore(UP).done, points))
    return path


def test_xarray_opens_it_as_it_is(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    with xarray.open_dataset(path, group="beam/up", engine="h5netcdf") as up:
        assert dict(up.sizes) == {"frequency": 6, "impact": 16, "mode": 3}
        assert np.array_equal(up.frequency, GRID)
        assert up.amplitude.sel(frequency=14.6).item() == 1.1
        assert np.isnan(up.amplitude[2:]).all()
        assert up.mode_energy.dims == ("frequency", "mode")
        assert up.impact_velocities.dims == ("frequency", "impact")
        assert (up.reach.attrs["units"], up.impact_velocity.attrs["units"]) == ("m", "m s-1")
        assert "½(max − min)" in up.amplitude.attrs["long_name"]
        assert "Q = Δ − min q" in up.reach.attrs["long_name"]
        assert all({"units", "long_name"} <= set(each.attrs) for each in up.variables.values())
        assert up.attrs["done"] == 2
        codes = dict(zip(up.ended.attrs["flag_values"], up.ended.attrs["flag_meanings"].split(), strict=True))
        assert codes[int(up.ended[2])] == Ended.NOT_RUN.name
    with xarray.open_dataset(path, group="beam/down", engine="h5netcdf") as down:
        assert down.frequency[0] == 17.0
    for group in ("case", "provenance"):
        xarray.open_dataset(path, group=group, engine="h5netcdf").close()


def test_says_case_and_provenance(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    written(path, points=3)
    with h5py.File(path) as file:
        assert file["case"].attrs["key"].decode() == CASE.key
        assert file["case/text"][()].decode() == CASE.text
        assert {"vibeam", "numpy", "numba", "kernels", "python", "platform", "time"} <= set(file["provenance"].attrs)
        assert file["provenance/continued"][0].startswith(b"vibeam ")
        assert file["provenance/continued"][1] == b""


def test_nondimensional_results_say_so(tmp_path: Path) -> None:
    with opened(tmp_path / "a.h5", replace(CASE, units=PLAIN)) as store:
        store.write(UP, 0, point(GRID[0], 3), [STATE])
    with xarray.open_dataset(tmp_path / "a.h5", group="beam/up", engine="h5netcdf") as up:
        assert (up.reach.attrs["units"], up.impact_velocity.attrs["units"]) == ("1", "s-1")


def test_gives_back_every_bit(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5", points=1)
    with opened(path, CASE) as store:
        kept, untouched = store.restore(UP), store.restore(DOWN)
    assert (kept.done, untouched.done, untouched.state) == (1, 0, None)
    assert kept.state is not None
    assert kept.state.resting is True
    assert kept.state.displacement.tobytes() == STATE.displacement.tobytes()
    assert kept.state.velocity.tobytes() == STATE.velocity.tobytes()
    assert same(read(path)["beam", "up"], kept.response)
    assert same(untouched.response, FrequencyResponse.empty(DOWN.frequency, 3))


def other_case(name: str = "a.toml") -> Requirements:
    changed = [replace(branch, key="c" * 64) for branch in CASE.branches]
    texts = CASE.text.replace("300", "30"), "b" * 64, CASE.shared.replace("300", "30")
    return Requirements(*texts, changed, "settle = 30\n", name)


def test_the_file_of_another_case_is_kept_aside_under_the_next_free_name(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    before, told = path.read_bytes(), list[str]()
    (tmp_path / "a.1.h5").write_text("mine")
    (tmp_path / "a.2.h5.parts").mkdir()
    with opened(path, other_case(), tell=told.append):
        assert path.read_bytes() == before
    assert not (tmp_path / "a.3.h5").exists()
    with opened(path, other_case(), tell=told.append) as store:
        put(store, [0])
    assert (
        told
        == [f"{path}: holds the case as it was (settle = 300 there, 30 here); its results are kept aside as a.3.h5"] * 2
    )
    assert (tmp_path / "a.3.h5").read_bytes() == before
    assert (tmp_path / "a.1.h5").read_text() == "mine"
    assert np.isfinite(read(path)["beam", "up"].amplitude).sum() == 1


def test_a_kill_before_the_first_point_keeps_the_file_aside_once(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    os.link(path, tmp_path / "a.1.h5")  # as the killed run has left it
    with opened(path, other_case()) as store:
        put(store, [0])
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.1.h5", "a.h5"]


def test_a_file_system_without_second_names_renames_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*names: object) -> None:
        raise PermissionError(errno.EPERM, "no links")

    path = written(tmp_path / "a.h5")
    before = path.read_bytes()
    (tmp_path / "a.1.h5").write_text("mine")
    monkeypatch.setattr(os, "link", refused)
    with opened(path, other_case()):
        assert (tmp_path / "a.2.h5").read_bytes() == before
    with opened(path, other_case()) as store:
        put(store, [0])
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.1.h5", "a.2.h5", "a.h5"]


def test_a_folder_that_takes_no_name_is_a_message_and_nothing_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*names: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    path = written(tmp_path / "a.h5")
    before = path.read_bytes()
    monkeypatch.setattr(os, "link", full)
    with pytest.raises(StoreError, match="cannot be written"), opened(path, other_case()):
        pass
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == {"a.h5": before}


@pytest.mark.parametrize("content", [b"", b"title = 'no results'\n", bytes(range(256)) * 40])
def test_what_is_no_result_is_refused_and_untouched(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.h5"
    path.write_bytes(content)
    with pytest.raises(StoreError, match="no vibeam result"), opened(path, CASE):
        pass
    assert path.read_bytes() == content


def test_a_foreign_hdf5_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["beam/up/amplitude"] = np.zeros(6)
    with pytest.raises(StoreError, match="no vibeam result"), opened(path, CASE):
        pass


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="is a folder"), opened(tmp_path, CASE):
        pass


def test_damage_is_refused_whatever_byte_it_is(tmp_path: Path) -> None:
    """A byte that is another, bytes that are lost, filled with zeros or added: HDF5 never sees them."""
    path = written(tmp_path / "a.h5")
    whole = path.read_bytes()
    places = range(0, len(whole), len(whole) // 150)
    flipped = [whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1 :] for at in places]
    zeros = [each for at in places if (each := whole[:at] + bytes(64) + whole[at + 64 :]) != whole]
    for content in (*flipped, *zeros, whole[:-1], whole[:-5000], whole[:5000] + whole[5001:], whole + b"0"):
        path.write_bytes(content)
        for use in (lambda: opened(path, CASE).__enter__(), lambda: read(path)):
            with pytest.raises(StoreError, match=rf"^{path}: (its digest does not fit: it is damaged|is no )"):
                use()


def test_what_another_program_has_changed_is_refused(tmp_path: Path) -> None:
    """Links to other places and values elsewhere, too."""
    for change in (
        lambda file: file["beam"].__setitem__("x", h5py.ExternalLink("/etc/hostname", "/x")),
        lambda file: file["beam"].create_dataset("x", (6,), float, external=[("elsewhere.bin", 0, 4096)]),
        lambda file: file["beam/up/amplitude"].__setitem__(1, 7.0),
    ):
        path = written(tmp_path / "a.h5")
        with h5py.File(path, "r+") as file:
            change(file)
        with pytest.raises(StoreError, match=r"its digest does not fit: .*changed since: start over with --fresh"):
            read(path)
        path.unlink()


@pytest.mark.parametrize("other", ["vibeam results 40", "vibeam results 3"])
def test_a_file_of_another_format_is_refused_though_its_seal_fits(tmp_path: Path, other: str) -> None:
    path = written(tmp_path / "a.h5")
    with edited(path) as file:
        file.attrs["format"] = fixed(other)
    for use in (lambda: opened(path, CASE).__enter__(), lambda: read(path)):
        with pytest.raises(StoreError, match="is no vibeam result of this version: start over with --fresh"):
            use()


def test_a_file_of_an_earlier_version_is_called_so(tmp_path: Path) -> None:
    """It has no digest, which is no damage."""
    path = written(tmp_path / "a.h5")
    path.write_bytes(path.read_bytes()[:-LENGTH].replace(b"vibeam results 4", b"vibeam results 3"))
    for use in (lambda: opened(path, CASE).__enter__(), lambda: read(path)):
        with pytest.raises(StoreError, match=r"is no vibeam result of this version: start over with --fresh"):
            use()
    with opened(path, CASE, fresh=True) as store:
        put(store, [0])
    assert read(path)["beam", "up"].amplitude[0] == 0.1


@pytest.mark.parametrize("place", ["text", "shared"])
def test_what_a_file_says_of_its_case_is_put_right(tmp_path: Path, place: str) -> None:
    path = written(tmp_path / "a.h5")
    with edited(path) as file:
        file["case"][place][...] = file["case"][place][()].replace(b"settle", b"sottle")
    lines: list[str] = []
    with opened(path, CASE, tell=lines.append) as store:
        assert store.restore(UP).done == 2
    with h5py.File(path) as file:
        assert file["case/text"][()].decode() == CASE.text
        assert file["case/shared"][()].decode() == CASE.shared
    assert len(lines) == 1


def test_a_start_that_fails_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), opened(tmp_path / "a.h5", CASE):
        raise ZeroDivisionError
    with pytest.raises(StoreError, match="cannot be written"), opened(tmp_path / "none" / "a.h5", CASE):
        pass
    assert not list(tmp_path.iterdir())


def test_a_failure_later_keeps_what_is_written(tmp_path: Path) -> None:
    with pytest.raises((TypeError, ValueError), match="broadcast"), opened(tmp_path / "a.h5", CASE) as store:
        store.write(UP, 0, point(GRID[0], 3), [STATE]) or store.write(UP, 1, point(GRID[1], 2), [STATE])
    assert read(tmp_path / "a.h5")["beam", "up"].ended[0] == Ended.COMPLETE.code


KILLED = """
import os, signal, sys
sys.path[:0] = {path!r}
from pathlib import Path
import test_store
with test_store.opened(Path({file!r}), test_store.CASE) as store:
    test_store.put(store, range(2, 4))
    os.{call} = lambda *given: os.kill(os.getpid(), signal.SIGKILL)
    {action}
"""
ACTIONS = {"block": "test_store.put(store, [4])", "record": "store.keep(test_store.CURVES, 'k', test_store.NONE)"}


@pytest.mark.parametrize("action", ACTIONS)
@pytest.mark.parametrize("call", ["write", "fsync", "replace"])
def test_a_kill_while_something_is_written_leaves_what_was_there(tmp_path: Path, call: str, action: str) -> None:
    path = written(tmp_path / "a.h5")
    assert run_script(KILLED, path, call=call, action=ACTIONS[action]).returncode == -9
    assert len(list((tmp_path / "a.h5.parts").glob("[!.]*"))) == 1
    assert read(path)["beam", "up"].amplitude[3] == 3.1
    with opened(path, CASE) as store:
        kept = store.restore(UP)
        assert (kept.done, kept.response.amplitude[3]) == (4, 3.1)
        assert kept.state is not None
        store.keep(CURVES, "k", NONE)
    assert list(tmp_path.iterdir()) == [path]


def test_points_beside_the_file_are_read_with_it_and_gathered_at_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, folder = tmp_path / "a.h5", tmp_path / "a.h5.parts"
    monkeypatch.setattr(store_file, "MOST", 3)
    with opened(path, CASE) as store:
        for index, blocks in enumerate((0, 1, 2, 3, 0, 1)):
            put(store, [index])
            assert len(list(folder.glob("*"))) == blocks
            assert read(path)["beam", "up"].amplitude[index] == index + 0.1
    assert list(tmp_path.iterdir()) == [path]
    with h5py.File(path) as file:
        assert np.array_equal(file["beam/up/amplitude"][()], np.arange(6) + 0.1)


def test_a_block_that_is_damaged_or_of_another_branch_is_not_there(tmp_path: Path) -> None:
    path, folder = tmp_path / "a.h5", tmp_path / "a.h5.parts"
    with opened(path, CASE) as store:
        put(store, range(3))
        blocks = {file: file.read_bytes() for file in folder.iterdir()}
        assert [file.name for file in sorted(blocks)] == ["beam-up-000000001.npz", "beam-up-000000002.npz"]
        content = path.read_bytes()
    first, second = sorted(blocks)
    whole = blocks[first]
    others = [whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :] for at in range(0, len(whole), 499)]
    for damaged in (*others, whole[:-1], b"", blocks[second]):
        folder.mkdir()
        path.write_bytes(content)
        first.write_bytes(damaged)
        second.write_bytes(blocks[second])
        assert np.isnan(read(path)["beam", "up"].amplitude[1:]).all()
        with opened(path, CASE) as store:
            assert store.restore(UP).done == 1
            put(store, [1])
        assert read(path)["beam", "up"].amplitude[1] == 1.1
        assert list(tmp_path.iterdir()) == [path]


def test_blocks_from_which_nothing_goes_on_are_deleted(tmp_path: Path) -> None:
    """Of a run that was killed when all were gathered, just before they were deleted."""
    path, folder = written(tmp_path / "a.h5"), tmp_path / "a.h5.parts"
    folder.mkdir()
    (folder / "beam-up-000000001.npz").write_bytes(b"gathered")
    before = path.read_bytes()
    written(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_of_others_beside_the_blocks_stays(tmp_path: Path) -> None:
    (folder := tmp_path / "a.h5.parts").mkdir()
    (folder / "notes.txt").write_text("mine", encoding="utf-8")
    written(tmp_path / "a.h5", points=3)
    assert [file.name for file in folder.iterdir()] == ["notes.txt"]


def test_several_files_are_open_at_once(tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("a.h5", "b.h5")]
    with opened(paths[0], CASE) as one, opened(paths[1], CASE) as other:
        put(one, range(2))
        put(other, range(3))
    assert [int(np.isfinite(read(path)["beam", "up"].amplitude).sum()) for path in paths] == [2, 3]


def test_a_record_is_kept_for_its_key(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    with opened(path, CASE) as store:
        store.keep(CURVES, "k", NONE)
        assert store.kept(CURVES, "another") is None
        kept = store.kept(CURVES, "k")
        assert kept is not None
        assert np.array_equal(kept.frequency, GRID)


def test_a_state_that_is_not_finite_is_refused(tmp_path: Path) -> None:
    state = State.reached(np.array([0.0, np.nan, 0.0]), np.zeros(3))
    with opened(tmp_path / "a.h5", CASE) as store:
        store.write(UP, 0, point(GRID[0], 3), [state])
        with pytest.raises(StoreError, match="state after its point 1 is not finite"):
            store.restore(UP)


def test_what_is_no_file_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.h5")
    for path, what in ((tmp_path / "a.h5", "a pipe"), (Path("/dev/zero"), "a device")):
        for fresh in (False, True):
            with pytest.raises(StoreError, match=f"^{path}: is {what}, not a file"), opened(path, CASE, fresh=fresh):
                pass
        with pytest.raises(StoreError, match=f"^{path}: is {what}, not a file"):
            read(path)


OTHER = "import h5py, sys; f = h5py.File({file!r}, 'r'); print('held', flush=True); sys.stdin.read()"
HOLDER = """
import sys
sys.path[:0] = {path!r}
from pathlib import Path
import test_store
with test_store.opened(Path({file!r}), test_store.CASE) as store:
    store.write(test_store.UP, 0, test_store.point(test_store.GRID[0], 3), [test_store.STATE])
    print("held", flush=True)
    sys.stdin.read()
"""


@contextmanager
def held(path: Path, script: str = HOLDER) -> Iterator[subprocess.Popen[str]]:
    places = [str(Path(__file__).parents[2] / "support"), *sys.path]
    command = [sys.executable, "-c", script.format(path=places, file=str(path))]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        yield holder
        holder.communicate("")


def test_a_file_that_another_program_has_open_is_replaced(tmp_path: Path) -> None:
    """That program keeps the one that it has."""
    path = written(tmp_path / "a.h5")
    with held(path, OTHER):
        written(path, points=3)
    assert read(path)["beam", "up"].amplitude[2] == 2.1


@pytest.mark.parametrize("fresh", [False, True])
def test_a_second_run_is_told_who_holds_the_file(tmp_path: Path, fresh: bool) -> None:
    """From before the file is there on: the two would make it, and one result would be lost."""
    path, link = tmp_path / "a.h5", tmp_path / "b.h5"
    link.symlink_to(path)
    with held(path) as holder:
        for name in (path, link):
            wanted = rf"^{name}: process {holder.pid} on {platform.node()} is writing it"
            with pytest.raises(StoreError, match=wanted), opened(name, CASE, fresh=fresh):
                pass
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.h5", "b.h5"]
    with opened(path, CASE) as store:
        assert store.restore(UP).done == 1


def test_the_lock_of_a_process_that_was_killed_does_not_hold(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with held(path) as holder:
        holder.kill()
    assert (tmp_path / ".a.h5.lock").exists()
    with opened(path, CASE) as store:
        assert store.restore(UP).done == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_made_by_another_meanwhile_stays(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with opened(path, CASE) as store:
        path.write_bytes(b"mine")
        with pytest.raises(StoreError, match="another program has made it meanwhile"):
            put(store, [0])
    assert path.read_bytes() == b"mine"
    assert list(tmp_path.iterdir()) == [path]


FULL = """
import resource, sys
sys.path[:0] = {path!r}
from pathlib import Path
import test_store
def limit():
    resource.setrlimit(resource.RLIMIT_FSIZE, ({size}, resource.RLIM_INFINITY))
path = Path({file!r})
try:
    if {at!r} == "start":
        limit()
    with test_store.opened(path, test_store.CASE, fresh={fresh}) as store:
        if {at!r} == "curves":
            limit()
            store.keep(test_store.CURVES, "k", test_store.NONE)
        for index in range(4):
            test_store.put(store, [index])
            if index == 1 and {at!r} == "points":
                limit()
except test_store.StoreError as fault:
    print(fault)
    sys.exit(2)
"""


def on_a_full_disk(path: Path, **how: object) -> str:
    """The message of a run for which files end at ``size`` bytes; it ends with exit code 2, not by a signal."""
    done = run_script(FULL, path, **({"size": 2048, "fresh": False} | how))
    assert (done.returncode, done.stderr) == (2, "")
    assert done.stdout.startswith(f"{path}: cannot be written (file too large): ")
    return done.stdout


@pytest.mark.parametrize("size", [0, 1, 100, 4096, 16384])
def test_a_disk_that_is_full_from_the_start_leaves_nothing(tmp_path: Path, size: int) -> None:
    cure = "make room" if size else "choose another --out"  # no room for a byte of the lock
    assert cure in on_a_full_disk(tmp_path / "a.h5", at="start", size=size)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("at", ["points", "curves"])
def test_a_disk_that_is_full_later_keeps_what_was_there(tmp_path: Path, at: str) -> None:
    path = written(tmp_path / "a.h5", points=1)
    assert "make room, then run again to go on" in on_a_full_disk(path, at=at)
    with opened(path, CASE) as store:
        assert store.restore(UP).done == (2 if at == "points" else 1)
    assert list(tmp_path.iterdir()) == [path]


def test_a_fresh_start_that_finds_no_room_keeps_what_was_there(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    before = path.read_bytes()
    on_a_full_disk(path, at="start", fresh=True)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_after_a_write_that_failed_no_other_is_tried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*given: object) -> int:
        raise OSError(errno.ENOSPC, "no space")

    with opened(tmp_path / "a.h5", CASE) as store:
        store.write(UP, 0, point(GRID[0], 3), [STATE])
        with monkeypatch.context() as patch:
            patch.setattr(os, "write", full)
            with pytest.raises(StoreError, match="no space left"):
                store.write(UP, 1, point(GRID[1], 3), [STATE])
        with pytest.raises(StoreError, match="no space left"):
            store.write(UP, 1, point(GRID[1], 3), [STATE])
    with opened(tmp_path / "a.h5", CASE) as store:
        assert store.restore(UP).done == 1


def test_fresh_takes_the_old_file_s_place_with_its_first_point(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5", points=4)
    before = path.read_bytes()
    with pytest.raises(ZeroDivisionError), opened(path, CASE, fresh=True) as store:
        raise ZeroDivisionError(store.restore(UP).done)
    assert path.read_bytes() == before
    with opened(path, CASE, fresh=True) as store:
        store.write(UP, 0, point(GRID[0], 3), [STATE])
    with opened(path, CASE) as store:
        assert store.restore(UP).done == 1
    with h5py.File(path) as file:
        assert file["provenance/continued"][0] == b""
    assert list(tmp_path.iterdir()) == [path]


def test_fresh_takes_damaged_results_but_nothing_else(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    path.write_bytes(path.read_bytes()[:4000])
    with opened(path, CASE, fresh=True) as store:
        store.write(UP, 0, point(GRID[0], 3), [STATE])
    assert read(path)["beam", "up"].ended[0] == Ended.COMPLETE.code
    path.write_bytes(b"mine")
    with pytest.raises(StoreError, match="no vibeam result"), opened(path, CASE, fresh=True):
        pass
    assert path.read_bytes() == b"mine"
