"""Adaptive choice of fidelity (``accuracy = "1 %"``): the cheapest model and solver within it, for each frequency.

``closed_forms`` has the closed-form motions of one model over the whole sweep. ``candidates`` evaluates one model by
one solver. ``finest`` follows the finest model as a sweep would: in closed form where a stable motion continues, by
flight elsewhere. ``choice`` selects a cheaper model between frequencies at which it is accurate enough;
``unsettled`` does so by statistics where the motion is aperiodic. ``verification`` computes the finest model at random
points. ``study`` combines them.
"""
