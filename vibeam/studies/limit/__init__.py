"""The limit of infinitely many modes: what converges, how fast, and where there is no limit.

``sequences`` evaluates a rig in 1, 2, 4 … modes with something held, ``rates`` observes how a sequence converges and
extrapolates it or refuses, ``study`` puts them together.
"""
