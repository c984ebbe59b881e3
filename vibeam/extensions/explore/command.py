"""``vibeam explore``: the page of a case in which its engine runs."""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from vibeam.cli.arguments import CaseFile, Fidelities, Overrides, load, of_fidelities, out_option, output_path
from vibeam.cli.commands.pages import PAGES
from vibeam.cli.errors import of_case
from vibeam.cli.output import print_json, put_lines
from vibeam.cli.streams import say
from vibeam.cli.verbosity import verbosity
from vibeam.extensions.explore.exploration import exploration


def explore(
    case: CaseFile,
    set_: Overrides = None,
    out: Annotated[str | None, out_option("The page (.html), or the folder for it.")] = None,
    fidelity: Fidelities = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Write the page, and open no browser.")] = False,
) -> None:
    """Fly a case in a page as its sliders move, without a sweep.

    The page holds the exact engine: frequency, drive, gap, restitution and damping are sliders, and a button writes the
    case at them. It is one file and needs no network. A browser opens it where the terminal has a display.

    \b
    Examples:
      vibeam explore mine.toml
      vibeam explore mine.toml --fidelity beam --set stop.gap='0.05 mm' --no-open
    """
    path = output_path(out, f"{case.stem}_explore.html", PAGES, "a page")
    found = of_fidelities(load(case, set_), fidelity)
    made = of_case(case, lambda: exploration(found))
    made.write(path)
    if verbosity().json:
        print_json({"files": [path], "flown": made.flown, "refused": made.refused})
        return
    put_lines([str(path)])
    for name, why in made.refused.items() if not verbosity().quiet else ():
        say(f"{name}: {why}")
    if not no_open and _display():
        import webbrowser

        webbrowser.open(path.resolve().as_uri())


def _display() -> bool:
    """Test whether somebody is there to look at a page: a terminal with a display, and no automation."""
    shown = sys.platform in ("darwin", "win32") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(shown) and sys.stdout.isatty() and not os.environ.get("CI")
