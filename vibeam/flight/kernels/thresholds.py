"""Thresholds of the kernels that what packs or reads their arrays needs too."""

from __future__ import annotations

PANEL = 2.1  # the longest panel is at most this over the drive's rate: a sixth to a third of its period

RESOLVED = 1.2  # κh up to which a pair takes part in the interpolant; above it enters by bounds

APART = 0.75  # μ²/σ² = 1 − 1/ζ² beyond which a pair is taken as its two decays: ζ > 2, one 13.9 times the other

LINGERING = 8.0  # longest panels, over e-folding time of the slow decay, below which it outlasts the lanes' panels

ELASTIC = 1e-5  # 1 − R below which an accumulation of impacts is left by its energy, not completed by its limit

SILENT = 1e-100  # a contact value so small that dividing by it would lose digits; such modes are carried by themselves

FORGOTTEN = 75.0  # decay exponents beyond this leave less than 1e-32

REDUCED = 1e5  # rad up to which the parts keep all digits

FAR = 10.0  # distance of the equilibrium over the size of the motion beyond which taking it out loses digits

BRISK = 1e3  # 2σ over the rate of the motion, or both over the drive's, beyond which carrying a mode costs too much

FAR_DRIVEN = 1e5  # the same of a steady response, which the motion soon becomes as large as, and carrying costs more
