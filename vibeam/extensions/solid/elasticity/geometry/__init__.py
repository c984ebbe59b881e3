"""Geometry of a scene's bodies: structured hexahedra of its sections, plates and mass blocks."""
