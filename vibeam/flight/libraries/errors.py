"""Faults of the compiled kernels."""

from __future__ import annotations


class LibraryUnavailable(Exception):
    """Why there is no library for this machine."""


class KernelsUnavailable(RuntimeError):
    """Neither a library for this machine nor numba, or a wrong VIBEAM_KERNELS; with the cure."""
