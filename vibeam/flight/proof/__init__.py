"""Proofs and bounds of a motion: its certificate, and the errors of its numbers."""
