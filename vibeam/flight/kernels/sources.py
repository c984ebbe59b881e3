"""The files of the kernels, and the digest by which a change in them is noticed."""

from __future__ import annotations

from functools import cache
from hashlib import sha256
from pathlib import Path

HERE = Path(__file__).parent
REGIMES, *OTHERS = GROUPS = ("regimes", "contacts", "tangents")  # folders of kernels that a plain system never calls


def files_of(group: str) -> tuple[Path, ...]:
    """The kernels of a group alone."""
    return tuple(sorted((HERE / group).rglob("*.py")))


FLIGHT = tuple(file for file in sorted(HERE.rglob("*.py")) if not {*GROUPS} & {*file.relative_to(HERE).parts})
EVERY = FLIGHT + files_of(REGIMES)  # of the engine of any regime, which the other groups are made of too
POINTS = tuple(sorted((HERE.parent / "points" / "kernels").glob("*.py")))  # of points in lanes alone


@cache
def digest(files: tuple[Path, ...]) -> str:
    """SHA-256 of the files' contents, in hexadecimal."""
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def sources_of(module: str) -> tuple[Path, ...]:
    """The files that an entry point in ``module`` may be compiled from."""
    if ".points." in module:
        return FLIGHT + POINTS
    own = next((group for group in OTHERS if f".{group}." in module), None)
    if own is not None:
        return EVERY + files_of(own)
    return EVERY if f".{REGIMES}." in module else FLIGHT
