"""The files that an entry point may be compiled from."""

from __future__ import annotations

from pathlib import Path

from vibeam.flight.kernels import sources

POINTS = tuple(sorted((Path(__file__).parents[1] / "points" / "kernels").glob("*.py")))


def sources_of(module: str) -> tuple[Path, ...]:
    """Those of ``kernels.sources``, and of batches those of ``points.kernels`` too."""
    return sources.sources_of(module) + (POINTS if ".points." in module else ())
