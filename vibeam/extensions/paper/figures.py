"""Declarations of the kinds of figure."""

from __future__ import annotations

from vibeam.figures.declaration import FigureKind

HOME = "vibeam.extensions.paper"
FIGURES = (
    FigureKind(
        "coordinates",
        f"{HOME}.coordinates_figure",
        "one mode's motion in physical and in Zhuravlev's or Ivanov's coordinates",
        ("frequency",),
        ("periods", "settle"),
        {"physical_jump": "1", "unfolded_jump": "1"},
        one_harmonic=True,
    ),
    FigureKind(
        "boundaries",
        f"{HOME}.boundaries_figure",
        "averaging's limits beside the exact ones",
        ("quantity",),
        # Q* of eq. 24, Δ_MAX of eq. 26, and the reach and the gap at the exact folds
        quantities={"least_stable_reach": "c", "largest_gap": "c"},
        one_harmonic=True,
        refuses=True,
    ),
)
