"""Meshes of other programs, read by the extension that brings them."""
