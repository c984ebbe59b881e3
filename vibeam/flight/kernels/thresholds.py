"""Thresholds of the kernels that what packs or reads their arrays needs too."""

from __future__ import annotations

PANEL = 2.1  # the longest panel is at most this over the drive's rate: a sixth to a third of its period

RESOLVED = 1.2  # κh up to which a pair takes part in the interpolant; above it enters by bounds

SILENT = 1e-100  # a contact value so small that dividing by it would lose digits; such modes are carried by themselves

FORGOTTEN = 75.0  # decay exponents beyond this leave less than 1e-32

REDUCED = 1e5  # rad up to which the parts keep all digits

FAR = 10.0  # distance of the equilibrium over the size of the motion beyond which taking it out loses digits

FAR_DRIVEN = 1e5  # the same of a steady response, which the motion soon becomes as large as, and carrying costs more
