"""Sweeps, runs of a case, and results files."""
