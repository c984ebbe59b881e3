"""Refined maps: the points that are flown have the bits of the full grid, the others the label of their cell."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from stand_in import SI

import vibeam
from vibeam.maps import run as running
from vibeam.maps.block import Block, evaluate_block
from vibeam.maps.grids import grids_of, key_of
from vibeam.maps.motions import label
from vibeam.maps.quadtree import UNFLOWN, Quadtree
from vibeam.maps.store.blocks import block_path, write_block
from vibeam.report.maps.page import map_figure

BASINS: dict[str, Any] = {
    "picture": "basins", "frequency": "5.5 rad/s", "settle": 400, "hold": 48,
    "axes": [
        {"key": "start.velocity", "from": -0.02, "to": 0.02, "points": 22},
        {"key": "start.displacement", "from": -0.01, "to": 0, "points": 18},
    ],
}  # fmt: skip

PERIODS: dict[str, Any] = {
    "direction": "apart", "settle": 40, "hold": 16, "fidelities": ["sdof"], "boundaries": False,
    "axes": [
        {"key": "stop.gap", "values": [0.0, 1e-4]},
        {"key": "drive.voltage", "from": "0.1 V", "to": "0.7 V", "points": 14},
        {"key": "sweep.frequency", "from": "14 Hz", "to": "17 Hz", "points": 17},
    ],
}  # fmt: skip


def basins(**more: Any) -> vibeam.Case:
    return vibeam.load("cases/maps/basins.toml", set=SI | {"map": {"m": BASINS | more}})


def periods(**more: Any) -> vibeam.Case:
    return vibeam.load("cases/dtu_loose.toml", set=SI | {"map": {"m": PERIODS | more}, "reference": None})


def flown_by_hand(truth: np.ndarray[Any, Any], levels: int) -> np.ndarray[Any, Any]:
    """Cells divided one by one until none has two labels among its flown points."""
    rows, columns = truth.shape
    flown = np.zeros(truth.shape, dtype=bool)

    def stations(step: int, size: int) -> list[int]:
        return [*range(0, size - 1, step), size - 1]

    for i in stations(2**levels, rows):
        for j in stations(2**levels, columns):
            flown[i, j] = True
    changed = True
    while changed:
        changed = False
        for level in range(levels):
            step = 2 ** (levels - level)
            down, across = stations(step, rows), stations(step, columns)
            for top, bottom in pairwise(down):
                for left, right in pairwise(across):
                    if not flown[np.ix_([top, bottom], [left, right])].all():
                        continue
                    part = np.s_[top : bottom + 1, left : right + 1]
                    if len({*truth[part][flown[part]]}) == 1:
                        continue
                    for i in [each for each in stations(step // 2, rows) if top <= each <= bottom]:
                        for j in [each for each in stations(step // 2, columns) if left <= each <= right]:
                            changed |= not flown[i, j]
                            flown[i, j] = True
    return flown


def refined(tree: Quadtree, truth: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    labels = np.full(truth.size, UNFLOWN)
    points = tree.coarse()
    while len(points):
        assert np.all(labels[points] == UNFLOWN)
        labels[points] = truth.ravel()[points]
        points = tree.ahead(labels)
    return labels


@pytest.mark.parametrize(("shape", "levels"), [((33, 33), 4), ((30, 47), 3), ((9, 20), 3), ((5, 4), 1)])
def test_points_flown_are_those_of_a_quadtree_made_by_hand(shape: tuple[int, int], levels: int) -> None:
    i, j = np.meshgrid(*(np.linspace(-1, 1, size) for size in shape), indexing="ij")
    truth = (i**2 + j**2 < 0.5).astype(int) + 2 * (j > 0.3 + 0.1 * np.sin(9 * i))
    tree = Quadtree((1, *shape), levels)
    labels = refined(tree, truth)
    np.testing.assert_array_equal((labels != UNFLOWN).reshape(shape), flown_by_hand(truth, levels))
    sources = tree.sources(labels != UNFLOWN)
    assert np.all(labels[sources] != UNFLOWN)
    filled = truth.ravel()[sources].reshape(shape)
    assert np.mean(filled != truth) < 0.02


def test_one_label_is_known_from_the_coarse_grid_and_an_island_within_a_cell_is_missed() -> None:
    truth = np.zeros((17, 17), dtype=int)
    truth[2, 3] = 1
    tree = Quadtree((1, 17, 17), 3)
    labels = refined(tree, truth)
    assert np.count_nonzero(labels != UNFLOWN) == 9
    truth[2, 3], truth[8, 8] = 0, 1
    labels = refined(tree, truth)
    np.testing.assert_array_equal(truth.ravel()[tree.sources(labels != UNFLOWN)], truth.ravel())


def test_planes_are_refined_by_themselves() -> None:
    truth = np.zeros((2, 9, 9), dtype=int)
    truth[1, :, 4:] = 1
    labels = refined(Quadtree((2, 9, 9), 3), truth).reshape(truth.shape)
    assert np.count_nonzero(labels[0] != UNFLOWN) == 4
    assert np.count_nonzero(labels[1] != UNFLOWN) > 4


@pytest.mark.parametrize(("made", "levels"), [(basins, 3), (periods, 2)])
def test_what_is_flown_is_the_full_grid_to_the_bit(made: Any, levels: int, tmp_path: Path) -> None:
    full = vibeam.run_map(made(), "m", tmp_path / "full.h5")
    found = vibeam.run_map(made(refine=levels), "m", tmp_path / "m.h5")
    for name, whole in full["sdof"].values.items():
        values, flown = found["sdof"].values[name], found["sdof"].values["flown"] == 1
        assert values.shape == whole.shape
        np.testing.assert_array_equal(values[flown], whole[flown], err_msg=name)
    flown = found["sdof"].values["flown"]
    assert 0 < np.count_nonzero(flown) < flown.size
    with h5py.File(tmp_path / "m.h5") as file:
        np.testing.assert_array_equal(file["sdof/flown"][()], flown)
        assert file["sdof/period"].dims[1][0].name == file["sdof/flown"].dims[1][0].name
    assert map_figure(found).axes


def test_a_number_that_is_no_label_is_none_where_it_was_not_flown(tmp_path: Path) -> None:
    found = vibeam.run_map(periods(refine=2), "m", tmp_path / "m.h5")["sdof"].values
    flown = found["flown"] == 1
    assert np.isfinite(found["amplitude"][flown]).all()
    assert np.isnan(found["amplitude"][~flown]).all()
    assert np.isfinite(found["rest"]).all()


def test_motions_of_starts_are_those_of_their_corners(tmp_path: Path) -> None:
    found = vibeam.run_map(basins(refine=3), "m", tmp_path / "m.h5")
    labelled = label(found["sdof"], 0)
    assert np.all(labelled.which >= 0)
    assert len(labelled.motions) > 1


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> list[Block]:
    """Blocks of twenty points, and a list of those that were computed."""
    computed: list[Block] = []

    def counted(block: Block) -> Any:
        computed.append(block)
        return evaluate_block(block, threads=1)

    monkeypatch.setattr(running, "lines_of_block", lambda case, grid: 20)
    monkeypatch.setattr(running, "evaluate_here", counted)
    return computed


@pytest.mark.parametrize("stored", [3, 14])
def test_a_run_that_ended_goes_on_in_the_pass_where_it_was(
    stored: int, tmp_path: Path, small: list[Block], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted(Exception):
        pass

    def ending(folder: Path, block: Block, key: str, values: Any) -> None:
        if len(list(folder.glob("*.npz"))) == stored:
            raise Interrupted
        write_block(folder, block, key, values)

    whole = vibeam.run_map(basins(refine=2), "m", tmp_path / "whole.h5")
    every = {block_path(Path(), block).name: block.size for block in small}
    assert len(every) == len(small) > 14
    with monkeypatch.context() as patch:
        patch.setattr(running, "write_block", ending)
        with pytest.raises(Interrupted):
            vibeam.run_map(basins(refine=2), "m", tmp_path / "m.h5", workers=1)
    there = {path.name for path in (tmp_path / "m.h5.parts").glob("*.npz")}
    small.clear()
    told: list[tuple[int, int]] = []
    partial: list[vibeam.MapResult] = []
    monkeypatch.setattr(running, "EVERY", 0.0)
    monkeypatch.setattr(running, "SHARE", 0.0)
    found = vibeam.run_map(
        basins(refine=2), "m", tmp_path / "m.h5", progress=lambda *done: told.append(done), partial=partial.append
    )
    again = {block_path(Path(), block).name for block in small}
    assert again == every.keys() - there
    assert told[0][0] == found.found == sum(every[name] for name in there)
    for name, values in whole["sdof"].values.items():
        np.testing.assert_array_equal(found["sdof"].values[name], values, err_msg=name)
    assert partial
    assert all(map_figure(each).axes for each in partial[:2])


def faults(**more: Any) -> str:
    with pytest.raises(vibeam.CaseError) as error:
        periods(**more)
    return str(error.value)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"refine": 2, "direction": "up"}, "map.m.refine: flies points by themselves, and here the state is carried"),
        ({"refine": 4}, "map.m.refine: begins with every 16th point, and an axis has 14: 3 at most"),
        ({"refine": 2, "picture": "values"}, "refining follows labels: leave it away"),
        ({"refine": 2, "picture": "basins", "starts": 4, "spread": "1 mm"}, "is of one motion a point"),
        ({"refine": 13}, "map.m.refine: 13 is outside"),
    ],
)
def test_what_cannot_be_refined_is_said(more: dict[str, Any], said: str) -> None:
    assert said in faults(**more)


def test_refining_belongs_to_the_key_of_a_map() -> None:
    made = [basins(refine=levels) for levels in (0, 2, 3)]
    assert len({key_of(each, grids_of(each, each.maps["m"])["sdof"]) for each in made}) == 3
