"""Texts of a figure in letters that its font has not."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from matplotlib.figure import Figure

from vibeam.figures import lettering

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
