"""Beams as data: sections and their shapes, stretches, bonded plates, supports."""
