"""Mode shapes of solids beside the beam's line: hidden surfaces, light, areas to scale, pairs of modes, stored data."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from solid_bodies import RIG

import vibeam
from vibeam.figures.kinds.shapes import pairs_of
from vibeam.figures.shading import AMBIENT, LIGHT, axes_of_view, picture, projected
from vibeam.figures.sheet import Column, Sheet, sheets
from vibeam.report.figures import figure

TEXT = (
    RIG
    + """[fidelity.line]
reduction = "modal"
modes = 3
[fidelity.body]
model = "solid"
reduction = "modal"
modes = 3
[show.forms]
kind = "shapes"
"""
)
RIGHT, UP, TOWARD = axes_of_view()
PIXEL = 0.01


def square(centre: tuple[float, float, float], side: float = 1.0) -> np.ndarray:
    """Corners (4, 3) of a square across the line of sight, centre and side in m of the view."""
    each = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * side / 2
    across = np.column_stack([each, np.zeros(4)]) + centre
    return np.asarray(across @ axes_of_view())


def seen(*squares: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Pixels of squares, each of one colour."""
    corners = np.array([[0, 1, 2], [0, 2, 3]])
    triangles = np.concatenate([corners + 4 * number for number in range(len(squares))])
    return picture(np.concatenate(squares), triangles, np.repeat(colours, 4, axis=0), PIXEL).pixels


def test_the_view_is_a_rotation() -> None:
    np.testing.assert_allclose(axes_of_view() @ axes_of_view().T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes_of_view()) == pytest.approx(1)
    along, up = projected(np.array([1.0, 0.0, 0.0])), projected(np.array([0.0, 0.0, 1.0]))
    assert along[0] > 0.8  # the beam goes to the right, and deflects upward
    assert up[1] > 0.8
    assert up[0] == pytest.approx(0)


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_the_nearest_surface_hides_what_lies_behind(order: tuple[int, ...]) -> None:
    """Three squares that overlap in the middle: in every order of drawing that with the largest depth is seen there."""
    squares = [square((0, 0, 0), 2.0), square((0.3, 0, 1), 1.0), square((-0.3, 0, 2), 1.0)]
    colours = np.eye(3)
    pixels = seen(*(squares[i] for i in order), colours=colours[list(order)])
    middle = pixels.shape[0] // 2
    assert np.argmax(pixels[middle, 100, :3]) == 2
    assert np.argmax(pixels[middle, 170, :3]) == 1
    assert np.argmax(pixels[middle, 10, :3]) == 0


def test_areas_are_to_scale_and_light_is_lamberts() -> None:
    """A square of 1 m² across the view covers 1 m²; one that leans by 60° half of it, less bright by its normal."""
    whole = seen(square((0, 0, 0)), colours=np.ones((1, 3)))
    assert whole[..., 3].sum() * PIXEL**2 == pytest.approx(1, rel=0.01)
    assert whole[50, 50, 0] == pytest.approx(AMBIENT + (1 - AMBIENT) * LIGHT[2], rel=1e-12)
    flat = np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    leant = flat * [1, np.cos(np.pi / 3), 0] + np.outer(flat[:, 1], [0, 0, np.sin(np.pi / 3)])
    pixels = seen(leant @ axes_of_view(), colours=np.ones((1, 3)))
    assert pixels[..., 3].sum() * PIXEL**2 == pytest.approx(0.5, rel=0.02)
    normal = np.array([0, -np.sin(np.pi / 3), np.cos(np.pi / 3)])
    at = pixels.shape[0] // 2
    assert pixels[at, 50, 0] == pytest.approx(AMBIENT + (1 - AMBIENT) * max(normal @ LIGHT, 0), rel=1e-12)


def test_what_is_turned_away_is_not_seen() -> None:
    away = seen(square((0, 0, 0))[::-1], square((0, 0, -1), 0.5), colours=np.eye(3)[:2])
    assert away[..., 0].max() == 0
    assert away[..., 1].max() > 0


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> vibeam.Case:
    path = tmp_path_factory.mktemp("shapes") / "case.toml"
    path.write_text(TEXT, encoding="utf-8")
    return vibeam.load(path)


def test_bodies_and_lines_show_the_same_bending(case: vibeam.Case) -> None:
    """Frequencies of both to 3 %, lines of the first mode to 2 % of its largest; surfaces of triangles seen outside."""
    line, body = sheets(case, case.shows["forms"])
    assert (line.fidelity, body.fidelity, line.fault, body.fault) == ("line", "body", "", "")
    assert body["mode_frequency"][0] == pytest.approx(line["mode_frequency"][0], rel=0.03)
    own, other = (each["beam_deflection"][0] / each["beam_deflection"][0][-1] for each in (line, body))
    np.testing.assert_allclose(np.interp(body["beam_position"], line["beam_position"], own), other, atol=0.02)
    assert body["surface_displacement"].shape == (3, len(body["surface_point"]), 3)
    a, b, c = (body["surface_point"][each.astype(int)] for each in body["surface_triangle"].T)
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(0.1 * 0.02 * 0.004, rel=1e-9)


def test_modes_stand_beside_those_of_the_same_shape(case: vibeam.Case, tmp_path: Path) -> None:
    """All panels have one scale; what the beam has no bending of is said; the numbers are kept in the file."""
    result = vibeam.run(case, out=tmp_path / "case.h5")
    drawn = figure(result, case.shows["forms"])
    panels = [axes for axes in drawn.axes if axes.get_title()]
    assert len(panels) == 6
    assert {axes.get_xlim() for axes in panels} == {panels[0].get_xlim()}
    lines = panels[::2]
    frequencies = [axes.get_title().splitlines()[-1] for axes in lines]
    assert frequencies[0].startswith("mode 1, ")
    assert all(axes.images for axes in panels[1::2])
    stored = vibeam.read(tmp_path / "case.h5")
    for one, other in zip(result.shown["forms"], stored.shown["forms"], strict=True):
        assert {name: each.values.tolist() for name, each in one.columns.items()} == {
            name: each.values.tolist() for name, each in other.columns.items()
        }


def test_pairs_are_made_by_shape_not_by_number() -> None:
    """Of a body with bending, torsion, bending the beam has the second mode first; torsion bends nothing."""
    places, x = Column(np.linspace(0, 1, 9), "m", ""), np.linspace(0, 1, 9)
    bent, twice = x**2, x**2 - 1.4 * x**3
    body = {
        "beam_position": places,
        "beam_deflection": Column(np.stack([bent, 1e-3 * x, twice]), "1", ""),
        "surface_displacement": Column(np.ones((3, 4, 3)), "1", ""),
    }
    body["mode_frequency"] = Column(np.arange(3.0), "Hz", "")
    line = {
        "mode_frequency": Column(np.arange(2.0), "Hz", ""),
        "beam_position": places,
        "beam_deflection": Column(np.stack([1.1 * twice + 0.01 * x, -bent]), "1", ""),
    }
    lead, other = Sheet("body", 0.0, body), Sheet("line", 0.0, line)
    assert pairs_of(lead, other) == {0: 1, 2: 0}
    assert pairs_of(lead, lead) == {0: 0, 1: 1, 2: 2}
    nearly = {**body, "beam_deflection": Column(np.stack([bent, bent + 0.1 * x, twice]), "1", "")}
    assert pairs_of(Sheet("body", 0.0, nearly), other) == {0: 1, 2: 0}  # one mode of the beam stands beside one alone


def test_modes_of_an_opposite_body_are_its_own_not_round_off(tmp_path: Path) -> None:
    """Where the second body alone moves the first stands still, and the picture has both."""
    opposite = "[opposite]\nposition = 0.06\nlength = 0.06\nwidth = 0.02\nthickness = 0.002\n"
    path = tmp_path / "case.toml"
    path.write_text(TEXT + opposite, encoding="utf-8")
    case = vibeam.load(path)
    line, body = sheets(case, case.shows["forms"])
    for sheet in (line, body):
        sizes = [np.abs(sheet[f"{name}_deflection"]).max(axis=1) for name in ("beam", "opposite")]
        assert sorted(np.argmax(sizes, axis=0).tolist())[::2] == [0, 1]
    count = np.count_nonzero(body["surface_point"][:, 2] <= 0.002)
    mode = int(np.argmax(np.abs(body["opposite_deflection"]).max(axis=1) > np.abs(body["beam_deflection"]).max(axis=1)))
    pairs = pairs_of(body, line)
    assert abs(line["mode_frequency"][pairs[mode]] / body["mode_frequency"][mode] - 1) < 0.05
    moved = np.linalg.norm(body["surface_displacement"][mode], axis=1)
    assert moved[:count].max() < 1e-6 * moved.max()


def test_a_case_under_a_record_has_shapes_too(tmp_path: Path) -> None:
    record = TEXT.replace("amplitude = 1e-5", 'shape = "half_sine"\nacceleration = 30.0\nduration = 3e-3')
    before, rest = record.split("[sweep]")
    path = tmp_path / "case.toml"
    path.write_text(f"{before}[record]\nduration = 0.01\n[solid]{rest.partition('[solid]')[2]}", encoding="utf-8")
    result = vibeam.run(vibeam.load(path))
    assert figure(result, result.case.shows["forms"]).axes[0].get_title().startswith("line\nmode 1, ")


def test_what_has_neither_beam_nor_body_is_refused() -> None:
    case = vibeam.load("cases/matrices/frame.toml", {"show.a.kind": "shapes"})
    with pytest.raises(vibeam.CaseError, match="whole: no shapes to draw: this case gives matrices"):
        vibeam.run(case)
