"""The files of the kernels, and the digest by which a change in them is noticed."""

from __future__ import annotations

from functools import cache
from hashlib import sha256
from pathlib import Path

REGIMES = "regimes"  # the folder of the kernels that a plain system never calls
HERE = Path(__file__).parent
EVERY = tuple(sorted(HERE.rglob("*.py")))
FLIGHT = tuple(file for file in EVERY if REGIMES not in file.relative_to(HERE).parts)
POINTS = tuple(sorted((HERE.parent / "points" / "kernels").glob("*.py")))  # of points in lanes alone


@cache
def digest(files: tuple[Path, ...]) -> str:
    """SHA-256 of the files' contents, in hexadecimal."""
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def sources_of(module: str) -> tuple[Path, ...]:
    """The files that an entry point in ``module`` may be compiled from."""
    if ".points." in module:
        return FLIGHT + POINTS
    return EVERY if f".{REGIMES}." in module else FLIGHT
