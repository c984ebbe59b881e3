"""Comparison of a result with reference curves and expected numbers."""
