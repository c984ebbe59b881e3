"""Links and other files under the names of vibeam's own: none is written, cut off, emptied or deleted through them."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from vibeam.cli.arguments import output_path
from vibeam.cli.main import app
from vibeam.exchange.matrices.declaration import write_arrays
from vibeam.exchange.vtu import VtuPiece, write_series
from vibeam.exchange.whole_files import open_own, read_sealed, write_sealed, write_whole
from vibeam.store.blocks import read_block, write_block
from vibeam.store.errors import StoreError
from vibeam.store.long_work import LongWork, WorkPart, WorkStep
from vibeam.store.parts import gathered, take_part
from vibeam.store.place import locked, place_of

PRECIOUS = b"precious"


def linked(name: Path, victim: Path) -> None:
    name.symlink_to(victim)


def pipe(name: Path, victim: Path) -> None:
    os.mkfifo(name)


def bound(name: Path, victim: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(name))


FOREIGN: dict[str, Callable[[Path, Path], None]] = {
    "a link": linked,
    "a link (dangling)": lambda name, victim: name.symlink_to(victim.with_name("none")),
    "a file with a hard link": lambda name, victim: name.hardlink_to(victim),
    "a pipe": pipe,
    "a socket": bound,
    "a folder": lambda name, victim: name.mkdir(),
}


@pytest.fixture
def victim(tmp_path: Path) -> Iterator[Path]:
    """A file that is another's: with its content at the end, and nothing beside it."""
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    file = folder / "victim"
    file.write_bytes(PRECIOUS)
    yield file
    assert file.read_bytes() == PRECIOUS
    assert list(folder.iterdir()) == [file]


def evaluate(step: WorkStep) -> dict[str, Any]:
    return {"x": np.arange(step.first, step.last)}


def work(folder: Path) -> LongWork:
    return LongWork(folder / "out.h5", {"a": "key"}, {"a": range(0, 6, 1)}, evaluate, "code", together=3)


@pytest.mark.parametrize("kind", FOREIGN)
def test_a_lock_that_is_no_file_of_ours_is_refused_and_stays(tmp_path: Path, victim: Path, kind: str) -> None:
    name = tmp_path / ".out.h5.lock"
    FOREIGN[kind](name, victim)
    with (
        pytest.raises(StoreError, match=rf"\.out\.h5\.lock is {kind.split(' (')[0]}, no file .*own: delete it"),
        locked(tmp_path / "out.h5"),
    ):
        pass
    assert os.path.lexists(name)


@pytest.mark.parametrize("name", ["00001.steps", "manifest"])
@pytest.mark.parametrize("kind", FOREIGN)
def test_files_of_parts_that_are_not_ours_are_not_written(tmp_path: Path, victim: Path, name: str, kind: str) -> None:
    made = work(tmp_path)
    made.folder.mkdir()
    FOREIGN[kind](made.folder / name, victim)
    if (name, kind) == ("manifest", "a file with a hard link"):  # damaged: a new file takes its name
        assert take_part(made).complete
        return
    with pytest.raises(StoreError, match=rf"{name} is {kind.split(' (')[0]}, no file of vibeam's own"):
        take_part(made)
    assert os.path.lexists(made.folder / name)


def test_steps_that_became_a_link_meanwhile_are_not_there(tmp_path: Path, victim: Path) -> None:
    made = work(tmp_path)
    take_part(made)
    kept = gathered(made)
    steps = made.folder / "00002.steps"
    steps.unlink()
    steps.symlink_to(victim)
    with pytest.raises(StoreError, match="damaged meanwhile"):
        list(kept)


def test_the_lock_of_a_part_or_of_its_file_is_not_put_beside_what_a_link_stands_for(
    tmp_path: Path, victim: Path
) -> None:
    made = work(tmp_path)
    made.folder.mkdir()
    (made.folder / "part 1 of 2").symlink_to(victim)
    seen = list[set[str]]()
    victim.parent.chmod(0o555)

    def looked(done: int, total: int) -> None:
        seen.append({each.name for each in victim.parent.iterdir()})

    try:
        assert take_part(made, WorkPart(1, 2), tell=looked).complete
    finally:
        victim.parent.chmod(0o755)
    assert set.union(*seen) == {"victim"}


def test_a_folder_of_parts_that_is_a_link_is_refused_before_anything_in_it_is_touched(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    for name in ("x.npz", "00001.steps", ".x.part", "manifest"):
        (other / name).write_bytes(PRECIOUS)
    parts = tmp_path / "out.h5.parts"
    for target in (other, tmp_path / "none", Path("out.h5.parts")):  # there, dangling, a link to itself
        parts.symlink_to(target)
        for use in (lambda: take_part(work(tmp_path)), lambda: place_of(tmp_path / "out.h5").discard()):
            with pytest.raises(StoreError, match=r"out\.h5\.parts is a link, no folder of vibeam's own: delete it"):
                use()
        parts.unlink()
    assert {each.read_bytes() for each in other.iterdir()} == {PRECIOUS}
    assert len(list(other.iterdir())) == 4


@pytest.mark.parametrize("kind", [each for each in FOREIGN if each != "a folder"])
def test_a_sealed_file_takes_the_name_of_a_link_and_leaves_what_that_stood_for(
    tmp_path: Path, victim: Path, kind: str
) -> None:
    file = tmp_path / "a-000000001.npz"
    FOREIGN[kind](file, victim)
    assert read_block(file, "it") is None
    write_block(tmp_path / "out.h5", file, "it", {"x": np.arange(3)})
    found = read_block(file, "it")
    assert found is not None
    assert found["x"].tolist() == [0, 1, 2]
    assert file.lstat().st_mode == (file.stat().st_mode & ~0o111)
    assert file.lstat().st_nlink == 1


def test_a_file_begun_under_a_name_of_ours_is_a_new_one(
    tmp_path: Path, victim: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "urandom", lambda count: b"\0" * count)
    begun = tmp_path / f".out.h5.{os.getpid()}-00000000.part"
    begun.symlink_to(victim)
    with pytest.raises(FileExistsError):
        write_sealed(tmp_path / "out.h5", b"x")


def test_a_folder_under_the_name_of_a_file_begun_stops_nothing(tmp_path: Path, victim: Path) -> None:
    (tmp_path / ".out.h5.1.part").mkdir()
    (tmp_path / ".out.h5.2.part").symlink_to(victim)
    (tmp_path / ".out.h5.3.part").write_bytes(b"begun")
    with locked(tmp_path / "out.h5") as place:
        place.tidy()
    assert [each.name for each in tmp_path.glob(".*")] == [".out.h5.1.part"]


@pytest.mark.parametrize("linking", [True, False])
def test_results_kept_aside_pass_over_a_name_that_a_link_has(
    tmp_path: Path, victim: Path, linking: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*given: object) -> None:
        raise PermissionError(1, "no second names here")

    if not linking:
        monkeypatch.setattr(os, "link", refused)
    results = tmp_path / "out.h5"
    results.write_bytes(b"results")
    (tmp_path / "out.1.h5").symlink_to(tmp_path / "none")
    (tmp_path / "out.2.h5").symlink_to(victim)
    (tmp_path / "out.3.h5").symlink_to(results)
    said = list[str]()
    assert place_of(results).keep_aside("holds another", said.append) == tmp_path / "out.4.h5"
    assert (tmp_path / "out.4.h5").read_bytes() == b"results"
    assert os.readlink(tmp_path / "out.1.h5") == str(tmp_path / "none")


def test_what_is_named_is_written_where_a_link_leads(tmp_path: Path) -> None:
    there = tmp_path / "there"
    there.mkdir()
    for name, target in (("a.csv", there / "b.csv"), ("out.h5", there / "kept.h5")):
        (tmp_path / name).symlink_to(target)
    write_whole(tmp_path / "a.csv", b"x")
    with locked(tmp_path / "out.h5") as place:
        place.replace(b"y")
        assert (there / ".kept.h5.lock").exists()
    assert (there / "b.csv").read_bytes() == b"x"
    assert read_sealed(there / "kept.h5") == b"y"
    assert (tmp_path / "a.csv").is_symlink()
    assert (tmp_path / "out.h5").is_symlink()


NAMED = "is a link, which is followed only where --out names it: delete it"


def test_a_name_that_nobody_wrote_is_not_followed(
    tmp_path: Path, victim: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.csv").symlink_to(victim)
    for out in (None, ".", f"{tmp_path}/"):
        with pytest.raises(OSError, match=NAMED):
            output_path(out, "m.csv", (".csv",), "a table")
    assert output_path("m.csv", "m.csv", (".csv",), "a table") == Path("m.csv")


def test_files_beside_the_one_that_is_named_are_not_written_through_a_link(tmp_path: Path, victim: Path) -> None:
    (tmp_path / "m_K.npy").symlink_to(victim)
    with pytest.raises(OSError, match=NAMED):
        write_arrays({"K": np.eye(2)}, tmp_path / "m.npy")
    piece = VtuPiece(np.zeros((2, 3)), {})
    (tmp_path / "shape").symlink_to(victim.parent)
    with pytest.raises(OSError, match=NAMED):
        write_series([(0.0, {"beam": piece})], tmp_path / "shape.pvd")
    (tmp_path / "form").mkdir()
    (tmp_path / "form" / "beam_0000.vtu").symlink_to(victim)
    with pytest.raises(OSError, match=NAMED):
        write_series([(0.0, {"beam": piece})], tmp_path / "form.pvd")


MASS = """units = "SI"
[beam]
length = 0.3
width = 0.02
thickness = 0.002
youngs_modulus = 70e9
density = 2700
damping_ratio = 0.05
[stop]
gap = 1e-5
restitution = 0.6
position = 0.3
[sensor]
position = 0.3
[drive]
amplitude = 1e-6
[sweep]
frequency = [15.0, 16.0]
settle = 2
hold = 2
[fidelity.one]
reduction = "modal"
modes = 1
"""


@pytest.mark.parametrize("name", ["m.h5", "m.svg", ".m.h5.lock", "m.h5.parts"])
def test_a_command_writes_nothing_through_a_link_in_its_folder(
    tmp_path: Path, victim: Path, name: str, monkeypatch: pytest.MonkeyPatch, undrawn: None
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.toml").write_text(MASS)
    Path(name).symlink_to(victim)
    done = CliRunner().invoke(app, ["run", "m.toml"])
    assert done.exit_code == 2
    assert f"{name}" in done.stderr
    assert "is a link" in done.stderr
    assert Path(name).is_symlink()
    Path(name).unlink()
    assert CliRunner().invoke(app, ["run", "m.toml"]).exit_code == 0


def test_a_name_that_changes_between_look_and_opening_is_not_followed(
    tmp_path: Path, victim: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The look says that nothing is there: opening itself refuses the link."""
    name = tmp_path / "lock"
    name.symlink_to(victim)

    def nothing(path: Path) -> None:
        raise FileNotFoundError

    monkeypatch.setattr(os, "lstat", nothing)
    with pytest.raises(OSError, match="symbolic links"):
        open_own(name, os.O_RDWR | os.O_CREAT)


def test_where_opening_cannot_refuse_a_link_the_look_before_does(
    tmp_path: Path, victim: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As under Windows, which has no O_NOFOLLOW."""
    monkeypatch.setattr("vibeam.exchange.whole_files.OWN", 0)
    name = tmp_path / "lock"
    name.symlink_to(victim)
    with pytest.raises(OSError, match="is a link, no file of vibeam's own"):
        open_own(name, os.O_RDWR | os.O_CREAT)
