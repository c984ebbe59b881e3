"""Declarations of the model of a fidelity, and of the case that is a mesh."""

from __future__ import annotations

from vibeam.casefile.kinds import CaseKind, ModelDeclaration
from vibeam_models.registry import Home

HOME = "vibeam.extensions.solid"
TABLE, SOURCES = f"{HOME}.table:SolidTable", f"{HOME}.rules:sources"
MODELS = (
    ModelDeclaration(
        "solid",
        "the rig as a three-dimensional body",
        TABLE,
        f"{HOME}.rules:solid_scene",
        f"{HOME}.rules:solid_rules",
        SOURCES,
    ),
)
KINDS = (
    CaseKind(
        "solid",
        f"{HOME}.rules:mesh_rules",
        "vibeam.casefile.tables.given:given_output",
        f"{HOME}.rules:mesh_scene",
        f"{HOME}.rules:most_modes",
        SOURCES,
        table=TABLE,
        meaning="A structure by a mesh of its body.",
        needs="mesh",
    ),
)
READERS = (Home("meshes", f"{HOME}.meshes.read:read_mesh"),)
