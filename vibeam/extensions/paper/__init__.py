"""Methods of Rebouças, Santos and Thomsen (2018) beside exact flight: averaging, mapping, two transformations."""

from __future__ import annotations

from vibeam_models.extensions import Extension

EXTENSION = Extension(
    {
        "solver": "vibeam.extensions.paper.solvers:SOLVERS",
        "kind of figure": "vibeam.extensions.paper.figures:FIGURES",
    }
)
