"""Run of a case under a record: motions, their numbers, the comparison of fidelities, the results file."""
