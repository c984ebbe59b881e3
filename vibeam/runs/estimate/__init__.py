"""A-posteriori error of a reduced model's response against the full model, through the impacts.

``error`` estimates it at the points of a response along the exact orbits of these, by closed forms or (``by_orbits``)
by shooting, ``full_sweep`` has the motions that the full model makes, ``of_case`` puts them together for a run and
``work`` counts what that takes, and
``records`` has what is found, and says it in a row. The mathematics is in ``vibeam.periodic.motions``.
"""
