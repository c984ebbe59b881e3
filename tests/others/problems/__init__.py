"""Rows of the book, a chapter a field."""
