"""Limit of infinitely many modes: which quantities converge, how fast, and which have no limit.

``sequences`` evaluates a rig in 1, 2, 4 … modes with something held, and observes how each sequence converges, or
refuses its limit; ``study`` puts them together.
"""
