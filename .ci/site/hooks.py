"""Hooks of the site's build: pages that lie where they are in the repository, generated pages, links between them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import reference
from manual import IMAGES, SOURCES, Manual
from mkdocs.structure.files import File

ASSETS = os.environ.get("VIBEAM_SITE_ASSETS")  # folder of scripts from npm
MADE = os.environ.get("VIBEAM_SITE_GALLERY")  # folder of the gallery's pages, where it was made
manual = Manual(gallery=Path(MADE) if MADE else None)


def on_config(config: Any) -> Any:
    """Add the gallery's pages and those of the reference to the navigation."""
    for entry in config.nav:
        name, pages = next(iter(entry.items()))
        if name == "Questions":
            pages += [place for place in manual.gallery if place.endswith(".md")]
        if name == "Reference":
            pages += list(reference.pages())
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add every page, the files that pages link to, and scripts."""
    for place, text in manual.texts().items():
        if place not in manual.gallery:
            files.append(File.generated(config, place, content=text))
    for place, path in manual.gallery.items():
        files.append(File.generated(config, place, abs_src_path=str(path)))
    for name in sorted(manual.linked):
        if name.endswith(IMAGES):
            files.append(File.generated(config, name, abs_src_path=str(manual.root / name)))
        else:
            files.append(File.generated(config, f"{SOURCES}/{name}.md", content=manual.source_page(name)))
    for place, text in reference.pages().items():
        files.append(File.generated(config, place, content=text))
    for path in sorted(Path(ASSETS).iterdir()) if ASSETS else []:
        files.append(File.generated(config, f"assets/{path.name}", abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Lead the links of a page to the places of the site."""
    place = page.file.src_uri
    if place.startswith((f"{SOURCES}/", "reference/")):
        return markdown
    return manual.with_places(place, markdown)


def on_post_page(output: str, page: Any, config: Any) -> str:
    """Load the script of diagrams where there is one, from the site itself."""
    if 'class="mermaid"' not in output:
        return output
    up = "../" * page.file.dest_uri.count("/")
    return output.replace("</head>", f'<script src="{up}assets/mermaid.tiny.js"></script></head>', 1)
