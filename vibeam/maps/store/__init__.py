"""Blocks of a map on disk, each a whole file, and the one file that they are gathered to."""
