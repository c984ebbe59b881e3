"""The results file: readable by others, resumable after a kill, refused where it does not belong."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray
from stand_in import point, same

from vibeam.response import Ended, FrequencyResponse
from vibeam.state import State
from vibeam.store.branch import Branch
from vibeam.store.faults import StoreError
from vibeam.store.file import opened, read

GRID = np.linspace(14.0, 17.0, 6)
UP, DOWN = Branch("beam", "up", GRID, 3), Branch("beam", "down", GRID[::-1].copy(), 3)
CASE = {"text": 'title = "a"\nsettle = 300\n', "key": "a" * 64, "branches": [UP, DOWN]}
STATE = State(np.array([1 / 3, 1e-300, -0.0]), np.array([np.pi, 2.0, -1e300]), resting=True)


def written(path: Path, points: int = 2) -> Path:
    with opened(path, **CASE) as store:
        for index in range(points):
            store.write(UP, index, point(GRID[index], 3, amplitude=index + 0.1, mode_energy=0.5), STATE)
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
        assert file["case"].attrs["key"].decode() == CASE["key"]
        assert file["case/text"][()].decode() == CASE["text"]
        assert {"vibeam", "numpy", "numba", "python", "platform", "time"} <= set(file["provenance"].attrs)
        assert file["provenance/continued"][0].startswith(b"vibeam ")
        assert file["provenance/continued"][1] == b""


def test_nondimensional_results_say_so(tmp_path: Path) -> None:
    with opened(tmp_path / "a.h5", **CASE, unit="1") as store:
        store.write(UP, 0, point(GRID[0], 3), STATE)
    with xarray.open_dataset(tmp_path / "a.h5", group="beam/up", engine="h5netcdf") as up:
        assert (up.reach.attrs["units"], up.impact_velocity.attrs["units"]) == ("1", "s-1")


def test_gives_back_every_bit(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5", points=1)
    with opened(path, **CASE) as store:
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
    other = CASE | {"text": CASE["text"].replace("300", "30"), "key": "b" * 64}
    with pytest.raises(StoreError, match="settle = 300' there, 'settle = 30' here") as caught, opened(path, **other):
        pass
    assert str(path) in str(caught.value)
    assert "choose another --out, or delete it" in str(caught.value)
    assert path.read_bytes() == before


@pytest.mark.parametrize("content", [b"", b"title = 'no results'\n", bytes(range(256)) * 40])
def test_what_is_no_result_is_refused_and_untouched(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.h5"
    path.write_bytes(content)
    with pytest.raises(StoreError, match="no vibeam result"), opened(path, **CASE):
        pass
    assert path.read_bytes() == content


def test_a_foreign_hdf5_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["beam/up/amplitude"] = np.zeros(6)
    with pytest.raises(StoreError, match="no vibeam result"), opened(path, **CASE):
        pass


def test_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="is a folder"), opened(tmp_path, **CASE):
        pass


@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_a_truncated_file_is_refused(tmp_path: Path, share: float) -> None:
    path = written(tmp_path / "a.h5")
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(StoreError, match=r"damaged: delete it and run again"), opened(path, **CASE):
        pass


def test_damage_anywhere_is_an_error_or_harmless(tmp_path: Path) -> None:
    """Whatever 64 bytes are lost: a StoreError or a file that reads, never another error."""
    whole = written(tmp_path / "a.h5").read_bytes()
    path, refused = tmp_path / "b.h5", 0
    for start in range(0, len(whole), 997):
        path.write_bytes(whole[:start] + bytes(64) + whole[start + 64 :])
        try:
            with opened(path, **CASE) as store:
                store.restore(UP)
                store.restore(DOWN)
        except StoreError:
            refused += 1
    assert refused


def test_a_start_that_fails_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), opened(tmp_path / "a.h5", **CASE):
        raise ZeroDivisionError
    with pytest.raises(StoreError, match="cannot be written"), opened(tmp_path / "none" / "a.h5", **CASE):
        pass
    assert not list(tmp_path.iterdir())


def test_a_failure_later_keeps_what_is_written(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="broadcast"), opened(tmp_path / "a.h5", **CASE) as store:
        store.write(UP, 0, point(GRID[0], 3), STATE) or store.write(UP, 1, point(GRID[1], 2), STATE)
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
    script = KILLED.format(tests=str(Path(__file__).parent), path=sys.path, file=str(file))
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -9
    with opened(file, **CASE) as store:
        kept = store.restore(UP)
        assert kept.done == 2
        assert kept.state is not None
        assert kept.response.amplitude[1] == 1.1


HOLDER = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('held', flush=True); sys.stdin.read()"


def test_two_runs_cannot_share_a_file(tmp_path: Path) -> None:
    path = written(tmp_path / "a.h5")
    command = [sys.executable, "-c", HOLDER, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(StoreError, match="another run is writing it"), opened(path, **CASE):
            pass
        holder.communicate("")
