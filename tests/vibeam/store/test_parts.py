"""Long computations in parts: any number of parts gives the same steps, none twice; what is not theirs is refused."""

from __future__ import annotations

import shutil
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vibeam.exchange.whole_files import write_sealed
from vibeam.store import parts, place, steps
from vibeam.store.errors import StoreError
from vibeam.store.long_work import LongWork, WorkPart, WorkStep
from vibeam.store.parts import Ending, gathered, spans, take_part
from vibeam.store.place import locked, place_of
from vibeam.store.price import price

ITEMS = {"fine": range(0, 47, 3), "coarse": range(0, 20, 4)}


def evaluate(step: WorkStep) -> dict[str, Any]:
    rng = np.random.default_rng([len(step.name), step.first])
    return {"x": rng.normal(size=step.last - step.first), f"only {step.first}": np.array(step.first)}


def work(folder: Path, **more: Any) -> LongWork:
    keys = {"fine": "a", "coarse": "b"}
    return LongWork(folder / "out.h5", keys, ITEMS, evaluate, "code", {"fine": 2}, **({"together": 3} | more))


def content(made: LongWork) -> list[tuple[WorkStep, dict[str, bytes]]]:
    return [(step, {name: each.tobytes() for name, each in values.items()}) for step, values in gathered(made)]


def test_any_number_of_parts_gives_the_steps_of_one_process_to_the_bit(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    taken = take_part(work(tmp_path / "one"))
    assert (taken.total, taken.found, taken.done, taken.complete) == (47 * 2 + 20, 0, 114, True)
    for number in (3, 1, 4, 2):
        take_part(work(tmp_path), WorkPart(number, 4), workers=1)
    assert content(work(tmp_path)) == content(work(tmp_path / "one"))
    assert [step.last for step, _ in gathered(work(tmp_path))][-6:] == [47, 4, 8, 12, 16, 20]
    names = sorted(path.name for path in work(tmp_path).folder.iterdir())
    assert names == [*(f"{file:05d}.steps" for file in range(1, 8)), "manifest"]


def test_a_second_run_computes_what_is_missing_alone_by_other_parts_too(tmp_path: Path) -> None:
    made, computed = work(tmp_path), list[int]()

    def counted(step: WorkStep) -> dict[str, Any]:
        computed.append(step.number)
        return evaluate(step)

    counting = replace(made, evaluate=counted)
    take_part(made, WorkPart(2, 3))
    assert take_part(counting, WorkPart(2, 3)).complete
    assert computed == []
    take_part(counting)
    assert sorted(computed) == [number for number in range(21) if number // 3 not in (1, 4)]
    assert len(content(made)) == 21


@pytest.mark.parametrize("at", [0, 5, 180, 230, 700, -70, -1])
@pytest.mark.parametrize("cut", [True, False])
def test_what_is_damaged_or_torn_is_named_and_computed_anew(tmp_path: Path, at: int, cut: bool) -> None:
    made = work(tmp_path)
    take_part(made)
    before, path = content(made), made.folder / "00004.steps"
    whole = path.read_bytes()
    at %= len(whole)
    path.write_bytes(whole[:at] if cut else whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
    with pytest.raises(StoreError, match=r"of 21 steps are not there, in the files 4\b.*--part 4/7"):
        gathered(made)
    take_part(made, WorkPart(4, 7))
    assert content(made) == before


@pytest.mark.parametrize("tail", [b"torn", b"x" * 100_000, b"step 0000000099 00000000000999\nthe beginning"])
def test_what_a_kill_has_left_behind_the_last_step_is_cut_off(tmp_path: Path, tail: bytes) -> None:
    (tmp_path / "one").mkdir()
    whole, made = work(tmp_path / "one"), work(tmp_path)
    take_part(whole, workers=1)
    take_part(made, workers=1)
    path = made.folder / "00002.steps"
    first = path.read_bytes().find(b"step ", len(b"vibeam steps") + 200)  # of the second record
    path.write_bytes(path.read_bytes()[:first] + tail)
    take_part(made, workers=1)
    assert path.read_bytes() == (whole.folder / path.name).read_bytes()


def other_first(made: LongWork, ending: Ending | None = None) -> LongWork:
    """The work in whose first step another process computes all of it."""

    def evaluated(step: WorkStep) -> dict[str, Any]:
        if step.number == 0:
            assert take_part(made).complete
            if ending is not None:
                ending.wish()
        return evaluate(step)

    return replace(made, evaluate=evaluated)


def test_a_file_that_another_has_written_meanwhile_is_read_again_before_it_is_written(tmp_path: Path) -> None:
    made, ending = work(tmp_path), Ending()
    take_part(other_first(made, ending), WorkPart(1, 2), workers=1, ending=ending)
    assert len(content(made)) == 21


def test_no_step_is_written_twice(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    whole, made = work(tmp_path / "one"), work(tmp_path)
    take_part(whole, workers=1)
    take_part(other_first(made), WorkPart(1, 2), workers=1)
    for file in whole.folder.glob("*.steps"):
        assert sorted((made.folder / file.name).read_bytes()) == sorted(file.read_bytes())


def test_a_file_is_locked_until_it_is_whole_and_no_longer(tmp_path: Path) -> None:
    made, free = work(tmp_path), dict[int, bool]()

    def evaluated(step: WorkStep) -> dict[str, Any]:
        try:
            with locked(made.folder / "00001.steps"):
                free[step.number] = True
        except StoreError:
            free[step.number] = False
        return evaluate(step)

    take_part(replace(made, evaluate=evaluated), workers=1)
    assert [free[number] for number in range(5)] == [True, False, False, True, True]


def test_a_record_of_another_file_of_the_same_steps_is_not_there(tmp_path: Path) -> None:
    """Its own first line is in the seal: what other code has computed is not taken for ours."""
    for name, code in (("here", "code"), ("there", "old!")):
        (tmp_path / name).mkdir()
        take_part(replace(work(tmp_path / name), code=code), workers=1)
    here, there = (work(tmp_path / name).folder / "00003.steps" for name in ("here", "there"))
    line = here.read_bytes().index(b"\n") + 1
    here.write_bytes(here.read_bytes()[:line] + there.read_bytes()[line:])
    with pytest.raises(StoreError, match=r"3 of 21 steps are not there, in the files 3 \(damaged: 3\)"):
        gathered(work(tmp_path / "here"))


def test_a_file_of_steps_in_another_layout_is_named_and_stays(tmp_path: Path) -> None:
    made = work(tmp_path)
    take_part(made)
    path = made.folder / "00003.steps"
    other = path.read_bytes().replace(b"vibeam steps 1:", b"vibeam steps 10:")
    path.write_bytes(other)
    for use in (gathered, take_part):
        with pytest.raises(StoreError, match="files 3 are of other code, other kernels or another computation"):
            use(made)
    assert path.read_bytes() == other


def test_a_sealed_file_of_another_kind_is_no_manifest(tmp_path: Path) -> None:
    made = work(tmp_path)
    take_part(made)
    manifest = made.folder / "manifest"
    before = manifest.read_bytes()
    for of in ("", "it"):
        write_sealed(manifest, b"no manifest", of)
        assert len(content(made)) == 21
        assert manifest.read_bytes() == before


def test_a_step_is_on_disk_unless_another_was_just_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock, synchronised = [0.0], list[float]()
    monkeypatch.setattr(parts, "monotonic", lambda: clock[0])

    def evaluated(step: WorkStep) -> dict[str, Any]:
        clock[0] += 0.2
        return evaluate(step)

    with monkeypatch.context() as patch:
        patch.setattr(steps.os, "fsync", lambda handle: synchronised.append(clock[0]))
        take_part(replace(work(tmp_path), evaluate=evaluated), workers=1)
    assert np.diff(synchronised[-7:]).tolist() == pytest.approx([0.6] * 6)


def test_files_of_others_in_the_folder_stay_and_the_manifest_goes_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, gone = work(tmp_path), list[str]()
    take_part(made)
    (made.folder / "notes.txt").write_text("another's")
    unlink = Path.unlink

    def noted(path: Path, missing_ok: bool = False) -> None:
        gone.append(path.name)
        unlink(path, missing_ok)

    monkeypatch.setattr(Path, "unlink", noted)
    place_of(made.path).discard()
    assert [each.name for each in made.folder.iterdir()] == ["notes.txt"]
    assert (len(gone), gone[-1]) == (8, "manifest")


def test_a_lock_that_its_last_holder_has_deleted_is_no_lock(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Between opening and locking the file: a third process would make a new one, and both would write."""
    file, lock, tries = tmp_path / ".out.h5.lock", place._lock, list[int]()

    def locking(handle: int) -> bool:
        tries.append(handle)
        if len(tries) == 1:
            file.unlink()
        return lock(handle)

    monkeypatch.setattr(place, "_lock", locking)
    with locked(tmp_path / "out.h5"):
        assert len(tries) == 2
        with pytest.raises(StoreError, match="is writing it"), locked(tmp_path / "out.h5"):
            pass


def test_a_lock_that_cannot_be_signed_is_given_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(handle: int, content: bytes) -> int:
        raise OSError(28, "no space left")

    with monkeypatch.context() as patch:
        patch.setattr(place.os, "write", full)
        with pytest.raises(StoreError, match="no space left"), locked(tmp_path / "out.h5"):
            pass
    assert list(tmp_path.iterdir()) == []
    with locked(tmp_path / "out.h5"):
        pass


def test_every_file_that_lacks_steps_is_named_at_once(tmp_path: Path) -> None:
    made = work(tmp_path)
    take_part(made)
    for number in (2, 3, 4, 6):
        (made.folder / f"{number:05d}.steps").unlink()
    with pytest.raises(StoreError, match=r"12 of 21 steps are not there, in the files 2 to 4, 6: run the same parts"):
        gathered(made)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ({"code": "new"}, "another version of vibeam"), ({"keys": {"fine": "c", "coarse": "b"}}, "of another case"),
        ({"kernels": "library other"}, r"of other kernels, library .*; here they are library other: take the same"),
    ],
)  # fmt: skip
def test_steps_of_others_are_refused_by_name(
    tmp_path: Path, other: dict[str, Any], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    take_part(work(tmp_path), WorkPart(1, 2))
    if kernels := other.pop("kernels", ""):
        monkeypatch.setattr(parts, "origin", lambda: kernels)
    for use in (gathered, take_part):
        with pytest.raises(StoreError, match=said):
            use(replace(work(tmp_path), **other))


def test_a_file_that_another_version_made_elsewhere_is_named(tmp_path: Path) -> None:
    for name, code in (("here", "code"), ("there", "old")):
        (tmp_path / name).mkdir()
        take_part(replace(work(tmp_path / name), code=code))
    here, there = work(tmp_path / "here").folder, work(tmp_path / "there").folder
    for number in (2, 5):
        shutil.copy(there / f"{number:05d}.steps", here)
    for use in (gathered, take_part):
        with pytest.raises(StoreError, match=r"files 2, 5 are of other code, other kernels or another computation"):
            use(work(tmp_path / "here"))


def test_two_processes_of_one_part_and_two_of_one_file_refuse_each_other(tmp_path: Path) -> None:
    made = work(tmp_path)
    made.folder.mkdir()
    for held, part in (("part 2 of 3", WorkPart(2, 3)), ("00003.steps", WorkPart(1, 2))):
        with locked(made.folder / held), pytest.raises(StoreError, match=rf"{held}: process \d+ .* is writing it"):
            take_part(made, part)
    assert take_part(made, WorkPart(2, 3)).complete


def test_a_wish_to_end_keeps_the_steps_in_hand_and_begins_no_other(tmp_path: Path) -> None:
    ending, begun = Ending(), list[int]()

    def evaluated(step: WorkStep) -> dict[str, Any]:
        begun.append(step.number)
        if len(begun) == 4:
            ending.wish()
        return evaluate(step)

    taken = take_part(replace(work(tmp_path), evaluate=evaluated), workers=1, ending=ending)
    assert begun == [0, 1, 2, 3]
    assert (taken.done, taken.complete) == (24, False)
    assert take_part(work(tmp_path)).found == 24


def test_a_step_that_is_too_long_for_an_end_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from vibeam.flight.engine.threads import pause

    ending, limit = Ending(), threading.Event()
    monkeypatch.setattr(parts, "PATIENCE", 0.05)

    def endless(step: WorkStep) -> dict[str, Any]:
        ending.wish()
        while not limit.wait(0.01):
            pause()
        return {}

    assert take_part(replace(work(tmp_path), evaluate=endless), ending=ending).done == 0


def test_files_are_few_whatever_the_size(tmp_path: Path) -> None:
    for count, seconds in ((10, 1.0), (3000, 1.0), (20_000, 60.0), (20_000, 300.0)):
        made = LongWork(tmp_path / "o", {"a": ""}, {"a": range(count)}, evaluate, seconds={"a": seconds})
        assert made.files <= 10_000
        assert made.steps_a_file * seconds <= 300 or made.files > 9_000
        assert made.files >= min(count, 1_300)


@pytest.mark.parametrize("text", ["0/4", "5/4", "a", "3", "3/", "-1/4", "1/4/2", ""])
def test_a_part_that_is_none_is_refused_with_the_cure(text: str) -> None:
    with pytest.raises(ValueError, match=r"is no part: write its number and how many there are, 1/64 to 64/64"):
        WorkPart.read(text)
    assert WorkPart.read("3/64") == WorkPart(3, 64)


def test_spans_of_numbers() -> None:
    assert spans([3, 17, 18, 19]) == "3, 17 to 19"
    assert spans(list(range(0, 90, 2))).endswith("38 and 25 more spans")


def test_the_price_is_that_of_all_steps(tmp_path: Path) -> None:
    def busy(step: WorkStep) -> dict[str, Any]:
        return {"x": np.zeros(100 * (step.last - step.first))}

    found = price(replace(work(tmp_path), evaluate=busy), seconds=0.01)
    assert found.points == 114
    assert found.bytes == pytest.approx(67 * 100 * 8, rel=0.4)
    assert (found.steps, found.files, found.parts) == (21, 7, 1)
    assert found.seconds > 0
    assert found.minutes_a_part == 10
