"""Several models in one panel: each is seen, whichever is larger, at any scale; titles and keys of such figures."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import vibeam
from tests.vibeam.figures.test_figures import responses
from vibeam.figures.page import composed
from vibeam.figures.response_curve import frc
from vibeam.figures.style import COLOURS
from vibeam.report.figures import figure
from vibeam.report.record_figure import record_figure
from vibeam.runs.result import Result

RIG: dict[str, Any] = {
    "title": "Relay: an open contact in a shock test",
    "beam": {
        "length": "180 mm",
        "width": "20 mm",
        "thickness": "3 mm",
        "youngs_modulus": "210 GPa",
        "density": "7850 kg/m^3",
        "damping_ratio": 0.017,
    },
    "mass": {"mass": "20 g", "position": "132 mm"},
    "stop": {"gap": "0.2 mm", "restitution": 0.7},
    "sensor": {"position": "100 mm"},
    "fidelity": {
        "one": {"reduction": "static_mode"},
        "two": {"reduction": "modal", "modes": 2},
        "three": {"reduction": "modal", "modes": 3},
    },
}
NOISE = {"drive": {"density": "0.002 g^2/Hz", "band": ["5 Hz", "400 Hz"], "seed": 3}, "record": {"duration": "0.5 s"}}
PULSE = {
    "drive": {"shape": "half_sine", "acceleration": "2 g", "duration": "11 ms"},
    "record": {"duration": "0.1 s"},
}
DEVICE = {"kind": "shock_spectrum", "response_of": "device", "output": "contact"}
EQUIPMENT = {"kind": "shock_spectrum", "natural": ["20 Hz", "90 Hz"]}
DENSITY = {"kind": "response_spectrum", "up_to": "200 Hz", "resolution": "5 Hz"}
DOTS = 150  # an inch
PURE = 0.1  # largest difference of a channel from a model's colour


def run(*changes: dict[str, Any]) -> Any:
    tables = dict(RIG)
    for each in changes:
        tables |= each
    return vibeam.run(vibeam.Case.of(tables))


def seen(made: Figure, panel: int) -> list[int]:
    """Number of dots in the colours of the first models, within the frame of a panel."""
    made.set_dpi(DOTS)
    canvas = FigureCanvasAgg(made)
    canvas.draw()
    dots = np.asarray(canvas.buffer_rgba())[..., :3] / 255
    box = made.axes[panel].get_window_extent()
    left, low, right, high = (round(each) for each in (box.x0, box.y0, box.x1, box.y1))
    inside = dots[dots.shape[0] - high : dots.shape[0] - low, left:right]
    return [int(np.all(np.abs(inside - to_rgb(each)) < PURE, axis=-1).sum()) for each in COLOURS[:3]]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"stop": {"gap": "1 m", "restitution": 0.7}},  # no impact: the motions of one mode and of more are alike
        {"fidelity": dict(reversed(RIG["fidelity"].items()))},  # the smaller motion in front, and behind
        {"drive": NOISE["drive"] | {"density": "2e-9 g^2/Hz"}, "stop": {"gap": "0.2 um", "restitution": 0.7}},
    ],
    ids=["stop", "nothing touches", "another order", "micrometres"],
)
def test_each_model_is_seen_in_the_histories(changes: dict[str, Any]) -> None:
    """In the whole record too, where an area would cover the ones behind it."""
    result = run(NOISE, changes)
    made = composed(lambda: record_figure(result))
    signals = [at for at, axes in enumerate(made.axes) if len(axes.collections) >= 3 and not axes.texts]
    assert signals
    for panel in signals:
        first, second, last = seen(made, panel)
        assert min(first, last) > 50, made.axes[panel].get_title(loc="left")
        assert second > 50 or "1 m" in str(changes)  # there two modes move as three do


def test_each_model_is_seen_in_a_shock_spectrum() -> None:
    """Where the curves lie on one another, each behind as a rim of the one before it."""
    result = run(PULSE, {"show": {"device": DEVICE}})
    made = composed(lambda: figure(result, result.case.shows["device"]))
    assert min(seen(made, 1)) > 50  # velocities of the hardest impacts, which hardly differ


@pytest.mark.parametrize(("record", "shown"), [(PULSE, DEVICE), (PULSE, EQUIPMENT), (NOISE, DENSITY)])
def test_title_and_caption_have_a_line_each(record: dict[str, Any], shown: dict[str, Any]) -> None:
    result = run(record, {"show": {"it": shown}})
    made = composed(lambda: figure(result, result.case.shows["it"]))
    assert len(made.get_suptitle().splitlines()) == 2


def test_what_another_restitution_would_give_stands_below_the_axes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The title has the case's name and what is prescribed, the key's head the rest; a result without it has none."""
    held = "R₁ held instead: f0 -3.2 % at peak (here +4.34 %)"
    monkeypatch.setattr(Result, "held", f"R = 0.5 at the contact\n{held}")
    made = frc(responses(1, 2))
    assert len(made.get_suptitle().splitlines()) == 2
    assert made.legends[0].get_title().get_text() == held
    monkeypatch.setattr(Result, "held", "")
    made = frc(responses(1, 2))
    assert made.get_suptitle().splitlines()[1] == "frequency response"
    assert not made.legends[0].get_title().get_text()
