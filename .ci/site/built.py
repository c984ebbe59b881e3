"""Check of the built site: nothing comes from a network, every public name is there, pages say what forges show."""

from __future__ import annotations

import inspect
import re
import sys
from html.parser import HTMLParser
from importlib import import_module
from pathlib import Path

import reference
from manual import ROOT, Manual
from markdown_it import MarkdownIt

TAG = re.compile(
    r"<(?:script|img|iframe|source)\b[^>]*?\bsrc=\"?(?:https?:)?//[^\s\">]+"
    r"|<link\b[^>]*?rel=\"?(?:stylesheet|preconnect|icon)[^>]*?href=\"?(?:https?:)?//[^\s\">]+"
)
STYLE = re.compile(r"(?:@import|url\()\s*[\"']?(?:https?:)?//[^\s\"')]+")
KEPT = {"li", "tr", "th", "td", "pre", "h1", "h2", "h3", "h4", "img", "strong", "em", "a", "p", "blockquote"}


class Shape(HTMLParser):
    """Words of a page, and the tags that matter among them, in their order; a heading's permalink is the site's own."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.text: list[str] = []
        self.inside_permalink = False
        self.feed(html)

    @property
    def found(self) -> list[str]:
        """Words and tags."""
        return "".join(self.text).split()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep a tag that matters."""
        self.inside_permalink = tag == "a" and ("class", "headerlink") in attrs
        if tag in KEPT and not self.inside_permalink:
            self.text.append(f" <{tag}> ")

    def handle_endtag(self, tag: str) -> None:
        """Leave the permalink; part what a kept tag parts."""
        self.inside_permalink = self.inside_permalink and tag != "a"
        if tag in KEPT:
            self.text.append(" ")

    def handle_data(self, data: str) -> None:
        """Keep the words."""
        if not self.inside_permalink:
            self.text.append(data)


def read_elsewhere(site: Path) -> list[str]:
    """What pages and style sheets load from other places."""
    kinds = ((path, {".html": TAG, ".css": STYLE}.get(path.suffix)) for path in sorted(site.rglob("*")))
    texts = ((path, kind, path.read_text(encoding="utf-8")) for path, kind in kinds if kind)
    return [f"{path.relative_to(site)}: {found[0]}" for path, kind, text in texts for found in kind.finditer(text)]


def public_names() -> list[str]:
    """Names that the reference must have: those of vibeam, and all that the two other packages define."""
    names = list(reference.homes())
    for package, folder in reference.PACKAGES.items():
        for home in reference.modules_of(package, ROOT / folder):
            members = vars(import_module(home)).items()
            own = [name for name, what in members if _defined(what, home) and not name.startswith("_")]
            names += [f"{home}.{name}" for name in own]
    return names


def _defined(what: object, home: str) -> bool:
    plain = inspect.unwrap(what) if callable(what) else what
    return (inspect.isclass(plain) or inspect.isfunction(plain)) and plain.__module__ == home


def names_left_out(site: Path) -> list[str]:
    """Public names without an entry in the reference."""
    pages = "".join(path.read_text(encoding="utf-8") for path in sorted((site / "reference").glob("*.html")))
    anchors = set(re.findall(r'id="?([\w.]+)', pages))
    return [name for name in public_names() if name not in anchors]


def other_shapes(site: Path, manual: Manual) -> list[str]:
    """Pages whose words or marks are not those that CommonMark reads in their files, from the first difference on."""
    forge, found = MarkdownIt("commonmark").enable(["table", "strikethrough"]), list[str]()
    for place, text in manual.texts().items():
        made = site / re.sub(r"(README)?\.md$", lambda end: "index.html" if end[1] else ".html", place)
        article = re.search(r"<article[^>]*>(.*?)</article>", made.read_text(encoding="utf-8"), re.DOTALL)
        assert article is not None
        ours, theirs = Shape(article[1]).found, Shape(forge.render(text)).found
        if ours != theirs:
            equal = [mine == other for mine, other in zip(ours, theirs, strict=False)]
            at = equal.index(False) if False in equal else len(equal)
            found.append(" | ".join([place, *(" ".join(words[max(0, at - 6) : at + 6]) for words in (ours, theirs))]))
    return found


def main(site: Path, gallery: Path | None = None) -> int:
    """Say every fault of the site; 1 where there is one."""
    faults = [f"read from elsewhere: {each}" for each in read_elsewhere(site)]
    faults += [f"not in the reference: {each}" for each in names_left_out(site)]
    faults += [f"not as the forge shows it: {each}" for each in other_shapes(site, Manual(gallery=gallery))]
    print("\n".join(faults) or f"{len(list(site.rglob('*.html')))} pages, {len(public_names())} public names")
    return bool(faults)


if __name__ == "__main__":
    raise SystemExit(main(*map(Path, sys.argv[1:])))
