"""The picture of a fit: key, bands and residuals."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.offsetbox import DrawingArea

import vibeam
from tests.vibeam.cli.test_fit_command import CASES
from vibeam.report.fit import fit_figure

SOFT, HARD = "softer impact", "harder impact"


def study(*points: tuple[float, str, float], size: float = 1e-4) -> Any:
    """A fit with points (Hz, motion, residual in σ) of such a size, m; its branches rise by 1 % a hertz."""

    def branch(name: str, motion: str, at: Any) -> tuple[Any, Any]:
        best = size * (1 + 0.01 * (at - 15)) * (1.1 if motion == HARD else 1.0)
        return best, 0.02 * best

    def point(frequency: float, motion: str, residual: float) -> Any:
        best = float(branch("", motion, frequency)[0])
        return SimpleNamespace(
            reference="lab", frequency=frequency, motion=motion, residual=residual, uncertainty=0.01 * best,
            measured=best * (1 + 0.01 * residual), left_out=False, actual=True,
        )  # fmt: skip

    case = vibeam.load(CASES / "dtu_neutral.toml")
    case = SimpleNamespace(
        title="A fit", figure=case.figure, scene=case.scene, sweep=case.sweep,
        references={"lab": SimpleNamespace(quantity="amplitude")},
    )  # fmt: skip
    return SimpleNamespace(points=[point(*each) for each in points], case=case, branch=branch)


@pytest.mark.parametrize(
    "points",
    [
        [(14.0, HARD, 2.7), (15.0, HARD, 0.1), (16.0, HARD, -3.0)],
        [(14.0, HARD, 0.5), (15.0, HARD, -0.5), (15.5, SOFT, 1.0), (16.0, SOFT, 0.0)],
        [(15.0, SOFT, 6.0)],
        [(14.0, SOFT, -40.0), (15.0, SOFT, 1.0)],
    ],
    ids=["beyond the band", "two branches", "one point", "far off"],
)
@pytest.mark.parametrize("size", [1e-4, 2e-7])
def test_no_residual_lies_on_the_frame(points: list[Any], size: float) -> None:
    """Each stands off by more than a mark: by a twelfth of the panel, whatever its size."""
    made = fit_figure(study(*points, size=size))
    FigureCanvasAgg(made).draw()
    (marks,) = (line for line in made.axes[1].lines if line.get_marker() == "o")
    shares = made.axes[1].transAxes.inverted().transform(made.axes[1].transData.transform(marks.get_xydata()))[:, 1]
    assert min(shares) > 1 / 12
    assert max(shares) < 11 / 12


def test_each_branch_has_line_and_band_of_one_colour_in_the_key() -> None:
    """Under one name: a band without a line belongs to none of two."""
    made = fit_figure(study((14.0, HARD, 0.5), (15.0, HARD, -0.5), (15.5, SOFT, 1.0), (16.0, SOFT, 0.0)))
    (key,) = made.legends
    names = [each.get_text() for each in key.get_texts()]
    assert names == [f"fitted, {HARD}; 95 % band", f"fitted, {SOFT}; 95 % band", "measured, ± 2 σ"]
    entries = [each.get_children() for each in key.findobj(DrawingArea)][:2]
    colours = [(to_rgb(band.get_facecolor()), to_rgb(line.get_color())) for band, line in entries]
    assert all(band == line for band, line in colours)
    assert len(set(colours)) == 2
