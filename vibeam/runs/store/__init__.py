"""Results file of a case: what it holds, how it is adapted to a changed case."""
