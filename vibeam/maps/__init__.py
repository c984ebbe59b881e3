"""Quantities of a case over a grid of its keys: in memory, or block by block on disk."""
