"""Motions under a load over time, a ``Record``."""
