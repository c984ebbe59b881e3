"""Maps on disk: resumed block by block, never computed twice, refused where they are another's."""

from __future__ import annotations

import os
import resource
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from stand_in import SI

import vibeam
from vibeam.maps import gathered
from vibeam.maps import run as running
from vibeam.maps.block import Block, evaluate_block
from vibeam.maps.evaluate import grids_of, key_of, lines_of_block
from vibeam.maps.gathered import finished, steps_of
from vibeam.maps.points import Axis
from vibeam.maps.run import work_of
from vibeam.store.long_work import WorkPart
from vibeam.store.parts import StepsOnDisk, take_part
from vibeam.store.place import place_of
from vibeam.store.steps import StepFile

AXES = [
    {"key": "stop.gap", "values": [0.0, 5e-5, 1e-4]},
    {"key": "drive.voltage", "from": 0.3, "to": 0.7, "points": 5},
    {"key": "sweep.frequency", "values": [14.5, 15.3, 16.0]},
]


def case(**more: Any) -> vibeam.Case:
    table = {"axes": AXES, "fidelities": ["sdof"], "direction": "both", "settle": 30, "hold": 8, "strobes": 2} | more
    return vibeam.load("cases/dtu_neutral.toml", set=SI | {"map": {"m": table}})


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> list[Block]:
    """Blocks of two lines, and a list of those that were computed."""
    computed: list[Block] = []

    def counted(block: Block) -> Any:
        computed.append(block)
        return evaluate_block(block, threads=1)

    monkeypatch.setattr(running, "lines_of_block", lambda case, grid: 2)
    monkeypatch.setattr(running, "evaluate_here", counted)
    return computed


def data(path: Path) -> dict[str, Any]:
    with h5py.File(path) as file:
        return {name: file["sdof"][name][()] for name in ("amplitude", "period", "rest", "ended", "strobes")}


def expected() -> vibeam.GridResponse:
    axes = {
        "stop.gap": [0.0, 5e-5, 1e-4], "drive.voltage": np.linspace(0.3, 0.7, 5),
        "sweep.frequency": [14.5, 15.3, 16.0],
    }  # fmt: skip
    return vibeam.evaluate(
        case(), "sdof", axes, direction="both", settle=30, hold=8, strobes=2,
        quantities=("amplitude", "period", "rest", "strobes"),
    )  # fmt: skip


def test_the_file_has_what_the_same_grid_gives_in_memory_to_the_bit(tmp_path: Path, small: list[Block]) -> None:
    told: list[tuple[int, int]] = []
    found = vibeam.run_map(case(), "m", tmp_path / "m.h5", progress=lambda *done: told.append(done))
    memory = expected()
    for name, values in data(tmp_path / "m.h5").items():
        np.testing.assert_array_equal(values, memory[name], err_msg=name)
        np.testing.assert_array_equal(found["sdof"][name], memory[name], err_msg=name)
    assert len(small) == 8
    assert (told[0], told[-1]) == ((0, 90), (90, 90))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m.h5"]


def test_it_opens_in_xarray_with_units(tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    vibeam.run_map(case(), "m", tmp_path / "m.h5")
    with xarray.open_dataset(tmp_path / "m.h5", group="sdof", engine="h5netcdf") as opened:
        assert opened["amplitude"].dims == ("direction", "stop.gap", "drive.voltage", "sweep.frequency")
        assert opened["strobes"].dims[-1] == "strobe"
        assert opened["amplitude"].attrs["units"] == "m"
        assert float(opened["stop.gap"][2]) == 1e-4


def test_a_run_that_ended_goes_on_and_computes_nothing_twice(
    tmp_path: Path, small: list[Block], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted(Exception):
        pass

    stored, append = list[int](), StepFile.append

    def ending(file: StepFile, said: Path, number: int, values: Any, sync: bool) -> None:
        if len(stored) == 3:
            raise Interrupted
        stored.append(2 * number)
        append(file, said, number, values, sync)

    with monkeypatch.context() as patch:
        patch.setattr(StepFile, "append", ending)
        with pytest.raises(Interrupted):
            vibeam.run_map(case(), "m", tmp_path / "m.h5", workers=1)
    assert not (tmp_path / "m.h5").exists()
    assert len(stored) == 3
    small.clear()
    found = vibeam.run_map(case(), "m", tmp_path / "m.h5")
    assert {block.first for block in small}.isdisjoint(stored)
    assert len(small) == 5
    assert found.found == 36
    for name, values in data(tmp_path / "m.h5").items():
        np.testing.assert_array_equal(values, expected()[name], err_msg=name)
    small.clear()
    assert vibeam.run_map(case(), "m", tmp_path / "m.h5").found == 90
    assert small == []


def test_a_damaged_block_is_computed_anew(tmp_path: Path, small: list[Block]) -> None:
    rig = case()
    work = work_of(rig, rig.maps["m"], tmp_path / "m.h5")
    take_part(work)
    path = tmp_path / "m.h5.parts" / "00003.steps"
    whole = path.read_bytes()
    step = work.every[2]
    values = StepsOnDisk(work).values(step)
    for at in range(200, len(whole), 97):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1 :])
        assert StepsOnDisk(work).missing() == [step]
    path.write_bytes(whole[:-100])
    small.clear()
    taken = take_part(work, WorkPart(3, 8))
    assert (taken.found, taken.done, taken.total, len(small)) == (0, 12, 12, 1)
    assert path.read_bytes() == whole
    for name, each in StepsOnDisk(work).values(step).items():
        np.testing.assert_array_equal(each, values[name], err_msg=name)


def test_a_damaged_map_is_told_whatever_byte_it_is(tmp_path: Path) -> None:
    path = tmp_path / "m.h5"
    vibeam.run_map(case(), "m", path)
    rig = case()
    whole, keys = path.read_bytes(), {"sdof": key_of(rig, grids_of(rig, rig.maps["m"])["sdof"])}
    assert finished(place_of(path), keys)
    flipped = [whole[:at] + bytes([whole[at] ^ 16]) + whole[at + 1 :] for at in range(0, len(whole), len(whole) // 60)]
    for content in (*flipped, whole[:-1], whole[:9], b"", whole + b"0", whole[:5000] + whole[5001:]):
        path.write_bytes(content)
        with pytest.raises(vibeam.StoreError, match=f"^{path}: (its digest does not fit|is no file of a map)"):
            finished(place_of(path), keys)


def test_a_map_that_another_program_has_changed_is_not_taken_for_ours(tmp_path: Path) -> None:
    vibeam.run_map(case(), "m", tmp_path / "m.h5")
    with h5py.File(tmp_path / "m.h5", "r+") as file:
        file["sdof/period"][...] = 1
    with pytest.raises(vibeam.StoreError, match=r"its digest does not fit .* start over with --fresh"):
        vibeam.run_map(case(), "m", tmp_path / "m.h5")
    vibeam.run_map(case(), "m", tmp_path / "m.h5", fresh=True)
    np.testing.assert_array_equal(data(tmp_path / "m.h5")["period"], expected()["period"])


@pytest.mark.parametrize("other", ["vibeam map 10", "vibeam map 2", "vibeam map 1a", "vibeam results 4"])
def test_a_map_of_another_format_is_refused_though_its_seal_fits(
    tmp_path: Path, other: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "m.h5"
    with monkeypatch.context() as patch:
        patch.setattr(gathered, "FORMAT", other)
        vibeam.run_map(case(), "m", path)
    before = path.read_bytes()
    with pytest.raises(
        vibeam.StoreError, match=r"is (a map of another version|no file of a map): choose another --out"
    ):
        vibeam.run_map(case(), "m", path)
    assert path.read_bytes() == before
    if other.startswith("vibeam map"):  # ours to replace
        vibeam.run_map(case(), "m", path, fresh=True)
        np.testing.assert_array_equal(data(path)["period"], expected()["period"])


def test_a_disk_that_is_full_while_a_map_is_gathered_loses_nothing(
    tmp_path: Path, small: list[Block], monkeypatch: pytest.MonkeyPatch
) -> None:
    vibeam.run_map(case(), "m", tmp_path / "whole.h5")
    whole = (tmp_path / "whole.h5").stat().st_size
    with monkeypatch.context() as patch:
        patch.setattr(running, "gather", lambda *given: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            vibeam.run_map(case(), "m", tmp_path / "m.h5")
    before = sorted((tmp_path / "m.h5.parts").iterdir())
    for size in (4096, whole // 2, whole - 1):
        said = f"{tmp_path}/m.h5: cannot be written (file too large): make room, then run again to go on"
        assert gathered_in_a_fork(tmp_path / "m.h5", size) == (0, said)
        assert sorted((tmp_path / "m.h5.parts").iterdir()) == before
        assert sorted(path.name for path in tmp_path.iterdir()) == ["m.h5.parts", "whole.h5"]
    small.clear()
    assert vibeam.run_map(case(), "m", tmp_path / "m.h5").found == 90
    assert small == []


def gathered_in_a_fork(path: Path, size: int) -> tuple[int, str]:
    """Exit code (negative: by that signal) and message of a process whose files end at ``size`` bytes."""
    said, say = os.pipe()
    if not (child := os.fork()):
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))
        try:
            vibeam.run_map(case(), "m", path)
        except vibeam.StoreError as fault:
            os.write(say, str(fault).encode())
        finally:
            os._exit(0)
    os.close(say)
    with os.fdopen(said) as message:
        told = message.read()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), told


def test_fresh_deletes_no_file_of_another_kind(tmp_path: Path) -> None:
    other = tmp_path / "m.h5"
    other.write_text("a year's notes", encoding="utf-8")
    with pytest.raises(vibeam.StoreError, match="is no file of a map"):
        vibeam.run_map(case(), "m", other, fresh=True)
    assert other.read_text(encoding="utf-8") == "a year's notes"


def test_the_map_of_the_case_as_it_was_is_kept_aside_and_fresh_starts_over(tmp_path: Path) -> None:
    path, told = tmp_path / "m.h5", list[str]()
    vibeam.run_map(case(), "m", path)
    before = path.read_bytes()
    assert vibeam.run_map(case(settle=31), "m", path, tell=told.append).found == 0
    assert (tmp_path / "m.1.h5").read_bytes() == before
    assert told == [f"{path}: holds the map of the case as it was; its results are kept aside as m.1.h5"]
    assert vibeam.run_map(case(), "m", tmp_path / "m.1.h5").found == 90
    assert vibeam.run_map(case(settle=32), "m", path, fresh=True).found == 0
    assert sorted(each.name for each in tmp_path.iterdir()) == ["m.1.h5", "m.h5"]
    (tmp_path / "other.h5").write_text("something")
    with pytest.raises(vibeam.StoreError, match="is no file of a map"):
        vibeam.run_map(case(), "m", tmp_path / "other.h5")


def test_blocks_of_the_case_as_it_was_are_kept_aside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*given: Any) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(running, "gather", stop)
        with pytest.raises(KeyboardInterrupt):
            vibeam.run_map(case(), "m", tmp_path / "m.h5")
    shutil.copytree(tmp_path / "m.h5.parts", tmp_path / "again.h5.parts")
    with pytest.warns(UserWarning, match=r"kept aside as again\.1\.h5\.parts"):
        vibeam.run_map(case(hold=9), "m", tmp_path / "again.h5")
    assert vibeam.run_map(case(), "m", tmp_path / "again.1.h5").found == 90
    with monkeypatch.context() as patch:
        patch.setattr("vibeam.maps.run.digest_of_code", lambda: "other")
        with pytest.raises(vibeam.StoreError, match="another version of vibeam"):
            vibeam.run_map(case(), "m", tmp_path / "m.h5")
    manifest = tmp_path / "m.h5.parts" / "manifest"
    manifest.write_bytes(manifest.read_bytes().replace(b"sizes", b"sizer"))  # blocks say themselves what they are of
    assert vibeam.run_map(case(), "m", tmp_path / "m.h5").found == 90


def test_what_does_not_change_the_numbers_does_not_change_the_key() -> None:
    one, other = case(), vibeam.load("cases/dtu_neutral.toml", set=SI | {"map": {"m": {
        "axes": AXES, "fidelities": ["sdof"], "direction": "both", "settle": 30, "hold": 8, "strobes": 2,
        "boundaries": False}}, "title": "another", "sweep.frequency.points": 5})  # fmt: skip
    keys = [key_of(each, grids_of(each, each.maps["m"])["sdof"]) for each in (one, other)]
    assert keys[0] == keys[1]
    third = case(hold=9)
    assert key_of(third, grids_of(third, third.maps["m"])["sdof"]) != keys[0]


def test_a_block_is_no_longer_than_its_map_and_has_a_line_at_least() -> None:
    rig = case()
    grid = grids_of(rig, rig.maps["m"])["sdof"]
    assert lines_of_block(rig, grid) == 15
    slow = case(settle=1_000_000)
    assert 1 <= lines_of_block(slow, grids_of(slow, slow.maps["m"])["sdof"]) <= 15


def test_a_very_large_map_has_no_more_blocks_than_a_client_can_hand_out() -> None:
    axes = [
        {"key": "stop.gap", "from": 0.0, "to": 1e-4, "points": 1000},
        {"key": "drive.voltage", "from": 0.3, "to": 0.7, "points": 1000},
        {"key": "sweep.frequency", "from": 14.0, "to": 17.0, "points": 300},
    ]
    rig = case(axes=axes, direction="apart", settle=3000)
    grid = grids_of(rig, rig.maps["m"])["sdof"]
    assert grid.lines / lines_of_block(rig, grid) < 21_000
    assert 300 * lines_of_block(rig, grid) > 14_000  # four seconds and more, for one of a small map


def test_few_numbers_of_a_large_map_are_read_back() -> None:
    rig = case()
    grid = grids_of(rig, rig.maps["m"])["sdof"]
    assert steps_of(grid, 10**6) == (1, 1, 1)
    assert steps_of(grid, 50)[0] == 1
    assert steps_of(grid, 50)[1] > 1
    assert Axis("stop.gap", (0.0,)).structural is False


def test_an_unknown_map_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(KeyError, match="there are m"):
        vibeam.run_map(case(), "n", tmp_path / "m.h5")
