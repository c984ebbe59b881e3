"""Fidelity map of a case: over two of its keys, the cheapest model that suffices, and where models differ in kind."""
