"""A load over time in place of a sine: the flow under it in closed form, piece by piece."""
