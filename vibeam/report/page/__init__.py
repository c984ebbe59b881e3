"""One HTML page of a results file."""
