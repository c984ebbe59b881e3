"""Pointwise mapping from impact to impact of a one-mode system."""
