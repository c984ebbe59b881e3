"""Digest of the code behind the numbers that a results file keeps in place of the systems."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np

import vibeam_models
import vibeam_reductions
from vibeam.solvers import SOLVERS
from vibeam_models.effects import EFFECTS
from vibeam_models.laws import LAWS
from vibeam_reductions.declaration import REDUCTIONS

FOLDERS = (Path(__file__).parents[1], *map(Path, [*vibeam_models.__path__, *vibeam_reductions.__path__]))

SHOWN = ("cli", "figures", "report", "studies")  # rooms that compute none of these numbers

BELOW = ("scipy", "scikit-fem")  # libraries that assemble and reduce


def digest_of_code() -> str:
    """Digest of all sources that build a system or compare fidelities, and of the libraries below them.

    Empty where a program has registered effects, laws, reductions or solvers of its own, whose code is not known here.
    """
    return "" if any(each.extended for each in (EFFECTS, LAWS, REDUCTIONS, SOLVERS)) else _digest(FOLDERS)


@cache
def _digest(folders: tuple[Path, ...]) -> str:
    found = sha256(" ".join([np.__version__, *map(_metadata, BELOW)]).encode())
    for folder in folders:
        for file in _sources(folder):
            found.update(file.read_bytes())
    return found.hexdigest()


def _sources(folder: Path) -> Iterator[Path]:
    for part in sorted(folder.iterdir()):
        if part.is_dir() and part.name not in SHOWN:
            yield from sorted(part.rglob("*.py"))
        elif part.suffix == ".py":
            yield part


def _metadata(package: str) -> str:
    """Metadata of an installed package, its version among them, as they are: reading them takes longer than hashing."""
    try:
        return distribution(package).read_text("METADATA") or ""
    except PackageNotFoundError:
        return "not installed"
