"""The first root of a signal, isolated with proof."""
