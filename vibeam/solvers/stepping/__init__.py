"""Compiled loops of the time-stepping solver, apart from the flight solver's kernels and their cache."""
