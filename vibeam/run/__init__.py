"""The sweep, the run of a case, and its results."""
