"""Uncertainty of the inputs carried through the sweep."""
