"""Pages of the manual: the repository's own Markdown files, the files that they link to, links between all of them."""

from __future__ import annotations

import os
import posixpath
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
FRONT = "README.md"
SOURCES = "source"  # folder of the files that pages link to
GALLERY = "cases/gallery"  # its pages are made by cases/gallery/pages.py
REPOSITORY = "https://github.com/vibeam/vibeam"

FENCED = re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"(\]\(<?)([^()\s>]+)")
ABSOLUTE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)
IMAGES = (".png", ".svg", ".jpg")
LANGUAGES = {".py": "python", ".pyi": "python", ".toml": "toml", ".json": "json", ".js": "javascript", ".sh": "bash"}
SKIPPED = {"venv", "build", "dist", "node_modules"}


def markdown_files(root: Path = ROOT) -> list[str]:
    """Markdown files of the repository by their paths in it; in an unpacked archive those of its folders."""
    if (root / ".git").exists() and shutil.which("git"):
        asked = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"]
        listed = subprocess.run(asked, cwd=root, capture_output=True, text=True, check=True).stdout.splitlines()
        return sorted(name for name in listed if (root / name).exists())
    found = []
    for folder, folders, files in os.walk(root):
        folders[:] = [name for name in folders if name[0] != "." and name not in SKIPPED]
        found += [(Path(folder) / name).relative_to(root).as_posix() for name in files if name.endswith(".md")]
    return sorted(found)


def slug(heading: str) -> str:
    """Anchor of a heading, as forges make it."""
    bare = re.sub(r"[*`]|\[([^]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", bare).replace(" ", "-")


@dataclass(frozen=True)
class Section:
    """Part of the front page that is a page of its own: its file, its text, the anchors in it."""

    file: str
    text: str

    @property
    def anchors(self) -> set[str]:
        """Anchors of all headings."""
        return {slug(line.lstrip("#")) for line in FENCED.sub("", self.text).splitlines() if line.startswith("#")}


def sections(text: str) -> list[Section]:
    """The front page, cut before every heading of the second level, which becomes the title; all others follow."""
    blocks = [match.span() for match in FENCED.finditer(text)]
    found = [match.start() for match in re.finditer(r"^## ", text, re.MULTILINE)]
    cuts = [cut for cut in found if not any(first < cut < last for first, last in blocks)]
    parts = [text[first:last] for first, last in zip([0, *cuts], [*cuts, len(text)], strict=True)]
    made = [Section(FRONT, parts[0])]
    for part in parts[1:]:
        raised = outside_of_code(part, lambda prose: re.sub(r"^##", "#", prose, flags=re.MULTILINE))
        made.append(Section(f"{slug(part.splitlines()[0].lstrip('#'))}.md", raised))
    return made


def outside_of_code(text: str, change: Callable[[str], str]) -> str:
    """The text with ``change`` applied to what stands between its blocks of code."""
    parts, end = [], 0
    for block in FENCED.finditer(text):
        parts += [change(text[end : block.start()]), block.group()]
        end = block.end()
    return "".join([*parts, change(text[end:])])


class Manual:
    """All files of the site by their places in it, and where a link of a page leads."""

    def __init__(self, root: Path = ROOT, gallery: Path | None = None) -> None:
        self.root = root
        self.front = sections((root / FRONT).read_text(encoding="utf-8"))
        self.files = [name for name in markdown_files(root) if name != FRONT]
        made = sorted(gallery.rglob("*")) if gallery else []
        self.gallery = {
            f"{GALLERY}/{path.relative_to(str(gallery)).as_posix()}": path for path in made if path.is_file()
        }
        self.linked: set[str] = set()
        for place, text in self.texts().items():
            self.with_places(place, text)  # finds what is linked

    def texts(self) -> dict[str, str]:
        """Markdown of every page by its place, links as they are in the repository."""
        own = {name: (self.root / name).read_text(encoding="utf-8") for name in self.files}
        made = {
            place: path.read_text(encoding="utf-8") for place, path in self.gallery.items() if place.endswith(".md")
        }
        return {section.file: section.text for section in self.front} | own | made

    def place_of(self, page: str, target: str) -> str:
        """Place in the site that a link of ``page`` leads to, relative to it; what is elsewhere stays as it is."""
        folder = posixpath.dirname(page)
        if target.startswith(f"{REPOSITORY}/blob/main/"):
            target = posixpath.relpath(target.removeprefix(f"{REPOSITORY}/blob/main/"), folder or ".")
        name, hash_, anchor = target.partition("#")
        if not name and page in {section.file for section in self.front}:
            name = FRONT
        if not name or ABSOLUTE.match(target):
            return target
        path = posixpath.normpath(posixpath.join(folder, unquote(name)))
        return posixpath.relpath(self._place(path, anchor), folder or ".") + hash_ + anchor

    def _place(self, path: str, anchor: str) -> str:
        if path == FRONT:
            return next((section.file for section in self.front if anchor in section.anchors), FRONT)
        made = f"{path.removesuffix('.py').removesuffix('.ipynb')}.md"
        if path in self.gallery or made in self.gallery:
            return path if path in self.gallery else made
        if (self.root / path).is_dir():
            path = f"{path}/README.md"
        if path.endswith(".md"):
            return path
        if (self.root / path).is_file():
            self.linked.add(path)
        return path if path.endswith(IMAGES) else f"{SOURCES}/{path}.md"

    def with_places(self, page: str, markdown: str) -> str:
        """The page's Markdown with its links as the site has them."""
        return outside_of_code(
            markdown, lambda prose: LINK.sub(lambda found: found[1] + self.place_of(page, found[2]), prose)
        )

    def source_page(self, name: str) -> str:
        """Page of a linked file: its text as it stands, kept out of the search."""
        text = (self.root / name).read_text(encoding="utf-8").rstrip("\n")
        fence = "`" * max(4, *(len(run) + 1 for run in [*re.findall(r"`+", text), ""]))
        language = LANGUAGES.get(Path(name).suffix, "text")
        head = "---\nsearch:\n  exclude: true\ntemplate: source.html\n---\n"
        return f"{head}# {name}\n\n{fence}{language}\n{text}\n{fence}\n"
