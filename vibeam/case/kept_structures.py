"""Reduced structures of solids kept on disk by their content, so that a second run builds none of the solid.

A file is named by the digest of the scene, the reduction, the code that makes them and the libraries below it, and is
sealed: a damaged one is made anew. They stand in ``VIBEAM_CACHE``, else in the user's folder for caches; an empty
``VIBEAM_CACHE`` keeps none. Of more than ``MOST`` the oldest go.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

import vibeam.exchange.meshes
import vibeam_models
import vibeam_reductions
from vibeam.exchange.whole_files import read_sealed, write_sealed
from vibeam_models.structure import FIELDS, Structure

OF, NOTE = "reduced structure 1", "note 1"  # what a file's seal says it is of
MOST = 500  # files, of some kilobytes each
LIBRARIES = ("numpy", "scipy", "scikit-fem", "meshio")
MAKERS = (vibeam_models, vibeam_reductions, vibeam.exchange.meshes)
UNKNOWN = (" at 0x", "...")  # in a repr that does not say all of a value
ROWS = FIELDS[:-1]


def folder() -> Path | None:
    """Folder of the files; None where none are kept."""
    said = os.environ.get("VIBEAM_CACHE")
    if said is not None:
        return Path(said) / "structures" if said else None
    own = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(own) if own else Path.home() / ".cache") / "vibeam" / "structures"


def place_of(*content: Any) -> Path | None:
    """File of what is made from ``content``; None where that cannot be told from its repr."""
    text, home = repr(content), folder()
    if home is None or any(each in text for each in UNKNOWN):
        return None
    return home / f"{sha256(f'{_code()} {text}'.encode()).hexdigest()[:40]}.npz"


def kept(place: Path | None) -> tuple[Structure, float] | None:
    """Reduced structure and static deflection of a file; None where there is none, or a damaged one."""
    content = _sealed(place, OF)
    return None if content is None else _read(content)


def keep(place: Path | None, structure: Structure, static: float) -> None:
    """Keep a reduced structure; nothing where the disk does not take it."""
    _write(place, _written(structure, static), OF)


def noted(*content: Any) -> Any:
    """Value noted of ``content``, as JSON has it; None where there is none, or a damaged one."""
    found = _sealed(_note_of(*content), NOTE)
    return None if found is None else json.loads(found)


def note(value: Any, *content: Any) -> None:
    """Note a value of ``content``; nothing where the disk does not take it."""
    _write(_note_of(*content), json.dumps(value).encode(), NOTE)


def _note_of(*content: Any) -> Path | None:
    place = place_of(*content)
    return None if place is None else place.with_suffix(".json")


def _sealed(place: Path | None, of: str) -> bytes | None:
    with suppress(OSError):
        return None if place is None else read_sealed(place, of)
    return None


def _write(place: Path | None, content: bytes, of: str) -> None:
    if place is None:
        return
    with suppress(OSError):
        place.parent.mkdir(parents=True, exist_ok=True)
        write_sealed(place, content, of)
        files = place.parent.glob(f"*{place.suffix}")
        for old in sorted(files, key=lambda each: each.stat().st_mtime)[:-MOST]:
            old.unlink(missing_ok=True)


def _written(structure: Structure, static: float) -> bytes:
    names = {"outputs": list(structure.outputs), "units": dict(structure.units), "static": static}
    names["flexibility"] = structure.contact_flexibility
    rows = {f"row {name}": getattr(structure, name) for name in ROWS}
    rows |= {f"output {i}": row for i, row in enumerate(structure.outputs.values())}
    rows |= {f"attached {i}": row for i, row in enumerate(structure.attached)}
    file = BytesIO()
    np.savez(file, names=np.array(json.dumps(names)), **dict[str, Any](rows))
    return file.getvalue()


def _read(content: bytes) -> tuple[Structure, float]:
    with np.load(BytesIO(content), allow_pickle=False) as file:
        names = json.loads(str(file["names"]))
        attached = tuple(file[f"attached {i}"] for i in range(sum(each.startswith("attached") for each in file.files)))
        outputs = {name: file[f"output {i}"] for i, name in enumerate(names["outputs"])}
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
