"""Studies of a case: regression, cost, influence, stability, derived parameters, modes."""
