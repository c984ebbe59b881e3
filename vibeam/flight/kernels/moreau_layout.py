"""Where things stand in the arrays of Moreau–Jean time stepping."""

from __future__ import annotations

# rows (ROWS, n): ω², 2ζω, contact, load Ω²B, static, 1/(1 + 2ζω θh + ω²θ²h²), workspace for the free velocities
STIFFNESS, DAMPING, CONTACT, LOAD, STATIC, INVERSE, FREE = range(7)

ROWS = 7

# scheme (4,): h, θ, gap, R
STEP, THETA, GAP, RESTITUTION = range(4)

# strikes (≥ count, 2): step, contact velocity before; totals (2,): impacts, steps held on the stop
IMPACTS, HELD = range(2)
