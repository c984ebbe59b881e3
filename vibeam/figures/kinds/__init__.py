"""Kinds of figures for a case."""
