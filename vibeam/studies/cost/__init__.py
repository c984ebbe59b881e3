"""Accuracy against time: every fidelity by every solver."""
