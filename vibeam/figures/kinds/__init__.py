"""The kinds of figures that a case may ask for."""
