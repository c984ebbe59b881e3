"""Reduced structures of solids on disk: found again to the bit, made anew where anything else, or damaged."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from vibeam.case import reduced_structure as rooms
from vibeam.exchange.whole_files import write_sealed
from vibeam.extensions.solid import kept_structures
from vibeam.extensions.solid.elasticity.plan import Solid
from vibeam.extensions.solid.elasticity.scene import SolidScene
from vibeam.extensions.solid.kept_structures import FORM, keep, kept, note, noted, place_of
from vibeam_models.base import Base
from vibeam_models.beams.beam import Beam, Damping
from vibeam_models.beams.shapes import Rectangle
from vibeam_models.scene import Sensor
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


def stored(*content: object) -> Path:
    place = place_of(*content)
    assert place is not None
    keep(place, small(), 1.0)
    return place


def test_the_file_of_another_structure_under_this_name_is_none(folder: Path) -> None:
    place, other = stored("a scene"), stored("another")
    place.write_bytes(other.read_bytes())
    assert kept(place) is None
    keep(place, small(), 1.0)
    assert kept(place) is not None
    other.unlink()
    place.rename(other)
    assert kept(other) is None


def test_the_code_that_makes_a_structure_is_in_its_name(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place, value = stored("a scene"), 1.5
    note(value, "a scene")
    assert noted(float, "a scene") == value
    monkeypatch.setattr(kept_structures, "_code", lambda: "other code")
    assert place_of("a scene") != place
    assert kept(place_of("a scene")) is None
    assert noted(float, "a scene") is None


@pytest.mark.parametrize("content", [b"", b"{}", b"PK\x03\x04 no archive", b"\x93NUMPY"])
def test_a_file_of_another_form_is_none_and_is_made_anew(folder: Path, content: bytes) -> None:
    place = stored("a scene")
    write_sealed(place, content, f"{FORM} {place.name}\n")
    assert kept(place) is None
    keep(place, small(), 1.0)
    assert kept(place) is not None


def test_a_structure_that_lacks_an_array_is_none(folder: Path) -> None:
    place, content = stored("a scene"), BytesIO()
    np.savez(content, names=np.array(json.dumps({"outputs": [], "units": {}, "static": 1.0, "flexibility": 0.0})))
    write_sealed(place, content.getvalue(), f"{FORM} {place.name}\n")
    assert kept(place) is None


def test_a_file_of_another_version_is_none(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = stored("a scene")
    monkeypatch.setattr(kept_structures, "FORM", FORM + "0")
    assert kept(place) is None
    assert kept_structures._seal_of(place) != FORM + place.name


def pair(said: tuple[float, list[str]]) -> tuple[float, tuple[str, ...]]:
    mass, assumed = said
    return float(mass), tuple(assumed)


@pytest.mark.parametrize(
    "content", [b"1.5", b"[1.5]", b"null", b'"text"', b'{"mass": 1}', b"[[], []]", b"", b"\xff", b"{", b'["a", []]']
)
def test_a_note_of_another_form_is_none_and_is_made_anew(folder: Path, content: bytes) -> None:
    note((1.5, ["said"]), "a mesh")
    assert noted(pair, "a mesh") == (1.5, ("said",))
    [file] = folder.glob("*.json")
    write_sealed(file, content, f"{FORM} {file.name}\n")
    assert noted(pair, "a mesh") is None
    note((1.5, ["said"]), "a mesh")
    assert noted(pair, "a mesh") == (1.5, ("said",))


def test_a_link_in_the_cache_is_replaced_and_what_it_stands_for_stays(folder: Path, tmp_path: Path) -> None:
    place, victim = stored("a scene"), tmp_path / "victim"
    victim.write_bytes(place.read_bytes())
    place.unlink()
    place.symlink_to(victim)
    assert kept(place) is None
    keep(place, replace(small(), contact_flexibility=0.5), 1.0)
    assert (kept(place) or (small(),))[0].contact_flexibility == 0.5
    assert not place.is_symlink()
    victim.unlink()


def test_a_folder_that_is_a_link_keeps_nothing_and_files_of_others_stay(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_structures, "MOST", 1)
    folder.mkdir()
    (folder / "data.npz").write_bytes(b"another's")
    (folder / f"{'0' * 40}.npz").symlink_to(folder / "none")
    for other in ("data.npz", f"{'0' * 40}.npz"):
        os.utime(folder / other, (0, 0), follow_symlinks=False)
    place = stored("a scene")
    assert {each.name for each in folder.iterdir()} == {"data.npz", place.name}
    moved = folder.rename(folder.with_name("moved"))
    folder.symlink_to(moved)
    assert place_of("a scene") is None


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
