"""Numerical integration: impact events, coordinate transformations, time stepping."""
