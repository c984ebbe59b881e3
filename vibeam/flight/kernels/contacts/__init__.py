"""Kernels of several contacts: sets that are held or pushed as regimes, impacts in turn, what stays held."""
