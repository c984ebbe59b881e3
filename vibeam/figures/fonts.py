"""Fonts of a figure: letters that the page's font lacks are taken from another installed one, or escaped."""

from __future__ import annotations

from functools import lru_cache

from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, fontManager, get_font
from matplotlib.text import Text

NO_FONT = "Last Resort"  # has a box for every letter


def set_fonts(figure: Figure) -> None:
    """Make every text of a figure legible; letters that no installed font has are written as Python escapes them."""
    own = _letters(findfont(FontProperties()))
    for text in figure.findobj(Text):
        lacking = frozenset(map(ord, text.get_text())) - own - {ord("\n")}
        if lacking:
            families, left = _others(lacking)
            text.set_fontfamily([*text.get_fontfamily(), *families])
            text.set_text("".join(_escaped(each) if ord(each) in left else each for each in text.get_text()))


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape").decode()


@lru_cache(maxsize=64)
def _others(lacking: frozenset[int]) -> tuple[tuple[str, ...], frozenset[int]]:
    """Installed families that have the letters, one after the other, and the letters that none has."""
    families, left = list[str](), lacking
    for entry in sorted(fontManager.ttflist, key=lambda each: (each.style != "normal", each.weight != 400, each.name)):
        if not left:
            break
        if not entry.name.startswith(NO_FONT) and left & (letters := _letters(entry.fname)):
            families, left = [*families, entry.name], left - letters
    return tuple(families), left


@lru_cache(maxsize=256)
def _letters(file: str) -> frozenset[int]:
    """Code points of a font file; none of one that cannot be read, or is made for no letters at all."""
    try:
        return frozenset(get_font(file).get_charmap())
    except (OSError, RuntimeError):
        return frozenset()
