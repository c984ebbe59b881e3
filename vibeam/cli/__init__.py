"""Command line of vibeam."""
