"""Meshes of the user's own: formats, groups, faults, and the body that they make."""
