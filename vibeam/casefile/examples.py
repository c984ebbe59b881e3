"""Examples: cases that come with vibeam, each a rig of another kind, with the files that it names.

They are the files below ``cases/`` of a checkout; a wheel has them beside its modules (``force-include`` of
``pyproject.toml``), so that there is one of each.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

PLACES = {
    "dtu": "dtu_neutral.toml",
    "relay": "rigs/relay.toml",
    "mems-switch": "rigs/mems_switch.toml",
    "afm-tip": "rigs/afm_tip.toml",
    "tube": "rigs/tube.toml",
    "harvester": "rigs/harvester.toml",
    "pinned-bar": "rigs/pinned_bar.toml",
    "elastic-stop": "rigs/elastic_stop.toml",
    "two-beams": "stuttgart/two_beams.toml",
    "absorber": "rigs/absorber.toml",
    "ball-in-cavity": "rigs/ball_in_cavity.toml",
    "frame": "matrices/frame.toml",
    "modes": "matrices/dtu_modes.toml",
    "solid": "solid/dtu.toml",
    "shock": "inputs/half_sine.toml",
    "plucked": "inputs/plucked.toml",
    "truck": "inputs/truck.toml",
    "tube-noise": "inputs/tube_noise.toml",
}  # example: its case file, from the folder of cases


@cache
def folder() -> Path:
    """The folder of cases: of the installed package, or of the checkout that it is imported from."""
    package = Path(__file__).parents[1]
    return next(each for each in (package / "cases", package.parent / "cases") if each.is_dir())


@cache
def tables(name: str) -> dict[str, Any]:
    """The tables of an example as its file has them."""
    return tomllib.loads(_text(folder() / PLACES[name]))


def meanings() -> dict[str, str]:
    """Titles of the examples, by name."""
    return {name: tables(name)["title"] for name in PLACES}


def texts(name: str, brief: bool = False) -> tuple[str, dict[str, str]]:
    """An example's text and, by name, those of the files that stand beside it once it is written.

    ``brief``: what it computes alone, with one comment on the choice that its answer hangs on.
    """
    case = folder() / PLACES[name]
    lines = _text(case).splitlines(keepends=True)
    text = "".join(line for line in lines if not line.startswith("# numbers:"))  # of the checkout's pages
    text = _brief(text) if brief else text
    files = [file for file in files_of(name, tables(name)) if f'"{file}"' in text]
    for file in files:
        text = text.replace(f'"{file}"', f'"{Path(file).name}"')
    return text, {Path(file).name: _text(case.parent / file) for file in files}


ASIDE = re.compile(r"(?m)^(#.*\n|\n|\[(reference|expect|measured|show)\..*\n([^\[].*\n|\n)*)|  # .*$")
WHOSE = '# whose R: "first mode", as a sensor shows it of slow motion (few modes do); "contact", the impact\'s own'
LAW = "# a stop that yields, in place of a rigid one with R: it moves no mode much faster than its contact lasts"


def _brief(text: str) -> str:
    """The lines of an example that decide what it computes, whose R it is among them."""
    text = ASIDE.sub("", text)
    if "\nlaw = " in text:
        return text.replace("\nlaw = ", f"\n{LAW}\nlaw = ")
    if "\nrestitution_of" not in text:
        text = re.sub(r"\nrestitution = .*", r'\g<0>\nrestitution_of = "contact"', text)
    return text.replace("\nrestitution_of", f"\n{WHOSE}\nrestitution_of")


def files_of(name: str, part: Any) -> Iterator[str]:
    """Names of files, as written, in a part of an example."""
    if isinstance(part, str):
        if "." in part and (folder() / PLACES[name]).parent.joinpath(part).is_file():
            yield part
    elif isinstance(part, dict | list):
        for inner in part.values() if isinstance(part, dict) else part:
            yield from files_of(name, inner)


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8")
