"""Texts of a figure in letters that its font has not; tick labels in plain text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from vibeam.figures import lettering
from vibeam.figures.lettering import power_of_ten, set_plain_labels

LETTERS = frozenset(map(ord, "挡块"))


@pytest.fixture
def titled() -> Iterator[Figure]:
    figure = Figure()
    figure.suptitle("挡块 Δ")
    figure.subplots().set_title("η ≥ 1,\nβ")
    lettering._others.cache_clear()
    yield figure
    lettering._others.cache_clear()


def test_letters_that_no_font_has_are_escaped(titled: Figure, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lettering, "fontManager", SimpleNamespace(ttflist=[]))
    lettering.set_fonts(titled)
    assert [text.get_text() for text in titled.texts] == [r"\u6321\u5757 Δ"]
    assert titled.axes[0].get_title() == "η ≥ 1,\nβ"
    titled.draw_without_rendering()  # no warning of a missing glyph


def test_a_font_that_has_them_is_taken(titled: Figure, monkeypatch: pytest.MonkeyPatch) -> None:
    own, found = lettering._letters_of, [each for each in lettering.fontManager.ttflist if each.name == "cmr10"]
    monkeypatch.setattr(
        lettering, "_letters_of", lambda file: own(file) | (LETTERS if "cmr10" in file else frozenset())
    )
    monkeypatch.setattr(lettering, "fontManager", SimpleNamespace(ttflist=found))
    lettering.set_fonts(titled)
    (title,) = titled.texts
    assert title.get_text() == "挡块 Δ"
    assert list(title.get_fontfamily())[1:] == ["cmr10"]


DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def drawn(low: float, high: float, scale: str) -> Figure:
    figure = Figure()
    axes = figure.subplots()
    axes.plot([0.0, 1.0], [low, high])
    axes.set_yscale(scale)
    return figure


def labels(figure: Figure) -> list[tuple[float, str]]:
    figure.draw_without_rendering()
    axis = figure.axes[0].yaxis
    ticks = axis.get_major_ticks() + axis.get_minor_ticks()
    return [(float(tick.get_loc()), tick.label1.get_text()) for tick in ticks if tick.label1.get_text()]


@pytest.mark.parametrize(("low", "high"), [(1e-9, 1.0), (2e-4, 7e-4), (0.5, 2e3)])
def test_labels_of_a_logarithmic_axis_have_their_ticks_value(low: float, high: float) -> None:
    own, plain = drawn(low, high, "log"), drawn(low, high, "log")
    set_plain_labels(plain)
    found = labels(plain)
    assert [at for at, _ in found] == [at for at, _ in labels(own)]
    for at, text in found:
        share, power = re.fullmatch(r"(?:([\d.]+)×)?10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", text).groups()
        assert float(share or 1) * 10.0 ** int(power.translate(DIGITS)) == pytest.approx(at, rel=1e-9)


def test_small_numbers_share_a_power_of_ten() -> None:
    figure = drawn(0.0, 3e-6, "linear")
    set_plain_labels(figure)
    values = labels(figure)
    assert figure.axes[0].yaxis.get_offset_text().get_text() == f"×{power_of_ten(-6)}"
    np.testing.assert_allclose(
        [float(text.replace("−", "-")) * 1e-6 for _, text in values], [at for at, _ in values], atol=1e-15
    )


def test_numbers_that_differ_little_share_an_offset() -> None:
    figure = drawn(1234567.0, 1234567.0003, "linear")
    set_plain_labels(figure)
    values = labels(figure)
    assert "+1.234567" in figure.axes[0].yaxis.get_offset_text().get_text().replace("e6", "e+06")
    assert "$" not in "".join(text for _, text in values)
