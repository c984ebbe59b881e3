"""Reference pages: every public name of the three packages, every key of the case file, every command."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from manual import ROOT

import vibeam

SPACES = ("observe", "periodic", "studies")  # names of vibeam that are namespaces themselves
PACKAGES = {"vibeam_models": "models/vibeam_models", "vibeam_reductions": "reductions/vibeam_reductions"}


@cache
def pages() -> dict[str, str]:
    """Generated pages by their places, in their order."""
    rooms = by_room()
    made = {f"reference/{room}.md": page_of(room, names) for room, names in rooms.items() if room not in PACKAGES}
    for package, folder in PACKAGES.items():
        listed = "\n".join(f"- [](){{#{name}}}[`{name}`][{path}]" for name, path in rooms[package].items())
        modules = "\n".join(f"::: {name}\n" for name in modules_of(package, ROOT / folder))
        made[f"reference/{package}.md"] = f"# {package}\n\nNames of `vibeam` among these:\n\n{listed}\n\n{modules}"
    return made


def homes() -> dict[str, str]:
    """The full path of every public name: ``vibeam.simulate`` → ``vibeam.flight.trajectory.simulate``."""
    spaces = {"vibeam": vars(vibeam)["_homes"], "vibeam.observe": vars(vibeam.observe)["_homes"]}
    own = ((space, name, home) for space, homes_in in spaces.items() for name, home in homes_in.items())
    return {f"{space}.{name}": f"{home}.{name}" for space, name, home in own if name not in SPACES}


def by_room() -> dict[str, dict[str, str]]:
    """Public names and their paths by the room, or the other package, that they live in; both in alphabetical order."""
    rooms: dict[str, dict[str, str]] = {}
    for name, path in sorted(homes().items(), key=lambda entry: entry[0].lower()):
        package, room = path.split(".")[:2]
        rooms.setdefault(package if package in PACKAGES else room, {})[name] = path
    return dict(sorted(rooms.items()))


def page_of(room: str, names: dict[str, str]) -> str:
    """Page of the public names of a room, each with its signature and its docstring."""
    entries = (
        f"[](){{#{name}}}\n\n::: {path}\n    options:\n      heading: {name}\n      toc_label: {name}\n"
        for name, path in names.items()
    )
    return f"# vibeam: {room}\n\n" + "\n".join(entries)


def modules_of(package: str, folder: Path) -> list[str]:
    """Modules of a package by their dotted names, without those whose names begin with an underscore."""
    found = sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.py"))
    return [f"{package}.{name.replace('/', '.')}" for name in found if not name.rpartition("/")[2].startswith("_")]
