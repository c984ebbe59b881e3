"""Kernels compiled ahead of time: which library a machine takes, how it is loaded and called."""
