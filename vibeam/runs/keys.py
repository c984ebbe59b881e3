"""Keys of what a results file keeps: digests of all that decides its numbers, the code included."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

import vibeam_models
import vibeam_reductions
from vibeam.solvers import SOLVERS
from vibeam_models.effects import EFFECTS
from vibeam_models.laws import LAWS
from vibeam_reductions.declaration import REDUCTIONS

if TYPE_CHECKING:
    from vibeam.case.case import Case
    from vibeam.runs.store.file import Store
    from vibeam.runs.store.records import KeyedRecord
    from vibeam.system.response import Branches


FOLDERS = (Path(__file__).parents[1], *map(Path, [*vibeam_models.__path__, *vibeam_reductions.__path__]))
SHOWN = ("cli", "figures", "report")  # rooms that compute no numbers
BUT_STUDIES = (*SHOWN, "studies")
BELOW = ("scipy", "scikit-fem")  # libraries that assemble and reduce

Made = TypeVar("Made")


def digest_of_code(studies: bool = False) -> str:
    """Digest of all sources that build a system or compare fidelities, and of the libraries below them.

    ``studies``: and of those of the studies. Empty where a program has registered effects, laws, reductions or solvers
    of its own, whose code is not known here.
    """
    extended = any(each.extended for each in (EFFECTS, LAWS, REDUCTIONS, SOLVERS))
    return "" if extended else _digest(FOLDERS, SHOWN) if studies else _digest(FOLDERS)


@cache
def _digest(folders: tuple[Path, ...], shown: tuple[str, ...] = BUT_STUDIES) -> str:
    found = sha256(" ".join([np.__version__, *map(_metadata, BELOW)]).encode())
    for folder in folders:
        for file in _sources(folder, shown):
            found.update(file.read_bytes())
    return found.hexdigest()


def _sources(folder: Path, shown: tuple[str, ...]) -> Iterator[Path]:
    for part in sorted(folder.iterdir()):
        if part.is_dir() and part.name not in shown:
            yield from sorted(part.rglob("*.py"))
        elif part.suffix == ".py":
            yield part


def _metadata(package: str) -> str:
    """Metadata of an installed package, its version among them, as they are: reading them takes longer than hashing."""
    try:
        return distribution(package).read_text("METADATA") or ""
    except PackageNotFoundError:
        return "not installed"


def branch_key(own: str, direction: str, up: NDArray[np.float64], after_up: bool) -> str:
    """Key of all numbers of a branch beside the frequencies, the sweep's lowest frequency included.

    ``own``: key of its fidelity, ``up``: all frequencies, ascending; ``after_up``: it goes on from the upward sweep.
    """
    start = up.tobytes() if direction == "down" and after_up else b"equilibrium"
    return sha256(b"\n".join((own.encode(), direction.encode(), up[:1].tobytes(), start))).hexdigest()


def model_key(case: Case, name: str) -> str:
    """Key of one fidelity's model and of its fitness for the frequencies: the case's part in it, and the code.

    Empty where the code is not known.
    """
    code = digest_of_code()
    return code and sha256(f"{code} {case.own[name]}".encode() + case.sweep.frequency.tobytes()).hexdigest()


def comparison_key(case: Case, finest: Mapping[str, str], branches: Mapping[str, Branches], asked: str = "") -> str:
    """Key of a comparison of fidelities with their ``finest``: models, and every number of their ``branches``.

    ``asked``: what is asked of them. Empty where the code is not known.
    """
    if not digest_of_code():
        return ""
    found = sha256(repr([(name, top, model_key(case, name)) for name, top in finest.items()]).encode() + asked.encode())
    for name, several in branches.items():
        for direction, response in several.items():
            found.update(f"{name} {direction}".encode())
            for field in fields(response):
                found.update(np.ascontiguousarray(getattr(response, field.name)).tobytes())
    return found.hexdigest()


def kept_or_made(store: Store | None, record: KeyedRecord[Made], key: str, make: Callable[[], Made]) -> Made:
    """Value that the file keeps of a ``record`` under ``key``, else what ``make`` makes, which it keeps from now on."""
    kept = store.kept(record, key) if store else None
    if kept is not None:
        return kept
    made = make()
    if store:
        store.keep(record, key, made)
    return made
