"""Kernels of small disturbances carried along the motions of points."""
