"""Reduced structures of solids on disk: found again to the bit, made anew where anything else, or damaged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vibeam.case import kept_structures
from vibeam.case import reduced_structure as rooms
from vibeam.case.kept_structures import keep, kept, place_of
from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.scene import Sensor
from vibeam_models.solid.plan import Solid
from vibeam_models.solid.scene import SolidScene
from vibeam_models.stop import Stop
from vibeam_models.structure import FIELDS, Structure


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("VIBEAM_CACHE", str(tmp_path))
    return tmp_path / "structures"


def small() -> Structure:
    rng = np.random.default_rng(0)
    rows = {name: rng.standard_normal(2) for name in ("load", "static", "contact")}
    K = np.array([[2.0, -1.0], [-1.0, 2.0]])
    return Structure(
        np.eye(2), 0.1 * K, K, **rows, outputs={"sensor": np.ones(2), "Ärm/1": np.zeros(2)}, units={"sensor": "m"},
        attached=(np.ones(2), np.array([0.0, 1.0])), contact_flexibility=0.25,
    )  # fmt: skip


def test_what_is_kept_is_read_to_the_bit(folder: Path) -> None:
    place = place_of("a scene", 3)
    assert place is not None
    assert kept(place) is None
    keep(place, small(), float("nan"))
    found, static = kept(place) or (None, 0.0)
    assert found == small()
    assert np.isnan(static)
    assert place_of("a scene", 4) != place


def test_a_damaged_file_is_none(folder: Path) -> None:
    place = place_of("a scene")
    assert place is not None
    keep(place, small(), 1.0)
    content = bytearray(place.read_bytes())
    content[len(content) // 2] ^= 1
    place.write_bytes(bytes(content))
    assert kept(place) is None
    place.write_bytes(content[:40])
    assert kept(place) is None
    keep(place, small(), 1.0)
    assert kept(place) is not None


def test_what_a_repr_does_not_say_is_not_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert place_of(small, 1) is None  # a function: its place in memory
    assert place_of(np.zeros(10_000)) is None  # shortened
    monkeypatch.setenv("VIBEAM_CACHE", "")
    assert place_of("a scene") is None


def test_a_disk_that_takes_nothing_stops_nothing(folder: Path) -> None:
    folder.write_text("a file where the folder should be")
    place = place_of("a scene")
    assert place is not None
    keep(place, small(), 1.0)
    assert kept(place) is None


def test_the_oldest_go(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_structures, "MOST", 2)
    for number in range(4):
        place = place_of(number)
        assert place is not None
        keep(place, small(), 1.0)
    assert len(list(folder.glob("*.npz"))) == 2


def test_a_second_run_builds_nothing_of_a_solid(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    beam = Beam(0.2, Rectangle(0.02, 0.01), 210e9, 7850.0, Damping("constant", (0.01,)), 4, poissons_ratio=0.3)
    solid = Solid(across=2, through=1)
    scene = SolidScene(beam, None, Stop(0.18, 1e-3), Sensor(0.1), Base(), solid=solid)
    made = rooms.reduced_structure(scene, "modal", 3)
    rooms._kept.cache_clear()

    def built(scene: object) -> None:
        raise AssertionError("the solid is built again")

    monkeypatch.setattr(rooms, "_kept_structure", built)
    found = rooms.reduced_structure(scene, "modal", 3)
    for name in FIELDS[:-1]:
        np.testing.assert_array_equal(getattr(found[0], name), getattr(made[0], name))
    assert found[1] == made[1]
    rooms._kept.cache_clear()
    with pytest.raises(AssertionError, match="built again"):
        rooms.reduced_structure(replace(scene, solid=Solid(across=4, through=1)), "modal", 3)
    rooms._kept.cache_clear()
