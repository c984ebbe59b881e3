"""Accuracy against time, over both axes: every fidelity by every solver that can take it, and where the error is."""
