"""Reductions of a structure. Imports ``vibeam_models`` only."""
