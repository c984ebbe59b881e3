"""A-posteriori error of a reduced model's response against the full model, through the impacts.

``error`` estimates it at the points of a response, ``motions`` has the impacts of the reduced model's motions,
``full_model`` the model with all modes of a fidelity's scene, ``flown`` the motions that this makes, ``of_case`` puts
them together for a run and ``summary`` says it in a row. The mathematics is in
``vibeam.periodic.predicted_response``.
"""
