"""Influence of each effect, and the smallest set that a scene needs."""
