"""Losses of a reduction, known beforehand."""
