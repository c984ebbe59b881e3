"""The results file: readable by others, resumable after a kill, refused where it does not belong."""

from __future__ import annotations

import errno
import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray
from stand_in import point, same

from vibeam.exchange.hdf5 import SIGNATURE, heaps_are_whole
from vibeam.runs.store import file as store_file
from vibeam.runs.store.branch import Branch
from vibeam.runs.store.disk import NO_LINKS, Disk
from vibeam.runs.store.errors import StoreError
from vibeam.runs.store.file import read
from vibeam.runs.store.layout import STATES
from vibeam.runs.store.provenance import read_provenance
from vibeam.runs.store.reuse import Wanted
from vibeam.runs.store.store import Store
from vibeam.system.curves import MotionCurves
from vibeam.system.quantities import PLAIN
from vibeam.system.response import Ended, FrequencyResponse
from vibeam.system.state import State

GRID = np.linspace(14.0, 17.0, 6)
UP, DOWN = Branch("beam", "up", GRID, 3, "u" * 64), Branch("beam", "down", GRID[::-1].copy(), 3, "d" * 64)
CASE = Wanted('title = "a"\nsettle = 300\n', "a" * 64, "settle = 300\n", (UP, DOWN))
CHANGED = replace(CASE, branches=(replace(UP, key="v" * 64), DOWN))  # sweeps up anew
STATE = State(np.array([1 / 3, 1e-300, -0.0]), np.array([np.pi, 2.0, -1e300]), resting=True)


def opened(path: Path, wanted: Wanted, **how: Any) -> AbstractContextManager[Store]:
    return store_file.opened(path, lambda models: wanted, **how)


def written(path: Path, points: int = 2) -> Path:
    with opened(path, CASE) as store:
        for index in range(points):
            store.write(UP, index, point(GRID[index], 3, amplitude=index + 0.1, mode_energy=0.5), [STATE])
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


def test_another_case_is_refused_and_untouched(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    before = path.read_bytes()
    changed = [replace(branch, key="c" * 64) for branch in CASE.branches]
    other = Wanted(CASE.text.replace("300", "30"), "b" * 64, CASE.shared.replace("300", "30"), changed)
    with pytest.raises(StoreError, match="settle = 300 there, 30 here") as caught, opened(path, other):
        pass
    assert str(path) in str(caught.value)
    assert "choose another --out, or start over with --fresh" in str(caught.value)
    assert path.read_bytes() == before


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


@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_a_truncated_file_is_refused(tmp_path: Path, share: float) -> None:
    path = written(tmp_path / "a.h5")
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(StoreError, match=r"damaged: start over with --fresh, or delete it"), opened(path, CASE):
        pass


def test_damage_anywhere_is_an_error_or_harmless(tmp_path: Path) -> None:
    """Whatever 64 bytes are lost: a StoreError or a file that reads, never another error."""
    whole = written(tmp_path / "a.h5").read_bytes()
    path, refused = tmp_path / "b.h5", 0
    for start in range(0, len(whole), 997):
        path.write_bytes(whole[:start] + bytes(64) + whole[start + 64 :])
        try:
            with opened(path, CASE) as store:
                store.restore(UP)
                store.restore(DOWN)
        except StoreError:
            refused += 1
    assert refused


def test_a_heap_without_an_end_is_refused_before_it_is_searched(tmp_path: Path) -> None:
    """An object of no size in a heap of texts has no next one: HDF5 looks for it forever."""
    path = written(tmp_path / "a.h5")
    whole = path.read_bytes()
    first = whole.index(SIGNATURE)
    assert heaps_are_whole(whole)
    for start, end in ((first + 16, first + 80), (first + 48, first + 400), (first + 8, first + 16)):
        content = whole[:start] + bytes(end - start) + whole[end:]
        assert not heaps_are_whole(content)
        path.write_bytes(content)
        with pytest.raises(StoreError, match="damaged: start over with --fresh"), opened(path, CASE):
            pass
        with pytest.raises(StoreError, match="damaged"):
            read(path)
    assert not heaps_are_whole(whole[: first + 100])


@pytest.mark.parametrize("place", ["text", "shared"])
def test_what_a_file_says_of_its_case_is_put_right(tmp_path: Path, place: str) -> None:
    path = written(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
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
sys.path[:0] = [{tests!r}, *{path!r}]
import h5py
from pathlib import Path
import test_store
modify, left = h5py.AttributeManager.modify, [2]
def kill_at_the_third(self, name, value):
    if not left[0]:
        os.kill(os.getpid(), signal.SIGKILL)
    left[0] -= 1
    modify(self, name, value)
h5py.AttributeManager.modify = kill_at_the_third
test_store.written(Path({file!r}), points=5)
"""


def test_a_kill_between_values_and_count_loses_one_point(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    script = KILLED.format(tests=str(Path(__file__).parents[2] / "support"), path=sys.path, file=str(file))
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -9
    with opened(file, CASE) as store:
        kept = store.restore(UP)
        assert kept.done == 2
        assert kept.state is not None
        assert kept.response.amplitude[1] == 1.1


def test_a_flipped_byte_is_noticed_or_harmless(tmp_path: Path) -> None:
    """Whatever byte is another: a StoreError, or what is taken from the file is what was put there."""
    whole = bytearray(written(tmp_path / "a.h5").read_bytes())
    with opened(tmp_path / "a.h5", CASE) as store:
        before = store.restore(UP)
    assert before.state is not None
    path, refused = tmp_path / "b.h5", 0
    for place in range(0, len(whole), 293):
        whole[place] ^= 0x10
        path.write_bytes(whole)
        whole[place] ^= 0x10
        try:
            with opened(path, CASE) as store:
                kept = store.restore(UP)
        except StoreError:
            refused += 1
            continue
        points = slice(kept.done)
        assert kept.done <= before.done
        assert np.array_equal(kept.response.amplitude[points], before.response.amplitude[points])
        assert np.array_equal(kept.response.mode_energy[points], before.response.mode_energy[points])
        if kept.done == before.done:
            assert kept.state is not None
            assert kept.state.displacement.tobytes() == before.state.displacement.tobytes()
            assert kept.state.velocity.tobytes() == before.state.velocity.tobytes()
    assert refused


@pytest.mark.parametrize("name", [*(field.name for field in fields(FrequencyResponse)), *STATES, "checksum"])
def test_every_value_of_a_point_has_a_part_in_its_checksum(tmp_path: Path, name: str) -> None:
    path = written(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        place = file["beam/up"][name].id.get_offset()
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)

    def restored() -> None:
        with opened(path, CASE) as store:
            store.restore(UP)

    for use in (restored, lambda: read(path), lambda: opened(path, CHANGED).__enter__()):
        with pytest.raises(StoreError, match=rf"^{path}: .*checksum of its point 1 .*damaged"):
            use()


def test_figures_and_curves_that_are_damaged_are_noticed(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    curves = MotionCurves.empty(GRID, 1)
    with opened(path, CASE) as store:
        store.write_curves("beam", "k", curves)
        assert store.curves("beam", "another") is None
        kept = store.curves("beam", "k")
    assert kept is not None
    assert np.array_equal(kept.frequency, GRID)
    with h5py.File(path, "r+") as file:
        file["beam/curves/amplitude"][2, 1] = 1.0
    with opened(path, CASE) as store, pytest.raises(StoreError, match=r"/beam/curves cannot be read .*checksum"):
        store.curves("beam", "k")


def test_a_state_that_is_not_finite_is_refused(tmp_path: Path) -> None:
    state = State.reached(np.array([0.0, np.nan, 0.0]), np.zeros(3))
    with opened(tmp_path / "a.h5", CASE) as store:
        store.write(UP, 0, point(GRID[0], 3), [state])
        with pytest.raises(StoreError, match="state after its point 1 is not finite"):
            store.restore(UP)


def _external_data(file: h5py.File) -> None:
    values = file["beam/up/reach"][()]
    del file["beam/up/reach"]
    file["beam/up"].create_dataset("reach", data=values, external=[("elsewhere.bin", 0, 4096)])


def _virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(6,), dtype=float)
    layout[:] = h5py.VirtualSource("elsewhere.h5", "x", shape=(6,))
    del file["beam/up/reach"]
    file["beam/up"].create_virtual_dataset("reach", layout)


def _compressed(file: h5py.File) -> None:
    file.create_dataset("bomb", shape=(10**9,), dtype=float, chunks=(10**6,), compression="gzip")


FOREIGN = {
    "external link": lambda file: file.__setitem__("beam/x", h5py.ExternalLink("/etc/hostname", "/x")),
    "soft link": lambda file: file.__setitem__("beam/x", h5py.SoftLink("/beam/up")),
    "circle": lambda file: file["beam"].__setitem__("x", file["beam"]),
    "external data": _external_data,
    "virtual data": _virtual,
    "compressed data": _compressed,
}


@pytest.mark.parametrize("kind", FOREIGN)
def test_what_lies_elsewhere_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    monkeypatch.chdir(tmp_path)
    path = written(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        FOREIGN[kind](file)
    for use in (lambda: opened(path, CASE).__enter__(), lambda: read(path)):
        with pytest.raises(StoreError, match=rf"^{path}: /.* vibeam writes no such file"):
            use()


def test_what_is_no_file_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.h5")
    for path, what in ((tmp_path / "a.h5", "a pipe"), (Path("/dev/zero"), "a device")):
        for fresh in (False, True):
            with pytest.raises(StoreError, match=f"^{path}: is {what}, not a file"), opened(path, CASE, fresh=fresh):
                pass
        with pytest.raises(StoreError, match=f"^{path}: is {what}, not a file"):
            read(path)


@pytest.mark.parametrize("number", [1, 2])
def test_an_older_file_of_the_case_goes_on(tmp_path: Path, number: int) -> None:
    """Format 1 had no checksums and no keys of branches, format 2 other keys."""
    path = written(tmp_path / "a.h5")
    with opened(path, CASE) as store:
        before = store.restore(UP)
    with h5py.File(path, "r+") as file:
        file.attrs["format"] = np.bytes_(f"vibeam results {number}")
        file["case"].attrs["key"] = np.bytes_("c" * 64)
        del file["case/text"]
        file["case/text"] = np.bytes_('settle = 300  # in periods\ntitle = "a"\n')
        for way in ("up", "down") if number == 1 else ():
            del file[f"beam/{way}/checksum"]
            del file[f"beam/{way}"].attrs["key"]
        if number == 1:
            del file["case/shared"]
    content = path.read_bytes()
    now = replace(CASE, branches=[replace(branch, key="n" * 64) for branch in CASE.branches])
    other = replace(now, text='title = "a"\nsettle = 301\n')
    with pytest.raises(StoreError, match=r"holds another case \(settle = 300 there, 301 here\)"), opened(path, other):
        pass
    assert path.read_bytes() == content
    assert same(read(path)["beam", "up"], before.response)
    told: list[str] = []
    with opened(path, now, tell=told.append) as store:
        kept = store.restore(UP)
    assert told == [f"{path}: brought to the present format"]
    assert (kept.done, same(kept.response, before.response)) == (2, True)
    assert same(read(path)["beam", "up"], before.response)
    with opened(path, now, tell=told.append) as store:
        assert store.restore(UP).done == 2
    assert len(told) == 1


def test_a_damaged_point_of_an_older_file_is_said(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        file.attrs["format"] = np.bytes_("vibeam results 2")
        file["beam/up/amplitude"][1] = 7.0
    with pytest.raises(StoreError, match="the checksum of its point 2 does not fit"), opened(path, CASE):
        pass


OTHER = "import h5py, sys; f = h5py.File(sys.argv[1], 'r'); print('held', flush=True); sys.stdin.read()"
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
def held(script: str, *words: str) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", script, *words]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        yield holder
        holder.communicate("")


def test_a_file_that_another_program_has_open_is_not_written(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    with held(OTHER, str(path)), pytest.raises(StoreError, match="another program has it open"), opened(path, CASE):
        pass


@pytest.mark.parametrize("fresh", [False, True])
def test_a_second_run_is_told_who_holds_the_file(tmp_path: Path, fresh: bool) -> None:
    """From before the file is there on: the two would make it, and one result would be lost."""
    path, link = tmp_path / "a.h5", tmp_path / "b.h5"
    link.symlink_to(path)
    script = HOLDER.format(path=[str(Path(__file__).parents[2] / "support"), *sys.path], file=str(path))
    with held(script) as holder:
        for name in (path, link):
            wanted = rf"^{name}: process {holder.pid} on {platform.node()} is writing it"
            with pytest.raises(StoreError, match=wanted), opened(name, CASE, fresh=fresh):
                pass
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a.h5", "b.h5"]
    with opened(path, CASE) as store:
        assert store.restore(UP).done == 1


def test_the_lock_of_a_process_that_was_killed_does_not_hold(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    script = HOLDER.format(path=[str(Path(__file__).parents[2] / "support"), *sys.path], file=str(path))
    with held(script) as holder:
        holder.kill()
    assert (tmp_path / ".a.h5.lock").exists()
    with opened(path, CASE) as store:
        assert store.restore(UP).done == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_made_by_another_meanwhile_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, make = tmp_path / "a.h5", Disk.stage

    def and_another(self: Disk, content: bytes) -> None:
        make(self, content)
        path.write_bytes(b"mine")

    monkeypatch.setattr(Disk, "stage", and_another)
    with pytest.raises(StoreError, match="another program has made it meanwhile"), opened(path, CASE):
        pass
    assert path.read_bytes() == b"mine"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("code", NO_LINKS)
def test_without_hard_links_a_file_is_made_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    def none(*paths: object) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "link", none)
    assert read(written(tmp_path / "a.h5"))["beam", "up"].amplitude[1] == 1.1
    assert list(tmp_path.iterdir()) == [tmp_path / "a.h5"]


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
            store.write_curves("beam", "k", test_store.MotionCurves.empty(test_store.GRID, 1))
        for index in range(4):
            store.write(test_store.UP, index, test_store.point(test_store.GRID[index], 3), [test_store.STATE])
            if index == 1 and {at!r} == "points":
                limit()
except test_store.StoreError as fault:
    print(fault)
    sys.exit(2)
"""


def on_a_full_disk(path: Path, **how: object) -> str:
    """The message of a run for which files end at ``size`` bytes; it ends with exit code 2, not by a signal."""
    paths = [str(Path(__file__).parents[2] / "support"), *sys.path]
    script = FULL.format_map({"path": paths, "file": str(path), "size": 2048, "fresh": False} | how)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "")
    assert done.stdout.startswith(f"{path}: cannot be written (file too large): ")
    return done.stdout


@pytest.mark.parametrize("size", [0, 1, 100, 4096, 16384])
def test_a_disk_that_is_full_from_the_start_leaves_nothing(tmp_path: Path, size: int) -> None:
    assert "choose another --out" in on_a_full_disk(tmp_path / "a.h5", at="start", size=size)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("at", ["points", "curves"])
def test_a_disk_that_is_full_later_keeps_what_was_there(tmp_path: Path, at: str) -> None:
    path = written(tmp_path / "a.h5", points=1)
    assert "make room, then run again to go on" in on_a_full_disk(path, at=at)
    assert list(tmp_path.iterdir()) == [path]
    with opened(path, CASE) as store:
        assert store.restore(UP).done == (2 if at == "points" else 1)


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
            patch.setattr(os, "pwrite", full)
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


REPLACING = """
import os, signal, sys
sys.path[:0] = {path!r}
from pathlib import Path
import test_store
with test_store.opened(Path({file!r}), test_store.CASE) as store:
    os.{call} = lambda *given: os.kill(os.getpid(), signal.SIGKILL)
    store.write_curves("beam", "k", test_store.MotionCurves.empty(test_store.GRID, 1))
"""


@pytest.mark.parametrize("call", ["pwrite", "fsync", "replace"])
def test_a_kill_while_groups_are_added_leaves_the_file_as_it_was(tmp_path: Path, call: str) -> None:
    path = written(tmp_path / "a.h5")
    before = path.read_bytes()
    script = REPLACING.format(path=[str(Path(__file__).parents[2] / "support"), *sys.path], file=str(path), call=call)
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -9
    assert path.read_bytes() == before
    with opened(path, CASE) as store:
        store.write_curves("beam", "k", MotionCurves.empty(GRID, 1))
    assert list(tmp_path.iterdir()) == [path]


def test_a_damaged_provenance_is_said_and_loses_no_point(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5", points=2)
    with h5py.File(path, "r+") as file:
        assert read_provenance(file["provenance"])["vibeam"]
        file["provenance"].attrs["numpy"] = "0.1"
    written(path, points=3)
    with h5py.File(path) as file:
        assert list(read_provenance(file["provenance"])) == ["damaged"]
    with opened(path, CASE) as store:
        assert store.restore(UP).done == 3
