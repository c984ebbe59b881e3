"""Functions of a spatial scene that the core asks for by the scene itself (``AnyScene.spatial``)."""

from __future__ import annotations

from vibeam.extensions.solid.kept_structures import keep as keep
from vibeam.extensions.solid.kept_structures import kept as kept
from vibeam.extensions.solid.kept_structures import place_of as place_of
from vibeam.extensions.solid.shape import solid_shapes as solid_shapes
from vibeam.extensions.solid.shape import solid_system as solid_system
