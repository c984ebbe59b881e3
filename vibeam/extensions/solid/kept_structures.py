"""Reduced structures of solids kept on disk by their content, so that a second run builds none of the solid.

A file is named by the digest of the scene, the reduction, the code that makes them and the libraries below it, and is
sealed as what has that name: one that is damaged, of another name or of another form is made anew. They stand in
``VIBEAM_CACHE``, else in the user's folder for caches; an empty ``VIBEAM_CACHE`` keeps none. Of more than ``MOST`` the
oldest go.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar
from zipfile import BadZipFile

import numpy as np

import vibeam.extensions.solid.elasticity
import vibeam.extensions.solid.meshes
import vibeam_models
import vibeam_reductions
from vibeam.exchange.whole_files import is_link, read_sealed, write_sealed
from vibeam_models.structure import FIELDS, Structure

FORM = "kept structure 2"  # of the files, in the seal of each
MISFITS = (OSError, EOFError, LookupError, TypeError, ValueError, AttributeError, BadZipFile)  # of content of any form
NAME = "[0-9a-f]" * 40  # of a file, without its ending: no other is deleted
MOST = 500  # files, of some kilobytes each
LIBRARIES = ("numpy", "scipy", "scikit-fem", "meshio")
MAKERS = (vibeam_models, vibeam_reductions, vibeam.extensions.solid.elasticity, vibeam.extensions.solid.meshes)
UNKNOWN = (" at 0x", "...")  # in a repr that does not say all of a value
ROWS = FIELDS[:-1]
Value = TypeVar("Value")


def folder() -> Path | None:
    """Folder of the files; None where none are kept."""
    said = os.environ.get("VIBEAM_CACHE")
    if said is not None:
        return Path(said) / "structures" if said else None
    own = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(own) if own else Path.home() / ".cache") / "vibeam" / "structures"


def place_of(*content: Any, ending: str = "npz") -> Path | None:
    """File of what is made from ``content``; None where that cannot be told from its repr, or the folder is a link."""
    text, home = repr(content), folder()
    if home is None or is_link(home) or any(each in text for each in UNKNOWN):
        return None
    return home / f"{sha256(f'{_code()} {text}'.encode()).hexdigest()[:40]}.{ending}"


def kept(place: Path | None) -> tuple[Structure, float] | None:
    """Reduced structure and static deflection of a file; None where there is none that fits."""
    return _fitting(place, _read)


def keep(place: Path | None, structure: Structure, static: float) -> None:
    """Keep a reduced structure; nothing where the disk does not take it."""
    _write(place, _written(structure, static))


def noted(form: Callable[[Any], Value], *content: Any) -> Value | None:
    """Value noted of ``content``, which ``form`` reads from what JSON has; None where there is none that fits."""
    return _fitting(place_of(*content, ending="json"), lambda found: form(json.loads(found)))


def note(value: Any, *content: Any) -> None:
    """Note a value of ``content``; nothing where the disk does not take it."""
    _write(place_of(*content, ending="json"), json.dumps(value).encode())


def _fitting(place: Path | None, read: Callable[[bytes], Value]) -> Value | None:
    with suppress(*MISFITS):
        content = None if place is None else read_sealed(place, _seal_of(place))
        return None if content is None else read(content)
    return None


def _seal_of(place: Path) -> str:
    """Form and name of a file, so that no other passes for it."""
    return f"{FORM} {place.name}\n"


def _write(place: Path | None, content: bytes) -> None:
    if place is None:
        return
    with suppress(OSError):
        place.parent.mkdir(parents=True, exist_ok=True)
        write_sealed(place, content, _seal_of(place))
        files = place.parent.glob(f"{NAME}{place.suffix}")
        for old in sorted(files, key=lambda each: each.lstat().st_mtime)[:-MOST]:
            old.unlink(missing_ok=True)


def _written(structure: Structure, static: float) -> bytes:
    names = {"outputs": list(structure.outputs), "units": dict(structure.units), "static": static}
    said = json.dumps(names | {"flexibility": structure.contact_flexibility})
    rows: dict[str, Any] = {f"row {name}": getattr(structure, name) for name in ROWS}
    file = BytesIO()
    np.savez(file, names=np.array(said), outputs=[*structure.outputs.values()], attached=structure.attached, **rows)
    return file.getvalue()


def _read(content: bytes) -> tuple[Structure, float]:
    with np.load(BytesIO(content), allow_pickle=False) as file:
        names, attached = json.loads(str(file["names"])), tuple(file["attached"])
        outputs = dict(zip(names["outputs"], file["outputs"], strict=True))
        rows = {name: file[f"row {name}"] for name in ROWS}
    made = Structure(
        **rows, outputs=outputs, units=names["units"], attached=attached, contact_flexibility=names["flexibility"]
    )
    return made, names["static"]


@cache
def _code() -> str:
    """Digest of the sources that read a mesh, make and reduce a structure, and the versions of libraries below them."""
    found = sha256(" ".join(map(version, LIBRARIES)).encode())
    for folder in (path for each in MAKERS for path in each.__path__):
        for file in sorted(Path(folder).rglob("*.py")):
            found.update(file.read_bytes())
    return found.hexdigest()
