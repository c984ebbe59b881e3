"""Explore: the exact engine inside a page, and the sliders that move it."""
