"""Rounds of independent evaluations: the same values in threads, by one process and by parts; who shares decides."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vibeam.store.errors import StoreError
from vibeam.store.long_work import LongWork, WorkPart
from vibeam.store.parts import StepsOnDisk, take_part
from vibeam.store.shares import Sharing, Told, are_shared, evaluate_each, set_aside, sharing

ITEMS = list("abcdefghijk")


def values_of(item: str) -> dict[str, Any]:
    """Arrays whose number and shape hang on the item, none of one."""
    place = ITEMS.index(item)
    rng = np.random.default_rng(place)
    return {f"{item} {n}": rng.normal(size=(place, n)) for n in range(place % 3 + 1)} if place else {}


def computed(of: str = "v", evaluate: Callable[[str], dict[str, Any]] = values_of) -> dict[str, dict[str, bytes]]:
    """What two rounds give, the second of what the first gave."""
    found: dict[str, dict[str, bytes]] = {}

    def keep(item: str, values: dict[str, Any]) -> None:
        found[item] = {name: each.tobytes() for name, each in values.items()}

    evaluate_each("letters", of, ITEMS, evaluate, keep)
    total = sum(len(each) for own in found.values() for each in own.values())
    evaluate_each("sum", f"{of} {total}", [total], lambda sum_: {"sum": np.array(sum_)}, lambda _, own: found.update(
        sum={"sum": own["sum"].tobytes()}
    ))  # fmt: skip
    return found


class Ended(Exception):
    """End of a share."""


def part_of(number: int, of: int) -> Callable[[LongWork, Told | None], None]:
    def take(work: LongWork, told: Told | None) -> None:
        take_part(work, WorkPart(number, of), tell=told)
        if StepsOnDisk(work).missing():
            raise Ended

    return take


def all_of_it(work: LongWork, told: Told | None) -> None:
    take_part(work, tell=told)


def nothing(work: LongWork, told: Told | None) -> None:
    pass


def test_rounds_in_steps_and_by_parts_give_what_threads_give_to_the_bit(tmp_path: Path) -> None:
    here = computed()
    assert set(here) == {*ITEMS, "sum"}
    with sharing(whole := Sharing(tmp_path / "one.csv", all_of_it)):
        assert computed() == here
    names = ["one.csv.1-letters.parts", "one.csv.2-sum.parts"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    whole.discard()
    assert not any(tmp_path.iterdir())
    for number in (2, 3, 1):
        with (
            sharing(Sharing(tmp_path / "two.csv", part_of(number, 3))),
            pytest.raises(Ended) if number > 1 else sharing(Sharing(tmp_path / "two.csv", part_of(1, 3))),
        ):
            computed()
    with sharing(Sharing(tmp_path / "two.csv", nothing)):
        assert computed() == here


def test_what_is_missing_is_named_with_the_command_of_who_shares(tmp_path: Path) -> None:
    path = tmp_path / "out.csv"
    with sharing(Sharing(path, part_of(2, 4))), pytest.raises(Ended):
        computed()
    said = r"8 of 11 steps are not there, in the files 1, 3 to 5, 7 to 9, 11: .*\(vibeam it --part 1/11\)"
    with sharing(Sharing(path, nothing, command="vibeam it")), pytest.raises(StoreError, match=said):
        computed()


def test_a_second_run_evaluates_what_is_missing_alone(tmp_path: Path) -> None:
    seen, most = list[str](), 4

    def evaluate(item: str) -> dict[str, Any]:
        if len(seen) == most:
            raise KeyboardInterrupt
        seen.append(item)
        return values_of(item)

    def one_by_one(work: LongWork, told: Told | None) -> None:
        take_part(work, workers=1)

    with sharing(Sharing(tmp_path / "out.csv", one_by_one)), pytest.raises(KeyboardInterrupt):
        computed(evaluate=evaluate)
    most = 100
    with sharing(Sharing(tmp_path / "out.csv", one_by_one)):
        assert computed(evaluate=evaluate) == computed()
    assert seen == ITEMS


def test_what_decides_the_values_decides_whose_steps_they_are(tmp_path: Path) -> None:
    path, told = tmp_path / "out.csv", list[str]()
    with sharing(Sharing(path, all_of_it)):
        computed("before")
    with sharing(Sharing(path, all_of_it)), pytest.raises(StoreError, match="holds steps of another case"):
        computed("after")
    with sharing(Sharing(path, all_of_it, code="new")), pytest.raises(StoreError, match="another version of vibeam"):
        computed("before")

    def aside(work: LongWork, _: Told | None) -> None:
        set_aside(work, told.append)
        take_part(work)

    with sharing(Sharing(path, aside)):
        assert computed("after") == computed()
    assert [line.split(": ", 1)[1] for line in told] == [
        "holds steps of the case as it was; its results are kept aside as out.csv.1.1-letters.parts",
        "holds steps of the case as it was; its results are kept aside as out.csv.1.2-sum.parts",
    ]


def test_evaluations_share_no_rounds_of_their_own(tmp_path: Path) -> None:
    def evaluate(item: str) -> dict[str, Any]:
        return {"shared": np.array(are_shared()), "within": np.array(len(computed()))}

    kept: list[dict[str, Any]] = []
    with sharing(Sharing(tmp_path / "out.csv", all_of_it)):
        assert are_shared()
        evaluate_each("outer", "", ITEMS, evaluate, lambda _, own: kept.append(own))
        with sharing(None):
            assert not are_shared()
    assert not are_shared()
    assert [(bool(each["shared"]), int(each["within"])) for each in kept] == [(False, 12)] * 11
    assert [path.name for path in tmp_path.iterdir()] == ["out.csv.1-outer.parts"]


@pytest.mark.parametrize("shared", [False, True])
def test_progress_is_told_up_to_the_total(tmp_path: Path, shared: bool) -> None:
    told: list[tuple[int, int]] = []
    with sharing(Sharing(tmp_path / "out.csv", all_of_it) if shared else None):
        evaluate_each("x", "", ITEMS, values_of, lambda *_: None, lambda *each: told.append(each))
    assert sorted(told) == [(done, 11) for done in range(12)]


def test_of_very_many_items_several_are_a_step(tmp_path: Path) -> None:
    def ended(work: LongWork, told: Told | None) -> None:
        assert (len(work.every), work.every[-1].last) == (15_000, 45_000)
        assert work.files <= 10_000
        raise Ended

    with sharing(Sharing(tmp_path / "out.csv", ended)), pytest.raises(Ended):
        evaluate_each("x", "", range(45_000), lambda n: {"n": np.array(n)}, lambda *_: None)
