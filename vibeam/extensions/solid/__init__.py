"""Solids: the rig as a three-dimensional body, meshed, or a mesh of the user's own."""

from __future__ import annotations

from vibeam_models.extensions import Extension

EXTENSION = Extension(
    {
        "model": "vibeam.extensions.solid.declared:MODELS",
        "kind of case": "vibeam.extensions.solid.declared:KINDS",
        "stage of a verdict": "vibeam.extensions.solid.stages:STAGES",
        "reader of meshes": "vibeam.extensions.solid.declared:READERS",
    }
)
